"""ShipEnv: the scalar Gymnasium environment, a batch of one."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from types import FrameType
from typing import Any

import gymnasium as gym
import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.flat_info import flat, is_flat
from ship_gym.envs.start_options import start_options
from ship_gym.envs.view import RENDER_MODES, Screen, check_render_mode, offered_modes
from ship_gym.scenarios.scenario import Scenario, load_scenario
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import numbered
from ship_gym.tasks import observations_of
from ship_gym.tasks.bridge import ASTERN_ROWS
from ship_gym.tasks.columns import ACTIONS

_ALL = np.array([0])
Given = str | os.PathLike | Ship | None


def resolved_scenario(
    scenario: str | Mapping[str, Any] | Scenario,
    ship: Given,
    control: str | None,
    surrogate: str | None,
    privileged: bool | None,
    overrides: Mapping[str, Any] | None,
) -> tuple[Scenario, Ship | None]:
    """Scenario with the arguments of an environment applied, and the ship if it is an object."""
    if overrides is not None and not isinstance(overrides, Mapping):
        raise ConfigError(f"overrides = {overrides!r}: must be a mapping of keys to values")
    changes = dict(overrides or {})
    ship = os.fspath(ship) if isinstance(ship, os.PathLike) else ship
    given = {"ship": ship, "surrogate": surrogate, "control": control, "privileged": privileged}
    if isinstance(ship, Ship):
        if surrogate is not None:
            raise ConfigError(
                f"surrogate = {surrogate!r}: the ship given as an object brings its own, "
                f"{ship.surrogate_name!r}"
            )
        given |= {"ship": ship.name, "surrogate": ship.surrogate_name}
    changes.update({key: value for key, value in given.items() if value is not None})
    return load_scenario(scenario, changes), ship if isinstance(ship, Ship) else None


def resolved_fleet(
    scenario: str | Mapping[str, Any] | Scenario,
    ships: Given | Sequence[str | os.PathLike | Ship],
    control: str | None,
    surrogate: str | None,
    privileged: bool | None,
    overrides: Mapping[str, Any] | None,
) -> tuple[Scenario, Ship | list[Ship] | None]:
    """As `resolved_scenario`, for one ship or several; the scenario names the first of several."""
    if ships is None or isinstance(ships, str | os.PathLike | Ship):
        return resolved_scenario(scenario, ships, control, surrogate, privileged, overrides)
    if not isinstance(ships, Sequence):
        raise ConfigError(f"ship = {ships!r}: must be a name, a Ship or a list of them")
    if len(ships) == 0:
        raise ConfigError("ship = []: a fleet needs at least one ship")
    for ship in ships:
        if not isinstance(ship, str | os.PathLike | Ship):
            raise ConfigError(f"ship = {ships!r}: each must be a name or a Ship")
    fleet: Sequence[Any] = ships  # paths are hashable too
    different, numbers = numbered(fleet)
    scenarios, made = [], []
    for ship in different:
        resolved, given = resolved_scenario(
            scenario, ship, control, surrogate, privileged, overrides
        )
        scenarios.append(resolved)
        made.append(given or load_ship(resolved.ship, surrogate=resolved.surrogate))
    return scenarios[0], [made[k] for k in numbers]


def recording_of(record: str | os.PathLike | Mapping[str, Any], env: Any) -> Any:
    """The ``EpisodeRecording`` that the option ``record`` of an environment asks for."""
    from ship_gym.envs.recording import EpisodeRecording  # not needed by others
    from ship_gym.envs.recording_options import RecordingOptions

    return EpisodeRecording(env.episodes, RecordingOptions.from_option(record), env.origin)


def action_space(scenario: Scenario) -> gym.spaces.Box:
    """Box [-1, 1] of shape (1,) or (2,), float32."""
    return gym.spaces.Box(-1.0, 1.0, (len(ACTIONS[scenario.control]),), np.float32)


def observation_space(scenario: Scenario) -> gym.spaces.Box:
    """Box of float32 with the documented bounds."""
    rows = observations_of(scenario.task, scenario.privileged)
    low = np.array([row.low for row in rows], dtype=np.float32)
    low[[row.name in ASTERN_ROWS for row in rows]] = -scenario.astern
    high = np.array([row.high for row in rows], dtype=np.float32)
    return gym.spaces.Box(low, high, dtype=np.float32)


def with_steps(scenario: Scenario, steps: int | None, overrides: Mapping | None) -> Scenario:
    """Scenario that is truncated after a number of control intervals; None or -1: as it is.

    Raises
    ------
    ConfigError
        Not a positive whole number, or a duration that was given too and is shorter.
    """
    if steps is None or steps == -1:
        return scenario
    if check_number("max_episode_steps", steps, 1, 10**9) != int(steps):
        raise ConfigError(f"max_episode_steps = {steps}: must be a whole number")
    if "duration" in (overrides or {}) and steps > scenario.steps:
        raise ConfigError(
            f"max_episode_steps = {steps} and overrides = {{'duration': {scenario.duration:g}}}, "
            f"which is {scenario.steps} steps: give one of them"
        )
    return scenario.with_duration(int(steps) * scenario.control_interval)


def _steps_of_make(made: type) -> int | None:
    """The ``max_episode_steps`` of the ``gym.make`` that is making a class, or of its spec.

    `gym.make` gives it to a TimeLimit wrapper only, which can shorten an episode but not lengthen
    it; so we look for it where it stands. None where there is none.
    """
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        if frame.f_code is getattr(gym.make, "__code__", None):
            spec: Any = frame.f_locals.get("env_spec")
            entry = getattr(spec, "entry_point", None)
            ours = entry is made or str(entry).startswith(f"{__name__.rpartition('.')[0]}.")
            if not ours:
                return None  # of somebody else, who makes us inside
            steps = frame.f_locals.get("max_episode_steps")
            return spec.max_episode_steps if steps is None else steps
        frame = frame.f_back
    return None


class ShipEnv(gym.Env):
    """A ship in a scenario: any task, any ship; the ids are its subclasses.

    With ``gym.make(..., max_episode_steps=k)`` an episode is k control intervals long, instead of
    what the scenario's duration says.

    Parameters
    ----------
    ship : str or Ship, optional
        One of ``ship_gym.available_ships()``, the path of a ship file, or a ``Ship``; the
        scenario's if None. Times, sea and current of a model are Froude-scaled.
    control : str, optional
        ``"rudder"`` or ``"rudder+rpm"``.
    surrogate : str, optional
        ``"regression"``, ``"gp"``, ``"nn"`` or another one of
        ``ship_gym.available_surrogates(ship)``; the ship's default if None.
    scenario : str, mapping or Scenario, optional
        A name of ``ship_gym.available_scenarios()``, a TOML file or a mapping; the class's own if
        None.
    privileged : bool, optional
        Append waves, wind, current and forces to the observation (``tasks.privileged``).
    overrides : mapping, optional
        Keys of the scenario, nested or dotted; unknown keys are refused.
    render_mode : str, optional
        ``"rgb_array"`` or ``"human"``. One whose library or screen is missing is refused, and not
        among the ``render_modes`` of the instance's metadata; the class has both.
    max_episode_steps : int, optional
        Control intervals of an episode, instead of what the scenario's duration says.
    copy : bool
        Whether observations and infos stay as they are. If False they are the environment's own
        arrays, which the next step or reset overwrites (an info counts when it is looked at).
    record : path or mapping, optional
        Folder for recordings of all episodes, or a mapping of the options of ``RecordRerun`` with
        ``folder`` among them.
    info : str
        ``"nested"`` (default), or ``"flat"``: no dicts in an info, numpy numbers and arrays only,
        ``info["forces.hull"]``, for clients that need that (docs/clients.md).
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 10}  # noqa: RUF012
    scenario_name = "heading_keeping"

    def __init__(
        self,
        ship: Given = None,
        control: str | None = None,
        surrogate: str | None = None,
        scenario: str | Mapping[str, Any] | Scenario | None = None,
        privileged: bool | None = None,
        overrides: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        copy: bool = True,
        record: str | os.PathLike | Mapping[str, Any] | None = None,
        info: str = "nested",
    ):
        self._copy, self._flat = bool(copy), is_flat(info)
        self._resets = 0  # since the stream was seeded
        check_render_mode(render_mode)
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_modes": offered_modes()}
        scenario = self.scenario_name if scenario is None else scenario
        resolved, given = resolved_scenario(
            scenario, ship, control, surrogate, privileged, overrides
        )
        if max_episode_steps is None:
            max_episode_steps = _steps_of_make(type(self))
        self.scenario = with_steps(resolved, max_episode_steps, overrides)
        self.episodes = EpisodeBatch(1, self.scenario, given, parallel=False)
        self.observation_space = observation_space(self.scenario)
        self.action_space = action_space(self.scenario)
        self._shape = self.action_space.shape
        self._screen = None if render_mode is None else Screen(render_mode, self.episodes)
        self._recording = None if record is None else recording_of(record, self)

    @property
    def ship(self) -> Ship:
        """The ship that sails."""
        return self.episodes.ship

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode; all its randomness comes from one draw of ``np_random``.

        Parameters
        ----------
        seed : int, optional
        options : dict, optional
            What is not drawn: ``heading_error_deg``, ``speed`` [m/s], ``position`` (north, east
            [m]), ``sea_seed``; see ``envs.start_options``.
        """
        given = start_options(options, 1)
        self._resets = 0 if seed is not None or self._np_random is None else self._resets + 1
        super().reset(seed=seed)
        draws = self.np_random.random((1, self.episodes.n_draws))
        self.episodes.start(_ALL, draws, given)
        if self._screen is not None:
            self._screen.begin()
        return self._seen(), self._info()

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Sail one control interval under one action."""
        episodes = self.episodes
        given = np.asarray(action)
        if given.shape != self._shape:
            raise ConfigError(
                f"action = {action!r} has shape {given.shape}, allowed is "
                f"{self.action_space.shape} for control = {self.scenario.control!r}"
            )
        episodes.step(given[None])
        if self._screen is not None:
            self._screen.follow()
        return (
            self._seen(),
            episodes.rewards.item(0),
            episodes.terminated.item(0),
            episodes.truncated.item(0),
            self._info(),
        )

    def _info(self) -> dict[str, Any]:
        info = self.episodes.info_of(0, self._copy)
        return flat(info) if self._flat else info

    def _seen(self) -> np.ndarray:
        observation = self.episodes.observations[0]
        return observation.copy() if self._copy else observation

    def render(self) -> Any:
        """Picture of the present instant, uint8 (height, width, 3); None in mode ``"human"``."""
        if self._screen is None:
            raise ConfigError(
                "render without a render mode: make the environment with render_mode='rgb_array'"
            )
        return self._screen.picture()

    def elevation(self, x: Any, y: Any, t: Any = None) -> np.ndarray:
        """Elevation of the sea above still water at places and times [m], ``ShipSim.elevation``."""
        return self.episodes.sim.elevation(x, y, t)

    def origin(self, index: int = 0) -> tuple[int | None, int]:
        """Where the randomness of this episode is from, enough to have it again.

        Returns
        -------
        seed : int or None
            Of the stream; None of a generator that was given.
        resets : int
            After that with the seed; 0: that one.
        """
        return (self._np_random_seed if self._np_random_seed != -1 else None), self._resets

    def close(self) -> None:
        """Close the live view and the recording, if there are any."""
        if self._screen is not None:
            self._screen.close()
        if self._recording is not None:
            self._recording.close()
