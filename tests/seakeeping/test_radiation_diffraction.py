import subprocess
import sys

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping.hull_mesh import capytaine_axes, lid, mesh_from_sections
from ship_gym.seakeeping.motions import impedance
from ship_gym.seakeeping.radiation_diffraction import (
    HalfHull,
    diffraction,
    half_hull,
    incident_wave,
    radiation,
)

pytest.importorskip("capytaine")


def hemisphere(stations=16, girth=8):
    """Floating hemisphere of radius 1 in ship axes."""
    angle = np.linspace(0.0, 0.5 * np.pi, girth + 1)  # from the keel to the waterline
    x = -np.cos(np.linspace(0.0, np.pi, stations + 1))
    r = np.sqrt(1.0 - x**2)[:, None]
    section = np.stack(np.broadcast_arrays(x[:, None], r * np.sin(angle), r * np.cos(angle)), -1)
    return mesh_from_sections(section)


def box(stations=16, girth=6, length=2.0):
    """Box of breadth 2, draught 0.5: irregular frequencies are known."""
    side = [[1.0, 0.5 * (1.0 - s)] for s in np.linspace(0.0, 1.0, girth)]
    bottom = [[y, 0.5] for y in np.linspace(0.0, 1.0, girth)[:-1]]
    profile = np.array(bottom + side)
    x = np.linspace(-0.5 * length, 0.5 * length, stations + 1)
    return mesh_from_sections(
        np.stack([np.concatenate([np.full((len(profile), 1), at), profile], 1) for at in x])
    )


def hull_of(mesh, strips=2):
    return half_hull(mesh, lid(mesh, strips), 1.0)


SPHERE = hull_of(hemisphere())


def test_geometry_of_a_hemisphere():
    assert SPHERE.volume == pytest.approx(2.0 * np.pi / 3.0, rel=0.03)
    assert 2.0 * SPHERE.areas.sum() == pytest.approx(2.0 * np.pi, rel=0.02)
    assert SPHERE.weights.sum() == pytest.approx(SPHERE.areas.sum(), rel=0.01)
    outward = np.sum(SPHERE.normals * SPHERE.centres, axis=1)
    assert (outward > 0.9).all()
    assert (SPHERE.centres[:, 1] > 0.0).all() and (SPHERE.centres[:, 2] < 0.0).all()


def test_half_hull_mirrors_the_starboard_half_to_port():
    vertices, _ = capytaine_axes(hemisphere())  # starboard at y < 0
    mirrored = np.unique(np.round(SPHERE.panels.reshape(-1, 3), 9), axis=0)
    expected = np.unique(np.round(vertices * [1.0, -1.0, 1.0], 9), axis=0)
    np.testing.assert_allclose(mirrored, expected, atol=1e-9)


def test_long_waves_see_a_rigid_surface():
    # a sphere in unbounded fluid has half its displaced mass as added mass (Lamb); flat panels
    # approach it from above
    errors = []
    for hull in (SPHERE, hull_of(hemisphere(24, 12))):
        Z = impedance(hull, radiation(hull, 1e-3))
        errors.append(-Z[[0, 1], [0, 1]].real / hull.volume / 0.5 - 1.0)
    assert (np.array(errors) > 0.0).all()
    assert (errors[1] < 0.05).all() and (errors[1] < 0.7 * errors[0]).all()


def test_added_mass_is_symmetric_and_damping_positive():
    Z = impedance(SPHERE, radiation(SPHERE, 1.0))
    scale = np.abs(Z).max()
    np.testing.assert_allclose(Z, Z.T, atol=0.01 * scale)
    assert (np.diag(-Z.imag)[:3] > 0.0).all()
    # a sphere that turns about its centre moves no water
    assert np.abs(np.diag(Z)[3:]).max() < 0.01 * scale


def test_haskind_relation():
    # Int phi_7 n_j = -Int phi_j dphi_0/dn: diffraction and radiation know each other
    k, mu = 0.8, np.array([2.0])
    waves, radiated = diffraction(SPHERE, k, mu), radiation(SPHERE, k)
    incoming = incident_wave(SPHERE, k, mu)[1]
    for j, (flow, part) in enumerate([(waves.even, 0), (waves.odd, 1), (waves.even, 0)]):
        direct = np.sum(SPHERE.areas * SPHERE.modes[:, j] * flow[0])
        by_radiation = -np.sum(SPHERE.areas * radiated[j] * incoming[part, 0])
        assert direct == pytest.approx(by_radiation, rel=0.02)


def test_port_and_starboard_waves_are_mirror_images():
    port, starboard = diffraction(SPHERE, 1.0, np.array([1.1, -1.1]))[np.array([0, 1])], None
    starboard = port[1]
    np.testing.assert_allclose(port[0].even, starboard.even, atol=1e-12)
    np.testing.assert_allclose(port[0].odd, -starboard.odd, atol=1e-12)


@pytest.mark.slow
def test_lid_removes_the_irregular_frequency():
    # box: the inner wave sin(pi x / 2) ... with nu = pi / sqrt(2), K = nu coth(nu T)
    nu = np.pi / np.sqrt(2.0)
    irregular = nu / np.tanh(0.5 * nu)

    def heave(hull):
        return [-impedance(hull, radiation(hull, k))[2, 2] for k in irregular * np.array([1, 1.15])]

    mesh = box()
    closed, bare = hull_of(mesh), HalfHull(hull_of(mesh).panels)
    at, beside = heave(closed)
    assert abs(at / beside - 1.0) < 0.1
    spoiled = max(
        abs(-impedance(bare, radiation(bare, k))[2, 2] / at - 1.0)
        for k in irregular * np.linspace(0.97, 1.05, 9)
    )
    assert spoiled > 0.3


def test_bad_hulls_are_refused():
    with pytest.raises(ConfigError, match="reverse the corner order"):
        HalfHull(SPHERE.panels[:, ::-1])
    with pytest.raises(ConfigError, match="y >= 0 and z <= 0"):
        HalfHull(SPHERE.panels * [1.0, -1.0, 1.0])
    with pytest.raises(ConfigError, match="exactly z = 0"):
        HalfHull(SPHERE.panels, SPHERE.lid - [0.0, 0.0, 1e-5])
    with pytest.raises(ConfigError, match="shape"):
        HalfHull(SPHERE.panels[:, :3])
    with pytest.raises(ConfigError, match="symmetric hull"):
        half_hull(hemisphere().both_sides(), lid(hemisphere()), 1.0)


def test_capytaine_prints_nothing_where_results_are_printed():
    """In a process of its own, whose root logger nobody has given a handler."""
    code = (
        "import logging; from ship_gym.seakeeping._capytaine import capytaine; capytaine()\n"
        "import capytaine as c\n"
        "assert logging.root.handlers == [] and logging.root.level == logging.WARNING\n"
        "c.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], [[0, 1, 2, 3]])\n"
    )
    made = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (made.stdout, made.stderr) == ("", "")
