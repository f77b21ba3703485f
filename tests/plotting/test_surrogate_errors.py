"""Errors by grid and turbulence, and the 95 % width of a process: numbers, pictures, refusals."""

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.plotting.surrogate_errors import plot_errors, plot_width, sample_errors, width_95
from ship_gym.surrogates.fit import Options, fit
from ship_gym.surrogates.samples import KCS, ONRT


@pytest.fixture(scope="module")
def regression():
    return fit(KCS)


@pytest.fixture(scope="module")
def process():
    return fit(KCS, Options("gp"))


def test_errors_are_those_of_the_printed_points(regression):
    """Point 1 of KCS: K_T on G3 and G2, and SST on G2, by hand; SST at points 1 to 4 only."""
    found = sample_errors(regression, "single")["K_T"]
    assert {k: len(v) for k, v in found.items()} == {
        "grid G1": 12, "grid G2": 12, "turbulence": 4, "regression": 4,
    }  # fmt: skip
    fine, base = (KCS.read(g, "SA", "single").values["K_T"][0] for g in ("G3", "G2"))
    other = KCS.read("G2", "SST", "single").values["K_T"][0]
    assert found["grid G2"][0] == pytest.approx(100.0 * abs(fine - base) / abs(fine))
    assert found["turbulence"][0] == pytest.approx(100.0 * abs(base - other) / abs(base))


@pytest.mark.parametrize("data", [KCS, ONRT], ids=lambda data: data.name)
def test_bars(tmp_path, data):
    means = plot_errors(fit(data), tmp_path / "e.png")
    assert (tmp_path / "e.png").read_bytes()[:4] == b"\x89PNG"
    assert set(means) == set(data.sides)
    if data is KCS:
        assert means["single"]["C_Fy"]["norm"] == pytest.approx(
            19.89, abs=0.07
        )  # section 3.2.4, Eq. 3.7


def test_width_is_twice_1_96_standard_deviations_over_the_mean(process):
    X = np.array([[0.4, 0.3], [0.7, 0.5]])
    mean, std = process.models["single"]["K_T"].predict(X)
    expected = 100.0 * ((mean + 1.95996 * std) - (mean - 1.95996 * std)) / mean
    assert width_95(process, "single", X)["K_T"] == pytest.approx(expected, rel=1e-5)


def test_width_through_the_points_is_nearly_none_at_them(process):
    exact = fit(KCS, Options("gp", noise="none"))
    X = exact.training["single"].X
    assert (width_95(exact, "single", X)["K_T"] < 0.5).all()
    assert (width_95(process, "single", X)["K_T"] > 5.0).all()


def test_width_picture(tmp_path, process):
    means = plot_width(process, tmp_path / "w.png", 11)
    assert (tmp_path / "w.png").read_bytes()[:4] == b"\x89PNG"
    assert set(means["single"]) == set(KCS.quantities)


def test_printed_coefficients_know_no_width():
    known = fit(KCS, None, "G2", "SST")  # printed coefficients, whose points are not printed
    with pytest.raises(ConfigError, match="no standard deviation"):
        width_95(known, "single", np.array([[0.4, 0.3]]))
