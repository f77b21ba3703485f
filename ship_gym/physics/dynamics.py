"""Three-degree-of-freedom equations of motion with coupled sway and yaw (YY15)."""

from __future__ import annotations

import math

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


@kernel
def forces(motion, controls, ship, tables):
    """Force breakdown of one ship at one instant, without disturbance.

    Parameters
    ----------
    motion : (float, float, float)
        u, v [m/s], r [rad/s] through the water.
    controls : (float, float)
        Rudder angle [rad], propeller speed [rev/s].
    ship : record
        One ship of ``ship_gym.ships.records``.
    tables : (ndarray, ndarray)
        Its open-water and surrogate tables.

    Returns
    -------
    hull, propeller, rudder : (float, float, float)
        X, Y [N], N [N m] at midship.
    flow : tuple of 7 floats
        J, beta_P, beta_R [rad], thrust [N], torque [N m], rudder normal force [N], extrapolation
        (``conventions.FLOW_NAMES``).
    """
    u, v, r = motion
    # |u|: astern the drift of wake and rudder is counted from the stern, so that nothing jumps
    # where the ship backs straight; the same as atan2(-v, u) ahead
    drift = (math.sqrt(u * u + v * v), math.atan2(-v, abs(u)))
    on_hull = hull_forces(u, v, r, ship.hull, ship.rho)
    on_propeller, race, local = propeller_forces(motion, controls, drift, ship, tables)
    epsilon, beta_P = local
    on_rudder, F_N, beta_R = rudder_forces(motion, controls, drift, race, epsilon, ship, tables[1])
    J = advance_ratio(u, controls[1], ship.propeller.D)
    outside = extrapolation(J, beta_P, beta_R, controls[0], ship.surrogate)
    flow = (J, beta_P, beta_R, race[0], race[2], F_N, outside)
    return on_hull, on_propeller, on_rudder, flow


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
