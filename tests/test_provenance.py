import contextlib
import errno
import os
import pickle
import shutil
import socket
import subprocess
import sys

import pytest

from ship_gym.config import ConfigError
from ship_gym.provenance import (
    DiskFull,
    atomic_path,
    check_own,
    check_place,
    full_disk_named,
    git_commit,
    held,
    locked,
    no_space,
    provenance,
    sha256,
    sweep,
)


def test_interrupted_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "out" / "a.txt"
    with atomic_path(path) as temporary:
        temporary.write_text("old")
    with pytest.raises(RuntimeError), atomic_path(path) as temporary:
        temporary.write_text("half of the n")
        raise RuntimeError("interrupted")
    assert path.read_text() == "old"
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]


def test_provenance_names_versions_and_commit():
    found = provenance()
    assert {"python", "numpy", "numba", "ship-gym"} <= set(found["versions"])
    assert len(git_commit().removesuffix("-dirty")) in (40, len("no git checkout"))


def test_sha256(tmp_path):
    (tmp_path / "a").write_bytes(b"abc")
    assert sha256(tmp_path / "a").startswith("ba7816bf8f01cfea")


def test_a_place_is_tried_and_left_as_it_was(tmp_path):
    (tmp_path / "a.json").write_text("kept")
    assert check_place(tmp_path / "a.json", "--out") == tmp_path / "a.json"
    check_place(tmp_path / "new" / "deeper" / "b.json", "--out")
    check_place(tmp_path / "run", "--out", folder=True)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a.json", "kept")]


@pytest.mark.parametrize(
    ("place", "folder", "reason"),
    [
        ("folder", False, "that is a folder"),
        ("file", True, "file is a file, not a folder"),
        ("file/below/x", False, "file is a file, not a folder"),
        ("lost/x", False, "lost is a file, not a folder"),
        ("x" * 300, False, "file name too long"),
    ],
)
def test_a_place_that_cannot_be_is_refused(tmp_path, place, folder, reason):
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    (tmp_path / "lost").symlink_to(tmp_path / "nowhere")
    where = rf"{tmp_path}/{place}" if len(place) < 20 else r"\S+\.\.\.x+"
    with pytest.raises(ConfigError, match=f"^--to {where}: .*{reason}$"):
        check_place(tmp_path / place, "--to", folder)


def test_a_place_without_permission_is_refused(tmp_path, monkeypatch):
    def refuse(**_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    with pytest.raises(ConfigError, match=f"cannot write into {tmp_path}: permission denied"):
        check_place(tmp_path / "x", "--to")


@pytest.fixture(params=["device", "pipe", "socket", "folder", "link to itself"])
def no_file(request, tmp_path):
    """Something that no file can be written to, and what it is called."""
    path = tmp_path / "x.json"
    if request.param == "device":
        path.symlink_to("/dev/null")
    elif request.param == "pipe":
        os.mkfifo(path)
    elif request.param == "socket":
        with socket.socket(socket.AF_UNIX) as one, contextlib.chdir(tmp_path):
            one.bind(path.name)
    elif request.param == "folder":
        path.mkdir()
    else:
        path.symlink_to(path)
    return path, request.param


@pytest.mark.skipif(os.name == "nt", reason="has none of them")
def test_only_a_regular_file_or_a_new_one_is_written(no_file):
    path, what = no_file
    before = os.lstat(path)
    with pytest.raises(ConfigError, match=rf"^--to {path}: (that is )?a {what}"):
        check_place(path, "--to")
    with pytest.raises(ConfigError, match=rf"^{path}: (that is )?a {what}"), atomic_path(path):
        pytest.fail("was given a place")
    assert os.path.samestat(before, os.lstat(path)) and len(os.listdir(path.parent)) == 1
    assert not os.path.isfile("/dev/null")


@pytest.mark.skipif(os.name == "nt", reason="links need a right there")
def test_links_stay_and_their_target_is_replaced_with_its_mode(tmp_path):
    target, link, further = tmp_path / "in" / "a.txt", tmp_path / "b.txt", tmp_path / "c.txt"
    target.parent.mkdir()
    target.write_text("old")
    target.chmod(0o640)
    link.symlink_to(target)
    further.symlink_to("b.txt")
    with atomic_path(further) as temporary:
        assert temporary.parent == target.parent
        temporary.write_text("new")
    assert link.is_symlink() and further.is_symlink() and target.read_text() == "new"
    assert target.stat().st_mode & 0o777 == 0o640
    target.unlink()
    with atomic_path(check_place(further, "--to")) as temporary:  # links to what is not there yet
        temporary.write_text("again")
    assert link.is_symlink() and target.read_text() == "again"


@pytest.mark.skipif(os.name == "nt", reason="has no locks of open files")
def test_what_a_killed_writer_left_is_swept_and_what_a_living_one_writes_is_not(tmp_path):
    write = (
        "import os, sys; from pathlib import Path; from ship_gym.provenance import atomic_path\n"
        f"with atomic_path({str(tmp_path / 'a.json')!r}) as path:\n"
        "    path.write_text('half'); os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", write], check=False)
    assert len(strays(tmp_path)) == 1
    (tmp_path / ".my-settings.json").write_text("a user's own")
    (tmp_path / ".diary-20261127.tmp.txt").write_text("of another program")
    with atomic_path(tmp_path / "b.json") as living:
        sweep(tmp_path, tmp_path / "other.json")
        assert len(strays(tmp_path)) == 2, "others than of this file stay"
        check_place(tmp_path / "a.json", "--to")
        assert strays(tmp_path) == [living.name]
        sweep(tmp_path)
        living.write_text("whole")
    assert sorted(os.listdir(tmp_path)) == [
        ".diary-20261127.tmp.txt",
        ".my-settings.json",
        "b.json",
    ]


@pytest.mark.skipif(os.name == "nt", reason="links need a right there")
def test_links_out_of_a_folder_of_a_run_are_refused_and_others_are_not(tmp_path):
    precious, run = tmp_path / "precious", tmp_path / "run"
    precious.write_text("mine")
    run.mkdir()
    (run / "inside.csv").symlink_to("card.json")
    (tmp_path / "link").symlink_to(run)
    check_own(tmp_path / "link", ["inside.csv", "card.json"])
    (run / "card.json").symlink_to("../precious")
    with pytest.raises(ConfigError, match=r"card\.json: a link to \.\./precious"):
        check_own(run, ["card.json"])
    (run / "lock").symlink_to(precious)
    with pytest.raises(ConfigError, match="lock: a link"), locked(run / "lock", "trains"):
        pytest.fail("was let in")
    assert precious.read_text() == "mine"


def test_a_file_system_without_locks_is_told_of(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")

    def none(file, how):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    with (
        pytest.warns(UserWarning, match=r"a\.json: no lock: No locks"),
        held(tmp_path / "a.json", "works"),
    ):
        (tmp_path / "a.json").write_text("{}")
    assert os.listdir(tmp_path) == ["a.json"]


def strays(folder):
    return [name for name in os.listdir(folder) if ".ship_gym.tmp" in name]


def test_a_file_is_held_by_one_process(tmp_path):
    path = tmp_path / "a.toml"
    with held(path, "tunes into this file"):
        with pytest.raises(ConfigError) as caught, held(path, "tunes into this file"):
            pytest.fail("was let in")
        assert str(caught.value).startswith(f"{path}: another process (pid {os.getpid()}) tunes")
    with held(path, "tunes into this file"):
        pass
    assert not os.listdir(tmp_path) or os.name == "nt"
    with pytest.raises(RuntimeError), held(tmp_path / "new" / "deeper" / "a.toml", "tunes"):
        raise RuntimeError("refused")
    assert not os.listdir(tmp_path) or os.name == "nt"


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EFBIG, errno.EDQUOT])
def test_a_full_disk_names_the_file_and_leaves_the_old_one(tmp_path, number):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(DiskFull) as caught, atomic_path(path) as temporary:
        temporary.write_text("half of the n")
        raise OSError(number, os.strerror(number))
    reason = os.strerror(number).lower()
    assert str(caught.value) == f"{path}: {reason}; nothing was written to it"
    assert path.read_text() == "old" and [p.name for p in tmp_path.iterdir()] == ["a.txt"]
    again = pickle.loads(pickle.dumps(caught.value))  # as from another process
    assert isinstance(again, DiskFull) and str(again) == str(caught.value) and no_space(again)


def test_a_full_disk_behind_an_error_of_a_library_is_found(tmp_path):
    with pytest.raises(DiskFull, match="x: no space left"), full_disk_named("x"):
        try:
            raise OSError(errno.ENOSPC, "No space left on device")
        except OSError:
            raise RuntimeError("the writer broke")  # noqa: B904, as libraries do
    with pytest.raises(RuntimeError, match="another"), full_disk_named("x"):
        raise RuntimeError("another")


@pytest.mark.skipif(os.name == "nt", reason="removes no open file")
def test_a_lock_leaves_nothing_where_nothing_was_written(tmp_path):
    (tmp_path / "mine").mkdir()
    for folder in ("mine", "runs/new"):
        lock = tmp_path / folder / "lock"
        with locked(lock, "trains"):
            assert lock.is_file()
            with pytest.raises(ConfigError), locked(lock, "trains"):
                pytest.fail("was let in")
            assert lock.is_file(), "who is refused removes nothing"
    assert os.listdir(tmp_path) == ["mine"] and os.listdir(tmp_path / "mine") == []
    with locked(tmp_path / "runs/lock", "trains"):
        (tmp_path / "runs/card.json").write_text("{}")
    assert sorted(os.listdir(tmp_path / "runs")) == ["card.json", "lock"]
    with locked(lock, "trains"):  # another's, made since the folder was removed, stays
        shutil.rmtree(lock.parent)
        lock.parent.mkdir()
        lock.write_text("1\n")
    assert lock.read_text() == "1\n"


@pytest.mark.skipif(os.name == "nt", reason="removes no open file")
def test_many_who_take_a_lock_at_once_hold_it_one_by_one(tmp_path):
    take = (
        "import os, sys; from ship_gym.provenance import locked; from ship_gym.config import "
        f"ConfigError\nheld = {str(tmp_path / 'held')!r}\n"
        "for _ in range(300):\n"
        "    try:\n"
        f"        with locked({str(tmp_path / 'run' / 'lock')!r}, 'trains'):\n"
        "            os.close(os.open(held, os.O_CREAT | os.O_EXCL)); os.unlink(held)\n"
        "    except ConfigError: pass\n"
    )
    both = [subprocess.Popen([sys.executable, "-c", take]) for _ in range(2)]
    assert [one.wait() for one in both] == [0, 0]
    # one who came between the other's last two steps leaves the folder that it has not made
    assert not [path for path in tmp_path.rglob("*") if path != tmp_path / "run"]
