"""The published hull of the Duisburg Test Case beside the parametric one, in waves.

The issue asks for head-sea surge and sway within 10 % of the peak and heave within 5 %. All hold,
heave from 0.65 L on; in shorter waves it is at most 0.12 of the amplitude and 6 % of that away.
The form of DTC, its bulb and the exponents of its curves among them, is measured on this file,
geometry to geometry; nothing of it was fitted to a force. Without the bulb and with straight bows
the drawn hull missed the surge by 24 % of the peak and the heave by 0.06 of the amplitude.
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
        heave.append(abs(found[5 + HEAVE]))
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


def test_surge_in_head_seas_is_that_of_the_real_hull(both):
    (real, _, _), (drawn, _, _) = both
    printed("CX 180 deg", real, drawn)
    ship = load_ship("dtc")
    snnm = -added_resistance(snnm_hull(ship), FROUDE, RATIO * ship.hull.L, np.pi)
    print("  SNNM    " + "".join(f"{x:8.3f}" for x in snnm))
    gap = np.abs(drawn - real) / np.abs(real).max()
    print(f"  largest difference {100.0 * gap.max():.1f} % of the peak")
    assert gap.max() <= 0.10
    assert np.abs(real).argmax() == np.abs(drawn).argmax()


def test_heave_in_head_seas_is_that_of_the_real_hull(both):
    (_, real, _), (_, drawn, _) = both
    printed("heave / A", real, drawn)
    gap = np.abs(drawn - real)
    print(
        f"  largest difference {gap.max():.3f} A, {100.0 * (gap / real).max():.0f} % of the value"
    )
    assert gap.max() <= 0.05  # of the wave's amplitude
    # of the value, where it is more than a fifth of the amplitude
    assert (gap / real)[RATIO >= 0.65].max() <= 0.05
