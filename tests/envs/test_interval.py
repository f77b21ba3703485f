"""What an interval and the start of an episode do, by hand: calm water, one to three ships.

Python runs these kernels too (``scripts/test.sh --kernel-coverage``), so the voyages are short.
"""

import math

import numpy as np
import pytest

from ship_gym import ShipVectorEnv
from ship_gym.conventions import DELTA, PSI, N, U, X, Y
from ship_gym.envs import interval
from ship_gym.envs.interval import BAD_ACTION, BAD_OUTCOME, Loops
from ship_gym.simulation import FASTEST
from ship_gym.tasks.base import DIVERGED, RUNNING
from ship_gym.tasks.bridge import N_BRIDGE

CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
FAILURE = {
    "failure.time": 2.0,
    "failure.rudder_rate": 0.25,
    "failure.heading_bias_deg": 10.0,
    "failure.propeller_speed": 0.5,
}


def begun(n=1, overrides=None, **options):
    """Episodes of the KCS in calm water that have just begun."""
    env = ShipVectorEnv(n, parallel=False, overrides=CALM | (overrides or {}), **options)
    env.reset(seed=1)
    return env.episodes


def sail(episodes, rudder=0.0):
    """One interval of all ships; what the loop returns."""
    episodes.actions[:] = rudder
    return episodes._loops.interval(0, episodes.n)


def test_an_interval_sails_every_ship_and_counts():
    episodes = begun(2)
    before = episodes.sim.state.copy()
    assert sail(episodes) == 0
    path = (episodes.sim.state - before)[:, [X, Y]]
    result = episodes._results
    assert result["elapsed"].tolist() == [1, 1] and not episodes._diverged.any()
    assert np.hypot(*path.T) == pytest.approx(episodes.dt * before[:, U], rel=0.01)
    np.testing.assert_allclose(result["energy"], result["power"] * episodes.dt, rtol=1e-12)
    assert (result["power"] > 0.0).all() and not result["cost"].any()


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # Python tells of 0 inf, which is meant
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_bad_action_of_one_ship_and_none_is_sailed(value):
    episodes = begun(3)
    arrays = (episodes.sim.state, episodes.observations, episodes.terms, episodes._results)
    before = [array.copy() for array in arrays]
    assert sail(episodes, np.array([[0.0], [0.0], [value]])) == BAD_ACTION
    for array, old in zip(arrays, before, strict=True):
        np.testing.assert_array_equal(array, old)


def test_an_outcome_that_is_not_named_is_told():
    """Of the names none is left, so that even a ship under way has an outcome beyond them."""
    episodes = begun()
    given = episodes._loops.episodes
    nameless = given._replace(failed=given.failed[:0].copy())
    assert Loops(episodes.task, episodes.sim.fleet, nameless).interval(0, 1) == BAD_OUTCOME


def test_a_failure_begins_with_its_interval():
    episodes = begun(overrides=FAILURE)
    task, ship = episodes.tasks[0], episodes.sim.records[0]
    rate, n_order = episodes.ship.gear.rate, task.n_order
    sail(episodes)
    assert not episodes._results["failed"][0]
    assert (task.heading_bias, task.n_limit, ship.gear.rate) == (0.0, math.inf, rate)
    for _ in range(2):  # it is not made worse by every interval
        sail(episodes, 1.0)
        assert episodes._results["failed"][0]
        assert task.heading_bias == math.radians(10.0)
        assert task.n_limit == 0.5 * n_order
        assert ship.gear.rate == 0.25 * rate
    state, dt = episodes.sim.state[0], episodes.dt[0]
    assert episodes.sim.commands[0, 1] == 0.5 * n_order and state[N] < n_order
    # one interval at the full rate, one at a quarter
    assert state[DELTA] == pytest.approx(1.25 * rate * dt, rel=1e-9)
    seen = math.atan2(episodes.observations[0, 0], episodes.observations[0, 1])
    assert seen == pytest.approx(state[PSI] - task.psi_ordered + math.radians(10.0), abs=1e-6)


def test_a_failure_from_the_start_and_an_engine_that_stays_as_it_was():
    only_bias = {"failure.time": 0.0, "failure.heading_bias_deg": -3.0}
    episodes = begun(overrides=only_bias)
    task = episodes.tasks[0]
    assert episodes._results["failed"][0] and task.heading_bias == math.radians(-3.0)
    assert task.n_limit == math.inf
    assert episodes.sim.records[0].gear.rate == episodes.ship.gear.rate


def test_a_ship_that_is_none_gets_her_state_back_and_her_episode_ends():
    episodes = begun(3)
    episodes.sim.state[1, U] = 1.5 * FASTEST * episodes.ship.speed
    before, seen = episodes.sim.state.copy(), episodes.observations.copy()
    assert sail(episodes, 0.5) == 1
    assert episodes._diverged.tolist() == [False, True, False]
    np.testing.assert_array_equal(episodes.sim.state[1], before[1])
    np.testing.assert_array_equal(episodes.observations[1], seen[1])  # not yet refreshed
    assert (episodes.sim.state[[0, 2], X] != before[[0, 2], X]).all()
    result = episodes._results
    assert result["power"][1] == 0.0 < result["power"][0] and not result["terminated"].any()

    episodes._loops.end(np.array([1]))
    assert result["outcome"].tolist() == [RUNNING, DIVERGED, RUNNING]
    assert result["terminated"].tolist() == [False, True, False]
    assert result["cost"].tolist() == [0.0, 1.0, 0.0] and not result["success"].any()
    # nothing is paid but the termination, the last term
    assert episodes.reward_terms[-1] == "termination"
    penalty = -episodes.tasks["termination"][1]
    assert result["reward"][1] == episodes.terms[1, -1] == penalty < 0.0
    assert not episodes.terms[1, :-1].any()
    error = before[1, PSI] - episodes.tasks["psi_ordered"][1]
    assert result["error"][1] == pytest.approx(math.remainder(error, 2.0 * math.pi), abs=1e-12)


def test_privileged_columns_are_written_at_the_start_and_by_every_interval():
    """Calm water has no current; forces by half rho L d U0^2, moments by L more."""
    episodes = begun(privileged=True)
    first = episodes._privileged_from
    assert first == N_BRIDGE and not episodes.observations[0, first:].any()  # no force has acted
    episodes.observations[:] = np.nan
    sail(episodes)
    row = episodes.observations[0, first:]
    assert np.isfinite(row).all() and not row[:2].any()
    ship = episodes.ship
    unit = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
    forces = episodes.sim.forces[0] / [unit, unit, unit * ship.hull.L]
    assert np.abs(forces).max() > 1e-3
    np.testing.assert_allclose(row[8:], forces.ravel(), rtol=1e-6, atol=1e-12)


def test_an_episode_without_an_aim_succeeds_by_lasting_one_with_an_aim_by_reaching_it():
    one = {"duration": 2.0}
    for scenario, success in (("heading_keeping", True), ("track_following", False)):
        episodes = begun(scenario=scenario, overrides=one)
        for _ in range(episodes.scenario.steps):
            assert not episodes._results["truncated"][0]
            sail(episodes)
        result = episodes._results[0]
        assert (result.truncated, result.success) == (True, success), scenario


def test_a_task_without_an_error_has_none():
    assert interval.error(np.zeros(8), 0.0) == 0.0
