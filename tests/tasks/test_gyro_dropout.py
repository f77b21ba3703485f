"""A gyro that is lost shows its last heading and yaw rate, and nothing else changes."""

import math

import numpy as np
import pytest

from ship_gym import ShipVectorEnv
from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.tasks.columns import observation_columns
from ship_gym.tasks.sensors import chance

COLUMNS = observation_columns(load_scenario("heading_keeping"))
STEPS = 24
ROUGH = {"sea.states": ["ss5"], "sea.current_speed": 1.0}


def voyage(seed=3, rudder=0.3, scenario="heading_keeping", **overrides):
    """Observations (STEPS + 1, columns) and states of an episode, the start included."""
    env = ShipEnv(scenario=scenario, overrides={**ROUGH, **overrides})
    seen = [env.reset(seed=seed)[0]]
    states = [env.episodes.sim.state[0].copy()]
    for _ in range(STEPS):
        seen.append(env.step(np.array([rudder]))[0])
        states.append(env.episodes.sim.state[0].copy())
    return COLUMNS.view(np.array(seen)), np.array(states)


def same_reading(seen):
    """Whether each reading but the first is exactly that before it, shape (STEPS,)."""
    held = [seen.sin_error, seen.cos_error, seen.yaw_rate]
    return np.all([np.diff(column) == 0.0 for column in held], axis=0)


@pytest.mark.parametrize("noise", [True, False])
def test_a_lost_gyro_shows_its_last_reading_and_then_the_ship_again(noise):
    """Lost from 5 s on for 7 s: the readings of 5 to 11 s are that of 4 s."""
    lost = {"failure.time": 5.0, "failure.dropout": 7.0}
    sound, states = voyage(**{"sensors.noise": noise})
    seen, other = voyage(**lost, **{"sensors.noise": noise})
    np.testing.assert_array_equal(states, other)  # it moves no ship
    during = np.arange(5, 12)
    for name in ("sin_error", "cos_error", "yaw_rate"):
        a, b = getattr(sound, name), getattr(seen, name)
        assert (b[during] == a[4]).all() and (a[during] != a[4]).all()
        np.testing.assert_array_equal(np.delete(a, during), np.delete(b, during))
    for name in ("surge", "sway", "rudder", "rudder_command"):
        np.testing.assert_array_equal(getattr(sound, name), getattr(seen, name))


def test_a_gyro_that_is_lost_from_the_start_has_one_reading():
    sound, _ = voyage()
    seen, _ = voyage(**{"failure.time": 0.0, "failure.dropout": 4.0})
    assert seen.sin_error[0] == sound.sin_error[0]
    assert same_reading(seen).tolist() == [True] * 3 + [False] * (STEPS - 3)


def test_the_order_may_change_while_the_heading_is_held():
    """The error is that of the held heading to the order of now."""
    steps = {"course.first": 8.0, "course.step_min_deg": 20.0, "course.step_max_deg": 20.0}
    lost = {"failure.time": 4.0, "failure.dropout": 10.0, "sensors.noise": False}
    seen, _ = voyage(scenario="course_changing", **steps, **lost)
    error = np.degrees(np.arctan2(seen.sin_error, seen.cos_error))
    assert abs(error[8] - error[7]) == pytest.approx(20.0, abs=1e-4)
    assert (error[4:8] == error[3]).all() and (error[9:14] == error[8]).all()


def test_a_biased_compass_is_held_with_its_bias():
    bias = {"failure.time": 3.0, "failure.heading_bias_deg": 5.0, "failure.dropout": 6.0}
    biased, _ = voyage(**{"failure.time": 3.0, "failure.heading_bias_deg": 5.0})
    both, _ = voyage(**bias)
    sound, _ = voyage()
    assert (both.sin_error[3:9] == sound.sin_error[2]).all()
    np.testing.assert_array_equal(both.sin_error[9:], biased.sin_error[9:])


@pytest.mark.parametrize("parallel", [False, True])
def test_vector_rows_are_scalars_by_chance_and_by_failure(parallel):
    overrides = {
        **ROUGH, "duration": 8.0, "failure.time": 3.0, "failure.dropout": 2.0,
        "sensors.dropout_rate": 400.0, "sensors.dropout_time": 2.5,
    }  # fmt: skip
    many = ShipVectorEnv(5, overrides=overrides, parallel=parallel)
    ones = [ShipEnv(overrides=overrides) for _ in range(5)]
    seen = many.reset(seed=[1, 2, 3, 4, 5])[0]
    single = [env.reset(seed=k + 1)[0] for k, env in enumerate(ones)]
    np.testing.assert_array_equal(seen, single)
    for _ in range(7):
        seen = many.step(np.full((5, 1), 0.4))[0]
        np.testing.assert_array_equal(seen, [env.step(np.array([0.4]))[0] for env in ones])


@pytest.mark.compiled
def test_dropouts_by_chance_come_as_often_and_last_as_long_as_stated():
    """900 an hour for 3 s: of 4 s of a sound gyro and 3 s of a lost one, so lost 3 in 7 s.

    An interval of a sound gyro is its last with p = 1 - exp(-1/4), so 1/p = 4.52 s pass on the
    average from one to the next, and 3 / (3 + 4.52 - 1) of the readings are held: the reading of
    the interval in which it is lost is held already.
    """
    n, steps = 40, 300
    overrides = {
        **ROUGH, "duration": 600.0, "limits.heading_error_deg": 180.0,
        "sensors.dropout_rate": 900.0, "sensors.dropout_time": 3.0,
    }  # fmt: skip
    env = ShipVectorEnv(n, overrides=overrides)
    seen = [env.reset(seed=1)[0]]
    seen += [env.step(np.zeros((n, 1)))[0] for _ in range(steps)]
    rates = np.array(seen)[:, :, COLUMNS["yaw_rate"]]
    held = np.diff(rates, axis=0) == 0.0
    p = -math.expm1(-0.25)
    expected = 3.0 / (3.0 + 1.0 / p - 1.0)
    # each spell is 3 readings: the spread of a share of n * steps / 3 nearly independent ones
    assert held.mean() == pytest.approx(expected, abs=4.0 * math.sqrt(0.25 / (n * steps / 3.0)))
    for row in held.T:
        begins = np.flatnonzero(np.diff(np.append(0, row.astype(int))) == 1)
        ends = np.flatnonzero(np.diff(np.append(row.astype(int), 0)) == -1)
        spells = ends - begins + 1
        assert (spells[:-1] % 3 == 0).all()  # two may follow each other without a pause


def test_the_chance_is_uniform_and_of_each_episode_and_interval():
    seen = np.array([[chance(k, i) for i in range(200)] for k in range(50)])
    assert 0.0 <= seen.min() and seen.max() < 1.0
    assert seen.mean() == pytest.approx(0.5, abs=4.0 / math.sqrt(12 * seen.size))
    assert len(np.unique(seen)) > 0.999 * seen.size
    assert abs(np.corrcoef(seen[:, 1:].ravel(), seen[:, :-1].ravel())[0, 1]) < 0.04


def test_a_model_is_lost_for_as_many_intervals():
    """Times are those of the full-scale ship."""
    env = ShipEnv(ship="kcs_model", overrides={"failure.time": 5.0, "failure.dropout": 7.0})
    seen = [env.reset(seed=3)[0]] + [env.step(np.zeros(1))[0] for _ in range(STEPS)]
    held = same_reading(COLUMNS.view(np.array(seen)))
    assert np.flatnonzero(held).tolist() == list(range(4, 11))


@pytest.mark.parametrize(
    "given", [{"sensors.dropout_rate": 3.0}, {"sensors.dropout_time": 3.0}], ids=str
)
def test_half_a_dropout_is_refused(given):
    with pytest.raises(ConfigError, match=r"dropout_rate = .* dropout_time = .*both above 0"):
        load_scenario("heading_keeping", given)
