"""Three-degree-of-freedom equations of motion with coupled sway and yaw (YY15)."""

from __future__ import annotations

import math
from typing import NamedTuple

from ship_gym.conventions import PSI, U, V
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import arctan2, cos_sin, cosine
from ship_gym.physics.hull import hull_forces
from ship_gym.physics.parameters import of_record
from ship_gym.physics.propeller import (
    Inflow,
    advance_ratio,
    outside_box,
    propeller_forces,
    surrogate_blend,
)
from ship_gym.physics.quantities import Controls, Flow, Force, Motion
from ship_gym.physics.rudder import rudder_forces


class OwnForces(NamedTuple):
    """Forces of the ship herself at one instant."""

    hull: Force
    propeller: Force
    rudder: Force


class Loading(NamedTuple):
    """How one propeller and its rudder are loaded: beta [rad], T [N], Q [N m], F_N [N]."""

    beta_P: float
    beta_R: float
    thrust: float
    torque: float
    F_N: float


class Units(NamedTuple):
    """Loading of each unit, in the axes of the ship; a single one is the starboard one."""

    starboard: Loading
    port: Loading


NO_UNIT = Loading(0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def total(loads):
    """Sum of some forces."""
    X, Y, N = loads[0]
    for k in range(1, len(loads)):
        load = loads[k]
        X, Y, N = X + load.X, Y + load.Y, N + load.N
    return Force(X, Y, N)


@kernel
def unit_forces(motion, controls, inflow, ship, tables):
    """Forces of one propeller with its rudder: the only one, or the starboard one.

    Returns
    -------
    propeller, rudder : Force
    loading : Loading
    """
    propeller, race, local = propeller_forces(motion, controls, inflow, ship, tables)
    epsilon, beta_P = local
    rudder, F_N, beta_R = rudder_forces(motion, controls, inflow, race, epsilon, ship, tables)
    return propeller, rudder, Loading(beta_P, beta_R, race.thrust, race.torque, F_N)


@kernel
def with_mirror_image(starboard, port):
    """Force of two units from the starboard one's and the port one's in the mirrored ship."""
    return Force(starboard.X + port.X, starboard.Y - port.Y, starboard.N - port.N)


@kernel
def mirror_image(loading):
    """Loading of the port unit from that of the starboard unit in the mirrored ship."""
    beta_P, beta_R, thrust, torque, F_N = loading
    return Loading(-beta_P, -beta_R, thrust, torque, -F_N)


@kernel
def own_forces(motion, controls, ship, tables):
    """Force breakdown and loading of one ship, as `forces`.

    Returns
    -------
    own : OwnForces
    units : Units
    """
    u, v, r = motion
    delta, n = controls
    # |u|: astern the drift of wake and rudder is counted from the stern, so that nothing jumps
    # where the ship backs straight; the same as atan2(-v, u) ahead
    U, beta = math.sqrt(u * u + v * v), arctan2(-v, abs(u))
    H = hull_forces(u, v, r, ship.hull, ship.rho)
    P, R, starboard = unit_forces(
        Motion(u, v, r), Controls(delta, n), Inflow(U, beta), ship, tables
    )
    if ship.propeller.y_P <= 0.0:
        return OwnForces(H, P, R), Units(starboard, NO_UNIT)
    motion, controls, inflow = Motion(u, -v, -r), Controls(-delta, n), Inflow(U, -beta)
    P2, R2, port = unit_forces(motion, controls, inflow, ship, tables)
    own = OwnForces(H, with_mirror_image(P, P2), with_mirror_image(R, R2))
    return own, Units(starboard, mirror_image(port))


@kernel
def flow_of(motion, controls, units, ship):
    """Flow of the ship and of its units from their loading."""
    u, _, r = motion
    delta, n = controls
    S, P = units
    D, y_P = ship.propeller.D, ship.propeller.y_P
    J, share = advance_ratio(u, n, D), 0.5 if y_P > 0.0 else 1.0
    beta_P, beta_R = share * (S.beta_P + P.beta_P), share * (S.beta_R + P.beta_R)
    outside = extrapolation(J, beta_P, beta_R, delta, ship.surrogate)
    J_S, J_P = J, 0.0
    if y_P > 0.0:
        J_S, J_P = advance_ratio(u - y_P * r, n, D), advance_ratio(u + y_P * r, n, D)
    return Flow(
        J, beta_P, beta_R, S.thrust + P.thrust, S.torque + P.torque, S.F_N + P.F_N, outside,
        J_S, S.beta_P, S.beta_R, S.thrust, S.torque, S.F_N,
        J_P, P.beta_P, P.beta_R, P.thrust, P.torque, P.F_N,
    )  # fmt: skip


@kernel
def forces(motion, controls, ship, tables):
    """Force breakdown of one ship at one instant, without the loads from outside.

    Parameters
    ----------
    motion : Motion
        Or a tuple u, v [m/s], r [rad/s] through the water.
    controls : Controls
        Or a tuple of rudder angle [rad] and propeller speed [rev/s]; of both, if there are two.
    ship : record
        One ship of ``ship_gym.ships.records``.
    tables : Tables

    Returns
    -------
    own : OwnForces
        Of all propellers and of all rudders together.
    flow : Flow
        Forces and torque of all, angles on the centreline; then those of each unit.
    """
    # named tuples, so that the versions that a step is made of serve here too
    u, v, r = motion
    delta, n = controls
    motion, controls, ship = Motion(u, v, r), Controls(delta, n), of_record(ship)
    own, units = own_forces(motion, controls, ship, tables)
    return own, flow_of(motion, controls, units, ship)


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
    c, s = cos_sin(psi)
    return sea.V_north * c + sea.V_east * s, sea.V_east * c - sea.V_north * s


@kernel
def vary_current(time, sea):
    """Set the current of this time: its mean times 1 + variation cos(omega t + phase)."""
    if sea.variation > 0.0:
        phase = sea.variation_omega * time + 2.0 * math.pi * sea.variation_phase
        factor = 1.0 + sea.variation * cosine(phase)
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
    du = (X + b.m_v * v * r + b.m_xG * r * r) * (1.0 / b.m_u)
    F = Y - b.m_u * u * r
    M = N - b.m_xG * u * r
    per_determinant = 1.0 / (b.m_v * b.I_r - b.m_xG * b.m_xG)
    dv, dr = b.I_r * F - b.m_xG * M, b.m_v * M - b.m_xG * F
    return du, dv * per_determinant, dr * per_determinant
