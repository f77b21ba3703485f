"""Crash stop, coasting, acceleration, pull-out and spiral: sailed in degrees, as data and text."""

from __future__ import annotations

import dataclasses
import math
import shlex
from collections.abc import Callable
from typing import Any

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.manoeuvres import imo_limits
from ship_gym.reports.case import sea_of
from ship_gym.reports.manoeuvre import CONDITION, estimates
from ship_gym.reports.measures import in_kilo
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion
from ship_gym.stability import PullOut, Spiral, pull_out, spiral
from ship_gym.stopping import SpeedChange, acceleration, coasting, neutral_angle, stopping
from ship_gym.text import paragraph, table

_DEG = 180.0 / math.pi
_LARGE = 20.0  # L, to which an Administration may go for large ships (MSC.137(76))
_STRAIGHT = 1e-3  # difference of r' left by a pull-out that counts as none


@dataclasses.dataclass(frozen=True)
class Kind:
    """A manoeuvre of this module.

    Attributes
    ----------
    sail : callable
        Function of ``ship_gym.stopping`` or ``ship_gym.stability``.
    title : str
        For people.
    delta_deg : float or None
        Rudder angle if none is given [deg]; None: the ship's neutral angle.
    ordered : bool
        Whether it takes a propeller order.
    quantities : dict
        Measure to label, unit of display, factor, digits.
    """

    sail: Callable[..., Any]
    title: str
    delta_deg: float | None
    ordered: bool
    quantities: dict[str, tuple[str, str, float, int]]


_WAY = {
    "track_reach": ("track reach", "L", 1.0, 2),
    "head_reach": ("head reach", "L", 1.0, 2),
    "lateral_deviation": ("lateral deviation, to starboard", "L", 1.0, 2),
    "heading_change": ("change of heading, to starboard", "deg", _DEG, 1),
    "time": ("time", "s", 1.0, 1),
    "speed_ratio": ("speed at the end U/U0", "-", 1.0, 3),
    "final_n": ("propeller speed at the end", "rev/s", 1.0, 3),
}
_ASTERN = {
    "reversal": ("propeller turns astern after", "s", 1.0, 1),
    "largest_astern_thrust": ("largest thrust astern", "N", 1.0, 2),
}
_PULL_OUT = {
    "turning_rate_starboard": ("yaw rate r L/U of the turn to starboard", "-", 1.0, 3),
    "turning_rate_port": ("yaw rate r L/U of the turn to port", "-", 1.0, 3),
    "residual_starboard": ("left with rudder neutral, after starboard", "-", 1.0, 4),
    "residual_port": ("left with rudder neutral, after port", "-", 1.0, 4),
    "residual_difference": ("difference of the two", "-", 1.0, 4),
    "half_time": ("yaw rate halves after", "s", 1.0, 1),
}
_SPIRAL = {
    "loop_width": ("width of the loop", "deg", _DEG, 2),
    "loop_height": ("height of the loop in r L/U", "-", 1.0, 4),
    "neutral_angle": ("neutral rudder angle", "deg", _DEG, 2),
    "slope": ("slope of r L/U over the rudder, end to end", "1/rad", 1.0, 2),
}
# what the user types -> the manoeuvre
KINDS = {
    "stopping": Kind(stopping, "crash stop", None, True, _WAY | _ASTERN),
    "coasting": Kind(coasting, "coasting with the engine stopped", None, False, _WAY),
    "acceleration": Kind(acceleration, "acceleration from rest", None, False, _WAY),
    "pull_out": Kind(pull_out, "pull-out", 20.0, False, _PULL_OUT),
    "spiral": Kind(spiral, "direct spiral", 15.0, False, _SPIRAL),
}


@dataclasses.dataclass(frozen=True)
class Handling:
    """A manoeuvre that has been sailed: what, rudder [rad], speed [m/s], n [rev/s] and result."""

    ship: Ship
    manoeuvre: str
    delta: float
    speed: float
    n: float
    sea: str
    result: SpeedChange | PullOut | Spiral


def sail_handling(
    ship: Ship,
    manoeuvre: str,
    *,
    delta_deg: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    order: float | None = None,
    sea: str = "calm",
    wave_height: float | None = None,
    wavelength: float | None = None,
    wave_from_deg: float | None = None,
) -> Handling:
    """Sail one of `KINDS` with its rudder in degrees.

    Parameters
    ----------
    ship : Ship
    manoeuvre : str
        Key of `KINDS`.
    delta_deg : float, optional
        Rudder angle [deg]: held in a stop (neutral), of the turns of a pull-out (20), largest of
        a spiral (15).
    speed, n : float, optional
        Approach speed [m/s] and propeller speed [rev/s]; nominal speed and self-propulsion.
    order : float, optional
        Propeller speed astern of a crash stop [rev/s], negative; the largest if omitted.
    sea, wave_height, wavelength, wave_from_deg
        As in ``case.sail``.

    Raises
    ------
    ConfigError
        Unknown manoeuvre or sea, a value out of range, an order that it does not take.
    """
    kind = KINDS[check_known("manoeuvre", manoeuvre, KINDS)]
    limit = math.degrees(ship.gear.delta_max) * (1.0 + 1e-12)
    given = kind.delta_deg if delta_deg is None else delta_deg
    given = math.degrees(neutral_angle(ship)) if given is None else given
    delta = math.radians(check_number("delta", given, -limit, limit, "deg"))
    delta = min(max(delta, -ship.gear.delta_max), ship.gear.delta_max)
    speed = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    water, label = sea_of(ship, sea, wave_height, wavelength, wave_from_deg)
    n = self_propulsion(ship, speed) if n is None else n
    options: dict[str, Any] = {"delta": delta, "speed": speed, "n": n, "sea": water}
    if kind.ordered:
        options["order"] = order
    elif order is not None:
        raise ConfigError(f"order: {kind.title} has none; it is of a crash stop")
    return Handling(ship, manoeuvre, delta, speed, n, label, kind.sail(ship, **options))


def title(case: Handling) -> str:
    """One line: ship, manoeuvre; condition."""
    what = KINDS[case.manoeuvre].title
    if case.delta != 0.0:
        what += f", rudder {math.degrees(case.delta):.3g} deg"
    fn = case.ship.froude(case.speed)
    speed = f"{case.speed:.4g} m/s (Fn {fn:.3f}), {case.n:.4g} rev/s"
    return f"{case.ship.name}: {what}{CONDITION}{speed}, sea: {case.sea}"


def _shown(case: Handling) -> dict[str, tuple[str, str, float, int]]:
    """Label, unit, value and digits of each measure."""
    found = {}
    measures = case.result.measures()
    for name, (label, unit, factor, digits) in KINDS[case.manoeuvre].quantities.items():
        value = measures[name] * factor
        unit, factor, digits = in_kilo(unit, value, digits)
        found[name] = (label, unit, factor * value, digits)
    return found


def as_dict(case: Handling) -> dict[str, Any]:
    """The manoeuvre as plain numbers, for ``--json``; degrees, the rest in SI or L."""
    quantities = KINDS[case.manoeuvre].quantities
    measures = case.result.measures()
    values = {name: measures[name] * factor for name, (_, _, factor, _) in quantities.items()}
    found = {
        "ship": case.ship.name,
        "surrogate": case.ship.surrogate_name,
        "variant": case.ship.variant,
        "manoeuvre": case.manoeuvre,
        "delta_deg": math.degrees(case.delta),
        "speed": case.speed,
        "n": case.n,
        "sea": case.sea,
        "units": {name: unit for name, (_, unit, _, _) in quantities.items()},
        "measures": {k: v if math.isfinite(v) else None for k, v in values.items()},
        "estimated": case.ship.estimated,
        "implausible": list(case.ship.implausible),
    }
    if case.manoeuvre == "stopping":
        limit = imo_limits(case.ship, case.speed)["track_reach"]
        passes = values["track_reach"] <= limit
        found["imo"] = {"track_reach": {"limit": limit, "large_ships": _LARGE, "pass": passes}}
    if isinstance(case.result, Spiral):
        found["curve"] = {
            "delta_deg": [math.degrees(delta) for delta in case.result.delta],
            "yaw_rate": list(case.result.yaw_rate),
        }
    return found


def as_text(case: Handling, files: list[str], name: str) -> str:
    """The manoeuvre as a report for people, with the files written and what to do next."""
    cells = [
        [label, f"[{unit}]", "none" if math.isnan(value) else f"{value:.{digits}f}"]
        for label, unit, value, digits in _shown(case).values()
    ]
    lines = [title(case), f"hull set {case.ship.variant}, surrogate {case.ship.surrogate_name}"]
    lines += ["", table(["measure", "unit", "computed"], cells, left=2), "", _verdict(case)]
    lines += [f"wrote {', '.join(files)}", "", estimates(case.ship)]
    kinds = list(KINDS)
    other = kinds[(kinds.index(case.manoeuvre) + 1) % len(kinds)]
    lines.append(f"next: ship-gym simulate {other} --ship {shlex.quote(name)}")
    return "\n".join(lines)


def _verdict(case: Handling) -> str:
    """What the measures say, and what the model leaves out."""
    if isinstance(case.result, SpeedChange):
        reach = case.result.track_reach
        return _stop_verdict(case, reach) if case.manoeuvre == "stopping" else "no limit of IMO"
    if case.sea != "calm":
        return "in this sea: what is left is of waves, wind and current too"
    if isinstance(case.result, PullOut):
        left = abs(case.result.residual_difference)
        return "she goes straight again" if left < _STRAIGHT else "she keeps turning: unstable"
    if case.result.loop_width == 0.0:
        return "no loop: stable on a straight course"
    return paragraph(
        f"unstable on a straight course: two yaw rates over {case.result.loop_width * _DEG:.2f} "
        "deg of rudder (known to a quarter of the step)"
    )


def _stop_verdict(case: Handling, reach: float) -> str:
    limit = imo_limits(case.ship, case.speed)["track_reach"]
    return paragraph(
        f"IMO MSC.137(76): track reach at most {limit:.0f} L from full ahead, {_LARGE:.0f} L for "
        f"large ships if the Administration allows it; computed {reach:.2f} L: "
        f"{'pass' if reach <= limit else 'above it'}. The engine is an estimate, and a reversed "
        "propeller has no side force here, so she does not turn of her own"
    )
