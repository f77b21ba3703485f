"""One manoeuvre: what was asked, what came out, what was measured, what IMO allows."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.manoeuvres import TurningCircle, ZigZag, imo_limits, turning_circle, zigzag
from ship_gym.reports.balance import steady_balance
from ship_gym.reports.text import paragraph, percent, table
from ship_gym.sea.state import load_sea
from ship_gym.ships.particulars import Ship, Trial
from ship_gym.simulation import self_propulsion

# what the user types -> the name in ship files
MANOEUVRES = {"turning": "turning_circle", "zigzag": "zigzag"}
_TURNING_DEG, _ZIGZAG_DEG = 35.0, 10.0  # rudder angle if none is given
_SAME = 0.02  # speed and propeller speed of a matching trial agree within this fraction
CONDITION = "; "  # between manoeuvre and condition in a title
_DEG = 180.0 / math.pi

# measure -> (label, unit of display, factor from the result's unit, digits)
_QUANTITIES: dict[str, tuple[str, str, float, int]] = {
    "advance": ("advance", "L", 1.0, 2),
    "transfer": ("transfer", "L", 1.0, 2),
    "tactical_diameter": ("tactical diameter", "L", 1.0, 2),
    "max_advance": ("maximum advance", "L", 1.0, 2),
    "max_transfer": ("maximum transfer", "L", 1.0, 2),
    "steady_diameter": ("steady diameter", "L", 1.0, 2),
    "steady_speed_ratio": ("steady speed ratio U/U0", "-", 1.0, 3),
    "steady_drift": ("steady drift angle", "deg", _DEG, 1),
    "steady_yaw_rate": ("steady yaw rate r L/U", "-", 1.0, 3),
    "steady_J": ("steady advance ratio J", "-", 1.0, 3),
    "steady_thrust": ("steady thrust", "N", 1.0, 2),
    "steady_torque": ("steady torque", "N m", 1.0, 4),
    "rudder_normal_force": ("rudder normal force, whole", "N", 1.0, 2),
    "movable_normal_force": ("  by area on the movable part", "N", 1.0, 2),
    "drift_distance": ("drift from 180 to 540 deg", "L", 1.0, 2),
    "drift_direction": ("  direction from north", "deg", _DEG, 0),
    "overshoot_1": ("first overshoot", "deg", _DEG, 1),
    "overshoot_2": ("second overshoot", "deg", _DEG, 1),
    "overshoot_3": ("third overshoot", "deg", _DEG, 1),
    "overshoot_4": ("fourth overshoot", "deg", _DEG, 1),
    "initial_turning": ("way to first reversal", "L", 1.0, 2),
    "period": ("period", "s", 1.0, 1),
}
_ONLY_IN_A_SEA = ("drift_distance", "drift_direction")
# rudder/heading [deg] of a zig-zag -> limit of `imo_limits` -> measure
_IMO_ZIGZAG = {
    (10, 10): {
        "initial_turning": "initial_turning",
        "overshoot_10_10_first": "overshoot_1",
        "overshoot_10_10_second": "overshoot_2",
    },
    (20, 20): {"overshoot_20_20_first": "overshoot_1"},
}


@dataclasses.dataclass(frozen=True)
class Case:
    """A manoeuvre that has been sailed.

    Attributes
    ----------
    manoeuvre : str
        ``"turning_circle"`` or ``"zigzag"``.
    delta, psi : float
        Rudder angle and heading of the reversals (0 in a turning circle) [rad].
    speed, n : float
        Approach speed [m/s] and propeller speed [rev/s].
    sea : str
        Name of the sea.
    trial : Trial or None
        Measured manoeuvre with the same rudder, heading and speed.
    """

    ship: Ship
    manoeuvre: str
    delta: float
    psi: float
    speed: float
    n: float
    sea: str
    result: TurningCircle | ZigZag
    trial: Trial | None


@dataclasses.dataclass(frozen=True)
class Row:
    """One measure in the unit of display; `limit` is IMO's, if there is one."""

    name: str
    computed: float
    measured: float | None = None
    limit: float | None = None

    @property
    def difference(self) -> float | None:
        """100 (computed - measured) / measured [%]; None without a measurement."""
        return None if self.measured is None else 100.0 * (self.computed / self.measured - 1.0)

    @property
    def passes(self) -> bool:
        """Whether the computed value is within IMO's limit."""
        return self.limit is None or self.computed <= self.limit


def sail(
    ship: Ship,
    manoeuvre: str = "turning",
    *,
    delta_deg: float | None = None,
    psi_deg: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    sea: str = "calm",
) -> Case:
    """Sail a manoeuvre given in degrees, beside the trial it belongs to.

    Parameters
    ----------
    ship : Ship
    manoeuvre : str
        ``"turning"`` or ``"zigzag"``.
    delta_deg, psi_deg : float, optional
        Rudder angle and heading of the reversals [deg], positive to starboard. Turning circle:
        35; zig-zag: 10, and each is the other if only one is given.
    speed : float, optional
        Approach speed [m/s]; the ship's nominal speed if omitted.
    n : float, optional
        Propeller speed [rev/s]; that of the matching trial, else self-propulsion, if omitted.
    sea : str
        Named sea.

    Raises
    ------
    ConfigError
        Unknown manoeuvre or sea, or a value out of range.
    """
    kind = MANOEUVRES[check_known("manoeuvre", manoeuvre, MANOEUVRES)]
    delta, psi = _angles(ship, kind, delta_deg, psi_deg)
    speed = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    trial = _matching_trial(ship, kind, delta, psi, speed, n) if sea == "calm" else None
    if n is None:
        n = self_propulsion(ship, speed) if trial is None or trial.n is None else trial.n
    if kind == "turning_circle":
        result = turning_circle(ship, delta, speed, n, load_sea(sea))
    else:
        result = zigzag(ship, delta, psi, speed, n, load_sea(sea))
    return Case(ship, kind, delta, psi, speed, n, sea, result, trial)


def sail_trials(ship: Ship) -> list[Case]:
    """Sail every trial of a ship file.

    Raises
    ------
    ConfigError
        The ship has none.
    """
    if not ship.trials:
        raise ConfigError(f"{ship.name}: its ship file has no trial to compare with")
    names = {kind: name for name, kind in MANOEUVRES.items()}
    cases = []
    for t in ship.trials:
        check_known(f"manoeuvre in a trial of {ship.name}", t.manoeuvre, names)
        case = sail(
            ship,
            names[t.manoeuvre],
            delta_deg=t.delta_deg,
            psi_deg=t.psi_deg or None,
            speed=t.speed,
            n=t.n,
        )
        cases.append(dataclasses.replace(case, trial=t))
    return cases


def _angles(ship: Ship, kind: str, delta_deg: float | None, psi_deg: float | None):
    """Checked rudder angle and heading [rad] from degrees."""
    limit = math.degrees(ship.gear.delta_max) * (1.0 + 1e-12)
    if kind == "turning_circle":
        if psi_deg is not None:
            raise ConfigError("psi: a turning circle has no heading to reverse at")
        delta_deg, psi_deg = _TURNING_DEG if delta_deg is None else delta_deg, 0.0
    else:
        given = [angle for angle in (delta_deg, psi_deg, _ZIGZAG_DEG) if angle is not None]
        delta_deg = given[0]
        psi_deg = given[0] if psi_deg is None else psi_deg
    check_number("delta", delta_deg, -limit, limit, "deg")
    check_number("psi", psi_deg, -90.0, 90.0, "deg")
    # degrees of the limit itself must not fail on the last bit
    delta = min(max(math.radians(delta_deg), -ship.gear.delta_max), ship.gear.delta_max)
    return delta, math.radians(psi_deg)


def _matching_trial(
    ship: Ship, kind: str, delta: float, psi: float, speed: float, n: float | None
) -> Trial | None:
    """First trial with this manoeuvre, these angles and this speed and propeller speed."""
    for t in ship.trials:
        same = t.manoeuvre == kind and abs(t.delta_deg - math.degrees(delta)) < 0.01
        same = same and abs(t.psi_deg - math.degrees(psi)) < 0.01
        same = same and abs(t.speed - speed) <= _SAME * t.speed
        if same and (n is None or t.n is None or abs(t.n - n) <= _SAME * t.n):
            return t
    return None


def rows(case: Case) -> list[Row]:
    """Measures of a case in units of display, with what was measured and what IMO allows."""
    measured, limits = _measured(case), _limits(case)
    found = []
    for name, value in _flat(case.result.measures()).items():
        if name not in _QUANTITIES or (name in _ONLY_IN_A_SEA and case.sea == "calm"):
            continue
        factor = _QUANTITIES[name][2]
        limit = limits.get(name)
        limit = None if limit is None else limit * factor
        found.append(Row(name, value * factor, measured.get(name), limit))
    return found


def _flat(measures: dict[str, Any]) -> dict[str, float]:
    """Measures with the overshoots of a zig-zag numbered from 1."""
    flat = {}
    for name, value in measures.items():
        if name == "overshoots":
            flat.update({f"overshoot_{k}": x for k, x in enumerate(value, start=1)})
        elif not isinstance(value, tuple):
            flat[name] = value
    return flat


def _measured(case: Case) -> dict[str, float]:
    """Measured values of the trial in units of display."""
    found: dict[str, float] = {}
    for name, value in (case.trial.measures if case.trial else {}).items():
        if name == "overshoots_deg":
            found.update({f"overshoot_{k}": float(x) for k, x in enumerate(value, start=1)})
        else:
            check_known(f"measure in a trial of {case.ship.name}", name, _QUANTITIES)
            found[name] = float(value) * _QUANTITIES[name][2]
    return found


def _limits(case: Case) -> dict[str, float]:
    """Limits of IMO MSC.137(76) that this manoeuvre is judged by, measure to limit."""
    limits = imo_limits(case.ship, case.speed)
    if case.manoeuvre == "turning_circle":
        hard_over = min(math.radians(35.0), case.ship.gear.delta_max)
        judged = abs(case.delta) >= hard_over - 1e-9
        return {k: limits[k] for k in ("advance", "tactical_diameter")} if judged else {}
    angles = (round(abs(math.degrees(case.delta))), round(abs(math.degrees(case.psi))))
    return {measure: limits[key] for key, measure in _IMO_ZIGZAG.get(angles, {}).items()}


def title(case: Case) -> str:
    """One line: ship, manoeuvre; condition."""
    side = "starboard" if case.delta > 0.0 else "port"
    if case.manoeuvre == "turning_circle":
        what = f"turning circle, {abs(math.degrees(case.delta)):.3g} deg rudder to {side}"
    else:
        angles = f"{abs(math.degrees(case.delta)):.3g}/{abs(math.degrees(case.psi)):.3g}"
        what = f"{angles} zig-zag, first to {side}"
    fn = case.ship.froude(case.speed)
    speed = f"{case.speed:.4g} m/s (Fn {fn:.3f}), {case.n:.4g} rev/s"
    return f"{case.ship.name}: {what}{CONDITION}{speed}, sea: {case.sea}"


def as_dict(case: Case) -> dict[str, Any]:
    """The case as plain numbers, for ``--json``."""
    found = rows(case)
    return {
        "ship": case.ship.name,
        "surrogate": case.ship.surrogate_name,
        "variant": case.ship.variant,
        "manoeuvre": case.manoeuvre,
        "delta_deg": math.degrees(case.delta),
        "psi_deg": math.degrees(case.psi),
        "speed": case.speed,
        "n": case.n,
        "sea": case.sea,
        "units": {row.name: _QUANTITIES[row.name][1] for row in found},
        "measures": {r.name: r.computed if math.isfinite(r.computed) else None for r in found},
        "measured": {r.name: r.measured for r in found if r.measured is not None},
        "difference_percent": {r.name: r.difference for r in found if r.measured is not None},
        "imo": {
            r.name: {"limit": r.limit, "pass": r.passes} for r in found if r.limit is not None
        },
        "trial_source": case.trial.source if case.trial else None,
        "estimated": case.ship.estimated,
    }


def as_text(case: Case) -> str:
    """The case as a report for people."""
    found = rows(case)
    lines = [title(case)]
    lines.append(f"hull set {case.ship.variant}, surrogate {case.ship.surrogate_name}")
    lines += ["", _measure_table(found)]
    if case.trial:
        lines.append(paragraph(f"measured: {case.trial.source}"))
    lines += ["", _imo_table(found)]
    if case.manoeuvre == "turning_circle" and case.sea == "calm":
        lines += ["", "force balance of the steady turn", _balance_table(case)]
    return "\n".join(lines)


def _measure_table(found: list[Row]) -> str:
    cells = []
    for row in found:
        label, unit, _, digits = _QUANTITIES[row.name]
        measured = "" if row.measured is None else f"{row.measured:.{digits}f}"
        computed = f"{row.computed:.{digits}f}"
        cells.append([label, f"[{unit}]", computed, measured, percent(row.difference)])
    return table(["measure", "unit", "computed", "measured", "difference"], cells, left=2)


def _imo_table(found: list[Row]) -> str:
    judged = [row for row in found if row.limit is not None]
    if not judged:
        return "IMO MSC.137(76) has no limit for this manoeuvre"
    cells = []
    for row in judged:
        label, unit, _, digits = _QUANTITIES[row.name]
        verdict = "pass" if row.passes else "FAIL"
        numbers = [f"{row.computed:.{digits}f}", f"{row.limit:.{digits}f}", verdict]
        cells.append([label, f"[{unit}]", *numbers])
    return table(["IMO MSC.137(76)", "unit", "computed", "at most", ""], cells, left=2)


def _balance_table(case: Case) -> str:
    cells = [
        [name, *(f"{value:.4g}" for value in values)]
        for name, values in steady_balance(case.ship, case.result.trajectory).items()
    ]
    return table(["", "X [N]", "Y [N]", "N [N m]"], cells)


def estimates(ship: Ship) -> str:
    """Which numbers of a ship no source prints, in short."""
    if not ship.estimated:
        return "every number of this ship is published"
    return paragraph(
        f"estimated for this ship: {', '.join(sorted(ship.estimated))} "
        "(reasons: ship_gym.load_ship(...).describe())"
    )
