"""How files are written: whole or not at all, and only where a file can be.

A file is written under a hidden name beside it, ``.NAME-xxxxxxxx.ship_gym.tmp.EXT``, which it
leaves when it is whole. The hidden one is locked as long as its writer lives, so that those of
killed writers are told from others and removed at the next start (`sweep`).
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from ship_gym.config import ConfigError
from ship_gym.locks import followed, is_there, take_lock, unfit

# what a write says where there is no room: full disk, quota, limit of file sizes
_FULL = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}
_STEM = 50  # letters of a file's name that the hidden one keeps
_HIDDEN = re.compile(r"\.(.*)-[a-z0-9_]{8}\.ship_gym\.tmp(\.[^.]*)?", re.DOTALL)


class DiskFull(OSError):
    """No room for a file; its message says for which, and that it was not written."""

    def __str__(self) -> str:
        return str(self.args[1])


def causes(error: BaseException | None) -> Iterator[BaseException]:
    """An error and those behind it: libraries hide one of the system behind one of their own."""
    while error is not None:
        yield error
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)


def no_space(error: BaseException) -> str:
    """What a full disk, a quota or a limit of file sizes said; empty if none caused the error."""
    for one in causes(error):
        if isinstance(one, OSError) and one.errno is not None and one.errno in _FULL:
            return os.strerror(one.errno).lower()
    return ""


@contextlib.contextmanager
def full_disk_named(path: str | os.PathLike) -> Iterator[None]:
    """Turn what a full disk raises in the block into a ``DiskFull`` that names `path`."""
    try:
        yield
    except DiskFull:
        raise
    except Exception as error:
        if not (reason := no_space(error)):
            raise
        text = f"{path}: {reason}; nothing was written to it"
        raise DiskFull(errno.ENOSPC, text) from error


def check_place(path: str | os.PathLike, option: str, folder: bool = False) -> Path:
    """Refuse, before any work, a file or folder that could not be written.

    A page of zeros is written into the folder, or into the nearest one above it that is there, and
    is gone at once: permission bits say nothing to root, nor of a disk that is full or read-only.
    What a killed writer left half there is removed.

    Parameters
    ----------
    path : path-like
        What will be written; a link stands for what it points to. It is not touched, and no folder
        is made.
    option : str
        Who named it, for the message.
    folder : bool
        It is a folder to write into, not a file.

    Returns
    -------
    pathlib.Path
        `path`.

    Raises
    ------
    ConfigError
        One line with option, path and reason.
    """
    path = Path(path)
    named = f"{option} {_short(path)}"
    if not folder and (what := unfit(path)):
        raise ConfigError(f"{named}: {what}")
    inside = path if folder else followed(path).parent
    there = next(p for p in (inside, *inside.absolute().parents) if os.path.lexists(p))
    if not os.path.isdir(there):
        raise ConfigError(f"{named}: {_short(there)} is a file, not a folder")
    try:
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            path.lstat()  # a name may be too long
        with tempfile.TemporaryFile(dir=there) as file:
            file.write(bytes(4096))
    except OSError as error:
        reason = os.strerror(error.errno).lower() if error.errno else str(error)
        raise ConfigError(f"{named}: cannot write into {_short(there)}: {reason}") from None
    sweep(inside, None if folder else path)
    return path


def _short(path: Path) -> str:
    """A path of which so much is shown that the reason behind it is not cut off."""
    text = str(path)
    return text if len(text) <= 110 else f"{text[:50]}...{text[-50:]}"


@contextlib.contextmanager
def atomic_path(path: str | os.PathLike) -> Iterator[Path]:
    """Give a temporary path beside `path`; rename it to `path` only if the block succeeds.

    Parameters
    ----------
    path : path-like
        Final path; its folder is created if missing. A link stays: what it points to is replaced. A
        file that is there passes its permissions on.

    Yields
    ------
    pathlib.Path
        Where to write. An exception in the block removes it and leaves `path` as it was.

    Raises
    ------
    ConfigError
        There is a folder, a device, a pipe or a socket.
    DiskFull
        No room for the file.
    """
    path = Path(path)
    if what := unfit(path):
        raise ConfigError(f"{path}: {what}")
    with full_disk_named(path), _replaced(followed(path)) as temporary:
        yield temporary


@contextlib.contextmanager
def _replaced(path: Path) -> Iterator[Path]:
    path.parent.mkdir(parents=True, exist_ok=True)
    with _hidden(path) as temporary:
        try:
            yield temporary
            temporary.chmod(_mode(path))  # mkstemp's 0600 would hide the result from other users
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


def _mode(path: Path) -> int:
    """Permissions of the file that is there, else those of a new one."""
    try:
        return stat.S_IMODE(path.stat().st_mode) & 0o777
    except FileNotFoundError:
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask


@contextlib.contextmanager
def _hidden(path: Path) -> Iterator[Path]:
    """A new hidden file beside `path`, locked where the system can."""
    while True:
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.stem[:_STEM]}-", suffix=f".ship_gym.tmp{path.suffix}"
        )
        if os.name == "nt":  # which renames no open file
            os.close(handle)
            yield Path(name)
            return
        with open(handle, "rb") as file:
            with contextlib.suppress(OSError):  # a file system without locks
                take_lock(file)
            if is_there(file, name):  # else swept away before it had its lock
                yield Path(name)
                return


def sweep(folder: str | os.PathLike, path: str | os.PathLike | None = None) -> None:
    """Remove the hidden files of writers that were killed; living ones hold theirs by a lock.

    Where the system has no such locks nothing is removed.

    Parameters
    ----------
    folder : path-like
        Not what is in folders in it.
    path : path-like, optional
        Only what was to become this file.
    """
    with contextlib.suppress(OSError), os.scandir(os.fspath(folder)) as entries:
        if os.name == "nt":
            return
        for entry in entries:
            found = _HIDDEN.fullmatch(entry.name)
            mine = path is None or (found and found[1] == followed(Path(path)).stem[:_STEM])
            if found and mine and entry.is_file(follow_symlinks=False):
                with contextlib.suppress(OSError), open(entry.path, "r+b") as file:
                    if take_lock(file):
                        os.unlink(entry.path)
