"""Pictures: right shape, the same for the same scene, and another one where something changes."""

from __future__ import annotations

import dataclasses
import math
import subprocess
import sys

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, PSI, N, R, U, X, Y
from ship_gym.rendering.scene import Scene

pytest.importorskip("PIL")

from ship_gym.rendering import canvas as drawing
from ship_gym.rendering.plan_view import PlanView

VIEW = PlanView()
PLAN, PANEL = slice(0, 640), slice(642, 960)  # columns of the plan view and of the instruments


def scene(**changes) -> Scene:
    state = np.array([7.0, -0.1, 0.002, 500.0, -300.0, 0.4, 0.0, 1.4])
    terms = {"heading": -0.02, "rudder": -0.001, "rudder_rate": 0.0}
    wake = np.stack([np.linspace(-400.0, 500.0, 90), np.linspace(-700.0, -300.0, 90)], axis=1)
    base = {"task": "Heading keeping", "ship": "KCS", "L": 230.0, "B": 32.2, "U0": 7.46}
    base |= {"delta_max": 0.61, "n_max": 2.3, "time": 120.0, "psi_ordered": 0.3, "wake": wake}
    base |= {"heading_limit": 1.05, "reward": -0.021, "reward_terms": terms}
    base |= {"state": state, "command": np.array([0.1, 1.5])}
    return Scene(**(base | changes))


def on_track(**changes) -> Scene:
    track = 230.0 * np.array([[-5.0, -2.0], [6.0, -2.0], [6.0, 6.0]])
    base = {"track": track, "cross_track": 160.0, "cross_track_limit": 1150.0}
    return scene(**(base | {"heading_limit": None} | changes))


def in_a_seaway(**changes) -> Scene:
    waves = {"wave_height": 3.0, "wave_period": 9.7, "wave_direction_to": 2.0, "wave_roll": 0.03}
    return scene(**(waves | {"wind": (-9.0, 4.0), "current": (0.3, 0.6)} | changes))


def moved(base: Scene, **state) -> Scene:
    new = base.state.copy()
    for name, value in state.items():
        new[{"psi": PSI, "delta": DELTA, "n": N, "r": R, "u": U, "x": X, "y": Y}[name]] = value
    return dataclasses.replace(base, state=new)


def differs(one: Scene, two: Scene, columns: slice) -> bool:
    return bool((VIEW.draw(one)[:, columns] != VIEW.draw(two)[:, columns]).any())


SCENES = {
    "heading": scene(),
    "seaway": in_a_seaway(),
    "model": scene(L=3.05, B=0.43, U0=0.86, scale=75.24),
    "track": on_track(),
    "ended": scene(outcome="heading limit"),
    "no order": scene(psi_ordered=None, heading_limit=None, reward_terms={}, wake=np.zeros((0, 2))),
}


@pytest.mark.parametrize("name", SCENES)
def test_picture_is_complete_and_repeatable(name):
    picture = VIEW.draw(SCENES[name])
    assert picture.shape == (540, 960, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 5.0
    assert np.array_equal(picture, PlanView().draw(SCENES[name]))


@pytest.mark.parametrize("size", [(640, 360), (1280, 720), (640, 1080), (1920, 360)])
def test_other_sizes(size):
    width, height = size
    assert PlanView(width, height).draw(on_track(outcome="arrived")).shape == (height, width, 3)


@pytest.mark.parametrize(
    ("field", "size"),
    [("width", 638), ("width", 961), ("width", 3842), ("width", 960.0), ("height", 0),
     ("height", 541), ("height", True), ("height", None)],
)  # fmt: skip
def test_bad_sizes_are_refused(field, size):
    with pytest.raises(ConfigError, match=rf"{field} = .*: allowed is an even integer from"):
        PlanView(**{field: size})


@pytest.mark.parametrize(
    "changed",
    [{"delta": -0.3}, {"delta": 0.3}, {"psi": 2.0}, {"r": 0.02}, {"u": 4.0}, {"n": 0.5}],
)
def test_the_state_moves_the_instruments(changed):
    assert differs(scene(), moved(scene(), **changed), PANEL)


@pytest.mark.parametrize(
    "changes",
    [{"command": np.array([-0.4, 1.5])}, {"command": np.array([0.1, 0.3])}, {"time": 121.0},
     {"psi_ordered": 0.9}, {"heading_limit": 0.5}, {"reward": -0.5}, {"scale": 20.0},
     {"reward_terms": {"heading": -0.01}}, {"current": (0.5, 0.5)}],
)  # fmt: skip
def test_orders_and_reward_move_the_instruments(changes):
    assert differs(scene(), scene(**changes), PANEL)


def test_the_cross_track_error_has_an_instrument():
    assert differs(on_track(), on_track(cross_track=-160.0), PANEL)
    assert differs(scene(), on_track(), PANEL)


@pytest.mark.parametrize(
    "other",
    [moved(scene(), psi=2.0), moved(scene(), delta=0.5), moved(scene(), x=580.0),
     scene(psi_ordered=0.9), scene(heading_limit=0.5), scene(wake=np.zeros((0, 2))),
     scene(wind=(5.0, 5.0)), scene(current=(0.5, 0.5)), in_a_seaway(), on_track(),
     scene(outcome="heading limit"), scene(task="Course changing"), scene(wave_yaw=0.2)],
)  # fmt: skip
def test_the_plan_shows_what_changes(other):
    assert differs(scene(), other, PLAN)


def test_crests_run_and_the_leg_is_marked():
    assert differs(in_a_seaway(), in_a_seaway(time=123.0), PLAN)
    assert not differs(scene(), scene(time=123.0), PLAN)
    assert differs(on_track(), on_track(active_leg=1), PLAN)
    assert differs(on_track(), on_track(cross_track_limit=None), PLAN)
    assert differs(on_track(), on_track(corridor=345.0), PLAN)


def test_rudder_bar_is_red_to_port_and_green_to_starboard():
    def count(delta, color):
        picture = VIEW.draw(moved(scene(), delta=delta, r=0.0))[210:250, PANEL]
        return int((picture == color).all(axis=2).sum())

    assert count(-0.3, drawing.RED) > 300
    assert count(-0.3, drawing.GREEN) == 0
    assert count(0.3, drawing.GREEN) > 300
    assert count(0.3, drawing.RED) == 0


def test_ship_points_up_to_the_north_and_right_to_the_east():
    def middle_of_hull(psi):
        quiet = scene(wake=np.zeros((0, 2)), psi_ordered=None, heading_limit=None)
        picture = VIEW.draw(moved(quiet, psi=psi, u=0.0))[120:420, 170:470]
        rows, columns = np.nonzero((picture == drawing.INK).all(axis=2))
        return np.ptp(columns), np.ptp(rows)

    width, height = middle_of_hull(0.0)
    assert height > 4 * width
    width, height = middle_of_hull(0.5 * math.pi)
    assert width > 4 * height


EXTREME = {
    "still": moved(scene(), u=0.0, n=0.0, r=0.0),
    "far": moved(scene(), x=1e12, y=-1e12),
    "far off the track": moved(on_track(cross_track=1e9), x=1e9, y=1e9),
    "fast": moved(in_a_seaway(), u=1e6, r=1e3, delta=-40.0, n=-1e3, psi=-1e5),
    "long wake": scene(wake=np.cumsum(np.full((20000, 2), 5.0), axis=0)),
    "wild wake": scene(wake=np.array([[1e15, 0.0], [-1e15, 1.0], [0.0, 0.0], [0.0, 0.0]])),
    "one point": on_track(track=np.zeros((2, 2))),
    "ripples": in_a_seaway(wave_height=1e-6, wave_period=1e-3),
    "tides": in_a_seaway(wave_height=1e6, wave_period=4e4),
    "storm": scene(wind=(1e9, 0.0), current=(-1e-9, 1e9)),
    "many terms": scene(reward_terms={f"term {k} " + "x" * 40: 10.0**k for k in range(30)}),
    "long texts": on_track(task="t" * 300, ship="s" * 300, outcome="o" * 300),
    "no limit": scene(heading_limit=10.0),
    "minute": scene(L=1e-3, B=1e-4),
}


@pytest.mark.parametrize("name", EXTREME)
def test_extreme_scenes_are_drawn(name):
    assert VIEW.draw(EXTREME[name]).shape == (540, 960, 3)


def texts_of(shown: Scene, width: int = 960, height: int = 540):
    """Every text on the picture with its left, top, right and bottom."""
    found = []

    class Recorder(drawing.Canvas):
        def pixels(self):
            found.extend((text[1], self._extent(text)) for text in self._texts)
            return super().pixels()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ship_gym.rendering.plan_view.Canvas", Recorder)
        PlanView(width, height).draw(shown)
    return found


@pytest.mark.parametrize("name", [*SCENES, "many terms", "long texts", "far off the track", "fast"])
def test_no_text_is_cut_off_or_covers_another(name):
    texts = texts_of((SCENES | EXTREME)[name])
    assert len(texts) > 20
    for k, (text, (left, top, right, bottom)) in enumerate(texts):
        assert 0.0 <= left, text
        assert right <= 960.0, text
        assert 0.0 <= top, text
        assert bottom <= 540.0, text
        for other, two in texts[:k]:
            # a letter reaches to about three quarters of its font's size
            apart = right <= two[0] or two[2] <= left
            apart = apart or bottom <= two[1] + 3.0 or two[3] <= top + 3.0
            assert apart, (text, other)


def test_pillow_loads_with_the_first_picture_only():
    code = "import sys, ship_gym, ship_gym.rendering; sys.exit('PIL' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_missing_pillow_says_what_to_install():
    code = (
        "import sys; sys.modules['PIL'] = None\n"
        "try:\n    import ship_gym.rendering.plan_view\n"
        "except ImportError as error:\n    assert 'ship-gym[render]' in str(error), error\n"
        "else:\n    sys.exit(1)\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
