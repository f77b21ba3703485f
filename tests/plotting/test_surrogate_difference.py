"""Difference map of two surrogates: the numbers behind it, the picture, and refusals."""

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting.surrogate_difference import difference, plot_difference
from ship_gym.plotting.surrogate_maps import response
from ship_gym.ships.loader import load_ship


@pytest.fixture(scope="module")
def pair():
    return load_ship("kcs_model"), load_ship("kcs_model", surrogate="G3_SA")


def test_a_surrogate_does_not_differ_from_itself(pair):
    _, found = difference(pair[0], pair[0], 5)
    assert set(found["single"]) == {"K_T", "10K_Q", "C_Fx", "C_Fy"}
    for values in found["single"].values():
        assert np.nanmax(np.abs(values)) == 0.0


def test_difference_is_in_percent_of_the_other(pair):
    """At one place of the map, by the kernels."""
    (J, beta), found = difference(*pair, 5)
    first, second = (response(s, float(J[2]), float(beta[3])) for s in pair)
    for name, values in found["single"].items():
        assert values.shape == (5, 5)
        expected = 100.0 * (first[name] / second[name] - 1.0)
        assert values[3, 2] == pytest.approx(expected, rel=1e-9), name


def test_picture_and_its_numbers(tmp_path, pair):
    sizes = plot_difference(*pair, tmp_path / "d.png")["single"]
    assert (tmp_path / "d.png").read_bytes()[:4] == b"\x89PNG"
    for size in sizes.values():
        assert 0.0 < size["mean"] < size["largest"]


def test_ships_that_cannot_be_compared():
    kcs = load_ship("kcs_model")
    with pytest.raises(ConfigError, match="no surrogate to compare"):
        difference(kcs, load_ship("kvlcc2_model"))
    with pytest.raises(ConfigError, match="cannot be compared"):
        difference(kcs, load_ship("onrt_model"))
