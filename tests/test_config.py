import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import (
    ConfigError,
    build,
    check_angle,
    check_known,
    check_number,
    merged,
    read_csv,
    read_toml,
)

HEADER = "# title: t\n# source: s\n# obtained: o\n# conventions: c\n"


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


def test_read_csv(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(HEADER + "J [-],beta [deg],grid\n0.5,90,G1\n0.6,180,G2\n")
    table = read_csv(path)
    assert table.header["source"] == "s"
    np.testing.assert_allclose(table.si("beta"), [math.pi / 2, math.pi])
    assert table.where(grid="G2").columns["J"].tolist() == [0.6]
    assert table.rows.tolist() == [6, 7]
    with pytest.raises(ConfigError, match=r"no column 'bta'; did you mean 'beta'"):
        table.require("bta")


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("J [-]\n0.5\n", "# title"),
        (HEADER.replace("# source: s\n", "") + "J [-]\n0.5\n", "# source"),
        (HEADER + "J [-]\n", "at least one row"),
        (HEADER + "J [-],b [-]\n0.5\n", ":6: 1 cells, but 2 columns"),
        (HEADER + "J [-]\nhalf\n", ":6: J = 'half'"),
        (HEADER + "J [-]\nnan\n", ":6: J = nan"),
        (HEADER + "J,b\n0.5,1\n", "unit in brackets"),
    ],
)
def test_read_csv_refuses(tmp_path, text, word):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(ConfigError) as error:
        read_csv(path)
    assert word in str(error.value)
