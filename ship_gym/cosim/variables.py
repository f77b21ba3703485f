"""Variables of a ship as a unit of co-simulation: names, units, meaning, and groups of OSP.

Names follow those of the demo cases of the Open Simulation Platform where these have one
(``ned_position.north``, ``body_velocity.surge``, ``wind_forces.yaw``); OSP-IS itself fixes units
and kinds of groups, not names. Axes, signs and units are those of ``ship_gym.conventions``.
"""

from __future__ import annotations

from typing import NamedTuple

from ship_gym.conventions import FLOW_NAMES, FLOW_OF_UNITS, FORCES, N_FLOW, STATE_NAMES, UNITS
from ship_gym.physics.waves import WAVE_NAMES

REAL, WHOLE, SWITCH, TEXT = "Real", "Integer", "Boolean", "String"
INPUT, OUTPUT, PARAMETER = "input", "output", "parameter"


class Variable(NamedTuple):
    """One variable of the unit.

    Attributes
    ----------
    name : str
    causality : str
        ``input``, ``output`` or ``parameter``; a parameter is fixed once the unit is initialised.
    kind : str
        ``Real``, ``Integer``, ``Boolean`` or ``String``.
    unit : str
        Of `UNIT_DEFINITIONS`; empty: a number without unit, or no number.
    meaning : str
    low, high : float or None
        Range of a parameter, ends included.
    """

    name: str
    causality: str
    kind: str
    unit: str
    meaning: str
    low: float | None = None
    high: float | None = None


class Unit(NamedTuple):
    """A unit as FMI defines it: exponents of base units, its factor, and how people read it.

    Attributes
    ----------
    exponents : dict
        Of base units kg, m, s, rad.
    factor : float
        Base units in one of it.
    display : tuple of (str, float)
        Name and number of display units in one of it.
    """

    exponents: dict[str, int]
    factor: float = 1.0
    display: tuple[tuple[str, float], ...] = ()


_DEG, _TURN = 57.29577951308232, 6.283185307179586
UNIT_DEFINITIONS = {
    "m": Unit({"m": 1}),
    "m/s": Unit({"m": 1, "s": -1}, display=(("kn", 3600.0 / 1852.0),)),
    "rad": Unit({"rad": 1}, display=(("deg", _DEG),)),
    "rad/s": Unit({"rad": 1, "s": -1}, display=(("deg/s", _DEG), ("deg/min", 60.0 * _DEG))),
    "rev/s": Unit({"rad": 1, "s": -1}, _TURN, (("rpm", 60.0),)),
    "N": Unit({"kg": 1, "m": 1, "s": -2}, display=(("kN", 1e-3),)),
    "N.m": Unit({"kg": 1, "m": 2, "s": -2}, display=(("kN.m", 1e-3),)),
    "deg": Unit({"rad": 1}, _TURN / 360.0),
    "s": Unit({"s": 1}),
}

RUDDER, PROPELLER = "rudder.command", "propeller.command"
INPUTS = (
    Variable(RUDDER, INPUT, REAL, "rad", "ordered rudder angle, positive turns her to starboard"),
    Variable(PROPELLER, INPUT, REAL, "rev/s", "ordered propeller speed, negative astern"),
)

# name of each of STATE_NAMES in the unit, and what it is
_STATES = {
    "u": ("body_velocity.surge", "m/s", "velocity over ground ahead, at midship"),
    "v": ("body_velocity.sway", "m/s", "velocity over ground to starboard, at midship"),
    "r": ("body_velocity.yaw", "rad/s", "yaw rate, positive: bow to starboard"),
    "x": ("ned_position.north", "m", "midship north of the start"),
    "y": ("ned_position.east", "m", "midship east of the start"),
    "psi": ("ned_position.yaw", "rad", "heading, 0 north, pi/2 east; counts on over 2 pi"),
    "delta": ("rudder.angle", "rad", "rudder angle, positive turns her to starboard"),
    "n": ("propeller.speed", "rev/s", "propeller speed, negative astern"),
}
STATES = tuple(Variable(_STATES[name][0], OUTPUT, REAL, *_STATES[name][1:]) for name in STATE_NAMES)

_AXES = (("surge", "N", "ahead"), ("sway", "N", "to starboard"), ("yaw", "N.m", "bow to starboard"))
LOADS = tuple(
    tuple(
        Variable(f"{force.name}_forces.{axis}", OUTPUT, REAL, unit, f"of {force.label}, {way}")
        for axis, unit, way in _AXES
    )
    for force in FORCES
)

_FLOWS = {
    "J": ("", "advance ratio of the propeller"),
    "beta_P": ("rad", "drift angle at the propeller"),
    "beta_R": ("rad", "inflow angle at the rudder"),
    "thrust": ("N", "thrust"),
    "torque": ("N.m", "torque of the propeller"),
    "rudder_normal_force": ("N", "normal force of the rudder"),
    "extrapolation": ("", "how far outside of what the surrogate was fitted to, 0 inside"),
}


def _flow(name: str) -> Variable:
    side = next((side for side in UNITS if name.endswith(f"_{side}")), "")
    plain = name.removesuffix(f"_{side}") if side else name
    unit, meaning = _FLOWS[plain]
    whose = f", {side}" if side else ""
    return Variable(f"flow.{name}", OUTPUT, REAL, unit, meaning + whose)


FLOW = tuple(_flow(name) for name in FLOW_NAMES)
FLOW_OF_TWO = tuple(_flow(name) for name in FLOW_OF_UNITS[N_FLOW:])

# of the wave state; its drift is in the loads, and its step length says nothing outside
_MOTIONS = {
    "sway": ("m", "to starboard"),
    "sway_velocity": ("m/s", "velocity to starboard"),
    "roll": ("rad", "roll about the axis ahead"),
    "yaw": ("rad", "yaw"),
    "yaw_rate": ("rad/s", "yaw rate"),
}
MOTIONS = {
    WAVE_NAMES.index(name): Variable(
        f"wave_motion.{name}", OUTPUT, REAL, unit, f"wave-frequency motion: {meaning}"
    )
    for name, (unit, meaning) in _MOTIONS.items()
}

ELEVATION = Variable(
    "wave_elevation.midship", OUTPUT, REAL, "m", "surface of the sea at midship, positive up"
)
CURRENT = (
    Variable("current.north", OUTPUT, REAL, "m/s", "velocity of the water now, to north"),
    Variable("current.east", OUTPUT, REAL, "m/s", "velocity of the water now, to east"),
)
PLACE = (
    Variable("position.latitude", OUTPUT, REAL, "deg", "WGS84 latitude, north positive"),
    Variable("position.longitude", OUTPUT, REAL, "deg", "WGS84 longitude, east positive"),
)


def _given(name: str, kind: str, unit: str, meaning: str, *limits: float) -> Variable:
    return Variable(name, PARAMETER, kind, unit, meaning, *limits)


PARAMETERS = (
    _given("ship.name", TEXT, "", "ship of the package, or a ship file in resources/ships"),
    _given("ship.surrogate", TEXT, "", "propeller and rudder; empty: the default of the ship"),
    _given("ship.variant", TEXT, "", "hull set; empty: the default of the ship"),
    _given("sea.name", TEXT, "", "named sea at the scale of the ship; calm: none"),
    _given("sea.wave_height", REAL, "m", "of waves instead of the named sea's; 0: those", 0, 30),
    _given("sea.wave_period", REAL, "s", "peak period of these waves", 0.1, 40),
    _given("sea.regular", SWITCH, "", "they are one regular wave; else JONSWAP, height is H_s"),
    _given("sea.spreading", REAL, "", "s of cos^(2s), 1 to 100; 0: long-crested", 0, 100),
    _given("sea.wave_direction_from", REAL, "rad", "where waves come from", -_TURN, _TURN),
    _given("sea.swell_height", REAL, "m", "H_s of a swell beside the waves; 0: none", 0, 30),
    _given("sea.swell_period", REAL, "s", "its peak period", 0.1, 40),
    _given("sea.swell_spreading", REAL, "", "its spreading", 0, 100),
    _given("sea.swell_direction_from", REAL, "rad", "where it comes from", -_TURN, _TURN),
    _given("sea.wind_speed", REAL, "m/s", "instead of the named sea's; 0: that", 0, 60),
    _given("sea.wind_direction_from", REAL, "rad", "where wind comes from", -_TURN, _TURN),
    _given("sea.gusts", SWITCH, "", "whether the wind has gusts"),
    _given("sea.current_speed", REAL, "m/s", "instead of the named sea's; 0: that", 0, 10),
    _given("sea.current_direction_to", REAL, "rad", "where this current flows", -_TURN, _TURN),
    _given("sea.current_variation", REAL, "", "share by which it varies slowly", 0, 1),
    _given("sea.current_period", REAL, "s", "period of that", 1, 1e6),
    _given("seed", WHOLE, "", "of the phases of waves, gusts, current, disturbance", 0, 2**31 - 1),
    _given("start.speed", REAL, "m/s", "through the water, straight ahead", -100, 100),
    _given("start.heading", REAL, "rad", "0 is north", -_TURN, _TURN),
    _given("start.self_propulsion", SWITCH, "", "propeller starts at the speed that holds this"),
    _given("start.propeller_speed", REAL, "rev/s", "without self-propulsion: at this", -1e3, 1e3),
    _given("integration.interval", REAL, "s", "longest step inside; 0: that of the ship", 0, 1e3),
)
START_PLACE = (
    _given("start.latitude", REAL, "deg", "of the start", -90, 90),
    _given("start.longitude", REAL, "deg", "of the start", -540, 540),
)


def variables(propellers: int, placed: bool) -> tuple[Variable, ...]:
    """All variables of a unit, in the order of its model description.

    Parameters
    ----------
    propellers : int
        Of the ship, 1 or 2; with two the flow of each side is there too.
    placed : bool
        Whether the start has a place on the earth.
    """
    loads = tuple(variable for component in LOADS for variable in component)
    return (
        *INPUTS,
        *STATES,
        *loads,
        *FLOW,
        *(FLOW_OF_TWO if propellers == 2 else ()),
        *MOTIONS.values(),
        ELEVATION,
        *CURRENT,
        *(PLACE if placed else ()),
        *PARAMETERS,
        *(START_PLACE if placed else ()),
    )
