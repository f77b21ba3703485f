"""Episodes that diverge, or whose ship is none any more, end by themselves; the others sail on."""

import dataclasses

import gymnasium as gym
import numpy as np
import pytest

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.conventions import R, U
from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.scenarios.sections import LARGEST
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import FASTEST, ShipSim, SimulationDiverged, limits_of
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import DIVERGED

HEADING = "ShipGym/HeadingKeeping-v0"
# ten standard deviations of the surrogate: some of these ships are none, so it is not allowed
WILD = {"randomisation.surrogate_std": 10.0, "limits.heading_error_deg": 180.0}
FULL = {"ship": "onrt", "control": "rudder+rpm", "overrides": WILD}


def hard_over(n):
    actions = np.ones((n, 2))
    actions[::2, 0] = -1.0
    return actions


@pytest.fixture(scope="module", autouse=True)
def wild():
    """Allow it here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(LARGEST, "surrogate_std", 10.0)
        yield


@pytest.fixture(scope="module")
def sailed(wild):
    """Seeds 0 to 127 hard over at full speed; when each diverged, 0: not at all."""
    envs = gym.make_vec(HEADING, num_envs=128, autoreset_mode="Disabled", **FULL)
    envs.reset(seed=0)
    when, last, rewards_at = np.zeros(128, int), {}, {}
    for k in range(1, 200):
        states = envs.episodes.sim.state.copy()
        observations, rewards, terminated, truncated, info = envs.step(hard_over(128))
        assert np.isfinite(observations).all() and np.isfinite(rewards).all()
        assert envs.observation_space.contains(observations)
        for i in np.flatnonzero(terminated):
            assert info["outcome"][i] == DIVERGED and info["cost"][i] == 1.0
            assert not info["is_success"][i]
            when[i], last[i] = k, (states[i], envs.episodes.sim.state[i].copy())
            rewards_at[i] = rewards[i]
        if terminated.any():
            envs.reset(options={"reset_mask": terminated})
        assert not truncated.any()
        if when.astype(bool).sum() > 5:
            break
    return when, last, rewards_at, k


def test_some_diverge_and_keep_the_last_state_of_a_ship(sailed):
    when, last, rewards, _ = sailed
    assert 5 < np.count_nonzero(when) < 128
    for i, (before, after) in last.items():
        assert (before == after).all()
        assert rewards[i] == -200.0


def test_scalar_is_vector(sailed):
    when, last, rewards, _ = sailed
    i = int(np.flatnonzero(when)[0])
    env = gym.make(HEADING, **FULL)
    env.reset(seed=i)
    for _ in range(when[i]):
        _, reward, terminated, _, info = env.step(hard_over(128)[i])
    assert terminated and info["outcome"] == DIVERGED and reward == rewards[i]
    assert (env.unwrapped.episodes.sim.state[0] == last[i][1]).all()


def test_threads_give_the_same_to_ships_that_diverge(sailed):
    """Each keeps the states at the start of an interval for its own block only."""
    when, *_ = sailed
    steps = int(when[64:][when[64:] > 0].min())  # the second thread has one that diverges
    serial, threads = (
        gym.make_vec(HEADING, num_envs=128, autoreset_mode="SameStep", parallel=parallel, **FULL)
        for parallel in (False, True)
    )
    assert (serial.reset(seed=0)[0] == threads.reset(seed=0)[0]).all()
    ended = 0
    for _ in range(steps):
        a, b = serial.step(hard_over(128)), threads.step(hard_over(128))
        for x, y in zip(a[:4], b[:4], strict=True):
            assert (x == y).all()
        assert (serial.episodes.sim.state == threads.episodes.sim.state).all()
        ended += a[2][64:].sum()
    assert ended > 0


def test_the_others_sail_as_if_nothing_had_been(sailed):
    when, _, _, steps = sailed
    i = int(np.flatnonzero(when == 0)[0])
    env = gym.make(HEADING, **FULL)
    env.reset(seed=i)
    for _ in range(steps):
        env.step(hard_over(128)[i])
    envs = gym.make_vec(HEADING, num_envs=128, **FULL)
    envs.reset(seed=0)
    for _ in range(steps):
        envs.step(hard_over(128))
    assert (env.unwrapped.episodes.sim.state[0] == envs.episodes.sim.state[i]).all()


@pytest.mark.parametrize("value", [np.nan, np.inf, 4.0 * 7.5, -1e300])
@pytest.mark.parametrize("task", list(TASKS))
def test_a_state_that_is_none_ends_the_episode_and_only_it(task, value):
    """The state is spoilt by hand, as a kernel would do it: between two intervals."""
    envs = gym.make_vec(TASKS[task].env_id, num_envs=3, autoreset_mode="Disabled")
    envs.reset(seed=0)
    envs.step(np.zeros((3, 1)))
    envs.episodes.sim.state[1, U] = value
    observations, rewards, terminated, _, info = envs.step(np.zeros((3, 1)))
    assert terminated.tolist() == [False, True, False]
    assert info["outcome"].tolist() == [0, DIVERGED, 0]
    assert np.isfinite(rewards).all() and np.isfinite(observations[[0, 2]]).all()


def test_a_ship_at_the_limit_of_speed_is_still_one():
    env = gym.make(HEADING).unwrapped
    env.reset(seed=0, options={"speed": 0.99 * FASTEST * env.ship.speed})
    *_, info = env.step(np.zeros(1))
    assert info["outcome"] == 0
    env.reset(seed=0)
    env.episodes.sim.state[0, U] = 1.2 * FASTEST * env.ship.speed
    _, reward, terminated, _, info = env.step(np.zeros(1))
    assert terminated and info["outcome"] == DIVERGED and reward == -200.0


def test_a_file_with_a_low_nominal_speed_does_not_end_her_full_ahead():
    """KCS as for a harbour: 5 kn, a tenth of the power; the same engine drives her at 5.5 U0."""
    kcs = load_ship("kcs", surrogate="none")
    slow = dataclasses.replace(kcs, name="slow", speed=2.57, trials=(), propulsion=())
    env = gym.make(HEADING, ship=slow, control="rudder+rpm", scenario="heading_calm").unwrapped
    env.reset(seed=0)
    for _ in range(400):
        *_, terminated, truncated, info = env.step(np.array([0.0, 1.0]))
        assert info["outcome"] == 0
        if terminated or truncated:
            break
    sim = env.episodes.sim
    assert sim.state[0, U] > 2.5 * 2.57
    assert 2.5 * 2.57 < sim.limits[0, 0] < 9.0 * 2.57
    for name in available_ships():  # of these no speed is so low
        assert limits_of(load_ship(name))[0] == FASTEST * load_ship(name).file_speed


def test_a_recording_of_one_has_finite_columns_and_metrics():
    sailed = rollout(ConstantController(1.0), seeds=range(128), **FULL)
    lost = np.flatnonzero(sailed.outcomes == DIVERGED)
    assert len(lost) > 3
    trajectory = sailed.trajectory(int(lost[0]))
    assert trajectory.meta["outcome"] == "diverged" and trajectory.meta["failed"]
    for name in trajectory.names:
        assert np.isfinite(trajectory[name]).all(), name
    assert metrics(trajectory)["success"] == 0.0


N = 512
BAD = 77  # among them


def spoil(envs):
    """One ship wins energy by drifting and turning: no loader lets such a ship through."""
    hull = envs.episodes.sim.records["hull"]
    for name in ("Y_v", "N_r"):
        hull[name][BAD] *= -20.0


def states_of(envs, spoiled, intervals=40):
    """Everything that 512 ships gave in some intervals, and whether the bad one diverged."""
    envs.reset(seed=3)
    if spoiled:
        spoil(envs)
    rng, rows, ended = np.random.default_rng(5), [], False
    for _ in range(intervals):
        actions = rng.uniform(-1.0, 1.0, (N, 1))
        observations, rewards, terminated, truncated, info = envs.step(actions)
        assert not truncated.any()
        assert np.isfinite(rewards).all() and envs.observation_space.contains(observations)
        assert np.isfinite(envs.episodes.sim.state).all()
        ended |= bool(terminated[BAD]) and info["outcome"][BAD] == DIVERGED
        rows.append(np.column_stack([envs.episodes.sim.state, observations, rewards, terminated]))
        if terminated.any():
            envs.reset(options={"reset_mask": terminated})
    return np.array(rows), ended


def test_one_bad_ship_among_512_is_nothing_to_the_others():
    calm = {"scenario": "heading_calm", "autoreset_mode": "Disabled"}
    seen = []
    for spoiled in (False, True):
        # ships that differ, so that one may
        overrides = {"randomisation.hull_std": 0.01}
        envs = gym.make_vec(HEADING, num_envs=N, overrides=overrides, **calm)
        seen.append(states_of(envs, spoiled))
    (good, never), (bad, ended) = seen
    assert ended and not never
    others = np.arange(N) != BAD
    assert (good[:, others] == bad[:, others]).all()
    assert (good[:, BAD] != bad[:, BAD]).any()


def test_nothing_hides_between_two_looks():
    """A spin within a long interval that is over at its end: each integration step counts."""
    sim = ShipSim("kcs")
    sim.reset(0)
    sim.set_interval(60.0)
    sim.state[0, R] = 0.9 * sim.limits[0, 1]
    assert sim.sail() == 1 and not sim.lost[0]
    sim.reset(0)
    sim.state[0, R] = 4.0 * sim.limits[0, 1]
    assert sim.sail() == 0 and sim.lost[0]
    assert abs(sim.state[0, R]) < sim.limits[0, 1]


def test_a_bare_simulation_says_what_became_of_her():
    sim = ShipSim("kcs", 3)
    sim.reset(0)
    sim.state[1, U] = 158.0 * sim.ships[1].speed
    with pytest.raises(
        SimulationDiverged, match=r"ship 1 \(kcs\) .* beyond 18.65 m/s .*: state u="
    ):
        sim.step(np.zeros((3, 2)), 1.0)
    sim.reset(0)
    sim.state[2, U] = np.nan
    with pytest.raises(SimulationDiverged, match=r"ship 2 .* not finite: state u=nan"):
        sim.step(np.zeros((3, 2)), 1.0)
    with pytest.raises(ConfigError, match=r"kcs: speed = 20.0: allowed is -18.649 to 18.649"):
        sim.reset(0, speed=20.0)


def test_a_reward_that_is_no_number_ends_the_episode():
    """By weights that no scenario may have: infinite minus infinite."""
    envs = gym.make_vec(HEADING, num_envs=3, autoreset_mode="Disabled")
    envs.reset(seed=0)
    envs.episodes.tasks["heading"][1] = np.nan
    _, rewards, terminated, _, info = envs.step(np.zeros((3, 1)))
    assert terminated.tolist() == [False, True, False] and info["outcome"][1] == DIVERGED
    assert np.isfinite(rewards).all() and rewards[1] == -200.0


def test_torch_is_the_vector_environment_also_of_ships_that_diverge():
    torch = pytest.importorskip("torch")
    env = ship_gym.ShipTorchEnv(128, **FULL)
    vector = ship_gym.ShipVectorEnv(
        128, scenario="heading_keeping", autoreset_mode="SameStep", **FULL
    )
    env.reset(seed=0)
    vector.reset(seed=0)
    ended = 0
    for _ in range(60):
        *ours, _ = env.step(torch.from_numpy(hard_over(128)))
        *theirs, _ = vector.step(hard_over(128))
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(a.numpy(), b)
        ended += int(theirs[2].sum())
    assert ended > 0
