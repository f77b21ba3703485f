"""Which episodes of a batch that sails are recorded, and their files: the engine of `RecordRerun`.

Episodes are counted from 0 in the order in which they sail their first interval, those of a vector
environment that begin together by their index. What is decided by the number is streamed into its
file while it sails (``envs.streamed``): a process that is killed leaves ``*.rrd.partial`` with all
rows but those of the last chunk. What is decided by the episode itself is kept in memory to its
end, half a kilobyte for each interval, and lost with the process.
"""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import math
import weakref
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.envs.episode_log import EpisodeLog
from ship_gym.envs.episode_record import Conditions, Setting, conditions_of, policy_meta
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.recording_options import RecordingOptions
from ship_gym.envs.streamed import Streamed, about_run
from ship_gym.provenance import provenance
from ship_gym.recording.journal import BeingWritten, journal_path
from ship_gym.recording.trajectory import Trajectory, import_rerun_export

Badness = tuple[bool, float]  # whether it failed, and its value, the larger the worse
_LARGEST_SEED = 2**63  # those that numpy draws itself are longer than a file name should be


@dataclasses.dataclass(eq=False)
class _Run:
    """An episode that is followed."""

    name: str  # of its file, without the ending
    place: int  # in the log
    conditions: Conditions
    about: dict[str, Any]
    stream: Streamed | None = None

    def follow(self) -> None:
        """Write what has been sailed since."""
        if self.stream is not None:
            self.stream.follow()


class EpisodeRecording:
    """Records episodes of a batch; a ``Watcher`` of it.

    Parameters
    ----------
    batch : EpisodeBatch
    options : RecordingOptions
    origin : callable
        ``origin(i)``: seed of the stream of environment i and how many episodes it has begun before
        this one since it was seeded.
    """

    def __init__(
        self,
        batch: EpisodeBatch,
        options: RecordingOptions,
        origin: Callable[[int], tuple[int | None, int]],
    ):
        self._batch, self._options, self._origin = batch, options, origin
        self._by = options.metric(batch.task)
        self._policy = policy_meta(options.policy)
        import_rerun_export()  # a missing one is said now
        options.make_folder()
        self._made = provenance()
        self._settings: dict[int, Setting] = {}
        self._log: EpisodeLog | None = None
        self._fresh: dict[int, dict[str, Any]] = {}  # begun, not yet sailed: options of the reset
        self._runs: dict[int, _Run] = {}  # by environment
        self._count = 0
        self._kept: list[tuple[Badness, Path]] = []  # the least bad first
        batch.watch(self)
        self._at_exit = weakref.finalize(self, _leave_all, self._runs)  # also after Ctrl-C

    @property
    def files(self) -> list[Path]:
        """Files of the episodes that have ended and are kept, in their order."""
        return [file for _, file in self._kept]

    def leave(self, which: np.ndarray) -> None:
        """See ``Watcher``: an episode that has not ended is cut short here."""
        left = [i for i in which.tolist() if i in self._runs]
        for i in left:
            if self._rows.lengths[self._runs[i].place] == 0:
                self._forget(i)
        if left := [i for i in left if i in self._runs]:
            self._finish(left, cut_short=True)

    def begin(self, which: np.ndarray, given: Mapping[str, np.ndarray]) -> None:
        """See ``Watcher``."""
        for row, i in enumerate(which.tolist()):
            self._fresh[i] = {name: values[row].tolist() for name, values in given.items()}

    def before(self) -> None:
        """See ``Watcher``."""
        if self._log is not None:
            self._log.before()
        if self._fresh:
            fresh, self._fresh = self._fresh, {}
            self._open(fresh)

    def after(self) -> None:
        """See ``Watcher``."""
        if not self._runs:
            return
        self._rows.after()
        terminated, truncated = self._batch.terminated, self._batch.truncated
        ended = [i for i in self._runs if terminated[i] or truncated[i]]
        if ended:
            self._finish(ended)
        due = [i for i, run in self._runs.items() if run.stream and run.stream.is_due()]
        if due:
            self._each(due, lambda i: self._runs[i].follow())

    def close(self) -> None:
        """Record no more; an episode that has not ended keeps its journal, if it is streamed."""
        self._batch.unwatch(self)
        self._fresh = {}
        self._at_exit()

    def _open(self, fresh: Mapping[int, dict[str, Any]]) -> None:
        """Follow those of the episodes that sail their first interval which are wanted."""
        numbers = dict(zip(sorted(fresh), itertools.count(self._count)))
        self._count += len(fresh)  # also where the function of the numbers fails
        wanted = {i: number for i, number in numbers.items() if self._options.wants(number)}
        if not wanted:
            return
        if self._log is None:
            self._log = EpisodeLog(self._batch, len(wanted))
        places = self._rows.begin(np.array(list(wanted)))
        self._rows.before()
        for (i, number), place in zip(wanted.items(), places.tolist(), strict=True):
            name, about = self._name(i, number), self._about(i, number, fresh[i])
            conditions = conditions_of(self._batch, i, self._setting(i))
            self._runs[i] = _Run(name, place, conditions, about)
        if self._options.streams:
            self._each(wanted, self._stream)

    @property
    def _rows(self) -> EpisodeLog:
        """The log, which is there as soon as an episode is followed."""
        assert self._log is not None
        return self._log

    def _stream(self, i: int) -> Streamed:
        """Open a file for an episode, one that is not there and that no other run writes."""
        run = self._runs[i]
        parts = (self._rows, run.place, run.conditions, run.about, self._options.picture)
        for again in itertools.count(1):
            name = f"{run.name}-again-{again}.rrd" if again > 1 else f"{run.name}.rrd"
            file = self._options.folder / name
            if not (file.exists() or journal_path(file).exists()):
                with contextlib.suppress(BeingWritten):  # since then, by another process
                    run.stream = Streamed(file, *parts)
                    return run.stream
        raise AssertionError("there is always another name")

    def _setting(self, i: int) -> Setting:
        ship = self._batch.ships[i]
        if id(ship) not in self._settings:
            self._settings[id(ship)] = Setting(self._batch.scenario, ship, self._batch.given)
        return self._settings[id(ship)]

    def _about(self, i: int, number: int, given: dict[str, Any]) -> dict[str, Any]:
        """Who steers, which episode of which stream; its seed where a reset gives it again."""
        stream, resets = self._origin(i)
        seed = stream if resets == 0 else None
        about = about_run(self._options.controller or "agent", self._policy, seed, self._made)
        about |= {"episode": number}
        if self._batch.n > 1:
            about["environment"] = i
        if resets:
            about["stream"] = {"seed": stream, "resets": resets}
        return about | ({"reset_options": given} if given else {})

    def _name(self, i: int, number: int) -> str:
        """Name of a file: number, environment, seed, resets of its stream."""
        seed, resets = self._origin(i)
        parts = [self._options.name, f"{number:06d}"]
        parts += [f"env-{i:04d}"] if self._batch.n > 1 else []
        if seed is not None and seed < _LARGEST_SEED:
            parts += [f"seed-{seed}", *([f"reset-{resets}"] if resets else [])]
        return "-".join(parts)

    def _finish(self, ended: list[int], cut_short: bool = False) -> None:
        """Write what is kept of the episodes that are over, from the batch as it is now."""
        self._rows.end(np.array([self._runs[i].place for i in ended]))

        def write(i: int) -> None:
            self._written(self._runs[i], -1 if cut_short else int(self._batch.outcomes[i]), i)
            self._rows.drop(np.array([self._runs.pop(i).place]))

        self._each(ended, write)

    def _written(self, run: _Run, outcome: int, i: int) -> None:
        """Write an episode whose last row the log has, if it is kept."""
        if run.stream is not None:
            run.stream.finish(outcome)
            return self._keep((False, 0.0), run.stream.path)
        rows = self._rows.part(run.place, 0, int(self._rows.lengths[run.place]) + 1)
        trajectory = run.conditions.trajectory(rows, outcome, run.about)
        badness = self._badness(trajectory)
        if badness is not None and self._options.takes(trajectory):
            stream = self._stream(i)
            stream.finish(outcome, trajectory)
            self._keep(badness, stream.path)
        return None

    def _badness(self, trajectory: Trajectory) -> Badness | None:
        """How bad an episode was, as ``evaluation.choice`` ranks it; None: not among the worst."""
        if self._by is None:
            return False, 0.0
        name, sign = self._by
        value, failed = trajectory.meta["metrics"].get(name), bool(trajectory.meta["failed"])
        if value is None and not failed:
            return None
        found = failed, math.inf if value is None else sign * value
        return None if self._is_full and found <= self._kept[0][0] else found

    @property
    def _is_full(self) -> bool:
        return self._options.most is not None and len(self._kept) >= self._options.most

    def _keep(self, badness: Badness, file: Path) -> None:
        """Count a file as kept; of too many the oldest, or the least bad, is removed."""
        dropped = self._kept.pop(0)[1] if self._is_full else None
        self._kept.append((badness, file))
        self._kept.sort(key=lambda one: one[0])
        if dropped is not None:
            dropped.unlink(missing_ok=True)

    def _each(self, which: Iterable[int], do: Callable[[int], object]) -> None:
        """Do something for some episodes; one that cannot be written is followed no more."""
        failed = None
        for i in list(which):
            try:
                do(i)
            except BaseException as error:
                self._forget(i)
                failed = failed or error
        if failed is not None:
            raise failed

    def _forget(self, i: int) -> None:
        """Follow an episode no more; its journal stays."""
        run = self._runs.pop(i)
        _leave(run)
        self._rows.drop(np.array([run.place]))

    def __reduce__(self):
        """A copy of an environment records nothing: two cannot write the same files."""
        return _nothing, ()


def _nothing() -> None:
    return None


def _leave(run: _Run) -> None:
    if run.stream is not None:
        with contextlib.suppress(OSError):
            run.stream.leave()


def _leave_all(runs: dict[int, _Run]) -> None:
    """Leave the journals of episodes that have not ended."""
    while runs:
        _leave(runs.popitem()[1])
