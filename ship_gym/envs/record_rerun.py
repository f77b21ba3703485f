"""Wrapper that records episodes while an environment is used; around vectors: the module beside."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import gymnasium as gym
from gymnasium.utils import RecordConstructorArgs
from gymnasium.vector import VectorEnv

from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv
from ship_gym.envs.recording import EpisodeRecording
from ship_gym.envs.recording_options import RecordingOptions


class RecordRerun(gym.Wrapper, RecordConstructorArgs):
    """Records episodes of a ``ShipEnv`` as files ``NAME-NUMBER-seed-SEED.rrd``.

    The same as the option ``record`` of the environment: ``gym.make(id, record=folder)`` or
    ``record={"folder": ..., "episodes": 10}``. It may stand under or over any other wrapper: what
    it writes is what the ship environment itself sees and gets.

    Episodes are numbered from 0 as they sail their first interval. Those that `keep` "all" writes
    are streamed: a killed process leaves ``*.rrd.partial`` with all rows but those of the last ten
    seconds. Otherwise the rows are in memory until the episode ends. Nothing that lies in the
    folder is overwritten. An episode that is reset before its end is written as "cut short"; one
    that has not ended when the environment is closed keeps its ``.partial``.

    What it costs, on one core of a 2.3 GHz server: an interval of 7.0 us takes 12.7 us with its
    rows in memory, 22 us streamed, 7.5 us while another episode is waited for. The end of an
    episode of 600 intervals takes 11 ms to write without `picture`, 60 ms with it. An interval of
    64 ships in one batch, 109 us, takes 132 us with one of them streamed, 139 us with all in
    memory, 630 us with all streamed; rows in memory are half a kilobyte.

    Parameters
    ----------
    env : gymnasium.Env
        Around a ``ShipEnv``.
    folder : path-like
        Made if missing.
    episodes : "all", int or callable
        Which are followed: all, every k-th (0, k, 2k, ...), or those for whose number a function
        gives True.
    keep : "all", "failed", "worst" or callable
        Which of those have a file in the end: all, those that ended at a limit or diverged, the
        worst so far, or those for whose ``Trajectory`` a function gives True.
    by : str, optional
        Metric of `keep` "worst"; the task's headline if None. Episodes that failed are worse than
        all others; one without a value that did not fail is no candidate. Of equal ones the earlier
        stays.
    most : int, optional
        How many files stay, of "worst" the worst, otherwise the latest; None: all, of "worst" 1.
        The others are removed.
    name : str
        First part of the file names.
    controller : str
        Who steers, for the recording; "agent" if empty.
    policy : path-like, optional
        File of the policy; its SHA-256 stands in the recording.
    picture : bool
        Whether the files hold what the viewer shows, or only the record.

    Raises
    ------
    ConfigError
        An option that is not allowed, or a folder into which nothing can be written.
    OSError
        From ``step`` or ``reset``: a file that could not be written, such as on a full disk. That
        episode is recorded no more; its step may have been sailed: go on with a ``reset``. The same
        holds for what a function of `episodes` or `keep` raises.
    """

    def __init__(
        self,
        env: gym.Env,
        folder: str | os.PathLike,
        *,
        episodes: Any = "all",
        keep: Any = "all",
        by: str | None = None,
        most: int | None = None,
        name: str = "episode",
        controller: str = "",
        policy: str | os.PathLike | None = None,
        picture: bool = True,
    ):
        given = {"episodes": episodes, "keep": keep, "by": by, "most": most, "name": name}
        given |= {"controller": controller, "policy": policy, "picture": picture}
        made = RecordingOptions(folder, **given)
        paths = {"folder": folder, "policy": policy}  # text: a spec is stored as JSON
        paths = {name: None if path is None else os.fspath(path) for name, path in paths.items()}
        RecordConstructorArgs.__init__(self, **{**given, **paths})
        gym.Wrapper.__init__(self, env)
        self._recording = recording_of_base(env.unwrapped, ShipEnv, made)

    @property
    def files(self) -> list[Path]:
        """Files of the episodes that are over, of "worst" the worst one last."""
        return [] if self._recording is None else self._recording.files

    def close(self) -> None:
        """Close the recording, then the environment."""
        if self._recording is not None:
            self._recording.close()
        super().close()


def recording_of_base(base: Any, kind: Any, options: RecordingOptions) -> EpisodeRecording:
    """Recording of a ship environment; ConfigError if it is none."""
    if not isinstance(base, kind):
        others = kind is not ShipEnv and isinstance(base, VectorEnv)
        way = "; wrap each of its environments with RecordRerun" if others else ""
        raise ConfigError(
            f"env is around a {type(base).__name__}: must be around a {kind.__name__}{way}"
        )
    return EpisodeRecording(base.episodes, options, base.origin)
