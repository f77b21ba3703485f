"""The report and the picture of the turns to both sides."""

import json
import math

import pytest

from reproduce.stern_picture import plot_sides
from reproduce.stern_tables import as_dict, as_text
from reproduce.stern_turns import turns


@pytest.fixture(scope="module")
def data():
    return as_dict()


def test_plain_data(data):
    assert json.loads(json.dumps(data)) == data
    assert len(data["balance"]) == 13 and len(data["printed"]) == 9


def test_differences_are_of_the_sizes_and_percent_of_their_mean(data):
    for row in data["balance"]:
        starboard, port = abs(row["starboard"]), abs(row["port"])
        assert row["difference"] == pytest.approx(port - starboard, abs=1e-9)
        percent = 100.0 * (port - starboard) / (0.5 * (port + starboard))
        assert row["difference_percent"] == pytest.approx(percent, abs=1e-9)


def test_drift_rises_from_bow_to_stern_by_the_yaw_rate(data):
    """The printed radii 1.24 L and 1.17 L make 46 and 49 deg; 10 and 40 of one sign make 30.

    A gap: our radii are 1.38 and 1.27 L, beyond the facilities' scatter (docs/trials.md).
    """
    circles = turns(0.26).turns
    for row, radius, gap in zip(data["drift"], (1.24, 1.17), (-0.105, -0.077), strict=True):
        span, own = row["AP"] - row["FP"], 0.5 * circles[row["side"]].circle.steady_diameter
        assert row["FP"] < 0.0 < row["AP"]
        assert span == pytest.approx(math.degrees(1.0 / own), rel=2e-3)
        assert span / math.degrees(1.0 / radius) - 1.0 == pytest.approx(gap, abs=0.01)


def test_text(data):
    text = as_text(data)
    assert f"of {len(data['findings'])} met" in text and "Table 4" in text
    assert "larger to port" in text


def test_picture(tmp_path, data):
    plot_sides(data, tmp_path / "s.png")
    assert (tmp_path / "s.png").read_bytes()[:4] == b"\x89PNG"
