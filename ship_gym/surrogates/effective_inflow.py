"""Constants of the effective-inflow rudder law, fitted to CFD samples at one or more angles."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy.optimize import least_squares

from ship_gym.physics.propeller import wake
from ship_gym.physics.rudder import axial_inflow, cross_inflow, normal_force
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import fleet


@dataclasses.dataclass(frozen=True)
class RudderSamples:
    """Forces on a rudder in pure drift of a turn to starboard, y to port.

    Attributes
    ----------
    J, beta, K_T, C_Fx, C_Fy : numpy.ndarray
        Shape (n,); beta in rad.
    delta : float or numpy.ndarray
        Rudder angle [rad], one or one each, shape (n,).
    S_R : float
        Reference area of the coefficients [m2].
    """

    J: np.ndarray
    beta: np.ndarray
    K_T: np.ndarray
    C_Fx: np.ndarray
    C_Fy: np.ndarray
    delta: float | np.ndarray
    S_R: float


def rudder_frame(C_Fx, C_Fy, delta: float | np.ndarray):
    """Normal and chordwise coefficients C_N, C_A from ship axes (x forward, y to port).

    C_N = C_Fy cos(delta) - C_Fx sin(delta), C_A = C_Fx cos(delta) + C_Fy sin(delta).
    """
    c, s = np.cos(delta), np.sin(delta)
    return C_Fy * c - C_Fx * s, C_Fx * c + C_Fy * s


def law_coefficients(samples: RudderSamples, record: np.record) -> np.ndarray:
    """C_N of the effective-inflow law at the samples, from the very kernels of the simulation.

    The reference speed is that of the samples, u^2 (1 + 8 K_T / (pi J^2)) + v^2, with n D = 1.
    """
    D, rho = float(record.propeller.D), float(record.rho)
    result = np.empty(len(samples.J))
    deltas = np.broadcast_to(samples.delta, samples.J.shape)
    for i, (J, beta, K_T) in enumerate(zip(samples.J, samples.beta, samples.K_T, strict=True)):
        direction = (math.sin(deltas[i]), math.cos(deltas[i]))
        u, v = J, -J * math.tan(beta)  # our sway is to starboard
        thrust = K_T * rho * D * D  # with n D = 1
        U = math.hypot(u, v)
        u_R = axial_inflow(u, (thrust, wake((U, beta), 0.0, record.propeller), 0.0), record)
        v_R = cross_inflow(U * beta, U, u_R, 1.0, record.rudder)
        F_N = normal_force(direction, u_R, v_R, record.rudder, rho)
        u_ref2 = u * u + 8.0 * K_T / math.pi + v * v
        result[i] = F_N / (0.5 * rho * samples.S_R * u_ref2)
    return result


def fit_effective_inflow(sides: dict[str, RudderSamples], ship: Ship) -> dict[str, object]:
    """Fit epsilon, kappa and gamma_R of the law to samples by relative least squares.

    Two rudders share epsilon and kappa; each has its own gamma_R. The remaining constants (f_alpha,
    eta, wake) are the ship's own.

    Parameters
    ----------
    sides : dict
        Name of each rudder (``samples.SINGLE``; or ``LEEWARD`` and ``WINDWARD``) to its samples.
    ship : Ship
        Without surrogate: its wake law and the constants that are not fitted.

    Returns
    -------
    dict
        epsilon, kappa, ``gamma_R`` and ``errors_percent`` at the samples by rudder, and the mean of
        their sizes.
    """
    record = fleet([ship]).records[0].copy()
    measured = [rudder_frame(s.C_Fx, s.C_Fy, s.delta)[0] for s in sides.values()]

    def relative(p):
        record.rudder["epsilon"], record.rudder["kappa"] = p[0], p[1]
        parts = []
        for samples, C_N, gamma_R in zip(sides.values(), measured, p[2:], strict=True):
            record.rudder["gamma_R_p"] = record.rudder["gamma_R_n"] = gamma_R  # of this side
            parts.append(law_coefficients(samples, record) / C_N - 1.0)
        return np.concatenate(parts)

    count = len(sides)
    start = [ship.rudder.epsilon, ship.rudder.kappa, *[ship.rudder.gamma_R_p] * count]
    bounds = ([0.3, 0.0] + [0.0] * count, [2.0, 1.5] + [1.5] * count)
    found = least_squares(relative, start, bounds=bounds)
    errors = 100.0 * relative(found.x)
    ends = np.cumsum([len(C_N) for C_N in measured])[:-1]
    return {
        "epsilon": float(found.x[0]),
        "kappa": float(found.x[1]),
        "gamma_R": {side: float(g) for side, g in zip(sides, found.x[2:], strict=True)},
        "errors_percent": {
            side: [round(float(e), 3) for e in part]
            for side, part in zip(sides, np.split(errors, ends), strict=True)
        },
        "mean_abs_error_percent": float(np.abs(errors).mean()),
        "rms_error_percent": float(np.sqrt(np.mean(errors**2))),
    }
