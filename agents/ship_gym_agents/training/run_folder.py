"""Folder of a training run: a lock, its card from the first second, checkpoints, the best policy.

Every file appears whole or not at all, and a checkpoint is a folder that gets its name when it is
complete, so that a run can be killed at any moment and continued.
"""

from __future__ import annotations

import contextlib
import json
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.provenance import atomic_path, locked
from ship_gym_agents.sb3.config import CARD_FILE

CURVE_FILE, CURVE_PICTURE = "curve.csv", "curve.png"
_LOCK, _CHECKPOINTS, _STATE, _UNFINISHED = "lock", "checkpoint", "run.json", "unfinished"


class TrainingFolder:
    """Where a run keeps what it has.

    Parameters
    ----------
    path : path-like
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self._checkpoints = self.path / _CHECKPOINTS

    @property
    def name(self) -> str:
        """Name of the folder; one of several seeds is named with its run."""
        path = self.path.absolute()
        return f"{path.parent.name}-{path.name}" if path.name.startswith("seed_") else path.name

    def locked(self) -> contextlib.AbstractContextManager[None]:
        """Hold the folder; refused while another process does. Killing that one frees it."""
        return locked(self.path / _LOCK, "trains into this folder")

    def card(self) -> dict[str, Any] | None:
        """The card of the run; None if there is none.

        Raises
        ------
        ConfigError
            A card that cannot be read.
        """
        file = self.path / CARD_FILE
        if not file.is_file():
            return None
        try:
            return json.loads(file.read_text(encoding="utf-8"))
        except ValueError as error:
            raise ConfigError(f"{file}: not valid JSON: {error}") from None

    def write_card(self, card: Mapping[str, Any]) -> None:
        """Write the card."""
        with atomic_path(self.path / CARD_FILE) as temporary:
            temporary.write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")

    @contextlib.contextmanager
    def new_checkpoint(self, state: Mapping[str, Any]) -> Iterator[Path]:
        """Give a folder to write a learner's state into; it counts once the block has ended.

        Parameters
        ----------
        state : mapping
            Plain values of the run itself, which `state` gives back.
        """
        number = 1 + max((int(old.name) for old in self._complete()), default=0)
        unfinished = self._checkpoints / _UNFINISHED
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir(parents=True)
        yield unfinished
        (unfinished / _STATE).write_text(json.dumps(state) + "\n", encoding="utf-8")
        unfinished.rename(self._checkpoints / f"{number:06d}")
        for old in self._complete()[:-1]:
            shutil.rmtree(old, ignore_errors=True)

    def checkpoint(self) -> Path | None:
        """Folder of the last complete checkpoint; None if there is none."""
        return (self._complete() or [None])[-1]

    def state(self) -> dict[str, Any] | None:
        """What the last complete checkpoint says of the run; None if there is none."""
        last = self.checkpoint()
        if last is None:
            return None
        return json.loads((last / _STATE).read_text(encoding="utf-8"))

    def _complete(self) -> list[Path]:
        """Complete checkpoints, the oldest first."""
        return sorted(path for path in self._checkpoints.glob("[0-9]*") if path.is_dir())

    def free(self) -> None:
        """Take back the card of a run that was refused before it had learned anything."""
        if self.checkpoint() is None:
            (self.path / CARD_FILE).unlink(missing_ok=True)

    def clear(self) -> None:
        """Remove what a run left that was killed before its first checkpoint."""
        for file in self.path.glob("policy.*"):
            file.unlink()
        for file in (CURVE_FILE, CURVE_PICTURE):
            (self.path / file).unlink(missing_ok=True)
        for folder in (_CHECKPOINTS, "tensorboard"):
            shutil.rmtree(self.path / folder, ignore_errors=True)
