import io
import json

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.tables import Axis, Table, tabulate

X, Y = Axis("x", -1.0, 0.1, 21), Axis("y", 0.0, 0.25, 9)


def plane(x, y):
    return np.stack([1.0 + 2.0 * x - 3.0 * y, x * y], axis=-1)


def test_bilinear_is_exact_for_bilinear_functions_and_clamps():
    table = tabulate(plane, (X, Y), ("a", "b"))
    x, y = np.random.default_rng(0).uniform([-1, 0], [1, 2], (50, 2)).T
    np.testing.assert_allclose(table(x, y), plane(x, y), atol=1e-12)
    np.testing.assert_allclose(table(9.0, -4.0), plane(np.array(1.0), np.array(0.0)), atol=1e-12)


def test_one_axis():
    table = tabulate(lambda x: x[..., None] ** 2, (X,), ("a",), tolerance=0.01)
    assert abs(table(0.5)[0] - 0.25) < 1e-12
    assert 0.0 < table.card["interpolation_error"]["a"] < 0.01


def test_too_coarse_a_grid_is_refused_with_the_quantity():
    with pytest.raises(ConfigError, match=r"table of wave: interpolation error .* finer grid"):
        tabulate(lambda x: np.sin(20 * x)[..., None], (X,), ("wave",))


def test_save_and_load_give_the_same_bits(tmp_path):
    table = tabulate(plane, (X, Y), ("a", "b"), {"source": "test"})
    table.save(tmp_path / "t.npz")
    again = Table.load(tmp_path / "t.npz")
    assert again.axes == table.axes and again.names == table.names and again.card == table.card
    assert (again.values == table.values).all()
    table.save(tmp_path / "u.npz")
    assert (tmp_path / "t.npz").read_bytes() == (tmp_path / "u.npz").read_bytes()


def test_bad_tables(tmp_path):
    with pytest.raises(ConfigError, match="no such table"):
        Table.load(tmp_path / "none.npz")
    (tmp_path / "bad.npz").write_bytes(b"no table")
    with pytest.raises(ConfigError, match="not a table file"):
        Table.load(tmp_path / "bad.npz")
    with pytest.raises(ConfigError, match=r"table values\[0, 0\] = nan: allowed"):
        Table((X,), ("a",), np.full((21, 1), np.nan))
    with pytest.raises(ConfigError, match="shape"):
        Table((X,), ("a",), np.zeros((20, 1)))
    with pytest.raises(ConfigError, match="did you mean"):
        tabulate(plane, (X, Y), ("alpha", "b")).channel("alpa")


def written(path, **changes):
    """A file of a good table with other arrays or other entries of its text; None: left out."""
    meta = {"axes": [vars(X) | {}], "names": ["a"], "card": {}}
    values = changes.pop("values", np.zeros((21, 1)))
    text = changes.pop(
        "text", json.dumps({k: v for k, v in (meta | changes).items() if v is not None})
    )
    arrays = {"values": values, "meta": np.frombuffer(text.encode(), np.uint8)}
    np.savez(path, **{k: v for k, v in arrays.items() if v is not None})
    return path


AXIS = {"name": "x", "start": 0.0, "step": 0.1, "count": 21}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"values": None}, "not a table file: no array 'values'"),
        ({"values": np.full((21, 1), np.inf)}, "values[0, 0] = inf: allowed"),
        ({"values": np.full((21, 1), 1e300)}, "values[0, 0] = 1e+300: allowed"),
        ({"values": np.zeros((20, 1))}, "table values has shape (20, 1): allowed is (21, 1)"),
        ({"values": np.zeros((21, 1), np.float32)}, "of type float32: allowed is float64"),
        ({"values": np.full((21, 1), "a")}, "are of type <U1: allowed is float64"),
        ({"values": np.empty((21, 1), object)}, "not a table file, or damaged"),
        ({"text": "["}, "not valid JSON"),
        ({"text": "[" * 100_000}, "nested too deep"),
        ({"text": "[1]"}, "its text holds [1]: allowed is a mapping"),
        ({"card": None}, "missing key 'card'"),
        ({"card": 7}, "card = 7: must be a table of keys"),
        ({"axes": [float("nan")]}, "NaN is no number of JSON"),
        ({"axes": [7]}, "axes = 7"),
        ({"axes": []}, "0 axes: allowed are 1 to 3"),
        ({"axes": [AXIS | {"step": 0}]}, "step = 0.0: allowed is above 0"),
        ({"axes": [AXIS | {"step": 1e300}]}, "step = 1e+300: allowed"),
        ({"axes": [AXIS | {"count": 10**400}]}, "count = an integer of 1329 bits"),
        ({"axes": [AXIS | {"count": 1}]}, "count = 1: allowed is 2 to"),
        ({"axes": [AXIS | {"stop": 1.0}]}, "unknown key 'stop'"),
        ({"axes": [{"name": "x", "start": 0.0, "step": 1.0}]}, "missing key 'count'"),
        ({"names": []}, "names = (): each is allowed once, none not"),
        ({"names": [1]}, "names = 1: must be of type str"),
    ],
)
def test_a_damaged_table_is_one_line(tmp_path, changes, words):
    path = written(tmp_path / "t.npz", **changes)
    with pytest.raises(ConfigError) as error:
        Table.load(path)
    text = str(error.value)
    assert words in text and str(path) in text and "\n" not in text and len(text) <= 300


def test_bytes_that_are_no_table(tmp_path):
    tabulate(plane, (X, Y), ("a", "b")).save(tmp_path / "t.npz")
    whole = (tmp_path / "t.npz").read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 255
    single = io.BytesIO()
    np.save(single, np.zeros(3))
    for data in (b"", whole[:50], whole[:-10], bytes(flipped), single.getvalue()):
        (tmp_path / "t.npz").write_bytes(data)
        with pytest.raises(ConfigError, match=r"not a table file"):
            Table.load(tmp_path / "t.npz")
