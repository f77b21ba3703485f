"""A voyage on its way into a recording, as ``ship-gym record`` writes them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.envs.episode_log import EpisodeLog
from ship_gym.envs.episode_record import Setting, conditions_of
from ship_gym.envs.streamed import Streamed, about_run
from ship_gym.provenance import provenance
from ship_gym_agents.serve.vessel import SteeredShip

CONTROLLER = "nmea"  # who steers, in the recording
_ENDED, _CUT_SHORT = 0, -1  # outcomes


class VoyageRecord:
    """Follows a ship into a file ``*.rrd``; a ``Watcher`` of her batch.

    Parameters
    ----------
    path : Path
    vessel : SteeredShip
    given : mapping
        Where she sails, as ``EpisodeBatch.given``: chart and route.
    """

    def __init__(self, path: Path, vessel: SteeredShip, given: Mapping[str, Any]):
        batch = vessel.batch
        self._log = EpisodeLog(batch, 1)
        self._log.begin(np.array([0]))
        self._log.before()
        self._vessel = vessel
        conditions = conditions_of(batch, 0, Setting(vessel.scenario, vessel.ship, given))
        told = about_run(CONTROLLER, None, vessel.seed, provenance())
        self._stream = Streamed(path, self._log, 0, conditions, told)
        batch.watch(self)

    @property
    def path(self) -> Path:
        """The file."""
        return self._stream.path

    def before(self) -> None:
        """See ``Watcher``."""
        self._log.before()

    def after(self) -> None:
        """See ``Watcher``."""
        self._log.after()
        if self._stream.is_due():
            self._stream.follow()

    def leave(self, which: np.ndarray) -> None:
        """See ``Watcher``."""

    def begin(self, which: np.ndarray, given: Mapping[str, np.ndarray]) -> None:
        """See ``Watcher``."""

    def finish(self) -> bool:
        """Write the file; False where not one interval was sailed, and nothing is written."""
        self._vessel.batch.unwatch(self)
        sailed = int(self._log.lengths[0])
        if sailed == 0:
            self._stream.leave()
            return False
        self._log.end(np.array([0]))
        self._stream.finish(_ENDED if sailed >= self._vessel.steps else _CUT_SHORT)
        return True

    def give_up(self) -> None:
        """Leave the rows so far in their journal, after an error."""
        self._vessel.batch.unwatch(self)
        self._stream.leave()
