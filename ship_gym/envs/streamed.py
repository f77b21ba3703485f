"""Rows of an episode on their way into its file while it sails."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.envs.episode_log import EpisodeLog
from ship_gym.envs.episode_record import Conditions
from ship_gym.recording.recorder import Recorder
from ship_gym.recording.trajectory import Trajectory

_ROWS, _SECONDS = 16, 10.0  # a chunk: rows of so much full-scale time, but at least so many


def about_run(
    controller: str, policy: Mapping[str, str] | None, seed: int | None, made: Mapping[str, Any]
) -> dict[str, Any]:
    """What a recording says of who steered, of the seed and of the program that made it."""
    return {"controller": controller, "policy": policy, "seed": seed, **made}


class Streamed:
    """Rows of one place of a log, handed to a ``Recorder`` a chunk at a time.

    Parameters
    ----------
    path : path-like
        File ``*.rrd``.
    log : EpisodeLog
        Its row of now is kept (`EpisodeLog.before`).
    place : int
    conditions : Conditions
    about : mapping
        See `about_run`.
    picture : bool
        As in ``Recorder``.

    Raises
    ------
    ConfigError, OSError
        As ``Recorder``.
    """

    def __init__(
        self,
        path: str | os.PathLike,
        log: EpisodeLog,
        place: int,
        conditions: Conditions,
        about: Mapping[str, Any],
        picture: bool = True,
    ):
        self._log, self._place, self._conditions, self._about = log, place, conditions, about
        self._sent = self._waiting = 0
        interval = conditions.setting.scenario.control_interval
        self._chunk = max(_ROWS, math.ceil(_SECONDS / interval))
        names = list(conditions.columns(log.part(place, 0, 1)))
        meta = conditions.meta() | dict(about) | {"complete": False}
        self._recorder = Recorder(path, meta, names, chunk=self._chunk, picture=picture)

    @property
    def path(self) -> Path:
        """The file."""
        return self._recorder.path

    def is_due(self) -> bool:
        """Count an interval that was sailed; whether there are rows enough for `follow`."""
        self._waiting += 1
        return self._waiting >= self._chunk

    def follow(self) -> None:
        """Hand over the rows that are new."""
        self._hand_over(int(self._log.lengths[self._place]))

    def _hand_over(self, stop: int) -> None:
        """Hand over the rows up to `stop`; those that cannot be written are not tried again."""
        first, self._sent, self._waiting = self._sent, stop, 0
        if stop > first:
            columns = self._conditions.columns(self._log.part(self._place, first, stop))
            self._recorder.add(np.array(list(columns.values())).T)

    def finish(self, outcome: int, trajectory: Trajectory | None = None) -> None:
        """Write the file of the episode, whose last row the log has (`EpisodeLog.end`).

        Parameters
        ----------
        outcome : int
            See ``Conditions.trajectory``.
        trajectory : Trajectory, optional
            If it is there already.
        """
        stop = int(self._log.lengths[self._place]) + 1
        self._hand_over(stop)
        if trajectory is None:
            rows = self._log.part(self._place, 0, stop)
            trajectory = self._conditions.trajectory(rows, outcome, self._about)
        self._recorder.finish(trajectory)

    def leave(self) -> None:
        """The episode breaks off: its journal stays, or, where nothing was sailed, nothing."""
        if self._log.lengths[self._place] == 0:
            self._recorder.discard()
        else:
            self.follow()
            self._recorder.keep()
