"""A recording is drawn as the environment drew itself, in pictures, strips and videos."""

from __future__ import annotations

import builtins
import errno
import os

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller

from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation import rollout
from ship_gym.manoeuvres import turning_circle
from ship_gym.recording import Trajectory
from ship_gym.rendering import replay

pytest.importorskip("PIL")

POINTS = [[0.0, 0.0], [400.0, 0.0], [1500.0, 250.0], [3000.0, 250.0]]
TRACK = {"track.kind": "points", "track.points": POINTS, "track.any_turns": True}
CASES = {
    "waves": ("pid", "heading_ss6_beam", {"duration": 20.0}),
    "steps of the order": ("pid", "course_changing", {"duration": 20.0, "course.first": 10.0}),
    "a track": ("ilos", "track_following", {"duration": 60.0, **TRACK}),
}


def recorded(controller: str, scenario: str, overrides: dict, seed: int = 3) -> Trajectory:
    found = rollout(make_controller(controller), scenario, seeds=[seed], overrides=overrides)
    return found.trajectory(0)


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return recorded(*CASES["waves"])


@pytest.mark.parametrize("case", CASES)
def test_frame_is_what_the_environment_showed(case):
    controller, scenario, overrides = CASES[case]
    trajectory = recorded(controller, scenario, overrides)
    env = ShipEnv(scenario=scenario, overrides=overrides, render_mode="rgb_array")
    steered = make_controller(controller)
    observation, _ = env.reset(seed=3)
    steered.reset(1, env.episodes.ship, env.episodes.scenario)
    assert np.array_equal(env.render(), replay.frame(trajectory, 0))
    turn = int(np.argmax(np.diff(trajectory["psi_ordered"]) != 0.0)) + 1
    assert turn > 1 or case == "waves"
    for row in range(1, len(trajectory)):
        observation, *_ = env.step(steered.act(observation[None])[0])
        if row in (1, turn - 1, turn, turn + 1, len(trajectory) - 1):
            assert np.array_equal(env.render(), replay.frame(trajectory, row)), row
    env.close()


def test_only_the_last_picture_has_the_outcome(run):
    assert replay.scene_at(run, -1).outcome == "end of time"
    assert replay.scene_at(run, -2).outcome == ""


def test_row_that_comes_again_is_drawn_once(run, monkeypatch):
    drawn = []
    original = replay.scene_at
    monkeypatch.setattr(replay, "scene_at", lambda t, row: drawn.append(row) or original(t, row))
    pictures = list(replay.frames(run, [0, 0, 1, 1, 1, 0]))
    assert drawn == [0, 1, 0]
    assert len(pictures) == 6


def test_row_at_a_time_is_the_last_one_that_has_begun(run):
    assert replay.row_at(run, 3.99) == 3
    assert replay.row_at(run, 4.0) == 4
    with pytest.raises(ConfigError, match="time = 21"):
        replay.row_at(run, 21.0)


def test_strip_stands_three_abreast_under_captions(run):
    picture = replay.strip(run, [0.0, 5.0, 10.0, 20.0], 640, 360)
    assert picture.shape == (2 * (360 + 28), 3 * 640, 3)
    assert picture.dtype == np.uint8
    assert np.array_equal(picture[28:388, 640:1280], replay.frame(run, 5, 640, 360))
    assert (picture[388:, 640:] == 255).all()  # two places are left
    with pytest.raises(ConfigError, match="at least one time"):
        replay.strip(run, [])


def test_moments_are_few_apart_and_have_start_worst_and_end(run):
    found = replay.moments(run, most=4)
    assert found == sorted(found)
    assert len(found) <= 4
    assert {0.0, 20.0} <= set(found)
    assert np.diff(found).min() > 0.02 * 20.0


def test_manoeuvre_is_drawn_with_its_whole_way():
    circle = turning_circle("kcs_model").trajectory
    scene = replay.scene_at(circle, -1)
    assert scene.psi_ordered is None
    assert scene.track is None
    assert len(scene.wake) <= 3200
    assert np.allclose(scene.wake[-1], scene.position)
    assert np.hypot(*scene.wake[0]) < 0.1 * scene.L
    assert replay.scene_at(circle, 0).command.tolist() == pytest.approx(
        [circle["delta_command"][0], circle["n_command"][0]]
    )
    assert replay.frame(circle, -1).shape == (540, 960, 3)


def test_recording_that_cannot_be_drawn_says_what_it_lacks(run):
    columns = {name: run[name] for name in run.names if name != "psi"}
    with pytest.raises(ConfigError, match=r"without psi, meta ship\.L cannot be drawn"):
        ship = {key: value for key, value in run.meta["ship"].items() if key != "L"}
        replay.scene_at(Trajectory(columns, run.meta | {"ship": ship}), 0)


def test_rows_of_a_video_follow_the_clock(run):
    rows = replay.video_rows(run, fps=4, speed=2.0)  # two rows a second, each for two pictures
    assert rows[:6] == [0, 0, 1, 1, 2, 2]
    assert rows[-1] == len(run) - 1
    assert len(rows) == 4 * 10 + 2
    assert len(replay.video_rows(run)) == 25 * 20 + 2  # as fast as the ship


@pytest.mark.parametrize(
    ("how", "message"),
    [({"fps": 0}, "fps = 0"), ({"fps": 2.5}, "fps"), ({"speed": 0.0}, "speed = 0")],
)
def test_bad_rates_are_refused(run, how, message, tmp_path):
    with pytest.raises(ConfigError, match=message):
        replay.write_video(run, tmp_path / "run.mp4", **how)
    assert os.listdir(tmp_path) == []


def test_video_shows_the_run(run, tmp_path):
    av = pytest.importorskip("av")
    path = tmp_path / "run.mp4"
    replay.write_video(run, path, fps=5, speed=10.0, width=640, height=360)
    with av.open(str(path)) as file:
        pictures = [picture.to_ndarray(format="rgb24") for picture in file.decode(video=0)]
        assert file.streams.video[0].codec_context.name == "h264"
    rows = replay.video_rows(run, 5, 10.0)
    assert len(pictures) == len(rows)
    for picture, row in zip(pictures, rows, strict=True):
        drawn = replay.frame(run, row, 640, 360).astype(int)
        assert np.abs(picture.astype(int) - drawn).mean() < 4.0  # colours are compressed
    assert os.listdir(tmp_path) == ["run.mp4"]


def test_broken_off_video_leaves_the_old_file(run, tmp_path):
    pytest.importorskip("av")
    path = tmp_path / "run.mp4"
    path.write_bytes(b"old")

    def broken(rows):
        yield rows[0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        replay.write_video(run, path, progress=broken)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["run.mp4"]


def test_full_disk_is_one_line_that_names_the_video(run, tmp_path, monkeypatch):
    pytest.importorskip("av")

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OSError, match=r"run\.mp4: no space left"):
        replay.write_video(run, tmp_path / "run.mp4", fps=1, speed=20.0)
    assert os.listdir(tmp_path) == []


def test_video_is_an_mp4_and_needs_av(run, tmp_path, monkeypatch):
    with pytest.raises(ConfigError, match=r"\*\.mp4"):
        replay.write_video(run, tmp_path / "run.avi")
    real = builtins.__import__

    def without(name, *rest):
        if name == "av":
            raise ModuleNotFoundError("No module named 'av'", name="av")
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=r"ship-gym\[video\]"):
        replay.write_video(run, tmp_path / "run.mp4")
