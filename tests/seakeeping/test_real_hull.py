"""The published hull of the Duisburg Test Case beside the parametric one, in waves.

The issue asks for head-sea surge and sway within 10 % of the peak and heave within 5 %. Sway is;
surge and heave are not: the gaps are held down below, so that a better hull shows up here. They are
of the form, not of the mesh: with twice as many panels on both hulls they are the same to 0.3 %.
Beside the real hull the parametric one has no bulb (sectional area 0.03 B d for 0.10 at 0.48 L
forward), a fuller waterline at the very ends and a finer one at the forward shoulder (half breadth
0.87 B / 2 for 0.92 at 0.25 L). SNNM lies near the parametric hull, on which the far field was
calibrated, and below the real one.
"""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from ship_gym.seakeeping.database import cell, make_problem
from ship_gym.seakeeping.drift import encounter_frequency
from ship_gym.seakeeping.hull_file import read_hull
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.motions import HEAVE, Radiation
from ship_gym.seakeeping.radiation_diffraction import diffraction, radiation
from ship_gym.seakeeping.snnm import added_resistance, snnm_hull
from ship_gym.ships.loader import load_ship

# GPL, not in the package: beside a checkout
FILE = Path(__file__).resolve().parents[3] / "shared" / "reference" / "dtc_hull.stl.gz"
FROUDE = 0.14
RATIO = np.array([0.3, 0.4, 0.5, 0.65, 0.8, 0.9, 1.0, 1.2, 1.6])
HEADINGS_DEG = (90.0, 120.0, 150.0)
ENCOUNTER = np.linspace(1.6, 6.2, 20)  # omega_e sqrt(L/g), from 180 deg to the shortest waves

# differences measured; a test fails if they grow or close
SURGE_GAP = 0.24  # of the peak of |CX|
HEAVE_GAP = 0.06  # of the wave amplitude

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not FILE.is_file(), reason="the published DTC geometry is not here"),
]


def in_waves(ship, mesh):
    """CX and |heave| / A of head seas (w,), and CY at rest (w, headings)."""
    problem = make_problem(ship, mesh)
    waves = Radiation(ENCOUNTER, np.array([radiation(problem.hull, w**2) for w in ENCOUNTER]))
    headings = np.radians([*HEADINGS_DEG, 180.0])
    CX, heave, CY = [], [], []
    for k0 in 2.0 * np.pi / RATIO:
        *oblique, ahead = diffraction(problem.hull, k0, headings)

        def second(k0=k0):
            encounter_k = encounter_frequency(k0, np.pi, FROUDE) ** 2
            return diffraction(problem.hull, k0, headings[-1:], encounter_k)[0]

        found = cell(problem, ahead, second, waves, k0, np.pi, FROUDE)
        CX.append(found[0].real / (ship.hull.B / ship.hull.L) ** 2)
        heave.append(abs(found[4 + HEAVE]))
        rest = [
            cell(problem, flow, None, waves, k0, mu, 0.0)
            for flow, mu in zip(oblique, headings, strict=False)
        ]
        CY.append([-2.0 * values[1].real for values in rest])
    return np.array(CX), np.array(heave), np.array(CY)


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """The same of the real and of the parametric hull."""
    for library in ("capytaine", "trimesh"):
        pytest.importorskip(library)
    ship = load_ship("dtc")
    path = tmp_path_factory.mktemp("dtc") / "dtc.stl"
    path.write_bytes(gzip.decompress(FILE.read_bytes()))
    place = {"scale": 59.407, "midship": 177.5, "waterline": 0.2440 * 59.407}
    meshes = read_hull(path, ship, **place), parametric_mesh(ship)
    return [in_waves(ship, mesh) for mesh in meshes]


def printed(name, real, drawn):
    print(f"\n{name:<10}" + "".join(f"{x:8.2f}" for x in RATIO))
    for kind, values in (("real", real), ("drawn", drawn)):
        print(f"  {kind:<8}" + "".join(f"{x:8.3f}" for x in values))


def test_sway_at_rest_is_that_of_the_real_hull(both):
    (_, _, real), (_, _, drawn) = both
    for j, heading in enumerate(HEADINGS_DEG):
        printed(f"CY {heading:.0f} deg", real[:, j], drawn[:, j])
        gap = np.abs(drawn[:, j] - real[:, j]).max() / np.abs(real[:, j]).max()
        print(f"  largest difference {100.0 * gap:.1f} % of the peak")
        assert gap <= 0.10


def test_surge_falls_short_of_the_real_hull_by_a_known_gap(both):
    (real, _, _), (drawn, _, _) = both
    printed("CX 180 deg", real, drawn)
    ship = load_ship("dtc")
    snnm = -added_resistance(snnm_hull(ship), FROUDE, RATIO * ship.hull.L, np.pi)
    print("  SNNM    " + "".join(f"{x:8.3f}" for x in snnm))
    gap = np.abs(drawn - real) / np.abs(real).max()
    print(f"  largest difference {100.0 * gap.max():.1f} % of the peak; the issue asks for 10 %")
    # met in waves of up to 0.65 L and of 1.6 L
    assert (gap[(RATIO <= 0.65) | (RATIO >= 1.6)] <= 0.10).all()
    # the parametric hull is too low by a quarter at the peak, which is in the right place
    assert gap.max() == pytest.approx(SURGE_GAP, abs=0.02)
    assert (np.abs(drawn) < np.abs(real)).all()
    assert np.abs(real).argmax() == np.abs(drawn).argmax()


def test_heave_falls_short_of_the_real_hull_by_a_known_gap(both):
    (_, real, _), (_, drawn, _) = both
    printed("heave / A", real, drawn)
    gap = np.abs(drawn - real)
    worst = gap.argmax()
    print(
        f"  largest difference {gap[worst]:.3f} A, {100.0 * gap[worst] / real[worst]:.0f} % of the "
        f"real hull's at {RATIO[worst]:g} L; the issue asks for 5 %"
    )
    assert (gap[RATIO <= 0.9] <= 0.05).all()  # of the wave's amplitude
    assert gap.max() == pytest.approx(HEAVE_GAP, abs=0.01)
