import contextlib
import errno
import os
import pickle
import socket
import subprocess
import sys

import pytest

from ship_gym.config import ConfigError
from ship_gym.writing import DiskFull, atomic_path, check_place, full_disk_named, no_space, sweep


def test_interrupted_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "out" / "a.txt"
    with atomic_path(path) as temporary:
        temporary.write_text("old")
    with pytest.raises(RuntimeError), atomic_path(path) as temporary:
        temporary.write_text("half of the n")
        raise RuntimeError("interrupted")
    assert path.read_text() == "old"
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]


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
        "import os, sys; from pathlib import Path; from ship_gym.writing import atomic_path\n"
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


def strays(folder):
    return [name for name in os.listdir(folder) if ".ship_gym.tmp" in name]


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
