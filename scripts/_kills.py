"""Processes that work in a folder and are killed there; see check_kills.py.

They are forked from one process that has loaded the libraries and compiled the kernels, so that
a kill costs no start. A process is killed after a time, or by itself at the n-th change of a file:
just before it opens a file to write, renames, removes or makes one.
"""

from __future__ import annotations

import os
import signal
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

LONGEST = 120.0  # after which a process counts as hanging [s]
ERRORS = "errors.txt"  # beside the folder: what the last process said on stderr
_CHANGES = {"os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.truncate", "os.chmod", "open"}
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC


class Ended(NamedTuple):
    """How a process ended.

    Attributes
    ----------
    how : str
        ``"done"``, ``"killed"``, ``"refused"`` (exit code not 0) or ``"hangs"``.
    seconds : float
    changes : int
        Of files, as far as it lived to tell them.
    said : str
        Last line on stderr.
    """

    how: str
    seconds: float
    changes: int
    said: str


def forked(
    work: Callable[[], None], folder: Path, change: int = 0, after: float | None = None
) -> Ended:
    """Work in a folder, in a process of its own.

    Parameters
    ----------
    work : callable
    folder : path
        Its current folder.
    change : int
        The change of a file, counted from 1, before which it kills itself; 0: none.
    after : float, optional
        Time after which it is killed [s].
    """
    told, tell = os.pipe()
    (folder.parent / ERRORS).touch()  # a child may be killed before it has opened it
    begun = time.perf_counter()
    child = os.fork()
    if child == 0:
        os.close(told)
        _live(work, folder, change, tell)
    os.close(tell)
    code = _waited(child, begun, after)
    with os.fdopen(told, "rb") as pipe:
        count = pipe.read()
    seconds = time.perf_counter() - begun
    said = (folder.parent / ERRORS).read_text(errors="replace").strip().splitlines()[-1:]
    if code is None:
        how = "hangs"
    elif os.WIFSIGNALED(code):
        how = "killed"
    else:
        how = "done" if os.WEXITSTATUS(code) == 0 else "refused"
    return Ended(how, seconds, int(count or 0), "".join(said))


def _waited(child: int, begun: float, after: float | None) -> int | None:
    """Status of a child, killed in time; None: it hung."""
    while True:
        found, code = os.waitpid(child, os.WNOHANG)
        if found:
            return code
        lived = time.perf_counter() - begun
        if lived >= (LONGEST if after is None else after):
            os.kill(child, signal.SIGKILL)
            _, code = os.waitpid(child, 0)
            return None if after is None else code
        left = 0.005 if after is None else min(0.005, after - lived)
        time.sleep(max(0.0, left))


def _live(work: Callable[[], None], folder: Path, change: int, tell: int) -> None:
    """The life of a child; never returns."""
    code, count = 1, [0]
    try:
        _quiet(folder.parent / ERRORS)
        os.chdir(folder)
        sys.addaudithook(lambda event, args: _seen(event, args, str(folder), count, change))
        work()
        code = 0
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os.write(tell, str(count[0]).encode())
        os._exit(code)


def _quiet(errors: Path) -> None:
    """Nothing on stdout; stderr into a file."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(os.open(errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), 2)
    sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")


def _seen(event: str, args: tuple, folder: str, count: list[int], change: int) -> None:
    """Count changes of files in the folder; the process ends before the one it is to end at."""
    if event not in _CHANGES or not isinstance(args[0], str | bytes | os.PathLike):
        return
    if event == "open" and not (isinstance(args[2], int) and args[2] & _WRITES):
        return
    path = os.fsdecode(args[0])
    if os.path.isabs(path) and not path.startswith(folder):
        return
    count[0] += 1
    if count[0] == change:
        os.kill(os.getpid(), signal.SIGKILL)
