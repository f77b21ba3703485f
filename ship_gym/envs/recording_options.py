"""What `RecordRerun` is asked for, refused before anything is written."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known
from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks.base import Task
from ship_gym.tasks.metrics import metrics_of
from ship_gym.writing import check_place

_KEEP = ("all", "failed", "worst")


@dataclasses.dataclass(eq=False)
class RecordingOptions:
    """Options of ``RecordRerun``, see there."""

    folder: Any  # str or path; then a Path
    episodes: Any = "all"
    keep: Any = "all"
    by: str | None = None
    most: int | None = None
    name: str = "episode"
    controller: str = ""
    policy: Any = None
    picture: bool = True

    def __post_init__(self) -> None:
        if not isinstance(self.folder, str | os.PathLike) or not os.fspath(self.folder):
            raise ConfigError(f"folder = {self.folder!r}: must be a path")
        self.folder = Path(self.folder).absolute()  # wherever the process goes
        self._check_choice()
        if not (isinstance(self.name, str) and re.fullmatch(r"[A-Za-z0-9_.-]+", self.name)):
            raise ConfigError(
                f"name = {self.name!r}: allowed are letters, digits, '_', '-' and '.'"
            )
        if not isinstance(self.controller, str):
            raise ConfigError(f"controller = {self.controller!r}: must be a name")
        if self.policy is not None and not isinstance(self.policy, str | os.PathLike):
            raise ConfigError(f"policy = {self.policy!r}: must be a file or None")
        if not isinstance(self.picture, bool):
            raise ConfigError(f"picture = {self.picture!r}: must be True or False")

    def _check_choice(self) -> None:
        """Refuse what does not say which episodes."""
        every = self.episodes
        if not (callable(every) or every == "all" or _is_count(every)):
            raise ConfigError(
                f"episodes = {every!r}: allowed is 'all', a whole number k from 1 on (every k-th) "
                "or a function of the number of an episode"
            )
        if not callable(self.keep):
            if not isinstance(self.keep, str):
                raise ConfigError(
                    f"keep = {self.keep!r}: allowed is one of {', '.join(map(repr, _KEEP))} or a "
                    "function of a Trajectory"
                )
            check_known("keep", self.keep, _KEEP)
        if self.by is not None and not self.is_worst:
            raise ConfigError(f"by = {self.by!r}: goes with keep = 'worst', not {self.keep!r}")
        if self.most is not None and not _is_count(self.most):
            raise ConfigError(f"most = {self.most!r}: must be a whole number from 1 on, or None")
        if self.is_worst and self.most is None:
            self.most = 1

    @classmethod
    def from_option(cls, record: str | os.PathLike | Mapping[str, Any]) -> RecordingOptions:
        """Of the option ``record`` of an environment: a folder, or a mapping with ``folder``."""
        if isinstance(record, str | os.PathLike):
            return cls(record)
        if not isinstance(record, Mapping):
            raise ConfigError(
                f"record = {record!r}: must be a folder, or a mapping of the options of RecordRerun"
            )
        known = [field.name for field in dataclasses.fields(cls)]
        for name in record:
            check_known("option of record", name, known)
        if "folder" not in record:
            raise ConfigError(f"record = {dict(record)!r}: missing key 'folder'")
        return cls(**record)

    def metric(self, task: Task) -> tuple[str, float] | None:
        """Metric of a task by which the worst episode is found, and 1, or -1 if more is better."""
        if not self.is_worst:
            return None
        known = metrics_of(task.name)
        name = check_known(f"metric of {task.name}", self.by or task.headline, known)
        return name, -1.0 if known[name].better == "higher" else 1.0

    def make_folder(self) -> None:
        """Make the folder.

        Raises
        ------
        ConfigError
            No file could be made in it.
        """
        check_place(self.folder, "folder", folder=True)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ConfigError(f"folder {self.folder}: cannot be made: {error.strerror}") from None

    @property
    def is_worst(self) -> bool:
        """Whether the worst episodes so far are kept."""
        return isinstance(self.keep, str) and self.keep == "worst"

    @property
    def streams(self) -> bool:
        """Whether it is known from the number of an episode that it is kept."""
        return isinstance(self.keep, str) and self.keep == "all"

    def wants(self, number: int) -> bool:
        """Whether the episode of this number is followed."""
        if callable(self.episodes):
            return bool(self.episodes(number))
        return self.episodes == "all" or number % self.episodes == 0

    def takes(self, trajectory: Trajectory) -> bool:
        """Whether an episode is kept, the others left aside."""
        if callable(self.keep):
            return bool(self.keep(trajectory))
        return self.keep != "failed" or bool(trajectory.meta["failed"])


def _is_count(value: Any) -> bool:
    """Whether a value is a whole number from 1 on."""
    return isinstance(value, int) and not isinstance(value, bool) and value >= 1
