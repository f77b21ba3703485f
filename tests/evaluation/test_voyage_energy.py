"""Energy of a voyage with a deadline: by hand, of models, and where she does not arrive."""

import dataclasses
import math

import numpy as np
import pytest
from ship_gym_agents.los import ILOS

from ship_gym.evaluation import metrics, rollout
from ship_gym.recording import Trajectory
from ship_gym.recording.about import ship_meta
from ship_gym.ships import available_ships, load_ship
from ship_gym.ships.open_water import coefficients
from ship_gym.ships.powering import largest_power, powering

SHORT = {"track.points": [[0.0, 0.0], [900.0, 0.0]], "duration": 240.0}


def steady(rows):
    """Columns of a ship that neither loses nor gains speed."""
    return {"u": np.full(rows, 7.0), "current_speed": np.zeros(rows)}


@pytest.fixture(scope="module")
def sailed():
    """Arrives after about 120 s."""
    return rollout(ILOS(), "track_economy", seeds=[1], overrides=SHORT).trajectory(0)


def test_energy_until_the_end_by_hand(sailed):
    """Constant 1.5 rev/s against 0.8 MN m: 2 pi 1.5 0.8e6 = 7.54 MW all the way."""
    assert sailed.meta["outcome"] == "arrived"
    rows = len(sailed)
    held = steady(rows) | {"n": np.full(rows, 1.5), "torque": np.full(rows, 0.8e6)}
    constant = Trajectory(sailed.columns | held, sailed.meta)
    hours = (sailed["t"][-1] - sailed["t"][0]) / 3600.0
    assert 90.0 < 3600.0 * hours < 150.0
    expected = 2.0 * math.pi * 1.5 * 0.8e6 * hours / 1e3
    assert metrics(constant)["voyage_energy"] == pytest.approx(expected, rel=1e-12)


def test_speed_lost_on_the_way_is_to_be_paid_and_speed_won_is_not(sailed):
    """From 7 to 5 m/s: m_u (49 - 25) / 2 over the efficiency; the engine stands still."""
    rows, ship = len(sailed), load_ship("kcs")
    still = {"n": np.zeros(rows), "torque": np.zeros(rows), "current_speed": np.zeros(rows)}
    speeds = np.linspace(7.0, 5.0, rows)
    lost = Trajectory(sailed.columns | still | {"u": speeds}, sailed.meta)
    expected = 12.0 * ship.inertia.m_u / powering(ship).efficiency / 3.6e6
    assert metrics(lost)["voyage_energy"] == pytest.approx(expected, rel=1e-12)
    won = Trajectory(sailed.columns | still | {"u": speeds[::-1]}, sailed.meta)
    assert metrics(won)["voyage_energy"] == 0.0


def test_to_arrive_with_the_corridor_left_is_to_arrive(sailed):
    strayed = Trajectory(sailed.columns, sailed.meta | {"outcome": "arrived, corridor left"})
    assert metrics(strayed)["voyage_energy"] == metrics(sailed)["voyage_energy"]


@pytest.mark.parametrize(
    ("outcome", "failed"),
    [("end of time", False), ("cross-track limit", True), ("missed the end", True)],
)
def test_who_does_not_arrive_has_gone_full_ahead_over_the_planned_time(sailed, outcome, failed):
    """KCS: 4 MN m at 2.306 rev/s is 57.9 MW; for 240 s 3,863 kWh."""
    lost = Trajectory(sailed.columns, sailed.meta | {"outcome": outcome, "failed": failed})
    found = metrics(lost)["voyage_energy"]
    assert found == pytest.approx(2.0 * math.pi * 2.3057584 * 4.0e6 * 240.0 / 3.6e6, rel=1e-6)
    assert found > 5.0 * metrics(sailed)["voyage_energy"]


def test_failing_at_once_never_pays(sailed):
    """Not even against full ahead all the way to the last second."""
    rows, ship = len(sailed), load_ship("kcs")
    engine = {"n": np.full(rows, ship.engine.n_max), "torque": np.full(rows, 4.0e6)}
    worst = Trajectory(sailed.columns | engine, sailed.meta)
    lost = Trajectory(sailed.columns, sailed.meta | {"outcome": "cross-track limit"})
    assert metrics(worst)["voyage_energy"] < metrics(lost)["voyage_energy"]


def test_a_model_counts_at_full_scale():
    """Energy goes with the fourth power of the scale, power with the 3.5th."""
    model = rollout(
        ILOS(),
        "track_economy",
        seeds=[1],
        ship="kcs_model",
        overrides={"track.kind": "straight", "track.points": [], "duration": 60.0},
    ).trajectory(0)
    ship = load_ship("kcs_model")
    late = 2.0 * math.pi * ship.engine.n_max * ship.engine.torque_max * ship.scale**3.5
    assert metrics(model)["voyage_energy"] == pytest.approx(late * 60.0 / 3.6e6, rel=1e-9)
    columns = model.columns | steady(len(model))
    there = Trajectory(columns, model.meta | {"outcome": "arrived"})
    power = 2.0 * math.pi * model["n"] * model["torque"]
    work = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(model["t"]))
    expected = work * ship.scale**4 / 3.6e6
    assert metrics(there)["voyage_energy"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", available_ships())
def test_the_largest_power_is_more_than_any_steady_speed_takes(name):
    ship = load_ship(name)
    assert largest_power(ship) > powering(ship).delivered_power
    assert ship_meta(ship)["power_max"] == largest_power(ship)


def test_without_a_limit_of_the_torque_the_propeller_is_held_in_place():
    ship = load_ship("onrt")
    free = dataclasses.replace(ship, engine=dataclasses.replace(ship.engine, torque_max=math.inf))
    n, D = ship.engine.n_max, ship.propeller.D
    torque = float(coefficients(ship.open_water, 0.0)[1]) * ship.rho * n**2 * D**5
    assert largest_power(free) == pytest.approx(2 * 2.0 * math.pi * n * torque)  # of two
    assert largest_power(ship) == pytest.approx(2 * 2.0 * math.pi * n * ship.engine.torque_max)
