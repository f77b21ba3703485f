"""Episodes as files: sailed into them, or written from a rollout, and read back to be sure."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import rollout
from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks import TASKS

RERUN, CSV = ".rrd", ".csv"
FORMATS = (RERUN, CSV)
TOGETHER = 64  # recordings that are written at a time: each holds a file open


class Recording(NamedTuple):
    """An episode that has its file.

    Attributes
    ----------
    file : pathlib.Path
    controller : str
    seed : int
    outcome : str
    failed : bool
    metrics : dict
        Computed from the file where it can be read back, which is checked to be those of the
        episode, bit for bit; empty if its task has none.
    """

    file: Path
    controller: str
    seed: int
    outcome: str
    failed: bool
    metrics: dict[str, float | None]

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {**self._asdict(), "file": str(self.file)}


def file_name(controller: str, seed: int, suffix: str = RERUN) -> str:
    """Name of a recording: who sailed which episode."""
    return f"{safe(controller)}-{seed}{suffix}"


def safe(text: str) -> str:
    """The text as a part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", text).strip("-") or "unnamed"


def check_told_apart(controllers: Sequence[str]) -> None:
    """Refuse controllers whose recordings would have one name.

    Raises
    ------
    ConfigError
        Names both.
    """
    seen: dict[str, str] = {}
    for name in controllers:
        if (other := seen.setdefault(safe(name), name)) != name:
            raise ConfigError(
                f"controllers {other!r} and {name!r}: their recordings would be one file, "
                f"{safe(name)}-SEED; give one another name"
            )


def sail(
    controller: Controller, seeds: Sequence[int], files: Sequence[Path], **how: Any
) -> list[Recording]:
    """Sail one episode per seed, each into its file, the rows of .rrd files while it sails.

    Parameters
    ----------
    controller : Controller
    seeds : sequence of int
        Shape (n,).
    files : sequence of path
        Of each episode, shape (n,), all of one format.
    **how
        As in ``rollout``.
    """
    found = []
    for k in range(0, len(seeds), TOGETHER):
        part = slice(k, k + TOGETHER)
        found += _sail(controller, seeds[part], files[part], how)
    return found


def _sail(controller: Controller, seeds: Sequence[int], files: Sequence[Path], how: dict) -> list:
    streamed = {i: file for i, file in enumerate(files) if file.suffix.lower() == RERUN}
    sailed = rollout(controller, seeds=seeds, record=streamed, **how)
    return [
        (checked if i in streamed else keep)(sailed.trajectory(i), file)
        for i, file in enumerate(files)
    ]


def keep(trajectory: Trajectory, file: str | os.PathLike) -> Recording:
    """Write an episode into a file, .rrd or .csv, and read it back.

    Raises
    ------
    OSError
        The file cannot be written, or its metrics are not those of the episode.
    """
    file = Path(file)
    (trajectory.to_csv if file.suffix.lower() == CSV else trajectory.to_rrd)(file)
    return checked(trajectory, file)


def checked(trajectory: Trajectory, file: Path) -> Recording:
    """The recording of an episode, read back from its file.

    Raises
    ------
    OSError
        The metrics of the file are not those of the episode.
    """
    live = _metrics(trajectory)
    if file.suffix.lower() == RERUN and _metrics(Trajectory.from_rrd(file)) != live:
        raise OSError(f"{file}: the metrics of the file are not those of the episode")
    meta = trajectory.meta
    told = {key: meta[key] for key in ("controller", "seed", "outcome", "failed")}
    return Recording(file, **told, metrics=live)


def _metrics(trajectory: Trajectory) -> dict[str, float | None]:
    measured = TASKS[trajectory.meta["task"]].measure is not None
    return metrics(trajectory) if measured else {}
