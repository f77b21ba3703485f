"""Which process may write a file or a folder: locks that name it; what a file may be at all."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
import warnings
from collections.abc import Iterable, Iterator
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
# what a file system without locks says
_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EINVAL}


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


def check_own(folder: Path, names: Iterable[str]) -> None:
    """Refuse links that lead out of a folder of a run, which may be a stranger's.

    What is written there is not what somebody named, as ``--out`` is: a link among it would let
    the maker of the folder choose a file of ours that is replaced. The folder itself may be one.

    Parameters
    ----------
    folder : Path
    names : iterable of str
        Files and folders in it that will be written.

    Raises
    ------
    ConfigError
        One leads out of it; says where to.
    """
    for name in names:
        path = folder / name
        if path.is_symlink() and not Path(os.path.realpath(path)).is_relative_to(
            os.path.realpath(folder)
        ):
            raise ConfigError(
                f"{path}: a link to {os.readlink(path)}; in the folder of a run allowed are only "
                "files and folders that lie in it"
            )


@contextlib.contextmanager
def locked(path: str | os.PathLike, doing: str, what: str | os.PathLike = "") -> Iterator[None]:
    """Hold a folder by a lock file in it, which names the process; a dead one holds nothing.

    A child that was forked meanwhile and lives on holds it, too. Where nothing was written beside
    the lock file it is removed at the end, and with it the folders that were made for it. Where
    the file system has no locks it goes on with a warning: two processes are not told apart.

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
        Another process holds it; says which. Or the lock file is a link or no file.
    """
    path = Path(path)
    with _taken_file(path, doing, what or path.parent) as file:
        try:
            yield
        finally:
            with contextlib.suppress(OSError):  # such as a folder that was removed
                if os.listdir(path.parent) == [path.name]:
                    _remove(file, path)


@contextlib.contextmanager
def _taken_file(path: Path, doing: str, what: str | os.PathLike) -> Iterator[IO[bytes]]:
    """The lock file, open and locked; folders that were made for it and are empty are removed."""
    made: list[Path] = []
    try:
        with _opened_and_taken(path, doing, what, made) as file:
            yield file
    finally:
        for folder in made:
            with contextlib.suppress(OSError):
                folder.rmdir()


@contextlib.contextmanager
def _opened_and_taken(
    path: Path, doing: str, what: str | os.PathLike, made: list[Path]
) -> Iterator[IO[bytes]]:
    """As `_taken_file`; puts the folders that it makes into `made`, the deepest first."""
    while True:
        try:
            made[:0] = _made(path.parent)
            if other := "a link" if path.is_symlink() else unfit(path):
                raise ConfigError(f"{path}: {other}; the lock is a file of its own")
            opened = open(path, "a+b", opener=_opened)
        except FileNotFoundError:
            continue  # who held it has just removed the folder
        with opened as file:
            if not _taken(file, what):
                file.seek(0)
                holder = file.read(20).decode("ascii", "replace").strip() or "unknown"
                raise ConfigError(
                    f"{what}: another process (pid {holder}) {doing}; wait for it, "
                    "or give another --out"
                )
            if not is_there(file, path):
                continue  # who held it has just removed it
            file.truncate(0)
            file.write(f"{os.getpid()}\n".encode())
            file.flush()
            yield file
            return


def _made(folder: Path) -> list[Path]:
    """The folders that had to be made for a folder, itself included, the deepest first."""
    if folder.is_dir():
        return []
    try:
        folder.mkdir()
    except FileNotFoundError:
        above = _made(folder.parent)
        return [*_made(folder), *above]
    except FileExistsError:
        if folder.is_file() or (folder.is_symlink() and not folder.exists()):
            raise
        return []  # another process was faster
    return [folder]


def _remove(file: IO[bytes], path: Path) -> None:
    """Remove a lock file while it is held; one that another process has made since stays."""
    if os.name != "nt" and is_there(file, path):  # Windows removes no open file
        path.unlink()


def _opened(name: str, flags: int) -> int:
    """Open a lock file, which is emptied, and not what somebody makes it point to."""
    return os.open(name, flags | getattr(os, "O_NOFOLLOW", 0), 0o666)


def _taken(file: IO[bytes], what: str | os.PathLike) -> bool:
    """As `take_lock`; a file system without locks is told of."""
    try:
        return take_lock(file)
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
        warnings.warn(f"{what}: {error.strerror}; nothing keeps others away", stacklevel=8)
        return True


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
    with _taken_file(lock, doing, path) as held_file:
        try:
            yield
        finally:
            with contextlib.suppress(OSError):
                _remove(held_file, lock)


def take_lock(file: IO[bytes]) -> bool:
    """Take the lock of a file for as long as it is open; False if another process has it.

    Raises
    ------
    OSError
        The file system has no locks.
    """
    if sys.platform == "win32":  # which locks bytes: one far behind the number stays readable
        import msvcrt

        file.seek(1 << 20)
        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):  # the latter by some network file systems
        return False
    except OSError as error:
        raise OSError(error.errno, f"no lock: {error.strerror}", file.name) from error
    return True
