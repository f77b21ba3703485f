"""Where compiled kernels are kept between processes, and whether that place can be trusted.

numba keeps machine code with a pickled index, and a pickle runs what it says. A folder is therefore
used only if it is a real directory (no link) that this user owns and that nobody else can write
to; it is made so (mode 0700). The first of these that is or can be made such a folder, and can be
written to, is taken:

1. ``$NUMBA_CACHE_DIR/ship_gym``, else ``$XDG_CACHE_HOME/ship_gym``, if one of them is set;
2. ``~/.cache/ship_gym``, if there is a home;
3. ``ship_gym-<user id>`` in the temporary directory, for users whose home cannot be written to: the
   kernels are compiled once, not by every process;
4. a new folder that is removed when the process ends.

On Windows, which has no owner and mode of this kind, the user's own profile and temporary directory
are trusted as they are.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO

_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
_UNUSED = 30 * 86400.0  # [s] after which kernels of other sources are removed


def cache_folder(key: str, parents: Sequence[Path] | None = None) -> str:
    """Folder for the kernels of the sources with this hash, by the rules of the module.

    Parameters
    ----------
    key : str
        Hash of the sources, the folder's name.
    parents : sequence of Path, optional
        Instead of `candidates`.
    """
    for parent in candidates() if parents is None else parents:
        if found := kept_in(parent, key):
            with contextlib.suppress(OSError):
                _forget_old_kernels(found)
            return str(found)
    return _for_this_process()


def candidates() -> list[Path]:
    """Folders in which kernels may be kept, the first choice first; none of them need be there."""
    found = []
    if root := os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME"):
        found.append(Path(root) / "ship_gym")
    with contextlib.suppress(RuntimeError):  # a user id without a home
        if (home := Path.home()).is_dir():
            found.append(home / ".cache" / "ship_gym")
    user = f"-{os.getuid()}" if hasattr(os, "getuid") else ""
    return [*found, Path(tempfile.gettempdir()) / f"ship_gym{user}"]


def kept_in(parent: Path, key: str) -> Path | None:
    """Folder `key` in `parent`, both made if they are missing; None if it must not be used."""
    try:
        parent.parent.mkdir(parents=True, exist_ok=True)
        for folder in (parent, parent / key):
            folder.mkdir(mode=0o700, exist_ok=True)
            if folder == parent:
                _close_to_others(folder)
            if not is_own(folder):
                return None
        with tempfile.TemporaryFile(dir=parent / key):  # os.access says yes to root
            pass
    except OSError:
        return None
    return parent / key


def _close_to_others(folder: Path) -> None:
    """Take the right to write from others, whatever the umask was.

    What lies in the folder is judged by itself.
    """
    state = folder.lstat()
    if _owned(state) and stat.S_IMODE(state.st_mode) & _OTHERS_WRITE:
        folder.chmod(0o700)


def is_own(folder: Path) -> bool:
    """Whether this is a real directory of this user that nobody else can write to."""
    state = folder.lstat()
    if not stat.S_ISDIR(state.st_mode):
        return False
    if not hasattr(os, "getuid"):
        return True
    return _owned(state) and not state.st_mode & _OTHERS_WRITE


def _owned(state: os.stat_result) -> bool:
    return hasattr(os, "getuid") and stat.S_ISDIR(state.st_mode) and state.st_uid == os.getuid()


def _for_this_process() -> str:
    """A new folder of mode 0700, removed when this process (not a fork of it) ends."""
    folder, owner = tempfile.mkdtemp(prefix="ship_gym-"), os.getpid()

    def remove() -> None:
        if os.getpid() == owner:
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)
    return folder


@contextlib.contextmanager
def one_at_a_time(folder: str) -> Iterator[None]:
    """Let other processes of this machine wait that do the same with a folder.

    Where a file system knows no locks nobody waits.
    """
    Path(folder).mkdir(parents=True, exist_ok=True)
    with open(Path(folder) / "lock", "a", encoding="utf-8") as file:
        with contextlib.suppress(OSError):
            _lock(file)
        yield  # closing the file ends the lock


def _lock(file: IO[str]) -> None:
    if sys.platform == "win32":
        import msvcrt

        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX)


def _forget_old_kernels(folder: Path) -> None:
    """Remove compiled kernels of other sources that nobody has used for a month."""
    os.utime(folder)  # "used now"
    month_ago = time.time() - _UNUSED
    for other in folder.parent.glob("?" * len(folder.name)):
        if is_own(other) and other.lstat().st_mtime < month_ago:
            shutil.rmtree(other, ignore_errors=True)
