"""A few manoeuvres of two ships, sailed once."""

import pytest

from ship_gym.evaluation.manoeuvres.definition import Manoeuvre
from ship_gym.evaluation.manoeuvres.sailing import sail_manoeuvres

FEW = (
    Manoeuvre("turning", 35.0),
    Manoeuvre("zigzag", 10.0, 10.0, ("calm", "ss5")),
    Manoeuvre("zigzag", 20.0, 5.0),
    Manoeuvre("stopping", seas=("calm", "ss5")),
)


@pytest.fixture(scope="session")
def sailed():
    return sail_manoeuvres(FEW, ["kvlcc2", "kcs"])
