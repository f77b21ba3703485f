import numpy as np
import pytest

from ship_gym import load_ship
from ship_gym.seakeeping.database import make_problem
from ship_gym.seakeeping.drift import encounter_frequency
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.seakeeping.motions import (
    Radiation,
    added_damping,
    impedance,
    motions,
    restoring,
    stream_terms,
)
from ship_gym.seakeeping.radiation_diffraction import diffraction, radiation

pytest.importorskip("capytaine")
SHIP = load_ship("kcs_model")
MESH = parametric_mesh(SHIP)
COARSE = make_problem(SHIP, parametric_mesh(SHIP, 20, 5))
K = 2.0 * np.pi / 1.2  # wavelength 1.2 L


@pytest.fixture(scope="module")
def waves():
    omega = np.linspace(0.2, 4.2, 6)
    return Radiation(omega, np.array([radiation(COARSE.hull, w**2) for w in omega]))


def move(problem, waves, k, mu, speed=0.0):
    flow = diffraction(problem.hull, k, np.array([mu]))[0]
    return motions(problem.hull, problem.body, flow, waves, k, mu, speed)[0]


def test_restoring_is_that_of_the_hydrostatics():
    problem, L = make_problem(SHIP, MESH), SHIP.hull.L
    C, known = restoring(problem.hull, problem.body), hydrostatics(MESH)
    assert C[2, 2] == pytest.approx(known.heave / L**2, rel=1e-3)
    assert C[4, 4] == pytest.approx(known.pitch(SHIP.form.KG) / L**4, rel=5e-3)
    assert C[2, 4] == pytest.approx(-known.A_wp * known.x_F / L**3, rel=5e-3)
    assert C[3, 3] == pytest.approx(known.volume * SHIP.form.GM / L**4, rel=1e-3)
    np.testing.assert_array_equal(C, C.T)


def test_inertia_is_the_kinetic_energy():
    body = COARSE.body
    M = body.inertia
    np.testing.assert_allclose(M, M.T)
    # twice the kinetic energy of a motion: of the centre of gravity, and about it
    v, w = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.4, -0.7])
    of_G = v + np.cross(w, [body.x_G, 0.0, body.z_G])
    radii = np.array([body.k_xx, body.k_yy, body.k_zz])
    twice = body.mass * (of_G @ of_G + np.sum((radii * w) ** 2))
    state = np.concatenate([v, w])
    assert state @ M @ state == pytest.approx(twice, rel=1e-12)


def test_in_long_waves_the_ship_follows_the_surface(waves):
    k = 2.0 * np.pi / 40.0
    long = Radiation(waves.omega, waves.potentials)
    head, beam = move(COARSE, long, k, np.pi), move(COARSE, long, k, 0.5 * np.pi)
    assert abs(head[2]) == pytest.approx(1.0, rel=0.02)
    assert abs(head[4]) / k == pytest.approx(1.0, rel=0.03)
    assert abs(beam[1]) == pytest.approx(1.0, rel=0.05)
    # particles move with the wave, a quarter period after the crest: x = A sin(...), Re(i e^-iwt)
    assert head[0] == pytest.approx(-1j, rel=0.1)
    assert beam[1] == pytest.approx(1j, rel=0.1)


def test_mirror_image(waves):
    port, starboard = (move(COARSE, waves, K, s * 2.2, 0.2) for s in (1.0, -1.0))
    signs = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(starboard, signs * port, rtol=1e-9, atol=1e-12)
    symmetric = move(COARSE, waves, K, np.pi, 0.2)
    assert np.abs(symmetric[[1, 3, 5]]).max() < 1e-12


def test_stream_terms_turn_the_normals():
    # pitch (bow down) and yaw tilt the normals towards the stream: W . (rotation x n)
    n, rotation = np.array([0.3, -0.5, 0.8]), np.array([0.0, 0.02, 0.03])
    m = stream_terms(0.25)
    tilted = 0.25 * np.cross(rotation, n)[0]
    assert rotation[1] * m[4] @ np.r_[n, 0, 0, 0] + rotation[2] * m[5] @ np.r_[n, 0, 0, 0] == (
        pytest.approx(tilted)
    )


def test_overtaken_waves_radiate_with_the_conjugate(waves):
    np.testing.assert_array_equal(waves.at(-1.3), waves.at(1.3).conj())
    np.testing.assert_array_equal(waves.at(99.0), waves.at(waves.omega[-1]))


def test_damping_beyond_potential_flow():
    body, C = COARSE.body, restoring(COARSE.hull, COARSE.body)
    rest, ahead = (added_damping(body, C, np.zeros(6), U, 0.05) for U in (0.0, 0.26))
    assert np.count_nonzero(rest) == 1 and rest[3, 3] > 0.0
    assert (np.diag(ahead)[1:] > 0.0).all()
    assert ahead[2, 2] == pytest.approx(2.0 * 0.08 * 0.26 * np.sqrt(C[2, 2] * body.mass))


def test_low_encounter_frequencies_are_faded(waves):
    # following sea, omega_e = 0 at c = U: the ship would surf
    U = 0.26
    k = (1.0 / U) ** 2 * 0.999  # wave speed just above the ship's
    assert abs(move(COARSE, waves, k, 0.0, U)[0]) < 1e-3


@pytest.mark.slow
def test_kcs_heave_in_head_seas_beside_the_prototype():
    # 0.51, 0.99, 1.04, 0.99 of the prototype, whose hull and definition of critical damping differ
    problem = make_problem(SHIP, MESH)
    omega = np.linspace(2.2, 4.6, 13)
    waves = Radiation(omega, np.array([radiation(problem.hull, w**2) for w in omega]))
    found = []
    for ratio in (1.0, 1.2, 1.35, 2.0):
        k, mu = 2.0 * np.pi / ratio, np.array([np.pi])
        flow = diffraction(problem.hull, k, mu, encounter_frequency(k, np.pi, 0.26) ** 2)[0]
        xi, _ = motions(problem.hull, problem.body, flow, waves, k, np.pi, 0.26)
        found.append(abs(xi[2]))
    np.testing.assert_allclose(found, [0.51, 0.99, 1.04, 0.99], atol=0.12)


def test_added_mass_is_positive(waves):
    Z = impedance(COARSE.hull, waves.potentials[2])
    assert (-np.diag(Z).real > 0.0).all() and (-np.diag(Z).imag > -1e-6).all()
