"""THE axes, signs, units and state order of Ship Gym. Every source is converted to these.

Earth axes: x north, y east, z down. Body axes: x forward, y to starboard, z down, origin midship
at the waterline. All angles in rad, clockwise seen from above:

- ``psi`` heading, 0 = north, pi/2 = east; ``r > 0`` moves the bow to starboard;
- ``delta > 0`` turns the ship to starboard;
- ``beta = atan2(-v, u)`` drift angle, positive in a steady turn to starboard;
- ``n`` propeller speed [rev/s], negative astern;
- directions say what they mean: ``*_direction_from`` and ``*_direction_to``, from north;
- relative wave heading ``mu = psi - wave_direction_to``: pi = head sea, 0 = following sea,
  pi/2 = waves from the starboard beam.

Units are SI after loading: m, s, rad, rev/s, N, kg, W. A name outside SI carries its unit
(``speed_kn``, ``heading_deg``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

# State vector of one ship: velocities over ground in body axes, position, heading, actuators.
STATE_NAMES = ("u", "v", "r", "x", "y", "psi", "delta", "n")
STATE_UNITS = ("m/s", "m/s", "rad/s", "m", "m", "rad", "rad", "rev/s")
U, V, R, X, Y, PSI, DELTA, N = range(8)
N_STATES = 8

# Commands of one ship: rudder angle [rad] and propeller speed [rev/s].
COMMAND_NAMES = ("delta_command", "n_command")
N_COMMANDS = 2


class Component(NamedTuple):
    """One row of the force breakdown, and how it is shown.

    Attributes
    ----------
    name : str
        In ``info["forces"]``, and behind X_, Y_ and N_ as the name of a column.
    label : str
        For people.
    colour : str
        In every picture, as ``#rrggbb``; on a dark ground see `on_dark`.
    outside : bool
        Whether it comes from outside the ship; those have an arrow in a recording.
    """

    name: str
    label: str
    colour: str
    outside: bool

    @property
    def on_dark(self) -> tuple[int, int, int]:
        """Red, green and blue for a dark ground: nine parts of the colour, seven of white."""
        parts = (int(self.colour[k : k + 2], 16) for k in (1, 3, 5))
        red, green, blue = ((9 * part + 7 * 255) // 16 for part in parts)
        return red, green, blue


# Rows of the force breakdown; columns are surge X [N], sway Y [N], yaw moment N [N m] at midship.
# Hull, propeller and rudder are of the start of an interval. Those from outside are held during an
# integration step: wave drift is its mean over the first step, wind and disturbance of its middle.
FORCES = (
    Component("hull", "hull", "#1f5a94", False),
    Component("propeller", "propeller", "#2a8f82", False),
    Component("rudder", "rudder", "#b8402f", False),
    Component("wave", "wave drift", "#7d4fa6", True),
    Component("wind", "wind", "#57a5d1", True),
    Component("disturbance", "disturbance", "#b5488a", True),
)
FORCE_COMPONENTS = tuple(force.name for force in FORCES)
FORCE_AXES = ("X", "Y", "N")
N_FORCES = len(FORCES)

# Flow diagnostics that accompany the forces, of all propellers and rudders together.
FLOW_NAMES = ("J", "beta_P", "beta_R", "thrust", "torque", "rudder_normal_force", "extrapolation")
FLOW_J, FLOW_BETA_P, FLOW_BETA_R, FLOW_THRUST, FLOW_TORQUE, FLOW_F_N, FLOW_EXTRAPOLATION = range(7)
N_FLOW = 7
# Of a ship with two also those of each unit, a propeller with its rudder, in the axes of the ship:
# J_starboard ... rudder_normal_force_port. They stand behind the common ones, so that a row of
# N_FLOW columns is one of a ship with a single unit, and FLOW_OF_UNITS[:width] names either.
UNITS = ("starboard", "port")
UNIT_NAMES = ("J", "beta_P", "beta_R", "thrust", "torque", "rudder_normal_force")
FLOW_OF_UNITS = FLOW_NAMES + tuple(f"{name}_{side}" for side in UNITS for name in UNIT_NAMES)

G = 9.80665  # standard gravity [m/s2], CGPM 1901
RHO_SEA = 1026.021  # sea water at 15 C [kg/m3], ITTC 7.5-02-01-03 (2011) table 2
RHO_FRESH = 999.103  # fresh water at 15 C [kg/m3], ITTC 7.5-02-01-03 (2011) table 1
NU_SEA = 1.1892e-6  # kinematic viscosity of sea water at 15 C [m2/s], ITTC 7.5-02-01-03 (2011)
RHO_AIR = 1.225  # dry air at 15 C and 1013.25 hPa [kg/m3], ISO 2533 (1975)
NU_FRESH = 1.1386e-6  # kinematic viscosity of fresh water at 15 C [m2/s], ITTC 7.5-02-01-03 (2011)
KNOT = 1852.0 / 3600.0  # [m/s]


def wrap_angle(angle):
    """Wrap an angle into [-pi, pi).

    Parameters
    ----------
    angle : float or numpy.ndarray
        Angle [rad].

    Returns
    -------
    float or numpy.ndarray
        The same direction in [-pi, pi) [rad].
    """
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def polar(north, east):
    """Length and direction of a horizontal vector.

    Parameters
    ----------
    north, east : float or numpy.ndarray
        Components.

    Returns
    -------
    length, direction : float or numpy.ndarray
        In the unit of the components; where it points to, from north clockwise in [0, 2 pi) [rad].
    """
    return np.hypot(north, east), np.arctan2(east, north) % (2.0 * math.pi)
