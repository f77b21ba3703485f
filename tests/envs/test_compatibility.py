"""What Gymnasium's users do with an environment: wrappers, vector forms, copies, processes, files.

Wherever two ways lead to the same episode, they must do so bit for bit.
"""

import copy
import functools
import multiprocessing
import pickle
import shutil
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import vector as vector_wrappers

import ship_gym
from ship_gym.config import ConfigError

IDS = sorted(ship_gym.ENVIRONMENTS)
HEADING, TRACK = "ShipGym/HeadingKeeping-v0", "ShipGym/TrackFollowing-v0"
SHORT = {"duration": 8.0}  # several episodes in a short test
MINE = """
base = "heading_keeping"
ship = "kvlcc2_model"
duration = 5.0

[sea]
states = []
gusts = false
wave_height = 2.5

[reward]
rudder = 0.7
"""


def native(env_id, n, **options):
    return ship_gym.ShipVectorEnv(n, scenario=ship_gym.ENVIRONMENTS[env_id], **options)


def sail(env, steps=12, seed=3):
    """All numbers that an environment gives under actions of a seed; it resets where it must."""
    generator = np.random.default_rng(seed)
    seen = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        action = generator.uniform(-1.0, 1.0, env.action_space.shape).astype(np.float32)
        *numbers, _ = env.step(action)
        seen += numbers
        if not isinstance(env, gym.vector.VectorEnv) and (numbers[2] or numbers[3]):
            seen.append(env.reset()[0])
    return [np.array(numbers) for numbers in seen]


def assert_same(a, b):
    assert len(a) == len(b)
    for one, other in zip(a, b, strict=True):
        np.testing.assert_array_equal(one, other, strict=True)


# --- checker, registry ---------------------------------------------------------------------------


@pytest.mark.parametrize("env_id", IDS)
def test_check_env_with_rendering_is_silent(env_id, tmp_path, monkeypatch):
    """Both render modes; what would open a viewer writes a file instead."""
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    pytest.importorskip("rerun", reason="extra 'rerun' not installed")
    from ship_gym.recording import live

    to_file = functools.partial(live.LiveView, sink=tmp_path / "live.rrd")
    monkeypatch.setattr(live, "LiveView", to_file)
    monkeypatch.setenv("DISPLAY", ":0")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gym.make(env_id, ship="kcs_model", render_mode="rgb_array").unwrapped
        check_env(env)
    assert env.metadata["render_modes"] == ["rgb_array", "human"]
    assert (tmp_path / "live.rrd").stat().st_size > 0


@pytest.fixture
def no_screen(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


def test_without_a_screen_check_env_is_silent_and_no_window_is_offered(no_screen):
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    pytest.importorskip("rerun", reason="extra 'rerun' not installed")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gym.make(HEADING, render_mode="rgb_array").unwrapped
        check_env(env)
    assert env.metadata["render_modes"] == ["rgb_array"]
    assert type(env).metadata["render_modes"] == ["rgb_array", "human"]
    with pytest.raises(RuntimeError, match=r"human.* needs a screen, .*rgb_array"):
        gym.make(HEADING, render_mode="human")


@pytest.mark.parametrize(
    ("library", "mode", "extra"), [("PIL", "rgb_array", "render"), ("rerun", "human", "rerun")]
)
def test_a_mode_without_its_library_is_not_offered(monkeypatch, library, mode, extra):
    monkeypatch.setitem(sys.modules, library, None)
    for make in (gym.make, gym.make_vec) if mode == "rgb_array" else (gym.make,):
        assert mode not in make(HEADING).metadata["render_modes"]
        with pytest.raises(ImportError, match=rf"{mode}.* needs .*ship-gym\[{extra}\]"):
            make(HEADING, render_mode=mode)


@pytest.mark.parametrize("env_id", IDS)
def test_a_picture_needs_a_render_mode_and_changes_nothing(env_id):
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    plain, shown = gym.make(env_id), gym.make(env_id, render_mode="rgb_array")
    with pytest.raises(ConfigError, match="render_mode='rgb_array'"):
        plain.unwrapped.render()
    shown.reset(seed=3)
    first = shown.render()
    assert first.ndim == 3 and first.shape[2] == 3 and first.dtype == np.uint8
    shown.step(np.ones(1, np.float32))
    assert (shown.render() != first).any()
    assert_same(sail(plain), sail(shown))


@pytest.mark.parametrize("env_id", IDS)
def test_a_spec_makes_the_same_environment(env_id):
    options = {"ship": "kcs_model", "control": "rudder+rpm", "overrides": SHORT}
    env = gym.make(f"ship_gym:{env_id}", **options)
    again = gym.make(gym.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    for other in (gym.make(env.spec), again, gym.make(pickle.loads(pickle.dumps(env.spec)))):
        assert_same(sail(env), sail(other))


# --- wrappers ------------------------------------------------------------------------------------


def test_time_limit_truncates_and_leaves_the_own_end_alone():
    env = gym.make(HEADING, max_episode_steps=5, overrides=SHORT)
    env.reset(seed=0)
    ends = [env.step(np.zeros(1, np.float32))[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]
    env = wrappers.TimeLimit(gym.make(HEADING, overrides=SHORT), 20)
    env.reset(seed=0)
    ends = [env.step(np.zeros(1, np.float32))[2:4] for _ in range(8)]
    assert ends == [(False, False)] * 7 + [(False, True)]


@pytest.mark.parametrize("env_id", IDS)
def test_wrappers_show_what_the_bare_environment_gives(env_id):
    """Statistics, normalisation, stacked frames, rescaled actions, all on top of each other."""
    env = gym.make(env_id, overrides=SHORT)
    env = wrappers.RescaleAction(env, np.float32(-35.0), np.float32(35.0))
    env = wrappers.RecordEpisodeStatistics(env)
    env = normal = wrappers.NormalizeObservation(env)
    env = wrappers.FrameStackObservation(env, 3)
    bare = gym.make(env_id, overrides=SHORT)
    expected = wrappers.utils.RunningMeanStd(shape=bare.observation_space.shape, dtype=np.float32)
    rows, total = [], 0.0

    def check(raw, stack):
        expected.update(raw[None])
        rows.append(((raw - expected.mean) / np.sqrt(expected.var + 1e-8)).astype(np.float32))
        filled = [rows[0]] * 2 + rows  # before the third, the first fills the stack
        np.testing.assert_array_equal(stack, filled[-3:])
        assert env.observation_space.contains(stack)

    stack, _ = env.reset(seed=1)
    check(bare.reset(seed=1)[0], stack)
    for k in range(8):
        share = np.float32(np.cos(k))
        stack, reward, *end, info = env.step(np.array([35.0 * share], np.float32))
        raw, reward_bare, *end_bare, info_bare = bare.step(np.array([share]))
        total += reward_bare
        check(raw, stack)
        assert end == end_bare and reward == pytest.approx(reward_bare, rel=1e-5)
    assert end == [False, True] and normal.obs_rms.count == pytest.approx(9, abs=0.01)
    assert info["episode"]["l"] == 8 and info["episode"]["r"] == pytest.approx(total, rel=1e-5)
    assert set(info) - set(info_bare) == {"episode"}


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize(
    "wrap",
    [
        wrappers.NormalizeReward,
        wrappers.ClipAction,
        lambda env: wrappers.TimeAwareObservation(wrappers.TimeLimit(env, 5)),
        functools.partial(
            wrappers.RescaleObservation, min_obs=np.float32(-1), max_obs=np.float32(1)
        ),
        functools.partial(wrappers.StickyAction, repeat_action_probability=0.5),
        functools.partial(wrappers.DelayObservation, delay=2),
    ],
)
def test_other_wrappers_take_it(env_id, wrap):
    env = wrap(gym.make(env_id, overrides=SHORT))
    obs, _ = env.reset(seed=0)
    for _ in range(3):
        assert env.observation_space.contains(obs)
        obs, reward, *_ = env.step(env.action_space.sample())
    assert np.isfinite(reward)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("env_id", IDS)
def test_vector_statistics_are_those_of_scalars(env_id, mode):
    env = vector_wrappers.RecordEpisodeStatistics(
        native(env_id, 3, autoreset_mode=mode, overrides=SHORT)
    )
    env.reset(seed=5)
    actions = np.linspace(-1.0, 1.0, 3, dtype=np.float32)[:, None]
    for _ in range(8):
        *_, info = env.step(actions)
    assert info["_episode"].all() and (info["episode"]["l"] == 8).all()
    for i in range(3):
        one = wrappers.RecordEpisodeStatistics(gym.make(env_id, overrides=SHORT))
        one.reset(seed=5 + i)
        for _ in range(8):
            *_, alone = one.step(actions[i])
        assert info["episode"]["r"][i] == pytest.approx(alone["episode"]["r"], abs=1e-5)


@pytest.mark.parametrize("env_id", IDS)
def test_vector_wrappers_see_native_and_sync_alike(env_id):
    def wrapped(env):
        env = vector_wrappers.NormalizeObservation(env)
        env = vector_wrappers.NormalizeReward(env)
        env = vector_wrappers.RescaleAction(env, np.float32(-2.0), np.float32(2.0))
        return vector_wrappers.ClipAction(env)

    sync = SyncVectorEnv([lambda: gym.make(env_id, overrides=SHORT)] * 3)
    assert_same(sail(wrapped(native(env_id, 3, overrides=SHORT)), 20), sail(wrapped(sync), 20))


def test_vector_infos_as_a_list_are_those_of_scalars():
    env = vector_wrappers.DictInfoToList(native(TRACK, 2))
    _, infos = env.reset(seed=0)
    *_, infos = env.step(np.zeros((2, 1), np.float32))
    for i, info in enumerate(infos):
        one = gym.make(TRACK)
        one.reset(seed=i)
        *_, alone = one.step(np.zeros(1, np.float32))
        assert set(info) == set(alone) and set(info["forces"]) == set(alone["forces"])
        assert info["reward_terms"] == alone["reward_terms"] and info["time"] == alone["time"]
        np.testing.assert_array_equal(info["forces"]["hull"], alone["forces"]["hull"])


def test_pictures_as_observations():
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    env = gym.make(TRACK, render_mode="rgb_array", overrides=SHORT)
    env = wrappers.AddRenderObservation(env, render_only=False)
    obs, _ = env.reset(seed=0)
    assert env.observation_space.contains(obs) and obs["pixels"].dtype == np.uint8
    obs, *_ = env.step(env.action_space.sample())
    assert env.observation_space.contains(obs)


def video_frames(path):
    """Number of frames, frames per second, width and height."""
    from moviepy import VideoFileClip

    with VideoFileClip(str(path)) as clip:
        return round(clip.duration * clip.fps), clip.fps, tuple(clip.size)


@pytest.mark.parametrize("env_id", IDS)
def test_record_video_writes_a_video_of_the_episode(env_id, tmp_path):
    pytest.importorskip("moviepy", reason="extra 'render' not installed")
    env = gym.make(env_id, render_mode="rgb_array", overrides=SHORT)
    env = wrappers.RecordVideo(env, tmp_path / env_id, episode_trigger=lambda k: True)
    env.reset(seed=0)
    for _ in range(8):
        env.step(np.ones(1, np.float32))
    env.close()
    height, width, _ = env.render().shape
    (path,) = (tmp_path / env_id).glob("*.mp4")
    assert video_frames(path) == (9, env.metadata["render_fps"], (width, height))


def test_vector_record_video_shows_all_environments(tmp_path):
    pytest.importorskip("moviepy", reason="extra 'render' not installed")
    env = native(HEADING, 2, render_mode="rgb_array", overrides=SHORT)
    wide = {"video_aspect_ratio": (4, 1)}  # two pictures beside each other
    env = vector_wrappers.RecordVideo(env, str(tmp_path / "two"), video_length=4, **wide)
    env.reset(seed=0)
    for _ in range(6):
        env.step(np.ones((2, 1), np.float32))
    env.close()
    height, width, _ = env.render()[0].shape
    (path,) = (tmp_path / "two").glob("*.mp4")
    assert video_frames(path)[2] == (2 * width, height)


# --- vector forms, processes ---------------------------------------------------------------------


@pytest.mark.parametrize("autoreset", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("env_id", IDS)
def test_make_vec_gives_the_same_episodes_in_every_mode(env_id, autoreset):
    options = {"ship": "kcs_model", "control": "rudder+rpm", "overrides": SHORT}
    seen = []
    for mode in ("vector_entry_point", "sync", "async"):
        given = {"autoreset_mode": autoreset}  # Gymnasium refuses vector_kwargs with an entry point
        more = given if mode == "vector_entry_point" else {"vector_kwargs": given}
        env = gym.make_vec(env_id, num_envs=2, vectorization_mode=mode, **options, **more)
        assert env.metadata["autoreset_mode"] is autoreset
        seen.append(sail(env, 20))
        env.close()
    assert_same(seen[0], seen[1])
    assert_same(seen[0], seen[2])


def test_make_vec_draws_in_every_mode():
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    seen = []
    for mode in ("vector_entry_point", "sync", "async"):
        env = gym.make_vec(TRACK, num_envs=2, vectorization_mode=mode, render_mode="rgb_array")
        env.reset(seed=1)
        env.step(np.ones((2, 1), np.float32))
        seen.append(env.render())
        env.close()
    assert_same(seen[0], seen[1])
    assert_same(seen[0], seen[2])


# made by name, so that a child process need not import this file
make_short = functools.partial(gym.make, f"ship_gym:{HEADING}", overrides=SHORT)


@pytest.mark.parametrize(
    "start", ["fork", "spawn", pytest.param("forkserver", marks=pytest.mark.slow)]
)
def test_episodes_are_the_same_in_child_processes(start):
    sail(native(HEADING, 64, parallel=True), 1)  # a process whose threads have run
    expected = sail(SyncVectorEnv([make_short] * 2), 20)
    env = AsyncVectorEnv([make_short] * 2, context=start)
    try:
        assert_same(sail(env, 20), expected)
    finally:
        env.close()


def kernels_and_episodes(parallel):
    """Where a process keeps its compiled kernels, of which sources, and what they compute."""
    from ship_gym.physics import _kernel

    env = ship_gym.ShipVectorEnv(64, parallel=parallel, overrides=SHORT)
    return _kernel.source_hash(), _kernel._CACHE_FOLDER, sail(env, 5)


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_kernels_are_the_same_in_child_processes(start, parallel):
    """Also in a fork of a process whose threads have already run."""
    expected = kernels_and_episodes(parallel)
    with ProcessPoolExecutor(1, multiprocessing.get_context(start)) as pool:
        found = pool.submit(kernels_and_episodes, parallel).result(timeout=60.0)
    assert found[:2] == expected[:2]
    assert_same(found[2], expected[2])


# --- copies --------------------------------------------------------------------------------------


def cloudpickled(env):
    cloudpickle = pytest.importorskip("cloudpickle")
    return pickle.loads(cloudpickle.dumps(env))


def repickled(env):
    return pickle.loads(pickle.dumps(env))


def under_way(env, steps=5):
    env.reset(seed=1)
    for _ in range(steps):
        env.step(np.full(env.action_space.shape, 0.4, np.float32))
    return env


def go_on(env, steps=12):
    """Sail on without a seed, over the end of the episode."""
    seen = []
    for k in range(steps):
        *numbers, _ = env.step(np.full(env.action_space.shape, np.sin(k), np.float32))
        seen += numbers
        if not isinstance(env, gym.vector.VectorEnv) and (numbers[2] or numbers[3]):
            seen.append(env.reset()[0])
    return [np.array(numbers) for numbers in seen]


@pytest.mark.parametrize("duplicate", [copy.deepcopy, repickled, cloudpickled])
@pytest.mark.parametrize("env_id", IDS)
def test_a_copy_sails_on_bit_for_bit_and_for_itself(env_id, duplicate):
    """In the middle of an episode with waves, gusts, noise and a random ship, over its end."""
    overrides = {**SHORT, "randomisation.hull_std": 0.1}
    for env in (
        gym.make(env_id, overrides=overrides),
        native(env_id, 3, overrides=overrides),
        native(env_id, 3, overrides=overrides, autoreset_mode="SameStep"),
    ):
        under_way(env)
        again = duplicate(env)
        first = go_on(again)  # first the copy: the original must not sail with it
        assert_same(go_on(env), first)


def test_a_copy_of_one_with_pictures_draws_the_same():
    pytest.importorskip("PIL", reason="extra 'render' not installed")
    env = under_way(gym.make(TRACK, render_mode="rgb_array"))
    env.render()
    for again in (copy.deepcopy(env), repickled(env)):
        np.testing.assert_array_equal(again.render(), env.render())


# --- files from outside the package --------------------------------------------------------------


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A scenario file, and another working directory than the checkout's."""
    path = tmp_path / "files" / "mine.toml"
    path.parent.mkdir()
    path.write_text(MINE)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    return path


def test_a_scenario_file_of_ones_own(mine):
    for path in (str(mine), mine, "../files/mine.toml"):
        env = gym.make(HEADING, scenario=path)
        scenario = env.unwrapped.scenario
        assert env.unwrapped.ship.name == "kvlcc2_model" and scenario.reward.rudder == 0.7
        env.reset(seed=0)
        assert [env.step(np.zeros(1, np.float32))[3] for _ in range(5)] == [False] * 4 + [True]
    env = gym.make(HEADING, scenario=str(mine), ship="kcs", overrides={"reward.rudder": 0.2})
    assert env.unwrapped.ship.name == "kcs" and env.unwrapped.scenario.reward.rudder == 0.2


def test_a_scenario_file_of_ones_own_in_every_vector_form(mine):
    seen = []
    for mode in ("vector_entry_point", "sync", "async"):
        env = gym.make_vec(HEADING, num_envs=2, vectorization_mode=mode, scenario=str(mine))
        seen.append(sail(env))
        env.close()
    assert_same(seen[0], seen[1])
    assert_same(seen[0], seen[2])


def test_a_scenario_file_on_top_of_ones_own(mine):
    other = mine.with_name("other.toml")
    other.write_text(f'base = "{mine.as_posix()}"\ncontrol = "rudder+rpm"\n')
    env = gym.make(HEADING, scenario=str(other))
    assert env.action_space.shape == (2,) and env.unwrapped.scenario.reward.rudder == 0.7


BESIDE = {
    "base": 'base = "mine.toml"',
    "ship": 'base = "heading_keeping"\nship = "ship.toml"',
    "track": 'base = "track_following"\n[track]\nkind = "points"\nfile = "bay.geojson"',
}


@pytest.mark.parametrize("key", BESIDE)
def test_files_that_a_scenario_names_lie_beside_it(mine, key):
    """A scenario with its ship and track can be kept in one folder and used from any other."""
    track = '{"type": "LineString", "units": "m", "coordinates": [[0, 0], [0, 3000]]}'
    mine.with_name("bay.geojson").write_text(track)
    for file in (Path(ship_gym.__file__).parent / "ships" / "data" / "kvlcc2_model").iterdir():
        shutil.copy(file, mine.with_name(file.name))
    other = mine.with_name("other.toml")
    other.write_text(BESIDE[key])
    env = gym.make(TRACK if key == "track" else HEADING, scenario=str(other))
    env.reset(seed=0)


def test_a_ship_file_of_ones_own(mine):
    """The same numbers in another file are the same ship."""
    shutil.copytree(Path(ship_gym.__file__).parent / "ships" / "data" / "kvlcc2_model", "my_tanker")
    path = "my_tanker/ship.toml"
    assert gym.make(HEADING, ship=path).unwrapped.ship.name == "my_tanker"
    options = {"overrides": {"sea.states": [], "sea.gusts": False}}
    a, b = (gym.make(HEADING, ship=name, **options) for name in (path, "kvlcc2_model"))
    assert_same(sail(a), sail(b))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (MINE + "\n[rewards]\n", "mine.toml: unknown key 'rewards'"),
        ("ship = \n", "mine.toml"),
        ('base = "heading_keepin"\n', "did you mean 'heading_keeping'"),
    ],
)
def test_a_wrong_scenario_file_is_named(mine, text, words):
    mine.write_text(text)
    with pytest.raises(ConfigError) as error:
        gym.make(HEADING, scenario=str(mine))
    assert words in str(error.value)
    with pytest.raises(ConfigError, match=r"nowhere\.toml"):
        gym.make(HEADING, scenario="nowhere.toml")
