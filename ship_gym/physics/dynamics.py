"""Three-degree-of-freedom equations of motion with coupled sway and yaw (YY15)."""

from __future__ import annotations

import math
from typing import NamedTuple

from ship_gym.conventions import PSI, U, V
from ship_gym.physics._kernel import kernel
from ship_gym.physics.hull import hull_forces
from ship_gym.physics.propeller import (
    advance_ratio,
    outside_box,
    propeller_forces,
    surrogate_blend,
)
from ship_gym.physics.rudder import rudder_forces


class OwnForces(NamedTuple):
    """Forces of the ship herself at one instant: X, Y [N], N [N m] at midship of each."""

    hull: tuple[float, float, float]
    propeller: tuple[float, float, float]
    rudder: tuple[float, float, float]


@kernel
def total(loads):
    """Sum of some loads: X, Y [N], N [N m]."""
    X, Y, N = loads[0]
    for k in range(1, len(loads)):
        load = loads[k]
        X, Y, N = X + load[0], Y + load[1], N + load[2]
    return X, Y, N


@kernel
def unit_forces(motion, controls, drift, ship, tables):
    """Forces of one propeller with its rudder: the only one, or the starboard one.

    Returns
    -------
    propeller, rudder : (float, float, float)
        X, Y [N], N [N m] at midship.
    diagnosis : (float, float, float, float, float)
        beta_P, beta_R [rad], thrust [N], torque [N m], rudder normal force [N].
    """
    propeller, race, local = propeller_forces(motion, controls, drift, ship, tables)
    epsilon, beta_P = local
    rudder, F_N, beta_R = rudder_forces(motion, controls, drift, race, epsilon, ship, tables)
    return propeller, rudder, (beta_P, beta_R, race[0], race[2], F_N)


@kernel
def with_mirror_image(starboard, port):
    """Force of two units from the starboard one's and the port one's in the mirrored ship."""
    return starboard[0] + port[0], starboard[1] - port[1], starboard[2] - port[2]


@kernel
def forces(motion, controls, ship, tables):
    """Force breakdown of one ship at one instant, without the loads from outside.

    Parameters
    ----------
    motion : (float, float, float)
        u, v [m/s], r [rad/s] through the water.
    controls : (float, float)
        Rudder angle [rad], propeller speed [rev/s]; of both, if there are two.
    ship : record
        One ship of ``ship_gym.ships.records``.
    tables : (ndarray, ndarray)
        Its open-water and surrogate tables.

    Returns
    -------
    own : OwnForces
        Of all propellers and of all rudders together.
    flow : tuple of 7 floats
        J, beta_P, beta_R [rad], thrust [N], torque [N m], rudder normal force [N], extrapolation
        (``conventions.FLOW_NAMES``); forces and torque of all, angles on the centreline.
    """
    u, v, r = motion
    # |u|: astern the drift of wake and rudder is counted from the stern, so that nothing jumps
    # where the ship backs straight; the same as atan2(-v, u) ahead
    drift = (math.sqrt(u * u + v * v), math.atan2(-v, abs(u)))
    on_hull = hull_forces(u, v, r, ship.hull, ship.rho)
    P, R, seen = unit_forces(motion, controls, drift, ship, tables)
    beta_P, beta_R, T, Q, F_N = seen
    if ship.propeller.y_P > 0.0:
        mirrored = (-controls[0], controls[1])
        P2, R2, seen = unit_forces((u, -v, -r), mirrored, (drift[0], -drift[1]), ship, tables)
        P, R = with_mirror_image(P, P2), with_mirror_image(R, R2)
        beta_P, beta_R = 0.5 * (beta_P - seen[0]), 0.5 * (beta_R - seen[1])
        T, Q, F_N = T + seen[2], Q + seen[3], F_N - seen[4]
    J = advance_ratio(u, controls[1], ship.propeller.D)
    outside = extrapolation(J, beta_P, beta_R, controls[0], ship.surrogate)
    return OwnForces(on_hull, P, R), (J, beta_P, beta_R, T, Q, F_N, outside)


@kernel
def extrapolation(J, beta_P, beta_R, delta, box):
    """Largest distance of propeller and rudder outside the trained box, 0 inside or amidships."""
    blend, side = surrogate_blend(delta, box)
    if blend <= 0.0:
        return 0.0
    return max(outside_box(J, side * beta_P, box), outside_box(J, side * beta_R, box))


@kernel
def water_velocity(psi, sea):
    """Current in body axes [m/s]: along the bow and to starboard."""
    c, s = math.cos(psi), math.sin(psi)
    return sea.V_north * c + sea.V_east * s, sea.V_east * c - sea.V_north * s


@kernel
def vary_current(time, sea):
    """Set the current of this time: its mean times 1 + variation cos(omega t + phase)."""
    if sea.variation > 0.0:
        phase = sea.variation_omega * time + 2.0 * math.pi * sea.variation_phase
        factor = 1.0 + sea.variation * math.cos(phase)
        sea.V_north, sea.V_east = sea.mean_north * factor, sea.mean_east * factor


@kernel
def over_ground(states, seas):
    """Make the velocities of `states` (n, 8) through the water into those over ground, in place."""
    for i in range(len(states)):
        u_c, v_c = water_velocity(states[i, PSI], seas[i])
        states[i, U] += u_c
        states[i, V] += v_c


@kernel
def accelerations(motion, X, Y, N, inertia):
    """Accelerations of the velocities through the water from the total force, YY15.

    Returns
    -------
    u', v' [m/s2], r' [rad/s2] : float
    """
    u, v, r = motion
    b = inertia
    du = (X + b.m_v * v * r + b.m_xG * r * r) / b.m_u
    F = Y - b.m_u * u * r
    M = N - b.m_xG * u * r
    determinant = b.m_v * b.I_r - b.m_xG * b.m_xG
    return du, (b.I_r * F - b.m_xG * M) / determinant, (b.m_v * M - b.m_xG * F) / determinant
