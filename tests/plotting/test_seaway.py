"""Pictures of a ship in waves, and the motion that they draw on top of the track."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.conventions import FORCE_COMPONENTS, FORCES
from ship_gym.plotting.seaway import (
    _share_text,
    plot_turning_in_waves,
    seen_motion,
)
from ship_gym.reports.case import sail, sea_of
from ship_gym.ships.loader import load_ship


@pytest.fixture(scope="module")
def case():
    """To port, in a regular wave; a picture of one to starboard is in test_seaway_manoeuvres."""
    return sail(load_ship("dtc_model"), delta_deg=-35.0, wave_height=0.05, wavelength=1.0)


def is_picture(path) -> bool:
    data = path.read_bytes()
    return data[:4] == b"\x89PNG" and 15_000 < len(data) < 300_000


def test_every_component_has_its_own_colour():
    for colours in ([f.colour for f in FORCES], [f.on_dark for f in FORCES]):
        assert len(set(colours)) == len(FORCE_COMPONENTS)


def test_sway_is_to_starboard_and_yaw_is_added():
    columns = {"x": 10.0, "y": 5.0, "psi": 0.5 * math.pi, "wave_sway": 2.0, "wave_yaw": 0.1}
    north, east, psi = seen_motion({name: np.array([value]) for name, value in columns.items()})
    assert (north, east) == (pytest.approx([8.0]), pytest.approx([5.0]))  # east: starboard is south
    assert psi == pytest.approx([0.5 * math.pi + 0.1])


def test_irregular_sea_has_no_share_at_first(tmp_path, case):
    assert _share_text(case).count("%") == 2
    water, _ = sea_of(case.ship, "ss5", wave_from_deg=30.0)
    case = dataclasses.replace(case, water=water)
    assert _share_text(case).count("%") == 1
    plot_turning_in_waves(case, tmp_path / "turn.png")
    assert is_picture(tmp_path / "turn.png")
