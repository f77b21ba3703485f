"""What a live environment logs is what a rollout logs, bit for bit, the last row too."""

import numpy as np
import pytest

from ship_gym import ShipEnv, ShipVectorEnv
from ship_gym.envs.episode_log import EpisodeLog
from ship_gym.evaluation import rollout
from ship_gym.evaluation.controller import ConstantController

STEPS = 40


class Wobble:
    """Actions beyond the limits, other ones in every interval and for every row."""

    name = "wobble"

    def reset(self, count, ship, scenario):
        self.count, self.k, self.n = count, 0, 2 if scenario.control == "rudder+rpm" else 1

    def act(self, observations):
        self.k += 1
        return np.tile(1.5 * np.sin(0.7 * self.k), (self.count, self.n))


@pytest.mark.parametrize(
    "env",
    [
        {"scenario": "heading_keeping"},
        {"scenario": "course_changing", "ship": "onrt"},
        {"scenario": "track_following", "control": "rudder+rpm", "privileged": True},
        {"scenario": "drill_thrust_loss", "overrides": {"failure.time": 10.0}},
    ],
    ids=lambda env: env["scenario"],
)
def test_a_live_log_is_that_of_a_rollout(env):
    given = {"duration": float(STEPS), **env.get("overrides", {})}
    env = env | {"overrides": given}
    steer = Wobble()
    sailed = rollout(steer, seeds=[7], **env)
    live = ShipEnv(**env)
    live.reset(seed=7)
    log = EpisodeLog(live.episodes, 1, 8)  # has to grow
    log.begin(np.array([0]))
    steer.reset(1, live.ship, live.scenario)
    done = False
    while not done:
        log.before()
        *_, terminated, truncated, _ = live.step(steer.act(None)[0])
        log.after()
        done = terminated or truncated
    log.end(np.array([0]))
    rows = int(log.lengths[0])
    assert rows == sailed.lengths[0]
    for name, kept in sailed.histories.items():
        stop = rows + (name not in ("terms", "rewards"))
        assert np.array_equal(log.histories[name][:stop, 0], kept[:stop, 0]), name
    assert np.abs(log.histories["actions"]).max() > 1.4  # as they were given
    forces = log.histories["forces"][rows, 0]
    assert forces.any() and not np.array_equal(forces, log.histories["forces"][rows - 1, 0])


def test_the_last_row_of_episodes_that_end_at_different_times_is_that_of_a_longer_one():
    """Forces that `loads_now` finds for some ships are those that the next interval reports."""
    early = {"limits.heading_error_deg": 20.0, "start.heading_error_deg": 10.0, "duration": 200.0}
    found = rollout(ConstantController(0.3), seeds=[0, 1, 2, 3], overrides=early)
    assert found.terminated.all() and len(set(found.lengths.tolist())) > 1
    late = early | {"limits.heading_error_deg": 60.0}
    longer = rollout(ConstantController(0.3), seeds=[0, 1, 2, 3], overrides=late)
    for i, last in enumerate(found.lengths.tolist()):
        for name in ("states", "forces", "flow", "waves", "observations"):
            assert np.array_equal(found.histories[name][last, i], longer.histories[name][last, i])


def test_places_are_used_again_and_follow_the_ships_they_were_given():
    env = ShipVectorEnv(3, overrides={"duration": 100.0})
    env.reset(seed=5)
    log, batch = EpisodeLog(env.episodes, 1), env.episodes
    seen = {0: [], 2: []}

    def sail():
        log.before()
        for i in seen:
            seen[i].append(batch.sim.state[i].copy())
        env.step(np.full((3, 1), 0.2))
        log.after()

    first = log.begin(np.array([2])).item()
    sail()
    second = log.begin(np.array([0])).item()  # needs more room
    sail()
    sail()
    assert log.lengths[[first, second]].tolist() == [3, 2]
    assert np.array_equal(log.part(first, 0, 3)["states"], seen[2])
    assert np.array_equal(log.part(second, 0, 2)["states"], seen[0][1:])
    log.end(np.array([first]))
    assert np.array_equal(log.part(first, 3, 4)["states"][0], batch.sim.state[2])
    log.drop(np.array([first]))
    assert log.begin(np.array([1])).item() == first
    sail()
    assert log.lengths[[first, second]].tolist() == [1, 3]


def test_looking_at_the_loads_changes_nothing():
    one, other = (ShipVectorEnv(2, overrides={"sea.states": ["ss5"]}) for _ in range(2))
    for env in (one, other):
        env.reset(seed=1)
    action = np.full((2, 1), 0.4)
    for _ in range(5):
        one.step(action)
        other.step(action)
        forces, flow = one.episodes.sim.loads_now(np.array([1, 0]))
    assert np.array_equal(one.episodes.sim.state, other.episodes.sim.state)
    assert np.array_equal(one.episodes.sim.forces, other.episodes.sim.forces)
    other.step(action)
    assert np.array_equal(forces[::-1], other.episodes.sim.forces)
    assert np.array_equal(flow[::-1], other.episodes.sim.flow)
    one.step(action)
    assert np.array_equal(one.episodes.observations, other.episodes.observations)
