"""Measures of a manoeuvre in units of display, beside what was measured and what IMO allows."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ship_gym.config import check_known
from ship_gym.manoeuvres import imo_limits
from ship_gym.reports.case import Case
from ship_gym.text import percent

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
    "movable_rudder_force": ("rudder normal force, movable part", "N", 1.0, 2),
    "drift_distance": ("drift from 180 to 540 deg", "L", 1.0, 2),
    "drift_direction": ("  direction from north", "deg", _DEG, 0),
    "overshoot_1": ("first overshoot", "deg", _DEG, 1),
    "overshoot_2": ("second overshoot", "deg", _DEG, 1),
    "overshoot_3": ("third overshoot", "deg", _DEG, 1),
    "overshoot_4": ("fourth overshoot", "deg", _DEG, 1),
    "initial_turning": ("way to first reversal", "L", 1.0, 2),
    "period": ("period", "s", 1.0, 1),
}
_KILO = 1e4  # N or N m from which kN or kN m are shown
_ONLY_IN_A_SEA = ("drift_distance", "drift_direction")
DIRECTIONS = ("drift_direction",)  # whose difference is an angle, not a share
# rudder/heading [deg] of a zig-zag -> limit of `imo_limits` -> measure
_IMO_ZIGZAG = {
    (10, 10): {
        "initial_turning": "initial_turning",
        "overshoot_10_10_first": "overshoot_1",
        "overshoot_10_10_second": "overshoot_2",
    },
    (20, 20): {"overshoot_20_20_first": "overshoot_1"},
}


def in_kilo(unit: str, size: float, digits: int) -> tuple[str, float, int]:
    """Unit, factor and digits by which a measure of this size is shown; large forces in kN."""
    if unit.startswith("N") and abs(size) >= _KILO:
        return f"k{unit}", 1e-3, 1
    return unit, 1.0, digits


@dataclasses.dataclass(frozen=True)
class Row:
    """One measure in the unit of display.

    ``deviation`` is the standard deviation of the facilities that measured, ``limit`` IMO's limit,
    ``calm`` the value without the waves, ``others`` what others computed.
    """

    name: str
    computed: float
    measured: float | None = None
    limit: float | None = None
    calm: float | None = None
    deviation: float | None = None
    others: dict[str, float] = dataclasses.field(default_factory=dict)

    @property
    def difference(self) -> float | None:
        """100 (computed - measured) / measured [%], of a direction [deg]; None if not measured."""
        if self.measured is None:
            return None
        if self.name in DIRECTIONS:
            return (self.computed - self.measured + 180.0) % 360.0 - 180.0
        return 100.0 * (self.computed / self.measured - 1.0)

    @property
    def deviations(self) -> float | None:
        """The difference in standard deviations of the facilities; None without these."""
        if self.measured is None or not self.deviation:
            return None
        return (self.computed - self.measured) / self.deviation

    @property
    def passes(self) -> bool:
        """Whether the computed value is within IMO's limit."""
        return self.limit is None or self.computed <= self.limit

    @property
    def label(self) -> str:
        """The measure in words."""
        return _QUANTITIES[self.name][0]

    @property
    def unit(self) -> str:
        """Unit of display."""
        return _QUANTITIES[self.name][1]

    @property
    def digits(self) -> int:
        """Digits after the point that it is shown with."""
        return _QUANTITIES[self.name][3]

    def shown(self, value: float | None) -> str:
        """A value of this measure as text; nothing for None."""
        return "" if value is None else f"{value:.{self.digits}f}"


def rows(case: Case) -> list[Row]:
    """Measures of a case in units of display, with what was measured and what IMO allows."""
    trial = case.trial
    measured = _displayed(case, trial.measures) if trial else {}
    others = {k: _displayed(case, v) for k, v in trial.others.items()} if trial else {}
    limits = _limits(case)
    calm = _flat(case, case.calm.measures()) if case.calm else {}
    found = []
    for name, value in _flat(case, case.result.measures()).items():
        if name not in _QUANTITIES or (name in _ONLY_IN_A_SEA and case.sea == "calm"):
            continue
        factor = _QUANTITIES[name][2]
        share = trial.deviation.get(name) if trial else None
        row = Row(
            name,
            value * factor,
            measured.get(name),
            limits[name] * factor if name in limits else None,
            calm[name] * factor if name in calm else None,
            abs(share * measured[name]) if share and name in measured else None,
            {who: values[name] for who, values in others.items() if name in values},
        )
        found.append(row)
    return found


def _flat(case: Case, measures: dict[str, Any]) -> dict[str, float]:
    """Measures with the overshoots of a zig-zag numbered from 1, and the movable rudder's force."""
    flat = {}
    share = case.trial.movable_factor if case.trial else None
    for name, value in measures.items():
        if name == "overshoots":
            flat.update({f"overshoot_{k}": x for k, x in enumerate(value, start=1)})
        elif not isinstance(value, tuple):
            flat[name] = value
        if name == "rudder_normal_force" and share is not None:
            flat["movable_rudder_force"] = share * value
    return flat


def _displayed(case: Case, printed: dict[str, Any]) -> dict[str, float]:
    """Values of a trial in units of display; a name that ends in _deg is in degrees already."""
    found: dict[str, float] = {}
    for key, value in printed.items():
        if key == "overshoots_deg":
            found.update({f"overshoot_{k}": float(x) for k, x in enumerate(value, start=1)})
            continue
        name = key.removesuffix("_deg")
        check_known(f"measure in a trial of {case.ship.name}", name, _QUANTITIES)
        found[name] = float(value) * (1.0 if name != key else _QUANTITIES[name][2])
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


def difference_text(row: Row) -> str:
    """Difference from the measured value: a percentage, of a direction an angle."""
    if row.difference is not None and row.name in DIRECTIONS:
        return f"{row.difference:+.0f} deg"
    return percent(row.difference)


def deviations_text(row: Row) -> str:
    """The difference in standard deviations of the facilities, or nothing."""
    return "" if row.deviations is None else f"{row.deviations:+.1f}"
