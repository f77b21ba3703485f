"""What no bridge knows, for the critic of an asymmetric agent or for analysis: sea and forces."""

from __future__ import annotations

import math

from ship_gym.conventions import FORCE_COMPONENTS, PSI, G
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin
from ship_gym.physics.dynamics import water_velocity
from ship_gym.tasks.base import Row
from ship_gym.tasks.bridge import clipped

_FORCES = tuple(
    Row(
        f"{axis}_{name}",
        f"{axis}_{name}'",
        "-",
        -5.0,
        5.0,
        f"{axis} of {name}, by 1/2 rho L d U0^2{length}",
        mirror,
    )
    for name in FORCE_COMPONENTS
    for axis, length, mirror in (("X", "", 1), ("Y", "", -1), ("N", " L", -1))
)
OBSERVATIONS = (
    Row("current_ahead", "u_c / U0", "-", -3.0, 3.0, "current along the bow", 1),
    Row("current_to_starboard", "v_c / U0", "-", -3.0, 3.0, "current to starboard", -1),
    Row("wind_ahead", "u_w / U0", "-", -20.0, 20.0, "mean wind along the bow, over ground", 1),
    Row(
        "wind_to_starboard", "v_w / U0", "-", -20.0, 20.0, "mean wind to starboard, over ground", -1
    ),
    Row("wave_height", "H_s / d", "-", 0.0, 5.0, "significant wave height", 1),
    Row("wave_period", "T_p sqrt(g/L) / 2 pi", "-", 0.0, 5.0, "peak period; 0 without waves", 1),
    Row(
        "sin_encounter",
        "sin(mu)",
        "-",
        -1.0,
        1.0,
        "of the encounter angle psi - wave_direction_to; 0 without waves",
        -1,
    ),
    Row(
        "cos_encounter",
        "cos(mu)",
        "-",
        -1.0,
        1.0,
        "-1 in a head sea, 1 in a following one; 0 without waves",
        1,
    ),
    *_FORCES,
)
_LOW = tuple(row.low for row in OBSERVATIONS)
_HIGH = tuple(row.high for row in OBSERVATIONS)
_SEA = len(OBSERVATIONS) - len(_FORCES)


@kernel
def observe(state, forces, ship, sea, task, first, row):
    """Write sea and forces of one ship from column `first` on; zero forces after a reset."""
    psi = state[PSI]
    c, s = cos_sin(psi)
    u_c, v_c = water_velocity(psi, sea)
    wet = 1.0 if task.wave_height > 0.0 else 0.0
    cos_mu, sin_mu = cos_sin(psi - task.wave_to)
    values = (
        u_c / task.speed,
        v_c / task.speed,
        (sea.wind_north * c + sea.wind_east * s) / task.speed,
        (sea.wind_east * c - sea.wind_north * s) / task.speed,
        task.wave_height / ship.hull.d,
        task.wave_period * math.sqrt(G / task.L) / (2.0 * math.pi),
        wet * sin_mu,
        wet * cos_mu,
    )
    for k in range(_SEA):
        row[first + k] = clipped(values[k], _LOW[k], _HIGH[k])
    unit = 0.5 * ship.rho * task.L * ship.hull.d * task.speed * task.speed
    for k in range(forces.shape[0]):
        for axis in range(3):
            share = forces[k, axis] / (unit * task.L if axis == 2 else unit)
            column = _SEA + 3 * k + axis
            row[first + column] = clipped(share, _LOW[column], _HIGH[column])
