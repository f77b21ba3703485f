"""Measured time histories: how a file is read, and MARIN's KVLCC2 beside its printed measures."""

import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.reports.case import sail
from ship_gym.reports.histories import (
    History,
    computed_history,
    difference,
    find_trials,
    measured_history,
    read_history,
)
from ship_gym.ships import load_ship

FOLDER = find_trials()
HEADER = "# a title\n# conventions: delta positive turns to PORT\n"
NAMES = "t [s],x [m],y [m],phi [deg],psi [deg],u [m/s],v [m/s],p [deg/s],r [deg/s],delta [deg]"
needs_files = pytest.mark.skipif(FOLDER is None, reason="MARIN's files are not beside the checkout")


@pytest.fixture
def file(tmp_path):
    """Approach at 8 m/s; from 10 s on the rudder goes to port with 2 deg/s."""
    rows = []
    for t in np.arange(0.0, 41.0):
        later = max(t - 10.0, 0.0)
        x, y, psi, delta = 8.0 * t, 5.0 - 0.01 * later**2, 0.3 - 0.1 * later, 0.5 + 2.0 * later
        rows.append(f"{t},{x:.9f},{y:.9f},0,{psi:.9f},8.0,0.0,0,0,{delta}")
    path = tmp_path / "marin_free_turn_60.csv"
    path.write_text(HEADER + NAMES + "\n" + "\n".join(rows) + "\n")
    return path


def test_time_and_axes_begin_with_the_rudder(file):
    ship = load_ship("kvlcc2")
    found = read_history(file, ship)
    assert found.t[0] == pytest.approx(0.0, abs=1e-9) and len(found.t) == 31
    np.testing.assert_allclose(found.x, 8.0 * found.t / 320.0, atol=1e-9)
    np.testing.assert_allclose(found.y, -0.01 * found.t**2 / 320.0, atol=1e-9)  # to port
    np.testing.assert_allclose(np.degrees(found.psi), 0.3 - 0.1 * found.t, atol=1e-9)
    np.testing.assert_allclose(np.degrees(found.delta), -0.5 - 2.0 * found.t, atol=1e-9)
    np.testing.assert_allclose(found.speed, 1.0, rtol=1e-9)


def test_of_a_model_ship_the_same_in_lengths(file):
    whole, model = (read_history(file, load_ship(name)) for name in ("kvlcc2", "kvlcc2_model"))
    np.testing.assert_allclose(whole.x, model.x, rtol=2e-2)  # 1/45.7 of 320 m is 7.00 m
    np.testing.assert_array_equal(whole.t, model.t)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("psi [deg]", "psi [rad]", "no column 'psi \\[deg\\]'"),
        ("8.5\n", "x\n", "delta .deg. = 'x' is not a number"),
        ("0,0,8.5\n", "0,0,-2.8e18\n", ":18: delta .deg. = -2.8e.18: allowed is -90 to 90"),
    ],
)
def test_a_damaged_file_is_told(file, old, new, words):
    file.write_text(file.read_text().replace(old, new))
    with pytest.raises(ConfigError, match=words):
        read_history(file, load_ship("kvlcc2"))


def test_a_rudder_that_never_moves_is_told(file):
    lines = file.read_text().splitlines()[:12]
    file.write_text("\n".join(lines) + "\n")
    with pytest.raises(ConfigError, match="the rudder does not move"):
        read_history(file, load_ship("kvlcc2"))


def test_the_folder_is_the_one_given_or_its_kvlcc2(file, tmp_path):
    assert find_trials(file.parent) == file.parent
    inner = tmp_path / "reference" / "kvlcc2"
    inner.mkdir(parents=True)
    (inner / file.name).write_text("")
    assert find_trials(inner.parent) == inner
    with pytest.raises(ConfigError, match="no files marin_free"):
        find_trials(tmp_path / "reference" / "none")


def test_differences_by_hand():
    t = np.arange(0.0, 11.0)
    flat = np.zeros(11)
    a = History(t, t, flat, flat, flat, flat + 1.0)
    b = History(t[:6], t[:6] + 3.0, flat[:6] + 4.0, flat[:6] + 0.1, flat[:6], flat[:6] + 0.8)
    found = difference(a, b)
    assert found["time"] == 5.0 and found["track"] == pytest.approx(5.0)
    assert found["heading"] == pytest.approx(math.degrees(0.1))
    assert found["speed"] == pytest.approx(0.2)


def test_of_a_circle_the_first_turn_counts():
    t = np.linspace(0.0, 10.0, 101)
    turning = 2.0 * math.pi * t / 5.0  # once round in 5 s
    circle = History(t, t, t, turning, t, t)
    assert difference(circle, circle)["time"] == pytest.approx(5.0, abs=0.11)


@needs_files
@pytest.mark.parametrize(
    ("delta", "advance", "transfer", "diameter"),
    [(35.0, 3.09, 1.35, 3.33), (-35.0, 3.02, 1.20, 3.07)],
)
def test_marins_turns_have_the_measures_that_the_ship_file_prints(
    delta, advance, transfer, diameter
):
    """So the side of the file, the beginning and the axes are right. To starboard and to port."""
    found = measured_history(sail(load_ship("kvlcc2"), "turning", delta_deg=delta), FOLDER)
    side = math.copysign(1.0, delta)
    turned = side * np.degrees(found.psi)
    x, y = (np.interp([90.0, 180.0], turned, part) for part in (found.x, side * found.y))
    assert x[0] == pytest.approx(advance, abs=0.03)
    assert y[0] == pytest.approx(transfer, abs=0.03)
    assert y[1] == pytest.approx(diameter, abs=0.03)
    assert np.degrees(np.abs(found.delta[-1])) == pytest.approx(35.0, abs=1.1)


@needs_files
@pytest.mark.parametrize(("delta", "first"), [(10.0, 8.1), (-10.0, 9.4), (20.0, 13.7)])
def test_marins_zigzags_have_the_first_overshoots_that_the_ship_file_prints(delta, first):
    case = sail(load_ship("kvlcc2"), "zigzag", delta_deg=delta, psi_deg=delta)
    found = measured_history(case, FOLDER)
    side = math.copysign(1.0, delta)
    early = found.t < 250.0
    largest = np.degrees((side * found.psi)[early].max())
    assert largest - abs(delta) == pytest.approx(first, abs=0.1)
    ours = computed_history(case)
    assert side * ours.psi[100] > 0.0 and side * found.delta[10] > 0.0
    assert difference(ours, found)["heading"] < 30.0


@needs_files
def test_other_ships_seas_and_zigzags_have_no_history():
    assert measured_history(sail(load_ship("kcs"), "turning"), FOLDER) is None
    odd = sail(load_ship("kvlcc2"), "zigzag", delta_deg=20.0, psi_deg=10.0)
    assert measured_history(odd, FOLDER) is None
    assert measured_history(odd, None) is None
