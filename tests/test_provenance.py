from ship_gym.provenance import git_commit, provenance, sha256


def test_provenance_names_versions_and_commit():
    found = provenance()
    assert {"python", "numpy", "numba", "ship-gym"} <= set(found["versions"])
    assert len(git_commit().removesuffix("-dirty")) in (40, len("no git checkout"))


def test_sha256(tmp_path):
    (tmp_path / "a").write_bytes(b"abc")
    assert sha256(tmp_path / "a").startswith("ba7816bf8f01cfea")
