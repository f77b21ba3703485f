"""Orders: what is judged by which one, and when the next comes."""

import math

import numpy as np
import pytest

from ship_gym.conventions import PSI
from ship_gym.envs.env import ShipEnv
from ship_gym.tasks.heading.kernels import FROM, ORDER

CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
STEPS = CALM | {
    "course.first": 4.0,
    "course.changes": 3,
    "course.step_min_deg": 20.0,
    "course.step_max_deg": 20.0,
    "course.interval_min": 10.0,
    "course.interval_max": 10.0,
}


def test_the_order_changes_at_its_time_and_the_interval_before_is_judged_by_the_old_one():
    env = ShipEnv(scenario="course_changing", overrides=STEPS)
    _, info = env.reset(seed=1)
    first = info["psi_ordered"]
    seen = [first]
    for k in range(1, 31):
        obs, _, _, _, info = env.step(np.zeros(1))
        seen.append(info["psi_ordered"])
        if k == 4:  # judged by the first order, observed by the second
            assert info["reward_terms"]["heading"] == pytest.approx(0.0, abs=1e-6)
            assert abs(math.degrees(math.asin(obs[0]))) == pytest.approx(20.0, abs=0.5)
        if k == 5:
            expected = -(math.radians(20.0) ** 2)
            assert info["reward_terms"]["heading"] == pytest.approx(expected, rel=0.05)
    changes = np.flatnonzero(np.diff(seen)) + 1
    assert changes.tolist() == [4, 14, 24]


def test_steps_have_size_side_and_time_of_the_scenario():
    envs = ShipEnv(scenario="course_changing").episodes
    rng = np.random.default_rng(0)
    steps, gaps = [], []
    for _ in range(200):
        envs.start(np.array([0]), rng.random((1, envs.n_draws)))
        plan = envs.plans[0]
        turn = np.diff(plan[:, ORDER])
        steps += np.degrees((turn + math.pi) % (2.0 * math.pi) - math.pi).tolist()
        gaps += np.diff(plan[1:, FROM]).tolist()
        assert plan[0, FROM] == 0.0 and plan[1, FROM] == 30.0
        assert (np.abs(plan[:, ORDER]) <= math.pi).all()
    size = np.abs(steps)
    assert size.min() >= 5.0 - 1e-9 and size.max() <= 60.0 + 1e-9
    assert size.mean() == pytest.approx(32.5, abs=2.0)
    assert np.mean(np.array(steps) > 0.0) == pytest.approx(0.5, abs=0.06)
    assert min(gaps) >= 180.0 and max(gaps) <= 240.0
    assert (np.mod(gaps, 1.0) == 0.0).all()


def test_a_step_after_the_end_is_never_ordered():
    late = {"course.first": 1e5, "duration": 20.0}
    env = ShipEnv(scenario="course_changing", overrides=STEPS | late)
    _, info = env.reset(seed=0)
    first = info["psi_ordered"]
    for _ in range(20):
        *_, truncated, info = env.step(np.zeros(1))
    assert truncated and info["psi_ordered"] == first


def test_the_error_is_wrapped():
    env = ShipEnv(overrides=CALM)
    env.reset(seed=0)
    episodes = env.episodes
    episodes.tasks["psi_ordered"][0] = math.pi - 0.05
    episodes.sim.state[0, PSI] = -math.pi + 0.05 + 4.0 * math.pi
    _, _, terminated, _, info = env.step(np.zeros(1))
    assert not terminated
    assert info["reward_terms"]["heading"] == pytest.approx(-0.01, rel=0.1)
