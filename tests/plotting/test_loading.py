"""Propeller loading: the definitions, the reference curve, and a picture of each manoeuvre."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.plotting.loading import plot_loading, propeller_loading, straight_ahead
from ship_gym.reports.case import sail
from ship_gym.reports.manoeuvre import title
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import self_propulsion


@pytest.fixture(scope="module")
def zigzag():
    return sail(load_ship("kcs_model"), "zigzag", delta_deg=20.0)


def samples(**changes):
    """Return one sample: D = 2 m, rho = 1000 kg/m3, J = 1, K_T = 0.2, K_Q = 0.03."""
    one = {"u": 3.0, "v": 1.0, "psi": 0.0, "current_speed": 0.0, "current_direction_to": 0.0}
    one |= {"n": 1.5, "thrust": 0.2 * 1000 * 2.25 * 16, "torque": 0.03 * 1000 * 2.25 * 32}
    return {name: np.array([value]) for name, value in (one | changes).items()}


def test_definitions_of_adachi_and_sugai():
    found = propeller_loading(samples(u=np.float64(1.5)), 2.0, 1000.0)
    expected = {"J": 0.5, "K_T": 0.2, "K_Q": 0.03, "t_prime": 0.8, "q_prime": 0.24}
    expected["n_prime"] = 0.8 / (2.0 * math.pi * 0.24)  # as Stern et al. (2021) print it
    for name, value in expected.items():
        assert found[name] == pytest.approx([value]), name


def test_two_propellers_share_the_thrust():
    one, two = (propeller_loading(samples(), 2.0, 1000.0, count) for count in (1, 2))
    for name, factor in (("J", 1.0), ("n_prime", 1.0), ("t_prime", 0.5), ("q_prime", 0.5)):
        assert two[name] == pytest.approx(factor * one[name])


def test_advance_ratio_is_that_through_the_water():
    with_current = samples(u=4.0, current_speed=1.0)  # to the north, as the ship goes
    assert propeller_loading(with_current, 2.0, 1000.0)["J"] == pytest.approx([1.0])


@pytest.mark.parametrize("changes", [{"u": 0.1}, {"u": -3.0}, {"n": 0.0}, {"n": 0.1}])
def test_ship_at_rest_or_astern_and_stopped_propeller_are_left_out(changes):
    """J = 0.03, -1, infinite and 15."""
    found = propeller_loading(samples(**changes), 2.0, 1000.0)
    assert found["kept"].tolist() == [False]
    assert all(len(found[name]) == 0 for name in ("J", "t_prime", "q_prime", "n_prime"))


def test_straight_course_is_the_open_water_curve_in_the_wake():
    """KP505 by NMRI: the ship's cubic through the points, read at J_A = (1 - w_P0) J."""
    ship = load_ship("kcs_model")
    points = read_csv(DATA / "kcs_model" / "kp505_open_water.csv").columns
    curve = straight_ahead(ship, (0.4, 1.2), 9)
    J_A = (1.0 - ship.propeller.w_P0) * curve["J"]
    assert curve["J"] == pytest.approx(np.linspace(0.4, 1.2, 9))
    for name, factor in (("K_T", 1.0), ("10K_Q", 10.0)):
        cubic = np.polyfit(points["J"], points[name], 3)
        found = factor * curve[name.removeprefix("10")]
        assert found == pytest.approx(np.polyval(cubic, J_A), abs=1e-4), name


def test_manoeuvre_starts_at_self_propulsion_on_the_curve(zigzag):
    ship = zigzag.ship
    found = propeller_loading(zigzag.result.trajectory, ship.propeller.D, ship.rho)
    n = self_propulsion(ship, ship.speed)
    assert found["J"][0] == pytest.approx(ship.speed / (n * ship.propeller.D))
    curve = straight_ahead(ship, (0.5, 1.0), 501)
    for name in ("q_prime", "n_prime"):
        # t' falls along the curve
        expected = np.interp(found["t_prime"][0], curve["t_prime"][::-1], curve[name][::-1])
        assert found[name][0] == pytest.approx(expected, rel=1e-4), name


def test_loading_collapses_better_than_thrust_over_advance_ratio(zigzag):
    """Stern et al. (2021): q'(t') and n'(t') scatter less than K_T(J)."""
    ship = zigzag.ship
    found = propeller_loading(zigzag.result.trajectory, ship.propeller.D, ship.rho)
    curve = straight_ahead(ship, (0.4, 1.0), 501)

    def scatter(x: str, y: str) -> float:
        order = np.argsort(curve[x])
        expected = np.interp(found[x], curve[x][order], curve[y][order])
        return float(np.std(found[y] / expected - 1.0))

    assert scatter("t_prime", "n_prime") < scatter("J", "K_T")
    assert scatter("t_prime", "q_prime") < scatter("J", "K_T")


@pytest.mark.parametrize("colour", ["delta", "t"])
def test_picture(tmp_path, zigzag, colour):
    path = tmp_path / "loading.png"
    plot_loading(zigzag.result.trajectory, zigzag.ship, path, title=title(zigzag), colour=colour)
    data = path.read_bytes()
    assert data[:4] == b"\x89PNG"
    assert 15_000 < len(data) < 250_000


def test_unknown_colour_is_refused_before_anything_is_written(tmp_path, zigzag):
    path = tmp_path / "loading.png"
    with pytest.raises(ConfigError, match="did you mean 'delta'"):
        plot_loading(zigzag.result.trajectory, zigzag.ship, path, title="x", colour="dleta")
    assert not path.exists()


def test_particulars_are_checked():
    with pytest.raises(ConfigError, match="count of propellers"):
        propeller_loading(samples(), 2.0, 1000.0, 0)
    with pytest.raises(ConfigError, match="D = "):
        propeller_loading(samples(), math.nan, 1000.0)
