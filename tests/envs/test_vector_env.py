import pickle

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import ship_gym
from ship_gym.config import ConfigError

IDS = sorted(ship_gym.ENVIRONMENTS)
# short, and with a limit close enough that random actions end episodes both ways
ENDS_OFTEN = {"duration": 90.0, "start.heading_error_deg": 20.0, "limits.heading_error_deg": 24.0}
OFTEN = {
    "ShipGym/HeadingKeeping-v0": ENDS_OFTEN,
    "ShipGym/CourseChanging-v0": ENDS_OFTEN
    | {
        "duration": 60.0,
        "course.first": 5.0,
        "course.interval_min": 10.0,
        "course.interval_max": 20.0,
        "course.step_max_deg": 8.0,
    },
    # short legs of a harmless track, which some ships finish and others leave
    "ShipGym/TrackFollowing-v0": {
        "duration": 60.0,
        "start.cross_track": 0.1,
        "limits.cross_track": 0.3,
        "track.leg_min": 1.05,
        "track.leg_max": 1.5,
        "track.legs": 2,
        "track.acceptance": 0.4,
    },
}


def same(a, b, path="info"):
    """Bitwise equality of two infos, masks included."""
    assert type(a) is type(b) or isinstance(a, dict) is isinstance(b, dict) is True, path
    if isinstance(a, dict):
        assert set(a) == set(b), (path, set(a) ^ set(b))
        for key in a:
            same(a[key], b[key], f"{path}.{key}")
    elif isinstance(a, np.ndarray) and a.dtype == object:
        for x, y in zip(a, b, strict=True):
            assert (x is None) == (y is None) and (x is None or (x == y).all()), path
    else:
        assert a.dtype == b.dtype and a.shape == b.shape and (a == b).all(), path


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("control", ["rudder", "rudder+rpm"])
@pytest.mark.parametrize("env_id", IDS)
def test_native_is_sync_of_scalars_bit_for_bit(env_id, control, mode):
    options = {"control": control, "overrides": OFTEN[env_id]}
    scenario = ship_gym.ENVIRONMENTS[env_id]
    native = ship_gym.ShipVectorEnv(5, scenario=scenario, autoreset_mode=mode, **options)
    sync = SyncVectorEnv([lambda: gym.make(env_id, **options).unwrapped] * 5, autoreset_mode=mode)
    rng = np.random.default_rng(8)
    (obs_a, info_a), (obs_b, info_b) = native.reset(seed=42), sync.reset(seed=42)
    assert (obs_a == obs_b).all() and obs_a.dtype == obs_b.dtype
    same(info_a, info_b)
    ended = np.zeros(2, dtype=int)
    actions = rng.uniform(-1, 1, (5, *native.single_action_space.shape)).astype(np.float32)
    for k in range(300):
        if k % 15 == 0:  # held long enough to drive the ship beyond the limit
            actions = rng.uniform(-1, 1, actions.shape).astype(np.float32)
        a, b = native.step(actions), sync.step(actions)
        for x, y in zip(a[:4], b[:4], strict=True):
            assert x.dtype == y.dtype and (x == y).all(), k
        same(a[4], b[4])
        ended += [a[2].sum(), a[3].sum()]
    assert (ended > 3).all(), f"terminations, truncations: {ended}"


@pytest.mark.parametrize("env_id", IDS)
def test_make_vec_gives_the_native_environment(env_id):
    env = gym.make_vec(env_id, num_envs=3, ship="kcs_model", control="rudder+rpm")
    assert isinstance(env.unwrapped, ship_gym.ShipVectorEnv) and env.num_envs == 3
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    obs, _ = env.reset(seed=0)
    assert env.observation_space.contains(obs)
    obs, *_ = env.step(env.action_space.sample())
    assert env.observation_space.contains(obs)


@pytest.mark.parametrize("mode", ["sync", "async"])
@pytest.mark.parametrize("env_id", IDS)
def test_make_vec_in_the_other_modes(env_id, mode):
    env = gym.make_vec(env_id, num_envs=2, vectorization_mode=mode)
    env.reset(seed=0)
    obs, *_ = env.step(np.zeros((2, 1), np.float32))
    native = ship_gym.ShipVectorEnv(2, scenario=ship_gym.ENVIRONMENTS[env_id])
    native.reset(seed=0)
    assert (native.step(np.zeros((2, 1), np.float32))[0] == obs).all()
    env.close()


def test_threads_change_nothing():
    def run(parallel):
        env = ship_gym.ShipVectorEnv(9, parallel=parallel, overrides=ENDS_OFTEN)
        env.reset(seed=1)
        rng = np.random.default_rng(0)
        return [env.step(rng.uniform(-1, 1, (9, 1)))[:4] for _ in range(120)]

    for a, b in zip(run(False), run(True), strict=True):
        for x, y in zip(a, b, strict=True):
            assert (x == y).all()


def test_disabled_autoreset_resets_by_mask():
    env = ship_gym.ShipVectorEnv(3, autoreset_mode="Disabled", overrides={"duration": 5.0})
    env.reset(seed=0)
    for _ in range(5):
        *_, truncated, _ = env.step(np.zeros((3, 1)))
    assert truncated.all()
    with pytest.raises(ConfigError, match=r"episodes \[0, 1, 2\] have ended"):
        env.step(np.zeros((3, 1)))
    env.reset(options={"reset_mask": np.array([True, True, False])})
    with pytest.raises(ConfigError, match=r"episodes \[2\] have ended"):
        env.step(np.zeros((3, 1)))
    env.reset(options={"reset_mask": np.array([False, False, True])})
    env.step(np.zeros((3, 1)))


def test_a_ship_that_was_never_reset_does_not_sail():
    env = ship_gym.ShipVectorEnv(3, autoreset_mode="Disabled")
    with pytest.raises(ConfigError, match=r"step before reset: call reset first$"):
        env.step(np.zeros((3, 1)))
    env.reset(options={"reset_mask": np.array([True, False, False])})
    with pytest.raises(ConfigError, match=r"call reset first, also of the environments \[1, 2\]"):
        env.step(np.zeros((3, 1)))
    env.reset(options={"reset_mask": np.array([False, True, True])})
    env.step(np.zeros((3, 1)))


def test_info_is_the_caller_s_to_change():
    env = ship_gym.ShipVectorEnv(2)
    _, info = env.reset(seed=0)
    info["_time"][:] = False
    _, info = env.reset(seed=1)
    assert info["_time"].all()


def test_seeds_are_known():
    env = ship_gym.ShipVectorEnv(3)
    env.reset(seed=42)
    assert env.np_random_seed == (42, 43, 44) and len(env.np_random) == 3


def test_the_action_of_an_ended_episode_is_not_used():
    env = ship_gym.ShipVectorEnv(2, overrides={"duration": 2.0})
    env.reset(seed=0)
    env.step(np.zeros((2, 1)))
    env.step(np.zeros((2, 1)))
    env.step(np.full((2, 1), np.nan))


def test_infos_of_a_masked_reset_are_zero_for_the_others():
    env = ship_gym.ShipVectorEnv(3, autoreset_mode="Disabled")
    env.reset(seed=1)
    env.step(np.ones((3, 1)))
    _, info = env.reset(options={"reset_mask": np.array([False, True, False])})
    assert info["_psi_ordered"].tolist() == [False, True, False]
    assert info["psi_ordered"][[0, 2]].tolist() == [0.0, 0.0] and info["psi_ordered"][1] != 0.0
    assert (info["forces"]["hull"][[0, 2]] == 0.0).all()


def test_pickling():
    env = ship_gym.ShipVectorEnv(4)
    env.reset(seed=0)
    env.step(np.full((4, 1), 0.2))
    again = pickle.loads(pickle.dumps(env))
    a, b = env.step(np.full((4, 1), -0.2)), again.step(np.full((4, 1), -0.2))
    assert (a[0] == b[0]).all() and (a[1] == b[1]).all()


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: ship_gym.ShipVectorEnv(0), "num_envs = 0"),
        (lambda: ship_gym.ShipVectorEnv(2, autoreset_mode="Never"), "autoreset_mode = 'Never'"),
        (lambda: ship_gym.ShipVectorEnv(2).reset(seed=[1, 2, 3]), "3 seeds given"),
        (
            lambda: ship_gym.ShipVectorEnv(2).reset(options={"reset_mask": np.zeros(2)}),
            "reset_mask",
        ),
    ],
)
def test_bad_input(call, word):
    with pytest.raises(ConfigError) as error:
        call()
    assert word in str(error.value)


def test_bad_actions_name_the_row():
    env = ship_gym.ShipVectorEnv(3)
    env.reset(seed=0)
    actions = np.zeros((3, 1))
    actions[1] = np.nan
    with pytest.raises(ConfigError, match=r"action 1 = \[nan\]"):
        env.step(actions)
    with pytest.raises(ConfigError, match=r"shape \(3,\)"):
        env.step(np.zeros(3))


# one with one screw and one with two; the others are slow tests
_SHIPS = [
    name if name == "kcs" else pytest.param(name, marks=pytest.mark.slow)
    for name in ship_gym.available_ships()
]


@pytest.mark.parametrize("name", _SHIPS)
def test_no_state_that_an_agent_can_reach_diverges(name):
    """1000 episodes of random actions, held for random times, rudder and rpm."""
    env = ship_gym.ShipVectorEnv(
        1000, ship=name, control="rudder+rpm", overrides={"limits.heading_error_deg": 180.0}
    )
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    sim, fastest, spin = env.episodes.sim, 0.0, 0.0
    # a third random every step, a third held for a minute, a third bang-bang
    actions = rng.uniform(-1, 1, (1000, 2))
    for k in range(600):
        fresh = rng.uniform(-1, 1, (1000, 2))
        actions[:333] = fresh[:333]
        if k % 60 == 0:
            actions[333:667] = fresh[333:667]
        if k % 25 == 0:
            actions[667:] = np.sign(fresh[667:])
        obs, rewards, *_ = env.step(actions)
        assert env.observation_space.contains(obs) and np.isfinite(rewards).all()
        fastest = max(fastest, np.hypot(sim.state[:, 0], sim.state[:, 1]).max())
        spin = max(spin, np.abs(sim.state[:, 2]).max())
    ship = env.ship
    # full power straight ahead and the largest current bound the speed over ground
    assert fastest < 2.2 * ship.speed + 1.0
    assert spin * ship.hull.L / ship.speed < 2.0
