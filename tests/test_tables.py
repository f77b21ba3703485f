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
