"""Which row of a recording holds what: commanded beside achieved, forces with their state."""

import math

import numpy as np
import pytest

from ship_gym import load_ship
from ship_gym.conventions import FLOW_OF_UNITS, N_FLOW, UNIT_NAMES
from ship_gym.evaluation import rollout

CALM = {
    "sea.states": [],
    "sea.gusts": False,
    "sea.current_speed": 0.0,
    "sensors.noise": False,
    "start.heading_error_deg": 0.0,
}
SHIP = load_ship("kcs")
RUDDER = (1.0, 1.0, -0.5, 0.0, 0.25)  # actions of five intervals, as shares of delta_max
RPM = (-1.0, 1.0, 0.0, 0.0, 0.5)


class Script:
    """Gives the same actions, interval by interval, to every episode."""

    name = "script"

    def __init__(self, *columns):
        self.actions = np.array(columns).T

    def reset(self, count, ship, scenario):
        self.count, self.k = count, 0

    def act(self, observations):
        self.k += 1
        return np.tile(self.actions[self.k - 1], (self.count, 1))


def sailed(dt=2.0, ship=None, **overrides):
    given = CALM | {"duration": dt * len(RUDDER), "control_interval": dt} | overrides
    return rollout(Script(RUDDER, RPM), seeds=[3], ship=ship, control="rudder+rpm", overrides=given)


def test_commands_stand_in_the_row_in_which_they_are_given_and_the_last_one_twice():
    t = sailed().trajectory(0)
    delta = math.radians(35.0) * np.array([*RUDDER, RUDDER[-1]])
    n = SHIP.engine.n_max * 0.5 * (1.0 + np.array([*RPM, RPM[-1]]))
    np.testing.assert_allclose(t["t"], 2.0 * np.arange(6))
    np.testing.assert_allclose(t["delta_command"], delta, rtol=1e-12)
    np.testing.assert_allclose(t["n_command"], n, rtol=1e-12)


def test_an_episode_that_ends_before_the_others_repeats_its_own_last_command():
    """Hard over with a little more rudder off in each interval, so that no two rows are alike."""
    actions = 1.0 - 0.001 * np.arange(60)
    early = {"limits.heading_error_deg": 12.0, "start.heading_error_deg": 10.0, "duration": 60.0}
    found = rollout(Script(actions), seeds=[0, 1, 2, 3], overrides=CALM | early)
    assert found.terminated.all() and len(set(found.lengths.tolist())) > 1
    for i, length in enumerate(found.lengths.tolist()):
        given = math.radians(35.0) * np.append(actions[:length], actions[length - 1])
        np.testing.assert_allclose(found.trajectory(i)["delta_command"], given, rtol=1e-12)


def test_the_rudder_follows_its_command_at_its_rate():
    """2.32 deg/s for 2 s: 4.64 deg an interval; commands are 35, 35, -17.5, 0 and 8.75 deg."""
    delta = np.degrees(sailed().trajectory(0)["delta"])
    np.testing.assert_allclose(delta, [0.0, 4.64, 9.28, 4.64, 0.0, 4.64], atol=1e-9)


def test_the_propeller_follows_its_command_as_a_lag_with_limited_rate():
    """By small steps of dn/dt = limited((n_c - n) / time constant), 1 ms each."""
    t, engine = sailed().trajectory(0), SHIP.engine
    n, rows = t["n"][0], [t["n"][0]]
    for action in RPM:
        command = engine.n_max * 0.5 * (1.0 + action)
        for _ in range(2000):
            wanted = (command - n) / engine.time_constant
            n += 1e-3 * min(max(wanted, -engine.rate), engine.rate)
        rows.append(n)
    np.testing.assert_allclose(t["n"], rows, atol=2e-4)
    assert np.abs(np.diff(rows)).min() > 1e-3  # it moves in every interval


def test_forces_and_flow_are_those_of_the_state_in_their_row():
    """J = u / (n D) and X_hull = -1/2 rho L d U^2 R0' straight ahead, row by row; the last too."""
    t = sailed().trajectory(0)
    np.testing.assert_allclose(t["J"], t["u"] / (t["n"] * SHIP.propeller.D), rtol=1e-12)
    h = SHIP.hull
    resistance = 0.5 * SHIP.rho * h.L * h.d * t["u"][0] ** 2 * h.R_0
    assert t["X_hull"][0] == pytest.approx(-resistance, rel=1e-9)
    assert t["rudder_normal_force"][0] == 0.0  # amidships
    assert (t["rudder_normal_force"][[1, 2, 3, 5]] > 0.0).all()


def test_a_recording_has_the_loads_of_each_unit_where_the_ship_has_two():
    t = sailed(ship="onrt").trajectory(0)
    assert [k for k in t.names if k.endswith("_port")] == [f"{name}_port" for name in UNIT_NAMES]
    for name in ("thrust", "torque", "rudder_normal_force"):
        one, other = t[f"{name}_starboard"], t[f"{name}_port"]
        np.testing.assert_allclose(t[name], one + other, rtol=1e-12)
        assert (one[2:4] != other[2:4]).all(), name
    single = sailed().trajectory(0)
    assert set(t.names) - set(single.names) == set(FLOW_OF_UNITS[N_FLOW:])


def test_the_reward_of_a_row_is_that_of_the_interval_which_starts_there():
    """-dt * 0.1 delta^2 at its end, and nothing in the last row."""
    t = sailed().trajectory(0)
    expected = -2.0 * 0.1 * t["delta"][1:] ** 2
    np.testing.assert_allclose(t["reward_rudder"], [*expected, 0.0], rtol=1e-12)
    stroke = np.diff(t["delta"]) / math.radians(2.0 * 2.32)
    np.testing.assert_allclose(
        t["reward_rudder_rate"], [*(-2.0 * 0.002 * stroke**2), 0.0], rtol=1e-9
    )
    terms = sum(t[name] for name in t.names if name.startswith("reward_"))
    np.testing.assert_allclose(t["reward"], terms, atol=1e-15)


def test_position_is_the_integral_of_the_velocity_over_ground():
    """Turned into north and east by the heading, by the trapezoidal rule, at 0.25 s a row."""
    t = sailed(0.25, **{"sea.current_speed": 1.0, "sea.current_speed_min": 1.0}).trajectory(0)
    c, s = np.cos(t["psi"]), np.sin(t["psi"])
    for name, rate in (
        ("x", t["u"] * c - t["v"] * s),
        ("y", t["u"] * s + t["v"] * c),
        ("psi", t["r"]),
    ):
        moved = np.sum(0.5 * (rate[1:] + rate[:-1])) * 0.25
        assert t[name][-1] - t[name][0] == pytest.approx(moved, rel=1e-3, abs=1e-5), name


def test_wave_yaw_rate_is_the_derivative_of_wave_yaw():
    """Central differences of the recording, 0.1 s a row; so is the noise-free gyro's share of it.

    Head seas: 0.9 rad/s of encounter make an error of (0.9 * 0.1)^2 / 6, a thousandth.
    """
    waves = {
        "sea.wave_height": 4.0,
        "sea.wave_height_min": 4.0,
        "sea.peak_period": 9.7,
        "control_interval": 0.1,
        "duration": 20.0,
    }
    steady = Script(np.zeros(200))
    t = rollout(steady, seeds=[3], overrides=CALM | waves).trajectory(0)
    by_rows = (t["wave_yaw"][2:] - t["wave_yaw"][:-2]) / 0.2
    rate = t["wave_yaw_rate"][1:-1]
    assert np.abs(rate).max() > 1e-4
    np.testing.assert_allclose(rate, by_rows, atol=0.02 * np.abs(rate).max())
