"""Folder of a training run: a lock, and generations of all that the run has.

A generation, ``checkpoint/NNNNNN``, is a folder with the learner's state, the state of the run, its
card and the best policy so far. It gets its name when it is complete: this one renaming is the
moment in which all of them change together. Card, policy and curve beside it are copies for people
and other programs; they are made after it, and once more at the next start if a kill came between.
"""

from __future__ import annotations

import contextlib
import json
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.locks import check_own, locked
from ship_gym.writing import atomic_path, sweep
from ship_gym_agents.policies.policy_file import POLICY_FILE, load_policy
from ship_gym_agents.sb3.run_card import CARD_FILE, read_run_card, read_run_state
from ship_gym_agents.training.curves import CURVE_FILE, CURVE_PICTURE, write_curve
from ship_gym_agents.training.recordings import FOLDER as RECORDINGS

_LOCK, _CHECKPOINTS, _STATE, _UNFINISHED = "lock", "checkpoint", "run.json", "unfinished"
_WRITTEN = [CARD_FILE, POLICY_FILE, CURVE_FILE, CURVE_PICTURE, _CHECKPOINTS]
_WRITTEN += ["tensorboard", RECORDINGS, "summary.json"]
_NUMBER = "checkpoint"  # in a card: the generation that it is of


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

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder, mended if a kill left it half; refused while another process does.

        Killing that one frees it.
        """
        check_own(self.path, _WRITTEN)
        with locked(self.path / _LOCK, "trains into this folder"):
            self._mend()
            yield

    def _mend(self) -> None:
        """Remove what killed writers left, and make the copies of the last generation anew."""
        shutil.rmtree(self._checkpoints / _UNFINISHED, ignore_errors=True)
        for old in self._complete()[:-1]:
            shutil.rmtree(old, ignore_errors=True)
        sweep(self.path)
        self.publish()

    def card(self) -> dict[str, Any] | None:
        """The card of the run; None if there is none.

        Raises
        ------
        ConfigError
            A card that cannot be read.
        """
        return self._read(self.path / CARD_FILE)

    @staticmethod
    def _read(file: Path) -> dict[str, Any] | None:
        if not file.is_file():
            return None
        return read_run_card(file)

    def write_card(self, card: Mapping[str, Any]) -> dict[str, Any]:
        """Write the card between two generations; it names the last one, and is returned."""
        made = {**card, _NUMBER: self._number}
        with atomic_path(self.path / CARD_FILE) as temporary:
            temporary.write_text(_text(made), encoding="utf-8")
        return made

    @contextlib.contextmanager
    def new_checkpoint(
        self, state: Mapping[str, Any], card: Mapping[str, Any] | None = None
    ) -> Iterator[Path]:
        """Give a folder to write a learner's state and the policy into.

        It counts once the block has ended, and its copies are made then.

        Parameters
        ----------
        state : mapping
            Plain values of the run itself, which `state` gives back.
        card : mapping, optional
        """
        number, unfinished = self._number + 1, self._checkpoints / _UNFINISHED
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir(parents=True)
        yield unfinished
        (unfinished / _STATE).write_text(json.dumps(state) + "\n", encoding="utf-8")
        if card is not None:
            text = _text({**card, _NUMBER: number})
            (unfinished / CARD_FILE).write_text(text, encoding="utf-8")
        unfinished.rename(self._checkpoints / f"{number:06d}")
        for old in self._complete()[:-1]:
            shutil.rmtree(old, ignore_errors=True)
        self.publish()

    def publish(self) -> None:
        """Copy policy and card of the last generation beside it, and draw up the curve.

        The card last: where it says that the run is complete, all is there. What is of this
        generation already stays as it is, as the card of a run that goes on.
        """
        last = self.checkpoint()
        card = None if last is None else self._read(last / CARD_FILE)
        if last is None or card is None:  # none yet, or of a version that had none in it
            return
        policy = last / POLICY_FILE
        copied = (self.card() or {}).get(_NUMBER) == self._number
        differs = policy.is_file() and not _same(policy, self.policy)
        if differs and not (copied and _is_damaged(policy)):
            with atomic_path(self.policy) as temporary:
                shutil.copyfile(policy, temporary)
        if not copied:
            write_curve(card.get("validations", []), self.path / CURVE_FILE)
            self.write_card(card)

    @property
    def policy(self) -> Path:
        """The file of the best policy."""
        return self.path / POLICY_FILE

    def checkpoint(self) -> Path | None:
        """Folder of the last complete generation; None if there is none."""
        complete = self._complete()
        return complete[-1] if complete else None

    def state(self) -> dict[str, Any] | None:
        """What the last complete generation says of the run; None if there is none."""
        last = self.checkpoint()
        return None if last is None else read_run_state(last / _STATE)

    @property
    def _number(self) -> int:
        """Number of the last complete generation; 0 if there is none."""
        return max((int(one.name) for one in self._complete()), default=0)

    def _complete(self) -> list[Path]:
        """Complete generations, the oldest first; a copy by another name is none."""
        found = (path for path in self._checkpoints.glob("[0-9]*") if path.name.isdecimal())
        return sorted(path for path in found if path.is_dir() and not path.is_symlink())

    def free(self) -> None:
        """Take back the card of a run that was refused before it had learned anything."""
        if self.checkpoint() is None:
            (self.path / CARD_FILE).unlink(missing_ok=True)

    def clear(self) -> None:
        """Remove what a run left that was killed before its first generation."""
        for file in self.path.glob("policy.*"):
            file.unlink()
        for name in (CURVE_FILE, CURVE_PICTURE):
            (self.path / name).unlink(missing_ok=True)
        for folder in (_CHECKPOINTS, "tensorboard"):
            shutil.rmtree(self.path / folder, ignore_errors=True)


def _text(card: Mapping[str, Any]) -> str:
    return json.dumps(card, indent=1) + "\n"


def _is_damaged(policy: Path) -> bool:
    """Whether a policy cannot be read; a copy made of it earlier is then the better one."""
    try:
        load_policy(policy)
    except ConfigError:
        return True
    return False


def _same(one: Path, other: Path) -> bool:
    """Whether two files hold the same bytes."""
    return other.is_file() and one.read_bytes() == other.read_bytes()
