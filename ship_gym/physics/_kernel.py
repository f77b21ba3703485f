"""The one door to numba: how a kernel is compiled and where its machine code is kept.

numba's disk cache of a function does not notice an edit in another function that it calls. The
cache folder is therefore named by a hash of every source file that holds kernels; where it lies and
when it is trusted: ``_cache``.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import numba

from ship_gym.physics._cache import cache_folder
from ship_gym.physics._compiler import LOOP, PART, keep_part

_PACKAGE = Path(__file__).resolve().parent.parent
_KERNEL_SOURCES = ("conventions.py", "physics/*.py", "tracks/*.py", "tasks/**/*.py")


def source_hash() -> str:
    """Hash of numba's version and of all kernel sources, 16 hex digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for pattern in _KERNEL_SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


_CACHE_FOLDER = cache_folder(source_hash())


@functools.cache
def _beside(folder: Path) -> str:
    """Hash of the Python files in a folder of a user, whose kernels may use each other."""
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.py")):
        state = path.stat()
        digest.update(f"{path.name} {state.st_mtime_ns} {state.st_size}\n".encode())
    return digest.hexdigest()[:16]


@contextlib.contextmanager
def _own_cache(kind: str, function: Callable) -> Iterator[None]:
    """Let numba put this function's cache into our folder; leave other users' setting alone.

    numba's cache key does not hold the `parallel` flag, hence one folder for each kind; a function
    of a user's file has one for all that lies beside that file.
    """
    file = Path(function.__code__.co_filename)
    if file.exists() and not file.resolve().is_relative_to(_PACKAGE):
        kind = f"{kind}-{_beside(file.resolve().parent)}"
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(Path(_CACHE_FOLDER) / kind)
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before


# No fastmath: same bits everywhere. Without _nrt no references of arrays are counted, which was
# 40 % of a step; such a kernel can neither make nor return an array.
_PLAIN = {"error_model": "numpy", "_nrt": False}


class Kernel:
    """A function of one ship at one instant: a part of loops, and callable from Python.

    To numba it is a part (``_compiler``); a call from Python compiles, and keeps, a version of it
    by itself.
    """

    def __init__(self, function):
        functools.update_wrapper(self, function)
        self.py_func = function
        self.part = _part(function)

    @property
    def _numba_type_(self):
        return self.part._numba_type_

    @functools.cached_property
    def alone(self):
        """Compiled to be called from Python."""
        with _own_cache("serial", self.py_func):
            return numba.njit(self.py_func, cache=True, **_PLAIN)

    def __call__(self, *args):
        return self.alone(*args)


def kernel(function):
    """Compile a function of one ship at one instant, to be inlined into a loop over ships."""
    return function if numba.config.DISABLE_JIT else Kernel(function)


def inlined(function):
    """As `kernel`, of a function without a source file, which is not called from Python."""
    return function if numba.config.DISABLE_JIT else _part(function)


def _part(function):
    return keep_part(numba.njit(function, forceinline=True, **_PLAIN, **PART))


def loop(function):
    """Compile a loop over ships; its array arguments must not overlap. Other threads may run."""
    with _own_cache("serial", function):
        return numba.njit(function, cache=True, nogil=True, **_PLAIN, **LOOP)


def batch(function):
    """Compile a loop over ships twice: ``(serial, parallel)``; `numba.prange` marks the loop."""
    with _own_cache("parallel", function):
        parallel = numba.njit(function, cache=True, error_model="numpy", parallel=True)
    return loop(function), parallel


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
