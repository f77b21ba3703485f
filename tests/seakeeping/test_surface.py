"""Gradients on a hull's panels beside those of functions that are known."""

import numpy as np
import pytest

from ship_gym import load_ship
from ship_gym.seakeeping.database import make_problem
from ship_gym.seakeeping.hull_form import parametric_mesh

SHIP = load_ship("kvlcc2_model")
SURFACE = make_problem(SHIP, parametric_mesh(SHIP)).surface
LARGE = ~SURFACE.slivers & (np.abs(SURFACE.centres[:, 0]) < 0.4)


def wave(k, mu):
    """A plane wave: its values, gradient and second derivatives on the panels."""
    d = np.array([1j * k * np.cos(mu), 1j * k * np.sin(mu), k])
    f = np.exp(SURFACE.centres @ d)
    return f, f[:, None] * d, f[:, None, None] * np.outer(d, d)


@pytest.mark.parametrize("mu", [0.0, 2.0])
def test_velocity_and_its_derivatives_of_a_plane_wave(mu):
    k = 2.0 * np.pi
    f, slope, second = wave(k, mu)
    normal_velocity = np.sum(slope * SURFACE.normals, axis=1)
    derivatives = SURFACE.derivatives(f, normal_velocity)
    found = SURFACE.gradient(derivatives, normal_velocity)
    error = np.linalg.norm(found - slope, axis=1)[LARGE]
    assert np.sqrt(np.mean(error**2)) < 0.02 * k
    again = SURFACE.second_derivatives(slope)
    error = np.linalg.norm(again - second, axis=(1, 2))[LARGE]
    assert np.sqrt(np.mean(error**2)) < 0.1 * k**2
    assert np.abs(np.trace(again, axis1=1, axis2=2)).max() < 1e-9 * k**2


def test_both_sides_close_the_hull_but_for_the_waterplane():
    total = SURFACE.areas @ SURFACE.normals
    assert abs(total[0]) < 1e-4 and abs(total[1]) < 1e-12 and total[2] < 0.0


def test_the_waterline_goes_around_the_waterplane():
    line = SURFACE.waterline
    assert np.abs(line.normal.sum(axis=0)).max() < 1e-4  # closed
    area = 0.5 * np.sum(line.middle * line.normal)  # Gauss
    assert area == pytest.approx(-(SURFACE.areas @ SURFACE.normals)[2], rel=0.01)


def test_no_fit_multiplies_the_errors_of_the_values():
    """Fine meshes of DTC have bow panels whose neighbours lie in a line: 107 without a check."""
    ship = load_ship("dtc")
    surface = make_problem(ship, parametric_mesh(ship, 80, 12)).surface
    matrices, _ = surface._fits
    noise = np.stack([abs(m).sum(axis=1) * np.sqrt(surface.areas) for m in matrices[:2]])
    assert noise[:, ~surface.slivers].max() < 15.0
