"""Where compiled kernels are kept; the suite may run as root, whom no mode stops."""

import os
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from ship_gym.physics import _cache
from ship_gym.physics._cache import cache_folder, candidates, is_own, kept_in

KEY = "0123456789abcdef"
posix = pytest.mark.skipif(not hasattr(os, "getuid"), reason="owners and modes are of POSIX")


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """No folder of the user who runs the suite: home, cache and temporary directory in tmp_path."""
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    return tmp_path


def made(path, mode=0o700):
    path.mkdir(parents=True, exist_ok=True)
    path.chmod(mode)
    return path


def test_the_order_of_choices(elsewhere, monkeypatch):
    user = f"-{os.getuid()}" if hasattr(os, "getuid") else ""
    temporary = elsewhere / "tmp" / f"ship_gym{user}"
    assert candidates() == [temporary]  # a home that is not there is not made
    made(elsewhere / "home")
    assert candidates() == [elsewhere / "home" / ".cache" / "ship_gym", temporary]
    monkeypatch.setenv("XDG_CACHE_HOME", str(elsewhere / "xdg"))
    assert candidates()[0] == elsewhere / "xdg" / "ship_gym" and len(candidates()) == 3
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(elsewhere / "numba"))
    assert candidates()[0] == elsewhere / "numba" / "ship_gym" and len(candidates()) == 3
    assert cache_folder(KEY) == str(elsewhere / "numba" / "ship_gym" / KEY)


def test_a_user_without_a_home(elsewhere, monkeypatch):
    def none():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", none)
    assert [path.parent for path in candidates()] == [elsewhere / "tmp"]


@posix
def test_a_new_folder_is_closed_whatever_the_umask(elsewhere):
    before = os.umask(0)
    try:
        folder = kept_in(elsewhere / "deep" / "ship_gym", KEY)
    finally:
        os.umask(before)
    assert folder == elsewhere / "deep" / "ship_gym" / KEY
    for path in (folder, folder.parent):
        assert stat.S_IMODE(path.stat().st_mode) == 0o700
    assert kept_in(elsewhere / "deep" / "ship_gym", KEY) == folder  # again


@posix
def test_a_folder_of_an_earlier_version_is_closed_but_not_what_lies_in_it(elsewhere):
    parent = made(elsewhere / "ship_gym", 0o775)
    assert kept_in(parent, KEY) == parent / KEY
    assert stat.S_IMODE(parent.stat().st_mode) == 0o700
    (parent / KEY).chmod(0o770)  # its group may have put anything there
    assert kept_in(parent, KEY) is None
    (parent / KEY).chmod(0o702)
    assert kept_in(parent, KEY) is None


@posix
@pytest.mark.parametrize("level", ["parent", "folder"])
def test_links_and_files_are_not_followed(elsewhere, level):
    parent = elsewhere / "ship_gym"
    there = parent if level == "parent" else made(parent) / KEY
    other = made(elsewhere / "other")
    made(other / KEY)
    there.symlink_to(other)
    assert kept_in(parent, KEY) is None
    assert list((other / KEY).iterdir()) == []
    there.unlink()
    there.write_text("a file")
    assert kept_in(parent, KEY) is None


@posix
@pytest.mark.parametrize("level", ["parent", "folder"])
def test_a_folder_of_another_user_is_not_used(elsewhere, monkeypatch, level):
    """The folder looks right in all but its owner."""
    parent = made(elsewhere / "ship_gym")
    theirs = parent if level == "parent" else made(parent / KEY)
    inode, real = theirs.stat().st_ino, Path.lstat

    def lstat(path):
        state = real(path)
        if state.st_ino != inode:
            return state
        return os.stat_result([*state[:4], os.getuid() + 1, *state[5:]])

    assert is_own(theirs)
    monkeypatch.setattr(Path, "lstat", lstat)
    assert not is_own(theirs) and kept_in(parent, KEY) is None
    own = elsewhere / "own" / "ship_gym"
    assert cache_folder(KEY, [parent, own]) == str(own / KEY)


def test_a_home_under_a_file_and_a_disk_that_is_full(elsewhere, monkeypatch):
    (elsewhere / "file").write_text("")
    assert kept_in(elsewhere / "file" / "home" / ".cache" / "ship_gym", KEY) is None

    def full(**_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    assert kept_in(elsewhere / "ship_gym", KEY) is None


def test_without_users_as_on_windows(elsewhere, monkeypatch):
    monkeypatch.delattr(os, "getuid", raising=False)
    assert candidates() == [elsewhere / "tmp" / "ship_gym"]
    assert cache_folder(KEY) == str(elsewhere / "tmp" / "ship_gym" / KEY)


def test_kernels_of_other_sources_are_forgotten_after_a_month(elsewhere):
    parent = elsewhere / "ship_gym"
    old, young, foreign = (parent / (letter * 16) for letter in "abc")
    for path in (old, young):
        made(path)
    made(elsewhere / "other")
    foreign.symlink_to(elsewhere / "other")
    keep = made(parent / "another name")
    long_ago = time.time() - 31 * 86400.0
    for path in (old, keep, elsewhere / "other"):
        os.utime(path, (long_ago, long_ago))
    assert cache_folder(KEY, [parent]) == str(parent / KEY)
    assert not old.exists() and young.exists() and keep.exists() and (elsewhere / "other").exists()


def run(code, tmp_path, **environment):
    """What a process prints, with no folder of the user who runs the suite."""
    (tmp_path / "tmp").mkdir(exist_ok=True)
    names = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME")
    kept = {name: value for name, value in os.environ.items() if name not in names}
    kept |= {"TMPDIR": str(tmp_path / "tmp"), "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, env=kept | environment, capture_output=True, text=True, check=True, timeout=120
    )
    return done.stdout.split()


@posix
@pytest.mark.compiled
@pytest.mark.parametrize("home", ["missing/home", "file/home"])
def test_without_a_usable_home_kernels_are_compiled_once(tmp_path, home):
    (tmp_path / "file").write_text("")
    (tmp_path / "tiny.py").write_text(
        "from ship_gym.physics._kernel import kernel\n\n\n"
        "@kernel\ndef double(x):\n    return 2.0 * x\n"
    )
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
        "import tiny; from ship_gym.physics import _kernel\n"
        "assert tiny.double(1.5) == 3.0\n"
        "print(_kernel._CACHE_FOLDER, sum(tiny.double.alone.stats.cache_hits.values()))"
    )
    first, second = (run(code, tmp_path, HOME=str(tmp_path / home)) for _ in range(2))
    folder = tmp_path / "tmp" / f"ship_gym-{os.getuid()}"
    assert Path(first[0]).parent == folder and first[0] == second[0]
    assert (first[1], second[1]) == ("0", "1")
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert [path.name for path in (tmp_path / "tmp").iterdir()] == [folder.name]


@posix
def test_a_folder_of_one_process_goes_with_it(tmp_path):
    """Nothing else can be used: home and temporary name are files. A fork leaves it alone."""
    (tmp_path / "tmp").mkdir()
    (tmp_path / "tmp" / f"ship_gym-{os.getuid()}").write_text("")
    code = (
        "import os, stat, sys; from ship_gym.physics._cache import cache_folder\n"
        f"folder = cache_folder({KEY!r})\n"
        "if os.fork() == 0: sys.exit(0)\n"
        "os.wait(); print(folder, os.path.isdir(folder), oct(os.stat(folder).st_mode)[-3:])"
    )
    folder, there, mode = run(code, tmp_path, HOME=str(tmp_path / "none"))
    assert (there, mode) == ("True", "700") and not Path(folder).exists()
    assert Path(folder).parent == tmp_path / "tmp"


def test_the_kernels_of_this_process_lie_in_a_folder_of_its_own():
    from ship_gym.physics import _kernel

    folder = Path(_kernel._CACHE_FOLDER)
    assert folder.name == _kernel.source_hash() and is_own(folder)
    assert _cache.kept_in(folder.parent, folder.name) == folder


SAVER = """
import sys, time
from ship_gym.physics import _kernel

@_kernel.loop
def total(values):
    found = 0.0
    for k in range(len(values)):
        found += values[k]
    return found

import numpy as np
print(total(np.ones(3, sys.argv[1])), len(_kernel.keep_code.__globals__["saved"]))
"""


@pytest.mark.slow
@posix
def test_processes_that_save_at_once_do_not_take_each_others_code(tmp_path):
    """Four types of one function: numba alone gives all of them the file number 1."""
    (tmp_path / "adding.py").write_text(SAVER)
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    env.pop("NUMBA_DISABLE_JIT", None)
    types = ("f8", "f4", "i8", "u1")

    def run_all():
        running = [
            subprocess.Popen(
                [sys.executable, str(tmp_path / "adding.py"), name],
                env=env, stdout=subprocess.PIPE, text=True,
            )
            for name in types
        ]  # fmt: skip
        return [one.communicate()[0].split() for one in running]

    assert run_all() == [["3.0", "1"]] * 4
    assert run_all() == [["3.0", "0"]] * 4
    codes = [path for path in (tmp_path / "cache").rglob("*.nbc") if "total" in path.name]
    assert len(codes) == 4


def test_a_lock_lets_errors_through_and_is_free_afterwards(tmp_path):
    with pytest.raises(OSError, match="full"), _cache.one_at_a_time(str(tmp_path / "new")):
        raise OSError("disk full")
    with _cache.one_at_a_time(str(tmp_path / "new")):
        pass


@pytest.mark.slow
@posix
def test_code_that_a_full_disk_cannot_keep_serves_its_process(tmp_path):
    (tmp_path / "adding.py").write_text("import resource\n" + SAVER.replace(
        "import numpy as np\n",
        "import numpy as np\nresource.setrlimit(resource.RLIMIT_FSIZE, (0, -1))\n",
    ))  # fmt: skip
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    env.pop("NUMBA_DISABLE_JIT", None)
    command = [sys.executable, str(tmp_path / "adding.py"), "f8"]
    done = subprocess.run(command, env=env, capture_output=True, text=True)
    assert done.stdout.split() == ["3.0", "0"], done.stderr
    assert "compiled code cannot be kept in" in done.stderr and "File too large" in done.stderr
    assert not [path for path in (tmp_path / "cache").rglob("*.nbc") if path.stat().st_size]
