"""What is done to a recording by check_recordings.py; in processes of their own, which may die."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.recording import DamagedRecording, Recorder, Trajectory

LONGEST = 120.0  # after which a process counts as hanging [s]
_HIDDEN = ", and a hidden temporary file"
SMALL = 200_000  # bytes of the full disk
_PACE = 0.5  # time in which the recording that is killed gets its rows [s]
_CHUNK = 16  # rows
_SPAWN = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang


class Apart:
    """Calls functions in one process apart, which is begun anew when it has died."""

    def __init__(self):
        self._pool: ProcessPoolExecutor | None = None

    def call(self, function: Callable[..., str], *arguments: Any) -> str:
        """What `function` returns, ``"process died"`` or ``"hangs"``."""
        if self._pool is None:
            self._pool = ProcessPoolExecutor(1, mp_context=_SPAWN)
        try:
            return self._pool.submit(function, *arguments).result(timeout=LONGEST)
        except BrokenProcessPool:
            self._pool = None
            return "process died"
        except TimeoutError:
            for process in list(self._pool._processes.values()):
                process.kill()
            self._pool = None
            return "hangs"

    def close(self) -> None:
        """End the process."""
        if self._pool is not None:
            self._pool.shutdown()


def flipped(path: str, bit: int, original: Trajectory) -> str:
    """What comes of one changed bit."""
    return _read(path, lambda data: _with_flip(data, bit), original)


def cut(path: str, length: int, original: Trajectory) -> str:
    """What comes of a file that ends early."""
    return _read(path, lambda data: data[:length], original)


def _with_flip(data: bytes, bit: int) -> bytes:
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def _read(path: str, change: Callable[[bytes], bytes], original: Trajectory) -> str:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / Path(path).name
        file.write_bytes(change(Path(path).read_bytes()))
        try:
            read = Trajectory.from_file(file)
        except DamagedRecording as error:
            clear = file.name in str(error) and "\n" not in str(error)
            return "one clear error" if clear else f"unclear error: {error}"
        except Exception as error:  # whatever it is, it is not what was promised
            return f"other error: {type(error).__name__}"
    if not _begins(original, read):
        return "changed numbers pass"
    if read.complete:
        return "reads as before"
    return "first rows, marked incomplete"


def _begins(original: Trajectory, read: Trajectory) -> bool:
    """Whether `read` has the first rows of `original`, in every bit."""
    meta = {k: v for k, v in read.meta.items() if k != "complete"}
    return (
        read.names == original.names
        and meta == {k: v for k, v in original.meta.items() if k != "complete"}
        and all(read[k].tobytes() == original[k][: len(read)].tobytes() for k in read.names)
    )


def killed(folder: str, run: Trajectory, row: int, after: float) -> str:
    """What a recording leaves that is killed some time [s] after it was given so many rows."""
    path, told = Path(folder) / "run.rrd", _SPAWN.Value("q", 0)
    child = _SPAWN.Process(target=_records, args=(str(path), run, told))
    child.start()
    while told.value < row and child.is_alive():
        time.sleep(0.001)
    time.sleep(after)
    child.kill()
    child.join()
    found = _left(path, run, told.value)
    others = [file for file in os.listdir(folder) if file not in _NAMES]
    if not others:
        return found
    # The file is written under a hidden name, which it leaves when it is whole.
    hidden = all(file.startswith(".run-") for file in others)
    return found + (_HIDDEN if hidden else f"; leaves {others}")


_NAMES = ("run.rrd", "run.rrd.partial")


def _records(path: str, run: Trajectory, told: Any) -> None:
    """Record `run` row by row; runs in a process of its own."""
    rows = np.stack([run[name] for name in run.names], axis=1)
    recorder = Recorder(path, run.meta, run.names, chunk=_CHUNK)
    begun = time.perf_counter()
    for k, row in enumerate(rows, start=1):
        recorder.add(row)
        told.value = k
        time.sleep(max(0.0, begun + _PACE * k / len(rows) - time.perf_counter()))
    recorder.finish(run)


def _left(path: Path, run: Trajectory, added: int) -> str:
    """What a killed recording left, by the rows it had been given."""
    if path.is_file():
        read = Trajectory.from_file(path)
        return "whole file" if read.complete and _begins(run, read) else "wrong file"
    try:
        read = Trajectory.from_file(path.with_name(path.name + ".partial"))
        count = len(read)
    except (DamagedRecording, FileNotFoundError):
        read, count = None, 0
    if read is not None and (read.complete or not _begins(run, read)):
        return "wrong rows"
    lost = added - count
    return "journal, at most one chunk lost" if lost <= _CHUNK else f"{lost} rows lost"


def full(folder: str, run: Trajectory, how: str, limit: int | None) -> str:
    """What a disk does that is full in the midst of a recording."""
    if limit is not None:
        import resource

        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    path = Path(folder) / "run.rrd"
    try:
        if how == "recorder":
            with Recorder(path, run.meta, run.names) as recorder:
                recorder.add(np.stack([run[name] for name in run.names], axis=1))
                recorder.finish(run)
        else:
            run.to_rrd(path)
    except OSError as error:
        if "run.rrd" not in str(error) or "\n" in str(error):
            return f"unclear error: {error}"
        left = sorted(os.listdir(folder))
        if how == "recorder" and left == ["run.rrd.partial"]:
            kept = Trajectory.from_file(path.with_name("run.rrd.partial"))
            return "one clear error, journal reads" if _begins(run, kept) else "wrong rows"
        return "one clear error, nothing left" if not left else f"leaves {left}"
    return "no error"


def refused(folder: str, run: Trajectory) -> str:
    """What a read-only place does before the run begins."""
    try:
        Recorder(Path(folder) / "run.rrd", run.meta, run.names).discard()
    except OSError as error:
        return "refused before the run" if "run.rrd" in str(error) else f"unclear error: {error}"
    return "taken"


@contextlib.contextmanager
def disk(folder: Path, options: str) -> Iterator[bool]:
    """A file system in memory at `folder`, where this user may mount one; else False."""
    command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        mounted = False
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", str(folder)], capture_output=True, check=True)
