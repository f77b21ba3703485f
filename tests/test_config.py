import dataclasses
import math
import time

import pytest

from ship_gym.config import (
    LONGEST,
    ConfigError,
    build,
    check_angle,
    check_known,
    check_number,
    cut,
    merged,
)
from ship_gym.reading import read_text, read_toml


@dataclasses.dataclass(frozen=True)
class Inner:
    rate: float
    on: bool = True


@dataclasses.dataclass(frozen=True)
class Outer:
    name: str
    inner: Inner
    values: tuple[float, ...] = ()
    limit: float | None = None


def test_build_converts_and_nests():
    made = build(Outer, {"name": "a", "inner": {"rate": 2}, "values": [1, 2.5]}, "f")
    assert made == Outer("a", Inner(2.0), (1.0, 2.5))
    assert isinstance(made.inner.rate, float)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"name": "a", "inner": {"rate": 1.0}, "limt": 3}, ["limt", "did you mean 'limit'"]),
        ({"name": "a"}, ["missing key 'inner'"]),
        ({"name": "a", "inner": {"rate": "fast"}}, ["f.inner.rate", "fast"]),
        ({"name": "a", "inner": {"rate": 1.0, "on": 1}}, ["f.inner.on", "bool"]),
        ({"name": 3, "inner": {"rate": 1.0}}, ["f.name", "str"]),
        ({"name": "a", "inner": {"rate": math.nan}}, ["f.inner.rate"]),
        ({"name": "a", "inner": 5}, ["f.inner", "table"]),
    ],
)
def test_build_refuses(values, words):
    with pytest.raises(ConfigError) as error:
        build(Outer, values, "f")
    for word in words:
        assert word in str(error.value)


def test_merged_is_deep_and_leaves_the_base():
    base = {"a": {"b": 1, "c": 2}}
    assert merged(base, {"a": {"c": 3}}) == {"a": {"b": 1, "c": 3}}
    assert base == {"a": {"b": 1, "c": 2}}


def test_check_angle_sees_degrees():
    assert check_angle("delta", 0.5) == 0.5
    with pytest.raises(ConfigError, match="looks like degrees"):
        check_angle("delta", 35.0)
    with pytest.raises(ConfigError, match="looks like degrees"):
        check_angle("delta", 20.0, limit=math.radians(35))
    with pytest.raises(ConfigError, match="finite"):
        check_angle("delta", math.nan)


def test_check_number_and_known():
    with pytest.raises(ConfigError, match=r"speed = -1.*0 to 10"):
        check_number("speed", -1, 0, 10, "m/s")
    with pytest.raises(ConfigError, match="must be a number"):
        check_number("speed", "fast")
    with pytest.raises(ConfigError, match="did you mean 'kcs'"):
        check_known("ship", "kcss", ["kcs", "onrt"])


def test_read_toml_errors_name_the_file(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        read_toml(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("a = = 1")
    with pytest.raises(ConfigError, match=r"bad\.toml"):
        read_toml(tmp_path / "bad.toml")


MARKED = ("utf-8-sig", "utf-16", "utf-32")  # Python writes a byte order mark with these


@pytest.mark.parametrize("encoding", ["utf-8", *MARKED])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_toml_of_any_marked_encoding(tmp_path, encoding, end):
    path = tmp_path / "a.toml"
    path.write_bytes(f'title = "Müller"{end}L = 7.0{end}'.encode(encoding))
    assert read_toml(path) == {"title": "Müller", "L": 7.0}


@pytest.mark.parametrize("order", ["le", "be"])
def test_utf_16_of_both_byte_orders(tmp_path, order):
    path = tmp_path / "a.toml"
    path.write_bytes("\ufeffL = 7.0\n".encode(f"utf-16-{order}"))
    assert read_toml(path) == {"L": 7.0}


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b'L = 7.0\ntitle = "M\xfcller"\n', r"a.toml:2: not in UTF-8 \(byte 0xfc\); save the file"),
        ("L = 7.0\n".encode("utf-16-le"), "zero bytes: .* UTF-16 without a byte order mark; save"),
        (b"\xff\xfeL\0 ", "not in UTF-16-LE .*; save the file as UTF-8"),
        (b"PK\x03\x04\0\0", "a workbook, not a text file; save the sheet as 'CSV UTF-8'"),
    ],
)
def test_other_bytes_are_refused_with_what_to_do(tmp_path, data, words):
    path = tmp_path / "a.toml"
    path.write_bytes(data)
    with pytest.raises(ConfigError, match=words) as error:
        read_toml(path)
    assert "\n" not in str(error.value)


def test_read_text_falls_back_only_where_it_may(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"M\xfcller\r\nK\xf6ln\r")
    text = "Müller\nKöln\n"
    assert read_text(path, fallback="cp1252") == text
    with pytest.raises(ConfigError, match="not in UTF-8"):
        read_text(path)
    with pytest.raises(ConfigError, match="cannot be read"):
        read_text(tmp_path)


def test_a_long_line_loses_the_beginning_of_a_path_in_no_time():
    path = f"/tmp/{'folder/' * 60}mine.toml"
    assert cut(f"{path}: x = 7") == ".../folder/folder/mine.toml: x = 7"
    start = time.process_time()
    assert max(len(cut(c * 200_000)) for c in ("a", "/", "a/", "'")) <= LONGEST
    assert time.process_time() - start < 2.0
