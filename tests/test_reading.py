"""Files of every format, whole and damaged: one line of at most 300 characters."""

import io
import json
import os
import pickle
import zipfile

import numpy as np
import pytest

from ship_gym import reading
from ship_gym.config import LONGEST, ConfigError
from ship_gym.reading import read_bytes, read_json, read_npy, read_npz, read_text, read_toml

READERS = {"toml": read_toml, "json": read_json, "npz": read_npz}
DEEP = 50_000


class Payload:
    """What a pickle would run."""

    def __reduce__(self):
        return os._exit, (77,)


def npz(**arrays) -> bytes:
    made = io.BytesIO()
    np.savez_compressed(made, **arrays)
    return made.getvalue()


WHOLE = npz(values=np.arange(3.0))
DAMAGED = [
    ("toml", b""[:0] + b"a = ", "not a valid TOML file"),
    ("toml", b"a = " + b"[" * DEEP, "nested too deep"),
    ("toml", b"a = " + b"9" * 5000, "not a valid TOML file"),
    ("toml", b"a = \xff", "not in UTF-8"),
    ("json", b"", "not valid JSON"),
    ("json", b"[" * DEEP, "nested too deep"),
    ("json", b'{"a": NaN}', "NaN is no number of JSON"),
    ("json", b"[-Infinity]", "-Infinity is no number of JSON"),
    ("json", b"1" + b"0" * 5000, "not valid JSON"),
    ("json", b'"' + b"x" * 5000, "not valid JSON"),
    ("npz", b"", "not an npz file"),
    ("npz", WHOLE[:-40], "not an npz file"),
    ("npz", WHOLE.replace(WHOLE[60:70], bytes(10)), "not an npz file"),
    ("npz", pickle.dumps(Payload()), "not an npz file"),
    ("npz", npz(values=np.array([Payload()], dtype=object)), "not an npz file"),
]


@pytest.mark.parametrize(("kind", "data", "told"), DAMAGED)
def test_a_damaged_file_is_one_line(tmp_path, kind, data, told):
    path = tmp_path / f"file.{kind}"
    path.write_bytes(data)
    with pytest.raises(ConfigError) as caught:
        READERS[kind](path)
    text = str(caught.value)
    assert told in text
    assert path.name in text
    assert len(text) <= LONGEST
    assert "\n" not in text


def test_whole_files(tmp_path):
    (tmp_path / "a.toml").write_text("a = 1\n")
    (tmp_path / "a.json").write_text(json.dumps({"a": [1, 2.5, None]}))
    (tmp_path / "a.npz").write_bytes(WHOLE)
    assert read_toml(tmp_path / "a.toml") == {"a": 1}
    assert read_json(tmp_path / "a.json") == {"a": [1, 2.5, None]}
    np.testing.assert_array_equal(read_npz(tmp_path / "a.npz", "values")["values"], [0, 1, 2])
    with pytest.raises(ConfigError, match="no array 'axes'"):
        read_npz(tmp_path / "a.npz", "values", "axes")


@pytest.mark.parametrize("read", [read_npz, read_npy])
def test_nobody_is_advised_to_run_a_pickle(tmp_path, read):
    path = tmp_path / "a.npz"
    for data in (pickle.dumps({}), b""):
        path.write_bytes(data)
        with pytest.raises(ConfigError) as caught:
            read(path)
        assert "trust" not in str(caught.value)
    np.savez(path, a=np.array([{}], dtype=object))
    with pytest.raises(ConfigError, match=r"a\.npz: not an np[yz] file"):
        read(path)


def test_one_array_without_a_name_is_no_npz(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros(3))
    with pytest.raises(ConfigError, match="without a name"):
        read_npz(tmp_path / "a.npy")


def test_what_is_no_file_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path, "/dev/zero"):
        with pytest.raises(ConfigError, match=r"allowed is a file|cannot be read"):
            read_bytes(path)
    with pytest.raises(ConfigError, match="no such file"):
        read_text(tmp_path / "none")
    with pytest.raises(ConfigError, match="no file has such a name"):
        read_text("a\0b")


def test_a_file_larger_than_memory_should_be_is_not_read(tmp_path):
    path = tmp_path / "bomb.npz"
    path.write_bytes(npz(values=np.zeros(10_000)))
    with zipfile.ZipFile(path) as archive, pytest.raises(ValueError, match="at most 1000"):
        reading.check_unpacked(archive, most=1000)
    with pytest.raises(ConfigError, match="allowed are at most 10"):
        read_bytes(path, most=10)
