"""The one door to numba: how a kernel is compiled and where its machine code is kept.

numba's disk cache of a function does not notice an edit in another function that it calls. The
cache folder is therefore named by a hash of every source file that holds kernels.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numba

_PACKAGE = Path(__file__).resolve().parent.parent
_KERNEL_SOURCES = ("conventions.py", "physics/*.py", "tracks/*.py", "tasks/**/*.py")


def source_hash() -> str:
    """Hash of numba's version and of all kernel sources, 16 hex digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for pattern in _KERNEL_SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> str:
    """Writable folder for the compiled kernels of exactly these sources."""
    root = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    for parent in (root, Path.home() / ".cache", tempfile.gettempdir()):
        if parent:
            folder = Path(parent) / "ship_gym" / source_hash()
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError:
                continue
            if os.access(folder, os.W_OK):
                return str(folder)
    return tempfile.mkdtemp(prefix="ship_gym-")


def _forget_old_kernels(folder: str) -> None:
    """Remove compiled kernels of other sources that nobody has used for a month."""
    month_ago = time.time() - 30 * 86400.0
    os.utime(folder)  # "used now"
    for other in Path(folder).parent.glob("?" * 16):
        if other.stat().st_mtime < month_ago:
            shutil.rmtree(other, ignore_errors=True)


_CACHE_FOLDER = _cache_folder()
with contextlib.suppress(OSError):
    _forget_old_kernels(_CACHE_FOLDER)


@contextlib.contextmanager
def _own_cache(kind: str) -> Iterator[None]:
    """Let numba put this function's cache into our folder; leave other users' setting alone.

    numba's cache key does not hold the `parallel` flag, hence one folder for each kind.
    """
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(Path(_CACHE_FOLDER) / kind)
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before


def kernel(function):
    """Compile a scalar function of one ship at one instant (no fastmath: same bits everywhere)."""
    with _own_cache("serial"):
        return numba.njit(function, cache=True, error_model="numpy")


def batch(function):
    """Compile a loop over ships twice: ``(serial, parallel)``; `numba.prange` marks the loop."""
    with _own_cache("parallel"):
        parallel = numba.njit(function, cache=True, error_model="numpy", parallel=True)
    return kernel(function), parallel


prange = numba.prange

_threads_lost = False


def _after_fork() -> None:
    """Remember a fork of a process whose threads run: GNU OpenMP would end the child at once."""
    global _threads_lost
    with contextlib.suppress(ValueError):  # no threads yet, the child may start its own
        _threads_lost = numba.threading_layer() == "omp"


if hasattr(os, "register_at_fork"):  # not on Windows, which cannot fork
    os.register_at_fork(after_in_child=_after_fork)


def threads_work() -> bool:
    """Whether this process may run the parallel version of a loop."""
    return not _threads_lost
