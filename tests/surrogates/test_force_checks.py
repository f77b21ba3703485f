"""Forces in another normalisation, and one angle in radians: warned of by their size."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.ships import load_ship
from ship_gym.surrogates.force_checks import (
    RUDDER_BAND,
    THRUST_BAND,
    force_ratios,
    stray_radians,
    unusual_sizes,
)
from ship_gym.surrogates.samples import DATA_SETS, KCS

SETS = [(data, choice) for data in DATA_SETS.values() for choice in data.choices]
NAMES = [f"{data.name} {' '.join(choice)}" for data, choice in SETS]
every_set = pytest.mark.parametrize(("data", "choice"), SETS, ids=NAMES)


def read(data, choice):
    """Ship and samples of every rudder."""
    ship = load_ship(data.ship, surrogate="none")
    return ship, [data.read(*choice, side) for side in data.sides]


def times(samples, factor, *names):
    values = {name: factor * samples.values[name] for name in names}
    return dataclasses.replace(samples, values=samples.values | values)


@every_set
def test_the_sets_of_the_package_are_usual_with_a_quarter_to_spare(data, choice):
    ship, rudders = read(data, choice)
    assert unusual_sizes(data, ship, rudders) == []
    bands = (RUDDER_BAND, THRUST_BAND)
    for ratio, (low, high) in zip(force_ratios(data, ship, rudders), bands, strict=True):
        assert 1.25 * low < ratio < high / 1.25


@every_set
@pytest.mark.parametrize("factor", [3.0, 1.0 / 3.0])
def test_another_normalisation_of_the_rudder_is_warned_of(data, choice, factor):
    ship, rudders = read(data, choice)
    (warning,) = unusual_sizes(data, ship, [times(s, factor, "C_Fx", "C_Fy") for s in rudders])
    assert str(data.path) in warning and "C_Fx, C_Fy: normal force" in warning
    assert f"A_R = {ship.rudder.A_R:.4g} m2, usual is 0.35 to 1.27" in warning


@every_set
@pytest.mark.parametrize("factor", [3.0, 1.0 / 3.0])
def test_another_normalisation_of_the_thrust_is_warned_of(data, choice, factor):
    ship, rudders = read(data, choice)
    found = unusual_sizes(data, ship, [times(s, factor, data.thrust) for s in rudders])
    assert any(f"{data.thrust}: " in x and "open-water thrust in the wake" in x for x in found)


def in_radians(samples, i):
    """The same samples with the angle of one written in rad under a column of degrees."""
    X = samples.X.copy()
    X[i, 1] = math.radians(X[i, 1])
    return dataclasses.replace(samples, X=X)


def test_one_angle_in_radians_is_named_with_its_line():
    samples = KCS.read("G2", "SA")
    assert stray_radians(samples, KCS) == []
    place = int(np.flatnonzero(samples.points == 8)[0])  # 42.19 deg
    (warning,) = stray_radians(in_radians(samples, place), KCS)
    assert f"line {samples.rows[place]}: drift looks like radians" in warning
    assert "go better with 42.2 deg" in warning


def test_nine_of_ten_such_angles_are_found_and_no_set_is_suspected():
    found = []
    for data, choice in SETS:
        for samples in read(data, choice)[1]:
            assert stray_radians(samples, data) == []
            if len(samples.points) < 8:
                continue
            for i in np.flatnonzero(samples.X[:, 1] > math.radians(8.0)):
                found.append(bool(stray_radians(in_radians(samples, i), data)))
    assert len(found) > 90 and np.mean(found) > 0.9


def test_an_angle_of_zero_or_far_beyond_the_others_is_no_slip():
    samples = KCS.read("G2", "SA")
    for angle in (0.0, math.radians(1.2)):  # as radians 0 and 69 deg
        X = samples.X.copy()
        X[5, 1] = angle  # point 6, 2.81 deg
        assert stray_radians(dataclasses.replace(samples, X=X), KCS) == []
