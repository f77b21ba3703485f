"""The one door to numba: how a kernel is compiled and where its machine code is kept.

numba's disk cache of a function does not notice an edit in another function that it calls. The
cache folder is therefore named by a hash of every source file that holds kernels; where it lies and
when it is trusted: ``_cache``.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import types
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.target_extension import current_target

from ship_gym.physics._cache import cache_folder
from ship_gym.physics._compiler import LOOP, PART, keep_code, keep_part

_PACKAGE = Path(__file__).resolve().parent.parent
_KERNEL_SOURCES = (
    "conventions.py",
    "physics/*.py",
    "tracks/*.py",
    "tasks/**/*.py",
    "envs/interval.py",
    "gpu/*.py",
)


def source_hash() -> str:
    """Hash of numba's version and of all kernel sources, 16 hex digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for pattern in _KERNEL_SOURCES:
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


_CACHE_FOLDER = cache_folder(source_hash())


def code_folder() -> Path:
    """Where the machine code of this process lies."""
    return Path(_CACHE_FOLDER)


def compiles() -> bool:
    """Whether kernels are compiled: not with ``NUMBA_DISABLE_JIT=1``."""
    return not numba.config.DISABLE_JIT


def _beside(folder: Path) -> str:
    """Hash of the Python files in a folder of a user, whose kernels may use each other."""
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.py")):
        state = path.stat()
        digest.update(f"{path.name} {state.st_mtime_ns} {state.st_size}\n".encode())
    return digest.hexdigest()[:16]


def _has_file(function: Callable) -> bool:
    return Path(function.__code__.co_filename).exists()


def _file_of_user(function: Callable) -> Path | None:
    """File of a function, None if it is one of the package or none."""
    file = Path(function.__code__.co_filename)
    if not file.exists() or file.resolve().is_relative_to(_PACKAGE):
        return None
    return file.resolve()


@contextlib.contextmanager
def _own_cache(kind: str, function: Callable) -> Iterator[None]:
    """Let numba put this function's cache into our folder; leave other users' setting alone.

    A function of a user's file has one for all that lies beside that file.
    """
    if (file := _file_of_user(function)) is not None:
        kind = f"{kind}-{_beside(file.parent)}"
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
        """What numba sees: the part; while it compiles for a graphics card, that of the card."""
        on_card = current_target() == "cuda"
        return (self.of_card if on_card else self.part)._numba_type_

    @functools.cached_property
    def of_card(self):
        """Compiled for a graphics card: numba.cuda takes only numba's own functions by itself."""
        from numba import cuda  # heavy, and not everywhere

        return cuda.jit(device=True)(self.py_func)

    @functools.cached_property
    def alone(self):
        """Compiled to be called from Python."""
        with _own_cache("serial", self.py_func):
            return keep_code(numba.njit(self.py_func, cache=True, **_options(self.py_func)))

    def __call__(self, *args):
        return self.alone(*args)


def kernel(function):
    """Compile a function of one ship at one instant, to be inlined into a loop over ships."""
    return function if numba.config.DISABLE_JIT else Kernel(function)


def composed(function):
    """As `kernel`, of a function that does little but call others: compiled in less time."""
    function.composed = True
    return kernel(function)


def in_python(function: Callable) -> Callable:
    """The Python function of a kernel, for arrays where it is arithmetic only."""
    return getattr(function, "py_func", function)


def inlined(function):
    """As `kernel`, of a function without a source file, which is not called from Python."""
    return function if numba.config.DISABLE_JIT else _part(function)


def _options(function) -> dict[str, Any]:
    """Options of a kernel; one of a user may make arrays, so its references are counted."""
    return _PLAIN if _file_of_user(function) is None else {**_PLAIN, "_nrt": True}


def _part(function):
    return keep_part(numba.njit(function, forceinline=True, **_options(function), **PART))


def loop(function):
    """Compile a loop over ships; its array arguments must not overlap. Other threads may run."""
    with _own_cache("serial", function):
        return keep_code(numba.njit(function, cache=True, nogil=True, **_PLAIN, **LOOP))


def specialised(function: Callable, name: str, **kernels: Callable) -> Callable:
    """A loop whose calls of the names `kernels` go to the kernels given; compiled as `loop` does.

    numba looks up the names of a function when it compiles it, so a copy of the function with other
    globals is another loop of the same source. Its machine code is kept under `name` and, where a
    kernel is one of a user's file, a hash of what lies beside that file. That of kernels without a
    file or with variables of a function around them is not kept.

    Parameters
    ----------
    function : callable
        Of the package, not yet compiled.
    name : str
        Of the copy, other than those of all other copies.
    kernels : callable
    """
    sources = [in_python(kernel) for kernel in kernels.values()]
    outside = {file for source in sources if (file := _file_of_user(source)) is not None}
    if outside:
        digest = hashlib.sha256()
        for file in sorted(outside):
            digest.update(f"{file} {_beside(file.parent)}\n".encode())
        for source in sources:
            digest.update(f"{source.__qualname__}\n".encode())
        name = f"{name}_{digest.hexdigest()[:16]}"
    made = types.FunctionType(function.__code__, {**function.__globals__, **kernels}, name)
    made.__qualname__, made.__doc__ = name, function.__doc__
    kept = all(_has_file(source) and source.__closure__ is None for source in sources)
    with _own_cache("serial", function):
        return keep_code(numba.njit(made, cache=kept, nogil=True, **_PLAIN, **LOOP))


def direct(function: Callable, arguments: Sequence[Any]) -> Callable:
    """The machine code of a compiled function for arguments of the types of these.

    A call of it saves numba's search for the version that fits, 0.1 to 0.5 us for each array; types
    are not checked, so it is for arrays that stay. Python's own function, where nothing is compiled
    (``NUMBA_DISABLE_JIT=1``).
    """
    if not hasattr(function, "compile"):
        return function
    return function.compile(tuple(_type_of(argument) for argument in arguments))


_record_types: dict[tuple[Any, ...], Any] = {}  # of arrays of records, by what numba looks at


def _type_of(value: Any) -> Any:
    """As `numba.typeof`, which takes a record's fields apart each time: 1.9 ms a fleet, not 0.3."""
    if isinstance(value, tuple):
        return numba.types.BaseTuple.from_types([_type_of(part) for part in value], type(value))
    if not (isinstance(value, np.ndarray) and value.dtype.names):
        return numba.typeof(value)
    dtype, flags = value.dtype, value.flags
    layout = flags.c_contiguous, flags.f_contiguous, flags.writeable
    key = dtype, dtype.isalignedstruct, value.ndim, *layout
    if key not in _record_types:
        _record_types[key] = numba.typeof(value)
    return _record_types[key]
