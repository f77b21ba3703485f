import functools
import inspect
import operator
import pickle
import re
import warnings
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.conventions import FORCE_COMPONENTS
from ship_gym.tasks import observations_of

IDS = sorted(ship_gym.ENVIRONMENTS)
SHIPS = ship_gym.available_ships()
CONTROLS = ("rudder", "rudder+rpm")
GOLDEN = Path(__file__).parents[1] / "golden"


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("ship", SHIPS)
def test_check_env_is_silent(env_id, ship, control):
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gym.make(env_id, ship=ship, control=control, render_mode="rgb_array").unwrapped
        check_env(env, skip_render_check=True)


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("ship", SHIPS)
def test_stable_baselines_check_env_is_silent(env_id, ship, control):
    pytest.importorskip("stable_baselines3", reason="extra 'rl' not installed")
    from stable_baselines3.common.env_checker import check_env as sb3_check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sb3_check_env(gym.make(env_id, ship=ship, control=control).unwrapped)


def rollout(env, seed, steps=50):
    rng = np.random.default_rng(seed)
    seen = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        action = rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)
        obs, reward, terminated, truncated, _ = env.step(action)
        seen.append(np.append(obs, [reward, terminated, truncated]))
    return np.concatenate(seen)


@pytest.mark.parametrize("env_id", IDS)
def test_same_seed_same_bits(env_id):
    a, b = rollout(gym.make(env_id), 3), rollout(gym.make(env_id), 3)
    assert (a == b).all()
    assert not (a == rollout(gym.make(env_id), 4)).all()


@pytest.mark.parametrize("env_id", IDS)
def test_pickling_keeps_the_state(env_id):
    env = gym.make(env_id).unwrapped
    env.reset(seed=1)
    for _ in range(5):
        env.step(np.array([0.3], dtype=np.float32))
    again = pickle.loads(pickle.dumps(env))
    for _ in range(5):
        a, b = env.step(np.array([-0.5])), again.step(np.array([-0.5]))
        assert (a[0] == b[0]).all() and a[1:4] == b[1:4]
    assert (env.reset()[0] == again.reset()[0]).all()


@pytest.mark.parametrize("env_id", IDS)
def test_docstring_table_is_the_space(env_id):
    env = gym.make(env_id).unwrapped
    rows = re.findall(
        r"^\| (\d+) \| `(\w+)` \| (\S.*?) \| - \| (-?\d+) \| (\d+) \| (.*?) \|$",
        inspect.getdoc(type(env)),
        re.M,
    )
    assert len(rows) == env.observation_space.shape[0]
    for (number, name, symbol, low, high, meaning), row in zip(
        rows, observations_of(env.scenario.task), strict=True
    ):
        i = int(number)
        assert (name, symbol, "-", float(low), float(high), meaning) == tuple(row)[:6]
        assert env.observation_space.low[i] == row.low
        assert env.observation_space.high[i] == row.high


def test_reward_is_the_sum_of_its_terms_and_info_is_complete():
    env = gym.make(IDS[0])
    _, info = env.reset(seed=0)
    keys = set(info)
    for _ in range(20):
        _, reward, *_, info = env.step(env.action_space.sample())
        # not sum(), which compensates rounding from Python 3.12 on
        assert reward == functools.reduce(operator.add, info["reward_terms"].values())
        assert set(info) == keys
    assert set(info["forces"]) == set(FORCE_COMPONENTS)
    assert info["forces"]["hull"].shape == (3,)
    assert info["power"] > 0.0 and info["time"] == 20.0 and info["extrapolation"] >= 0.0


def test_truncation_and_termination_are_told_apart():
    env = gym.make(IDS[0], overrides={"duration": 30.0})
    env.reset(seed=0)
    ends = [env.step(np.zeros(1, np.float32))[2:4] for _ in range(30)]
    assert ends[-1] == (False, True) and not any(any(e) for e in ends[:-1])
    env = gym.make(IDS[0], overrides={"start.heading_error_deg": 0.0})
    env.reset(seed=0)
    for _ in range(600):
        _, _, terminated, truncated, info = env.step(np.ones(1, np.float32))
        if terminated:
            break
    assert terminated and not truncated
    assert info["reward_terms"]["termination"] == -200.0 and info["cost"] == 1.0


def test_positive_action_turns_to_starboard_and_reduces_a_negative_error():
    env = gym.make(IDS[0], overrides={"sea.current_speed": 0.0}).unwrapped
    obs, _ = env.reset(seed=0)
    for _ in range(40):
        obs, *_ = env.step(np.array([0.5], np.float32))
    assert obs[2] > 0.0 and obs[5] > 0.4 and obs[7] == np.float32(0.5)


def test_model_ship_gets_froude_scaled_times():
    full, model = gym.make(IDS[0]).unwrapped, gym.make(IDS[0], ship="kcs_model").unwrapped
    ratio = np.sqrt(75.2371)
    assert full.episodes.dt == 1.0
    assert model.episodes.dt == pytest.approx(1.0 / ratio)
    assert model.episodes.tasks["rudder_stroke"][0] == pytest.approx(
        full.episodes.tasks["rudder_stroke"][0], rel=0.01
    )


def test_rpm_control_moves_the_propeller():
    env = gym.make(IDS[0], control="rudder+rpm").unwrapped
    obs, _ = env.reset(seed=0)
    for _ in range(100):
        obs, *_ = env.step(np.array([0.0, -1.0], np.float32))
    assert obs[6] < 0.05 and obs[8] == 0.0


def test_a_ship_object_can_sail():
    ship = ship_gym.load_ship("kcs", surrogate="none")
    env = ship_gym.ShipEnv(ship=ship)
    assert env.ship is ship and np.isfinite(env.reset(seed=0)[0]).all()
    assert env.scenario.surrogate == "none"
    with pytest.raises(ConfigError, match="brings its own"):
        ship_gym.ShipEnv(ship=ship, surrogate="G2_SA")


def test_step_before_reset():
    with pytest.raises(ConfigError, match="call reset first"):
        ship_gym.ShipEnv().step(np.zeros(1))


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"ship": "kcss"}, "did you mean 'kcs'"),
        ({"control": "sail"}, "control"),
        ({"surrogate": "G9"}, "surrogate of kcs"),
        ({"scenario": "parking"}, "unknown scenario"),
        ({"overrides": {"rewards": {}}}, "did you mean 'reward'"),
        ({"render_mode": "humans"}, "did you mean 'human'"),
    ],
)
def test_bad_arguments(arguments, word):
    with pytest.raises(ConfigError) as error:
        ship_gym.ShipEnv(**arguments)
    assert word in str(error.value)


@pytest.mark.parametrize(
    ("action", "word"),
    [
        (np.array([np.nan]), "finite"),
        (np.array([np.inf]), "finite"),
        (np.zeros(2), r"shape \(2,\), allowed is \(1,\)"),
        (0.3, r"action = 0.3 has shape \(\), allowed is \(1,\)"),
        (np.array(["left"]), "type"),
    ],
)
def test_bad_actions(action, word):
    env = ship_gym.ShipEnv()
    env.reset(seed=0)
    before = env.episodes.sim.state.copy()
    with pytest.raises(ConfigError, match=word):
        env.step(action)
    assert (env.episodes.sim.state == before).all()  # refused before any work


@pytest.mark.parametrize("env_id", IDS)
def test_golden_trajectory(env_id):
    """A change detector: if it fails on purpose, the id needs a new version.

    Write it anew with ``python -m tests.golden.write``.
    """
    path = GOLDEN / (env_id.replace("/", "_") + ".csv")
    golden = np.loadtxt(path, delimiter=",")
    from tests.golden.write import golden_rows

    np.testing.assert_allclose(golden_rows(env_id), golden, rtol=1e-6, atol=1e-7)


def test_two_resets_in_a_row_show_the_second_episode(tmp_path, monkeypatch):
    pytest.importorskip("rerun")
    from ship_gym.recording import live

    shown = []

    class View:
        def __init__(self, ship, title, plots=()):
            self.open = False

        def show(self, row, track, sea=None):
            if not self.open:
                shown.append(track[-1].tolist())
            self.open = True

        def close(self):
            self.open = False

    monkeypatch.setattr(live, "LiveView", View)
    monkeypatch.setenv("DISPLAY", ":0")
    env = ship_gym.TrackFollowing(render_mode="human")
    env.reset(seed=0)
    env.reset(seed=1)
    assert len(shown) == 2 and shown[1] == env.episodes.plans[0, -1].tolist() != shown[0]
