import errno
import os
import pickle

import pytest

from ship_gym.config import ConfigError
from ship_gym.provenance import (
    DiskFull,
    atomic_path,
    check_place,
    full_disk_named,
    git_commit,
    no_space,
    provenance,
    sha256,
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
    with pytest.raises(ConfigError, match=f"^--to {tmp_path}/{place[:60]}.*: .*{reason}$"):
        check_place(tmp_path / place, "--to", folder)


def test_a_place_without_permission_is_refused(tmp_path, monkeypatch):
    def refuse(**_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    with pytest.raises(ConfigError, match=f"cannot write into {tmp_path}: permission denied"):
        check_place(tmp_path / "x", "--to")


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
