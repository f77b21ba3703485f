"""What an environment shows of one of its episodes: a picture, or a live view in rerun."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from ship_gym.config import check_known
from ship_gym.conventions import FLOW_OF_UNITS, FORCE_AXES, FORCE_COMPONENTS, N_FLOW, X, Y
from ship_gym.physics.waves import WAVE_ROLL, WAVE_YAW
from ship_gym.recording.screen import has_screen
from ship_gym.sea.surface import wave_entries

if TYPE_CHECKING:
    from ship_gym.envs.episodes import EpisodeBatch
    from ship_gym.recording.live import LiveView
    from ship_gym.rendering.plan_view import PlanView
    from ship_gym.rendering.scene import Scene

RENDER_MODES = ("rgb_array", "human")
_WAKE = 901  # positions that the wake keeps


def offered_modes(modes: Sequence[str] = RENDER_MODES) -> list[str]:
    """Those of some render modes that can work here: their library and a screen are there."""
    return [mode for mode in modes if _missing(mode) is None]


def check_render_mode(mode: str | None, modes: Sequence[str] = RENDER_MODES) -> None:
    """Refuse a render mode that is none, or that cannot work here.

    Raises
    ------
    ConfigError
        Not one of `modes`.
    ImportError, RuntimeError
        Its library, or a screen, is missing.
    """
    if mode is not None:
        check_known("render_mode", mode, modes)
        missing = _missing(mode)
        if missing is not None:
            raise missing


def _missing(mode: str) -> Exception | None:
    """What keeps a render mode from working."""
    if mode == "rgb_array":
        return (
            None
            if find_spec("PIL")
            else ImportError(
                'render_mode = "rgb_array" needs Pillow: pip install "ship-gym[render]"'
            )
        )
    if not find_spec("rerun"):
        return ImportError('render_mode = "human" needs rerun: pip install "ship-gym[rerun]"')
    if not has_screen():
        return RuntimeError(
            'render_mode = "human" needs a screen, and here is none (neither DISPLAY nor '
            'WAYLAND_DISPLAY is set); use "rgb_array", or record the rollout with ship-gym record'
        )
    return None


class Screen:
    """Follows one episode of a batch; the drawing libraries load at the first picture.

    Parameters
    ----------
    mode : str
        One of `RENDER_MODES`.
    episodes : EpisodeBatch
    index : int
        Which episode.
    """

    def __init__(self, mode: str, episodes: EpisodeBatch, index: int = 0):
        self._mode, self._episodes, self._index = mode, episodes, index
        self._wake: deque[tuple[float, float]] = deque(maxlen=_WAKE)
        self._view: PlanView | None = None
        self._live: LiveView | None = None

    def begin(self) -> None:
        """A new episode begins."""
        self._wake.clear()
        if self._live is not None:
            self._live.close()  # two resets without a step between them begin at the same time
        self.follow()

    def follow(self) -> None:
        """Keep the present position; show it at once in mode ``human``."""
        x, y = self._episodes.sim.state[self._index, [X, Y]].tolist()
        self._wake.append((x, y))
        if self._mode == "human":
            self._stream()

    def picture(self) -> np.ndarray | None:
        """uint8 (height, width, 3); None in mode ``human``, which shows itself."""
        if self._mode == "human":
            return None
        if self._view is None:
            from ship_gym.rendering.plan_view import PlanView

            self._view = PlanView()
        return self._view.draw(self.scene())

    def _stream(self) -> None:
        if self._live is None:
            from ship_gym.recording.live import LiveView

            episodes = self._episodes
            ship, plots = episodes.ships[self._index], episodes.task.plots
            self._live = LiveView(ship, self._title(), plots=plots)
        scene = self.scene()
        self._live.show(scene.row() | self._forces(), scene.track, self._sea(scene))

    def _sea(self, scene: Scene) -> dict[str, object]:
        """What the meta of a recording says of the waves."""
        names = ("wave_height", "wave_period", "wave_direction_to")
        waves = wave_entries(self._episodes.sim.water.waves_of(self._index))
        return {"sea": {name: getattr(scene, name) for name in names}, "waves": waves}

    def _title(self) -> str:
        return self._episodes.scenario.task.replace("_", " ").capitalize()

    def _forces(self) -> dict[str, float]:
        """Forces at the start of the interval, of two units also of each, as in a recording."""
        sim, i = self._episodes.sim, self._index
        units = dict(zip(FLOW_OF_UNITS[N_FLOW:], sim.flow[i, N_FLOW:].tolist(), strict=False))
        return {
            f"{axis}_{component}": float(sim.forces[i, k, j])
            for k, component in enumerate(FORCE_COMPONENTS)
            for j, axis in enumerate(FORCE_AXES)
        } | (units if self._episodes.ships[i].propellers == 2 else {})

    def scene(self) -> Scene:
        """The present instant in plain numbers."""
        from ship_gym.rendering.scene import Scene

        e, i = self._episodes, self._index
        ship, task, sea = e.ships[i], e.tasks[i], e.sim.seas[i]
        return Scene(
            task=self._title(),
            ship=ship.name,
            L=ship.hull.L,
            B=ship.hull.B,
            U0=ship.speed,
            delta_max=ship.gear.delta_max,
            n_max=ship.engine.n_max,
            state=e.sim.state[i].copy(),
            command=e.sim.commands[i].copy(),
            time=float(e.sim.time[i]),
            scale=ship.scale,
            wake=np.array(self._wake),
            **e.task.scene(e, i),
            current=(float(sea["V_north"]), float(sea["V_east"])),
            wind=(float(sea["wind_north"]), float(sea["wind_east"])),
            wave_height=float(task["wave_height"]),
            wave_period=float(task["wave_period"]),
            wave_direction_to=float(task["wave_to"] % (2.0 * math.pi)),
            wave_yaw=float(e.sim.waves[i, WAVE_YAW]),
            wave_roll=float(e.sim.waves[i, WAVE_ROLL]),
            reward=float(e.rewards[i]),
            reward_terms=dict(zip(e.reward_terms, e.terms[i].tolist(), strict=True)),
            outcome=self._outcome(),
        )

    def _outcome(self) -> str:
        e, i = self._episodes, self._index
        if e.terminated[i]:
            return e.task.all_outcomes[e.outcomes[i]].name
        return "end of time" if e.truncated[i] else ""

    def close(self) -> None:
        """Close the live view."""
        if self._live is not None:
            self._live.close()
            self._live = None
