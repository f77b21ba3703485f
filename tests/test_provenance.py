import pytest

from ship_gym.provenance import atomic_path, git_commit, provenance, sha256


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
