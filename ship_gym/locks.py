"""Which process may write a file or a folder: locks that name it; what a file may be at all."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from ship_gym.config import ConfigError

# what a path may be that no file can be written to
_OTHERS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def unfit(path: Path) -> str:
    """Why no file can be written to a path; empty where there is a regular file or none."""
    try:
        kind = stat.S_IFMT(os.stat(path).st_mode)
    except OSError as error:
        return "a link to itself" if error.errno == errno.ELOOP else ""
    if kind == stat.S_IFREG:
        return ""
    what = f"that is {_OTHERS.get(kind, 'no regular file')}"
    return what if kind == stat.S_IFDIR else f"{what}; allowed is a regular file or a new one"


def followed(path: Path) -> Path:
    """What a link points to, through all of them; another path as it is."""
    return Path(os.path.realpath(path)) if os.path.islink(path) else path


def is_there(file: IO[bytes], path: str | os.PathLike) -> bool:
    """Whether an open file still has its name."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(file.fileno()))
    except FileNotFoundError:
        return False


@contextlib.contextmanager
def locked(path: str | os.PathLike, doing: str, what: str | os.PathLike = "") -> Iterator[None]:
    """Hold a folder by a lock file in it, which names the process; a dead one holds nothing.

    Parameters
    ----------
    path : path-like
        The lock file; its folder is created if missing.
    doing : str
        What the holder does, as in ``"trains into this folder"``.
    what : path-like
        What is held, for the message: the folder of the lock file if omitted.

    Raises
    ------
    ConfigError
        Another process holds it; says which.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if other := unfit(path):
        raise ConfigError(f"{path}: {other}")
    while True:
        with path.open("a+b") as file:
            if not take_lock(file):
                file.seek(0)
                holder = file.read(20).decode("ascii", "replace").strip() or "unknown"
                raise ConfigError(
                    f"{what or path.parent}: another process (pid {holder}) {doing}; wait for it, "
                    "or give another --out"
                )
            if not is_there(file, path):
                continue  # who held it has just removed it
            file.truncate(0)
            file.write(f"{os.getpid()}\n".encode())
            file.flush()
            yield
            return


@contextlib.contextmanager
def held(path: str | os.PathLike, doing: str) -> Iterator[None]:
    """Hold a file that takes long to make, so that of two who make it one is refused at once.

    By a lock ``.NAME.lock`` beside it, which is removed at the end, as are folders that were made
    for it where nothing was written into them.

    Parameters
    ----------
    path : path-like
        The file, which need not be there.
    doing : str
        What the holder does, as in ``"tunes into this file"``.

    Raises
    ------
    ConfigError
        Another process holds it; says which.
    """
    file = followed(Path(path))
    lock = file.with_name(f".{file.name}.lock")
    new = [p for p in (lock.parent, *lock.parent.parents) if not p.exists()]
    with locked(lock, doing, path):
        try:
            yield
        finally:
            if os.name != "nt":  # which removes no open file
                lock.unlink(missing_ok=True)
            for folder in new:  # nothing was written: none is left
                with contextlib.suppress(OSError):
                    folder.rmdir()


def take_lock(file: IO[bytes]) -> bool:
    """Take the lock of a file for as long as it is open; False if another process has it.

    Raises
    ------
    OSError
        The file system has no locks.
    """
    try:
        import fcntl
    except ImportError:  # Windows locks bytes: one far behind the number, which stays readable
        import msvcrt

        file.seek(1 << 20)
        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):  # the latter by some network file systems
        return False
    except OSError as error:
        raise OSError(error.errno, f"no lock: {error.strerror}", file.name) from error
    return True
