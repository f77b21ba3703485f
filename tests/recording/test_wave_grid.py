"""The pictured water is the surface of the recorded waves, coarse, with the right side up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ship_gym.conventions import G
from ship_gym.recording.wave_grid import SHADES, wave_grid
from ship_gym.sea import WaveSystem
from ship_gym.sea.components import wave_components

L = 230.0


def sea(length: float = 200.0, height: float = 4.0, spread: float = 0.0) -> dict:
    """Three waves near one length, some aside."""
    k = 2.0 * math.pi / length * np.array([0.9, 1.0, 1.2])
    return {
        "waves": {
            "amplitude": (height / 4.0 * math.sqrt(2.0 / 3.0) * np.ones(3)).tolist(),
            "omega": np.sqrt(G * k).tolist(),
            "k": k.tolist(),
            "direction_to": (0.7 + spread * np.array([-1.0, 0.0, 1.0])).tolist(),
            "phase": [0.1, 2.0, 4.0],
        }
    }


@pytest.mark.parametrize("meta", [{}, {"waves": None}, sea(), sea(spread=0.6)])
def test_triangles_face_up_and_cover_the_grid_once(meta):
    grid = wave_grid(meta, L, 5000.0)
    for x, y, triangles in (
        (grid.x, grid.y, grid.triangles),
        (*grid.rim[:, :2].T, grid.rim_triangles),
    ):
        a, b, c = triangles.T
        # x north, y east, z down: a turn from north by east to south is clockwise from above
        area = 0.5 * ((x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]))
        assert (area < 0.0).all()  # the normal points to negative z, up
    whole = (2.0 * 5000.0) ** 2
    assert _area(grid.x, grid.y, grid.triangles) + _area(
        *grid.rim[:, :2].T, grid.rim_triangles
    ) == pytest.approx(whole, rel=0.01)


def _area(x, y, triangles) -> float:
    a, b, c = triangles.T
    return float(
        np.abs(0.5 * ((x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]))).sum()
    )


def test_heights_are_those_of_the_waves_in_steps():
    meta, t, place = sea(), 12.0, np.array([300.0, -70.0])
    grid = wave_grid(meta, L, 5000.0)
    heights, shades = grid.pictures(np.array([t]), place[None])
    w = {name: np.array(values) for name, values in meta["waves"].items()}
    for i in np.flatnonzero(grid.inner)[::7]:
        x, y = grid.x[i] + place[0], grid.y[i] + place[1]
        along = x * np.cos(w["direction_to"]) + y * np.sin(w["direction_to"])
        true = (w["amplitude"] * np.cos(w["omega"] * t - w["k"] * along + w["phase"])).sum()
        assert heights[0, i] == pytest.approx(true, abs=0.5 * grid.height / 9.0 + 1e-9)
    assert (heights[0, ~grid.inner] == 0.0).all()
    assert shades.min() >= 0 and shades.max() < SHADES
    assert grid.height == pytest.approx(4.0)


def test_a_crest_goes_where_the_wave_goes():
    meta = sea()
    for name, values in meta["waves"].items():
        meta["waves"][name] = values[1:2]
    grid = wave_grid(meta, L, 5000.0)
    place = np.zeros((2, 2))
    first, later = grid.pictures(np.array([0.0, 2.0]), place)[0]
    omega, k = meta["waves"]["omega"][0], meta["waves"]["k"][0]
    way = grid.x * math.cos(0.7) + grid.y * math.sin(0.7)
    moved = np.cos(k * (way - omega / k * 2.0) - meta["waves"]["phase"][0])
    assert np.corrcoef(later[grid.inner], moved[grid.inner])[0, 1] > 0.98
    assert np.corrcoef(first[grid.inner], moved[grid.inner])[0, 1] < 0.9


def test_few_points_and_pictures():
    for spread in (0.0, 0.6):
        grid = wave_grid(sea(spread=spread), L, 5000.0)
        assert len(grid.x) <= 150
        assert 2.0 < grid.step < 4.0
        gap = np.unique(np.abs(np.diff(np.sort(grid.x[grid.inner]))))
        assert gap.max() < 200.0 / 3.0


def test_most_of_an_ocean_sea_is_shown():
    """What is left out is shorter than three points of the grid."""
    long = wave_components((WaveSystem("bretschneider", 4.0, 12.4),))
    wide = wave_components((WaveSystem("bretschneider", 4.0, 12.4, spreading=2.0),))
    for parts, share in ((long, 0.95), (wide, 0.9)):
        waves = {name: getattr(parts, name) for name in ("amplitude", "omega", "k")}
        waves |= {"direction_to": parts.direction, "phase": np.zeros(len(parts.k))}
        assert share * 4.0 < wave_grid({"waves": waves}, L, 5000.0).height <= 4.0


def test_calm_water_is_one_flat_picture():
    grid = wave_grid({}, L, 5000.0)
    heights, shades = grid.pictures(np.array([0.0]), np.zeros((1, 2)))
    assert not heights.any()
    assert np.ptp(shades) == 0
    assert math.isinf(grid.step)


def test_a_model_has_the_same_picture():
    """By Froude's law: lengths by 75, times by its root."""
    full, scale = sea(), 75.0
    model = {"waves": dict(full["waves"])}
    for name, power in (("amplitude", -1.0), ("omega", 0.5), ("k", 1.0)):
        model["waves"][name] = (np.array(full["waves"][name]) * scale**power).tolist()
    one, other = wave_grid(full, L, 5000.0), wave_grid(model, L / scale, 5000.0 / scale)
    assert other.step == pytest.approx(one.step / math.sqrt(scale))
    assert other.x * scale == pytest.approx(one.x, abs=1.0)
