"""Wave-frequency motions of a ship with forward speed.

Axes, time factor and units: see `radiation_diffraction` (z up, y to port, L = g = rho = 1). Modes
surge, sway, heave, roll, pitch, yaw of the origin (midship at the waterline): rotations about the
same axes, so bow down is positive in pitch here.

Diffraction is taken at the true wave number, radiation at the encounter frequency. The uniform
stream enters by Tuck's theorem (Salvesen, Tuck & Faltinsen 1970): the flow of unit pitch gains
U times that of unit heave velocity, of unit yaw -U times that of sway velocity, and the pressure's
-U d/dx passes to the normals alike. Where the ship overtakes the waves omega_e is negative and
radiation is the complex conjugate of that at |omega_e|.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cached_property

import numpy as np

from ship_gym.seakeeping import calibration
from ship_gym.seakeeping.drift import encounter_frequency
from ship_gym.seakeeping.radiation_diffraction import (
    EVEN_MODES,
    ODD_MODES,
    Flow,
    HalfHull,
    incident_wave,
)

SURGE, SWAY, HEAVE, ROLL, PITCH, YAW = range(6)


@dataclasses.dataclass(frozen=True)
class RigidBody:
    """Mass and added damping of a ship, by L, g and rho.

    Attributes
    ----------
    mass : float
        Displacement volume by L^3.
    x_G, z_G : float
        Centre of gravity forward of midship and above the waterline, by L.
    k_xx, k_yy, k_zz : float
        Radii of gyration about it, by L.
    GM : float
        Transverse metacentric height by L; imposed, the mesh's own is not used.
    Y_v, N_r : float
        Linear hull derivatives of sway and yaw by 1/2 rho L d U^2 and 1/2 rho L^2 d U^2 (both
        negative): the lift that damps sway and yaw at speed.
    """

    mass: float
    x_G: float
    z_G: float
    k_xx: float
    k_yy: float
    k_zz: float
    GM: float
    Y_v: float
    N_r: float

    @cached_property
    def inertia(self) -> np.ndarray:
        """Mass matrix about the origin, shape (6, 6)."""
        x, z = self.x_G, self.z_G
        lever = np.array([[0.0, -z, 0.0], [z, 0.0, -x], [0.0, x, 0.0]])  # r_G x
        radii = np.diag([self.k_xx, self.k_yy, self.k_zz]) ** 2
        return self.mass * np.block([[np.eye(3), -lever], [lever, radii - lever @ lever]])


def restoring(hull: HalfHull, body: RigidBody) -> np.ndarray:
    """Hydrostatic stiffness about the origin with the imposed GM, shape (6, 6)."""
    x, _, z = hull.points.reshape(-1, 3).T
    # the hull's vertical projection covers the waterplane: minus n_z dS is an element of it
    waterplane = -2.0 * (hull.weights * hull.normals[:, 2:]).reshape(-1)
    C = np.zeros((6, 6))
    C[HEAVE, HEAVE] = waterplane.sum()
    C[HEAVE, PITCH] = C[PITCH, HEAVE] = -(waterplane @ x)
    C[ROLL, ROLL] = body.mass * body.GM
    moment = -0.5 * waterplane @ z**2  # volume times the height of its centre
    C[PITCH, PITCH] = waterplane @ x**2 + moment - body.mass * body.z_G
    return C


@dataclasses.dataclass(frozen=True)
class Radiation:
    """Unit-velocity potentials of the six modes over the encounter frequency.

    Attributes
    ----------
    omega : numpy.ndarray
        Increasing frequencies > 0, shape (f,); beyond either end the end value holds.
    potentials : numpy.ndarray
        Complex, shape (f, 6, n).
    """

    omega: np.ndarray
    potentials: np.ndarray

    @cached_property
    def _spline(self) -> Callable[[float], np.ndarray]:
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.omega, self.potentials)

    def at(self, omega_e: float) -> np.ndarray:
        """Potentials at a signed encounter frequency, shape (6, n)."""
        found = self._spline(np.clip(abs(omega_e), self.omega[0], self.omega[-1]))
        return found.conj() if omega_e < 0.0 else found


def impedance(hull: HalfHull, potentials: np.ndarray) -> np.ndarray:
    """Z_ij = Int n_i phi_j dS over both halves, shape (6, 6); -Z = added mass + i damping / omega.

    Parameters
    ----------
    hull : HalfHull
    potentials : numpy.ndarray
        Of unit velocity, shape (6, n).
    """
    Z = 2.0 * (hull.modes.T * hull.areas) @ potentials.T
    Z[np.ix_(EVEN_MODES, ODD_MODES)] = Z[np.ix_(ODD_MODES, EVEN_MODES)] = 0.0
    return Z


def stream_terms(speed: float) -> np.ndarray:
    """m-terms of the uniform stream: mode (row) gains the flow of another (column), (6, 6)."""
    m = np.zeros((6, 6))
    m[PITCH, HEAVE], m[YAW, SWAY] = speed, -speed
    return m


def added_damping(
    body: RigidBody, C: np.ndarray, added_mass: np.ndarray, speed: float, draught: float
) -> np.ndarray:
    """Damping beyond potential flow (see ``calibration.py``), diagonal, shape (6, 6)."""
    ratio = np.zeros(6)
    ratio[ROLL] = calibration.ROLL_DAMPING
    ratio[[HEAVE, PITCH]] = calibration.HEAVE_PITCH_DAMPING_BY_FROUDE * speed
    inertia = np.maximum(np.diag(body.inertia) + added_mass, 0.0)
    damping = 2.0 * ratio * np.sqrt(np.diag(C) * inertia)
    damping[SWAY] = -0.5 * draught * speed * body.Y_v
    damping[YAW] = -0.5 * draught * speed * body.N_r
    return np.diag(damping)


def absorbed_action(
    hull: HalfHull,
    body: RigidBody,
    radiation: Radiation,
    xi: np.ndarray,
    omega_e: float,
    speed: float = 0.0,
) -> np.ndarray:
    """Wave action per unit time that `added_damping` takes in each mode, shape (6,).

    Power 1/2 omega_e^2 B |xi|^2 by omega_e, for motions `xi` of a wave of unit amplitude; negative
    where the ship overtakes the waves, as in `drift`.
    """
    added_mass = -np.diag(impedance(hull, radiation.at(omega_e))).real
    draught = float(-hull.panels[..., 2].min())
    B = added_damping(body, restoring(hull, body), added_mass, speed, draught)
    return 0.5 * omega_e * np.diag(B) * np.abs(xi) ** 2


def motions(
    hull: HalfHull,
    body: RigidBody,
    diffracted: Flow,
    radiation: Radiation,
    k0: float,
    heading: float,
    speed: float = 0.0,
) -> tuple[np.ndarray, Flow]:
    """Motions in a wave of unit amplitude, and the flow of the moving body.

    Parameters
    ----------
    hull : HalfHull
    body : RigidBody
    diffracted : Flow
        For this wave, arrays of shape (n,).
    radiation : Radiation
    k0 : float
        Wave number of the incident wave by 1/L.
    heading : float
        mu [rad].
    speed : float
        Froude number.

    Returns
    -------
    xi : numpy.ndarray
        Complex amplitudes of the six modes, shape (6,): displacements by the wave amplitude,
        rotations [rad] by amplitude / L; factor e^{-i omega_e t}.
    flow : Flow
        Diffracted and radiated flow, arrays of shape (n,).
    """
    omega_e, omega = encounter_frequency(k0, heading, speed), np.sqrt(k0)
    potentials = radiation.at(omega_e)
    Z = impedance(hull, potentials)
    stream = stream_terms(speed)
    velocity, pressure = stream - 1j * omega_e * np.eye(6), stream + 1j * omega_e * np.eye(6)
    C = restoring(hull, body)
    draught = float(-hull.panels[..., 2].min())
    B = added_damping(body, C, -np.diag(Z).real, speed, draught)
    left = C - omega_e**2 * body.inertia - 1j * omega_e * B + pressure @ Z @ velocity.T
    incident = incident_wave(hull, k0, np.array([heading]))[0][:, 0]
    force = -1j * omega * _force(hull, *incident)
    force -= pressure @ _force(hull, diffracted.even, diffracted.odd)
    xi = np.linalg.solve(left, force)
    fade = min(1.0, (omega_e / calibration.FADE_FREQUENCY) ** 4)
    xi[[SURGE, SWAY, YAW]] *= fade
    return xi, _moving(hull, diffracted, potentials, velocity.T @ xi)


def _force(hull: HalfHull, even: np.ndarray, odd: np.ndarray) -> np.ndarray:
    """Int n_i phi dS over both halves, shape (6,)."""
    weighted = 2.0 * hull.modes.T * hull.areas
    force = weighted @ even
    force[list(ODD_MODES)] = weighted[list(ODD_MODES)] @ odd
    return force


def _moving(hull: HalfHull, diffracted: Flow, potentials, amplitudes) -> Flow:
    """Diffracted flow plus `amplitudes` times the unit flows."""
    parts = []
    for modes in (EVEN_MODES, ODD_MODES):
        a = amplitudes[list(modes)]
        parts.append((a @ potentials[list(modes)], a @ hull.modes.T[list(modes)]))
    (even, even_velocity), (odd, odd_velocity) = parts
    return Flow(
        diffracted.even + even,
        diffracted.odd + odd,
        diffracted.even_velocity + even_velocity,
        diffracted.odd_velocity + odd_velocity,
    )
