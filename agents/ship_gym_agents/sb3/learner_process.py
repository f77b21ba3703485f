"""A second process that learns, so that Python's lock does not hold up the sailing of this one.

A thread would not do: a batch of ships is many short operations under the lock, for each of which
the learner would wait, and so the other way round. The process keeps nothing: it gets the policy
with each rollout and gives it back, and may die at any time. It ends when its input does, so that
it outlives nobody. It runs no main module of anybody: scripts need no guard.

Both speak in pickles, which run what they say. They go through the two pipes that the run made for
this child of its own program: no name in the file system and no address leads to them, so nobody
can write there who could not already write into the memory of the run.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import traceback
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ship_gym_agents.sb3.learner import Learner, Rollout


class Gone(Exception):
    """The process has died or cannot be reached."""


class LearnerProcess:
    """Learns from rollouts in another process, whose start takes seconds; a context manager."""

    def __enter__(self) -> LearnerProcess:
        path = os.pathsep.join(folder for folder in sys.path if folder)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", __name__],  # -P: no module of the folder it stands in
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": path},
        )
        self._pool = ThreadPoolExecutor(1, "learner")
        self._hello = self._pool.submit(self._read)
        return self

    def __exit__(self, *_: Any) -> None:
        self._process.kill()  # it has nothing that would be lost
        self._process.wait()
        self._pool.shutdown()
        for stream in (self._process.stdin, self._process.stdout):
            assert stream is not None  # a pipe
            with contextlib.suppress(OSError):  # what a dead process did not read
                stream.close()

    @property
    def ready(self) -> bool:
        """Whether it has started."""
        return self._hello.done() and self._hello.exception() is None

    def begin(self, learner: Learner, rollout: Rollout) -> Future:
        """Begin to learn from a rollout: a future of the policy, a copy, and of what `learn` gives.

        The future raises `Gone` where there is no process any more.
        """
        return self._pool.submit(self._learn, learner, rollout)

    def _learn(self, learner: Learner, rollout: Rollout) -> Any:
        import torch

        self._write((torch.get_num_threads(), learner, rollout))
        done, found = self._read()
        if not done:
            raise RuntimeError(f"learning failed in its process:\n{found}")
        return found

    def _write(self, message: Any) -> None:
        try:
            _send(message, self._process.stdin)
        except OSError as error:
            raise Gone from error

    def _read(self) -> Any:
        assert self._process.stdout is not None
        try:
            return pickle.load(self._process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError) as error:
            raise Gone from error


def _send(message: Any, stream: Any) -> None:
    pickle.dump(message, stream, protocol=pickle.HIGHEST_PROTOCOL)
    stream.flush()


def serve() -> None:
    """Learn from what comes in until nothing more does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the run, which ends this
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what anybody prints goes elsewhere
    import torch

    import ship_gym_agents.sb3.learner  # before the first rollout, which waits for it
    import ship_gym_agents.sb3.networks  # noqa: F401

    with contextlib.suppress(EOFError, BrokenPipeError, pickle.UnpicklingError):  # the run ended
        _send("hello", out)
        while True:
            threads, learner, rollout = pickle.load(sys.stdin.buffer)
            torch.set_num_threads(threads)
            _send(_answer(learner, rollout), out)


def _answer(learner: Learner, rollout: Rollout) -> tuple[bool, Any]:
    """Whether it could learn, and the result or what went wrong."""
    try:
        return True, (learner.policy, learner.learn(rollout))
    except Exception:
        return False, traceback.format_exc()


if __name__ == "__main__":
    serve()
