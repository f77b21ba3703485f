"""The report and the picture of the turns to both sides."""

import json

import pytest

from reproduce.stern_picture import plot_sides
from reproduce.stern_tables import as_dict, as_text


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
    """The printed radii 1.24 L and 1.17 L make 46 and 49 deg; 10 and 40 of one sign make 30."""
    for row, radius in zip(data["drift"], (1.24, 1.17), strict=True):
        span = row["AP"] - row["FP"]
        assert row["FP"] < 0.0 < row["AP"]
        assert span == pytest.approx(57.3 / radius, rel=0.1)


def test_text(data):
    text = as_text(data)
    assert f"of {len(data['findings'])} met" in text and "Table 4" in text
    assert "larger to port" in text


def test_picture(tmp_path, data):
    plot_sides(data, tmp_path / "s.png")
    assert (tmp_path / "s.png").read_bytes()[:4] == b"\x89PNG"
