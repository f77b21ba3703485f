"""Sentences of what the instruments show. Fields, signs and units: docs/autopilot_loop.md."""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable
from typing import NamedTuple

from ship_gym.conventions import KNOT
from ship_gym_agents.serve.instruments import Seen, relative
from ship_gym_agents.serve.voyage import OnLeg

MILE = 1852.0  # [m]
# kind -> who talks: gyro, turn indicator, steering gear, Doppler log, satellite receiver, weather
# instruments, electronic chart; and how often in a second. In the order in which they are sent.
TALKERS = {
    "HDT": "HE",
    "ROT": "TI",
    "RSA": "SG",
    "VBW": "VD",
    "RMC": "GP",
    "GGA": "GP",
    "MWV": "WI",
    "XTE": "EC",
    "APB": "EC",
}
RATES = {"HDT": 10.0, "ROT": 10.0, "RSA": 5.0} | dict.fromkeys(list(TALKERS)[3:], 1.0)


class Fix(NamedTuple):
    """What is said of an instant.

    Attributes
    ----------
    seen : Seen
    latitude, longitude : float
        WGS84 [deg].
    utc : datetime
    leg : OnLeg or None
        Where she is on the route; None: no route.
    simulated : bool
        Whether receivers are told that the position is a simulator's.
    """

    seen: Seen
    latitude: float
    longitude: float
    utc: datetime.datetime
    leg: OnLeg | None
    simulated: bool


Fields = list[str]


def sentences_of(kind: str, fix: Fix) -> list[Fields]:
    """Fields of the sentences of a kind; none where there is nothing to say: no wind, no route."""
    return _FIELDS[kind](fix)


def _hdt(fix: Fix) -> list[Fields]:
    return [[_bearing(fix.seen.heading), "T"]]


def _rot(fix: Fix) -> list[Fields]:
    return [[_fixed(math.degrees(fix.seen.rate) * 60.0, 2), "A"]]


def _rsa(fix: Fix) -> list[Fields]:
    angle = _fixed(math.degrees(fix.seen.rudder), 2)
    return [[angle, "A", angle, "A"] if fix.seen.rudders == 2 else [angle, "A", "", "V"]]


def _vbw(fix: Fix) -> list[Fields]:
    now = fix.seen
    water = [_fixed(value / KNOT, 3) for value in (now.surge, now.sway)]
    ground = [_fixed(value / KNOT, 3) for value in (now.ground_surge, now.ground_sway)]
    return [[*water, "A", *ground, "A"]]


def _rmc(fix: Fix) -> list[Fields]:
    now = fix.seen
    motion = [_fixed(now.speed / KNOT, 3), _bearing(now.course)]
    mode, status = ("S", "V") if fix.simulated else ("A", "A")  # V goes with every mode but A, D
    date = fix.utc.strftime("%d%m%y")
    return [[_time(fix), status, *_place(fix), *motion, date, "", "", mode]]


def _gga(fix: Fix) -> list[Fields]:
    quality = "8" if fix.simulated else "1"
    return [[_time(fix), *_place(fix), quality, "12", "0.8", "0.0", "M", "0.0", "M", "", ""]]


def _mwv(fix: Fix) -> list[Fields]:
    if fix.seen.wind is None:
        return []
    found = []
    for reference, moving in (("R", True), ("T", False)):
        angle, speed = relative(fix.seen, moving)
        found.append([_bearing(angle, 1), reference, _fixed(speed / KNOT, 2), "N", "A"])
    return found


def _xte(fix: Fix) -> list[Fields]:
    return [] if fix.leg is None else [["A", "A", *_off(fix.leg), "N"]]


def _apb(fix: Fix) -> list[Fields]:
    leg = fix.leg
    if leg is None:
        return []
    flags = ["A" if flag else "V" for flag in (leg.arrived, leg.passed)]
    bearings = [[_bearing(angle), "T"] for angle in (leg.bearing, leg.bearing_there, leg.to_steer)]
    return [["A", "A", *_off(leg), "N", *flags, *bearings[0], leg.name, *bearings[1], *bearings[2]]]


_FIELDS: dict[str, Callable[[Fix], list[Fields]]] = {
    "HDT": _hdt,
    "ROT": _rot,
    "RSA": _rsa,
    "VBW": _vbw,
    "RMC": _rmc,
    "GGA": _gga,
    "MWV": _mwv,
    "XTE": _xte,
    "APB": _apb,
}


def _off(leg: OnLeg) -> list[str]:
    """Cross-track error [nautical miles] and the side to steer to: to port when she is off it."""
    return [_fixed(abs(leg.cross) / MILE, 4), "L" if leg.cross > 0.0 else "R"]


def _fixed(value: float, places: int) -> str:
    """A number without an exponent, and without -0."""
    text = f"{value:.{places}f}"
    return text.lstrip("-") if float(text) == 0.0 else text


def _bearing(angle: float, places: int = 2) -> str:
    """Degrees in [0, 360), rounded first: 359.999 is 0.00."""
    degrees = round(math.degrees(angle), places) % 360.0
    return f"{degrees:0{places + 4}.{places}f}"


def _time(fix: Fix) -> str:
    return fix.utc.strftime("%H%M%S.") + f"{fix.utc.microsecond // 10000:02d}"


def _place(fix: Fix) -> Fields:
    """Latitude ddmm.mmmmm N or S, longitude dddmm.mmmmm E or W."""
    found = []
    for value, width, sides in ((fix.latitude, 2, "NS"), (fix.longitude, 3, "EW")):
        whole, hundred_thousandths = divmod(round(abs(value) * 6e6), 6_000_000)
        minutes = f"{hundred_thousandths / 1e5:08.5f}"
        found += [f"{whole:0{width}d}{minutes}", sides[value < 0.0]]
    return found
