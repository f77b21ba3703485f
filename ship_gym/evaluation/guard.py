"""Controllers that go wrong: what one did, in which episode and interval, as one error."""

from __future__ import annotations

import site
import sysconfig
import time
import traceback
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.envs.episodes import shaped_actions
from ship_gym.evaluation.controller import Controller
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship

_FIRST = 3  # decisions before a mean counts: the first one may load or compile


class ControllerFailed(ConfigError):
    """A controller raised, gave what is no action, or takes too long.

    Attributes
    ----------
    controller : str
        Name.
    seeds : tuple of int
        The episode; several where it is one of these that were sailed together.
    interval : int
        Of the episode, from 0; -1: before the first one.
    what : str
        It did.
    slow : bool
        It takes too long, whatever the episode.
    """

    def __init__(
        self, controller: str, seeds: Sequence[int], interval: int, what: str, slow: bool = False
    ):
        self.controller, self.seeds, self.interval = controller, tuple(seeds), interval
        self.what, self.slow = what, slow
        several = f"episodes {seeds[0]} to {seeds[-1]}" if len(seeds) > 1 else f"episode {seeds[0]}"
        super().__init__(f"controller {controller}, {several}, {self.place}: {what}")

    @property
    def place(self) -> str:
        """The interval in words."""
        return f"interval {self.interval}" if self.interval >= 0 else "reset"

    def __reduce__(self):
        """Pickle by what it was made of."""
        return type(self), (self.controller, self.seeds, self.interval, self.what, self.slow)


class ControllerRefused(ControllerFailed):
    """A controller says itself, by a ConfigError in its ``reset``, that it cannot steer this."""

    def __str__(self) -> str:
        return self.what


class Guarded:
    """A controller that is watched: whatever it does wrong is a `ControllerFailed`.

    Parameters
    ----------
    controller : Controller
    seeds : sequence of int
        Of the episodes that it steers, one for each row.
    allowed : float, optional
        Longest mean time of a decision of one ship [s]; any if None.

    Attributes
    ----------
    file : path or None
        What the controller was loaded from, if it says.
    seconds : list of float
        How long each call of ``act`` took, for all rows together.
    """

    def __init__(self, controller: Controller, seeds: Sequence[int], allowed: float | None = None):
        self.controller, self.name = controller, controller.name
        self.file = getattr(controller, "file", None)
        self.seeds, self.allowed = tuple(int(seed) for seed in seeds), allowed
        self.seconds: list[float] = []

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Reset the controller; `ControllerRefused` if it cannot steer this."""
        self._shape = count, scenario.control
        self.seconds = []
        try:
            self.controller.reset(count, ship, scenario)
        except ConfigError as error:
            raise ControllerRefused(self.name, self.seeds, -1, str(error)) from error
        except (Exception, SystemExit) as error:
            raise self._failed(-1, told(error)) from error

    def act(self, observations: np.ndarray) -> np.ndarray:
        """The controller's actions, which are of the right shape and finite."""
        interval, start = len(self.seconds), time.perf_counter()
        try:
            actions = self.controller.act(observations)
        except (Exception, SystemExit) as error:
            raise self._failed(interval, told(error)) from error
        self.seconds.append(time.perf_counter() - start)
        try:
            actions = shaped_actions(actions, *self._shape)
        except ConfigError as error:
            raise self._failed(interval, str(error)) from error
        if not np.isfinite(actions).all():
            row = int(np.flatnonzero(~np.isfinite(actions).all(axis=1))[0])
            what = f"action = {actions[row].tolist()}: must be finite, in [-1, 1]"
            raise ControllerFailed(self.name, self.seeds[row : row + 1], interval, what)
        self._check_time(interval)
        return actions

    def _check_time(self, interval: int) -> None:
        if self.allowed is None:
            return
        decisions = max(len(self.seconds), _FIRST) * len(self.seeds)
        if sum(self.seconds) > self.allowed * decisions:
            what = f"too slow: a decision takes more than {self.allowed:.4g} s"
            raise ControllerFailed(self.name, self.seeds, interval, what, slow=True)

    def _failed(self, interval: int, what: str) -> ControllerFailed:
        return ControllerFailed(self.name, self.seeds, interval, what)


def told(error: BaseException) -> str:
    """An exception in one line, with the last line of code it passed that is no library's."""
    frames = traceback.extract_tb(error.__traceback__)[1:]  # without the one that caught it
    own = [frame for frame in frames if not _of_library(frame)]
    text = " ".join(str(error).split())
    what = f"{type(error).__name__}: {text}" if text else type(error).__name__
    return f"{what} ({Path(own[-1].filename).name}:{own[-1].lineno})" if own else what


def _of_library(frame: traceback.FrameSummary) -> bool:
    folders = (*site.getsitepackages(), sysconfig.get_paths()["stdlib"])
    return any(Path(frame.filename).is_relative_to(folder) for folder in folders)
