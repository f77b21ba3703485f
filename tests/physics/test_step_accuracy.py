"""Error of the default integration step at sea: heading of 64 ships against 1/32 of the step."""

from __future__ import annotations

import pytest

from ship_gym.reports.accuracy import MEDIAN, NINETY, conditions, measure
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship

CONDITIONS = {condition.name: condition for condition in conditions()}
CASES = [("kcs", name) for name in CONDITIONS]
CASES += [(name, "ahead") for name in available_ships() if name != "kcs"]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "condition"), CASES)
def test_the_default_step_is_accurate(name, condition):
    """600 steps without control, in which errors grow; what loads held over a step fail."""
    (found,) = measure(load_ship(name), CONDITIONS[condition], fractions=[1.0])
    assert found.median < MEDIAN, found
    assert found.ninety < NINETY, found
