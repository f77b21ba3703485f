"""Where an artefact comes from, and how to write one without leaving half a file behind."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import platform
import subprocess
import tempfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import IO

from ship_gym.config import ConfigError

# what a write says where there is no room: full disk, quota, limit of file sizes
_FULL = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}
_PACKAGES = ("numpy", "scipy", "numba", "gymnasium", "torch", "stable-baselines3", "rerun-sdk")


def versions() -> dict[str, str]:
    """Versions of Python, this package and the installed libraries that decide a result."""
    found = {"python": platform.python_version(), "ship-gym": _version("ship-gym")}
    for name in _PACKAGES:
        if (version := _version(name)) != "not installed":
            found[name] = version
    return found


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def git_commit() -> str:
    """Commit of the checkout that this package runs from, with ``-dirty`` if it was edited.

    Returns
    -------
    str
        Forty hex digits, or ``"no git checkout"`` for an installed wheel.
    """
    package = Path(__file__).resolve().parent
    command = ["git", "-C", str(package), "describe", "--always", "--abbrev=40", "--dirty"]
    try:
        top = subprocess.run(
            ["git", "-C", str(package), "rev-parse", "--show-toplevel"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
        if Path(top).resolve() != package.parent:  # a wheel inside somebody else's repository
            return "no git checkout"
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "no git checkout"


def provenance() -> dict[str, object]:
    """Versions and commit, to be stored in every artefact beside its config and seed."""
    return {"versions": versions(), "git_commit": git_commit()}


def sha256(path: str | os.PathLike) -> str:
    """SHA-256 of a file's bytes, as hex digits."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


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
        if isinstance(one, OSError) and one.errno in _FULL:
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

    Parameters
    ----------
    path : path-like
        What will be written. It is not touched, and no folder is made.
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
    if not folder and os.path.isdir(path):
        raise ConfigError(f"{option} {path}: that is a folder")
    inside = path if folder else path.parent
    there = next(p for p in (inside, *inside.absolute().parents) if os.path.lexists(p))
    if not os.path.isdir(there):
        raise ConfigError(f"{option} {path}: {there} is a file, not a folder")
    try:
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            path.lstat()  # a name may be too long
        with tempfile.TemporaryFile(dir=there) as file:
            file.write(bytes(4096))
    except OSError as error:
        reason = os.strerror(error.errno).lower() if error.errno else str(error)
        raise ConfigError(f"{option} {path}: cannot write into {there}: {reason}") from None
    return path


@contextlib.contextmanager
def atomic_path(path: str | os.PathLike) -> Iterator[Path]:
    """Give a temporary path beside `path`; rename it to `path` only if the block succeeds.

    Parameters
    ----------
    path : path-like
        Final path; its folder is created if missing.

    Yields
    ------
    pathlib.Path
        Where to write. An exception in the block removes it and leaves `path` as it was.

    Raises
    ------
    DiskFull
        No room for the file.
    """
    path = Path(path)
    with full_disk_named(path), _replaced(path) as temporary:
        yield temporary


@contextlib.contextmanager
def _replaced(path: Path) -> Iterator[Path]:
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(
        dir=path.parent, prefix=f".{path.stem[:50]}-", suffix=path.suffix
    )
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)  # mkstemp's 0600 would hide the result from other users
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def locked(path: str | os.PathLike, doing: str) -> Iterator[None]:
    """Hold a folder by a lock file in it, which names the process; a dead one holds nothing.

    Parameters
    ----------
    path : path-like
        The lock file; its folder is created if missing.
    doing : str
        What the holder does, as in ``"trains into this folder"``.

    Raises
    ------
    ConfigError
        Another process holds it; says which.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a+b") as file:
        if not take_lock(file):
            file.seek(0)
            holder = file.read(20).decode("ascii", "replace").strip() or "unknown"
            raise ConfigError(
                f"{path.parent}: another process (pid {holder}) {doing}; wait for it, or give "
                "another --out"
            )
        file.truncate(0)
        file.write(f"{os.getpid()}\n".encode())
        file.flush()
        yield


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
