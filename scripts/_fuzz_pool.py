"""Worker processes, each with a limit of time for each task; one that dies is replaced."""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import multiprocessing
import os
import resource
import signal
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from _fuzz_judge import Verdict, innermost_of_dump

SECONDS = 10  # of computing that a task may take
_WAITING = 90.0  # [s] a task may take in all: one that waits for something computes nothing
_MEMORY = 6 << 30  # [bytes] of data a worker may ask for, to protect the machine


class Broken(str):
    """What the work itself said when it failed, which no case may make it do."""


class _Worker:
    """One process, forked with all that is loaded."""

    def __init__(self, number: int, work: Callable, folder: Path):
        self.dump = folder / f"worker_{number}.txt"
        context = multiprocessing.get_context("fork")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(
            target=_serve, args=(theirs, self.pipe, work, self.dump), daemon=True
        )
        self.process.start()
        theirs.close()
        self.task: Any = None
        self.begun = 0.0

    def give(self, task: Any) -> None:
        self.task, self.begun = task, time.monotonic()
        with contextlib.suppress(OSError):  # a dead one is noticed by its pipe
            self.pipe.send(task)

    def answer(self) -> Any:
        """What the worker sent, or a Verdict of its death."""
        try:
            found = self.pipe.recv()
            if isinstance(found, Broken):
                raise RuntimeError(f"the fuzzer itself failed: {found}")
            if _broken_off(found):
                self.process.join(5.0)
                self.end()
            return found
        except (EOFError, OSError):
            self.process.join(10.0)
            self.end()
            return self._death(self.process.exitcode)

    def _death(self, code: int | None) -> Verdict:
        text = self.dump.read_text(errors="replace") if self.dump.is_file() else ""
        took = time.monotonic() - self.begun
        if code in (-signal.SIGPROF, -signal.SIGABRT) and took > SECONDS:
            return Verdict("hang", innermost_of_dump(text), f"killed after {took:.0f} s", took)
        name = signal.Signals(-code).name if code and code < 0 else f"exit code {code}"
        return Verdict("death", f"{name} at {innermost_of_dump(text)}", text[:400], took)

    def end(self) -> None:
        if self.process.is_alive():
            self.process.kill()
            self.process.join(5.0)
        self.pipe.close()


def _broken_off(answer: Any) -> bool:
    """Whether a task ended amidst anything: its worker goes, and another begins anew."""
    return getattr(answer, "outcome", "") == "work"


def _serve(pipe: Any, other: Any, work: Callable, dump: Path) -> None:
    """Loop of a worker: what hangs is ended by the system, and says where it was."""
    other.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the one who asks is told by its own
    null = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(null, stream)
    gc.freeze()
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with dump.open("w") as told:
        faulthandler.enable(told, all_threads=False)
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        faulthandler.register(signal.SIGPROF, told, all_threads=False, chain=True)
        while True:
            try:
                task = pipe.recv()
            except (EOFError, OSError):
                return
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            try:
                answer = work(task)
            except BaseException:
                answer = Broken(f"{task}: {traceback.format_exc()}")
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            pipe.send(answer)
            if _broken_off(answer):
                return


class Pool:
    """Workers for tasks; ``with Pool(...) as pool: for task, answer in pool.each(tasks)``.

    Parameters
    ----------
    jobs : int
    work : callable
        Takes a task, gives an answer; both travel through a pipe.
    folder : Path
        For notes of workers that die.
    """

    def __init__(self, jobs: int, work: Callable, folder: Path):
        self._work, self._folder, self._made = work, folder, 0
        self._workers = [self._new() for _ in range(jobs)]

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: Any) -> None:
        for worker in self._workers:
            worker.end()

    def _new(self) -> _Worker:
        self._made += 1
        return _Worker(self._made, self._work, self._folder)

    def each(self, tasks: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
        """Tasks with their answers, in the order in which they end.

        A worker that dies answers with a `Verdict` "hang" or "death"; another takes its place.
        """
        left = iter(tasks)
        for k, _ in enumerate(self._workers):
            self._next(k, left)
        while busy := {w.pipe: k for k, w in enumerate(self._workers) if w.task is not None}:
            for pipe in wait(list(busy), timeout=5.0):
                k = busy[pipe]
                task, answer = self._workers[k].task, self._workers[k].answer()
                self._workers[k].task = None
                self._next(k, left)
                yield task, answer
            self._stop_waiting()

    def _next(self, k: int, left: Iterator[Any]) -> None:
        task = next(left, None)
        if task is None:
            return
        worker = self._workers[k]
        if worker.pipe.closed or not worker.process.is_alive():
            worker.end()
            self._workers[k] = worker = self._new()
        worker.give(task)

    def _stop_waiting(self) -> None:
        for worker in self._workers:
            if worker.task is not None and time.monotonic() - worker.begun > _WAITING:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(worker.process.pid, signal.SIGABRT)
