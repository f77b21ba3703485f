"""Recordings of a training run: the worst episode of every so many validations, the last few."""

from __future__ import annotations

import warnings
from pathlib import Path

from ship_gym.recording.trajectory import Trajectory
from ship_gym.writing import sweep

FOLDER = "episodes"  # of the run's folder
KEPT = 5  # recordings; older ones make way


class Recordings:
    """Writes the worst validation episodes of a run into its folder.

    A run is worth more than its recordings: where rerun-sdk is not installed or the disk refuses,
    training says so once and goes on without.

    Parameters
    ----------
    folder : path
        Of the run.
    every : int
        Record of every so many validations; 0: none.
    """

    def __init__(self, folder: Path, every: int):
        self.folder, self._every = folder / FOLDER, every

    def due(self, number: int) -> bool:
        """Whether the validation of this number, counted from 1, is recorded."""
        return self._every > 0 and number % self._every == 0

    def keep(self, number: int, worst: Trajectory | None) -> None:
        """Write the worst episode of a validation, and let the oldest recordings go.

        Parameters
        ----------
        number : int
            Of the validation; its file is the same however often the run was resumed.
        worst : Trajectory or None
            None: no episode could be judged.
        """
        if worst is None:
            return
        # its weights are not kept: no command sails it again
        meta = worst.meta | {"validation": number, "command": ""}
        try:
            Trajectory(worst.columns, meta).to_rrd(self.folder / f"validation_{number:04d}.rrd")
        except (ImportError, OSError) as error:
            self._every = 0
            warnings.warn(f"training goes on without recordings: {error}", stacklevel=2)
            return
        for old in self._files()[:-KEPT]:
            old.unlink(missing_ok=True)

    def keep_first(self, count: int) -> None:
        """Remove recordings of later validations than of so many, which a kill has undone."""
        sweep(self.folder)
        for file in self._files():
            if _number(file) > count:
                file.unlink(missing_ok=True)

    def _files(self) -> list[Path]:
        """The recordings, the oldest first."""
        found = self.folder.glob("validation_*.rrd")
        return sorted((file for file in found if _number(file)), key=_number)


def _number(file: Path) -> int:
    """Number of the validation that a recording is of; 0: the file is none of ours."""
    text = file.stem.removeprefix("validation_")
    return int(text) if text.isdecimal() else 0
