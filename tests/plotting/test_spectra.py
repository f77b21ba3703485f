"""The picture of a spectrum, and what a recording of a manoeuvre in it says of its waves."""

import dataclasses
import json
from pathlib import Path

import pytest

from ship_gym.recording.surroundings import waves_of
from ship_gym.sea import measured_sea, read_spectrum

HINDCAST = Path(__file__).parents[2] / "docs" / "spectra" / "hindcast.csv"


def test_the_samples_are_read_and_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    from PIL import Image

    from ship_gym.plotting.spectra import plot_spectrum

    path = tmp_path / "a.png"
    plot_spectrum(read_spectrum(HINDCAST), path, count=30)
    with Image.open(path) as image:
        assert image.size[0] > 1000
    buoy = read_spectrum(HINDCAST.with_name("buoy.csv"))
    assert buoy.height == pytest.approx(3.0, rel=0.02)  # JONSWAP of 3 m up to 0.49 Hz


def test_a_recording_says_height_period_and_direction_of_a_measured_sea():
    sea = measured_sea(HINDCAST)
    meta = {"config": {"sea": json.loads(json.dumps(dataclasses.asdict(sea)))}}
    height, period, to, regular = waves_of(meta)
    assert (height, period, to) == (sea.height, sea.period, sea.wave_direction_to)
    assert not regular
