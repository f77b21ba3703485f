"""What a surrogate's table must hold before a ship sails with it: names, axes, values, card."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from ship_gym.config import ConfigError, check_fields, check_number, shown
from ship_gym.keys import Keys
from ship_gym.reading import check_array
from ship_gym.tables import Axis, Table

_LARGEST = 10.0  # of a coefficient by the square of the speed of a blade; published ones reach 1
_LENGTH = (1e-3, 1e4, "m")
_INFLOW = (-10.0, 10.0, "-")  # of the constants of the law: published ones lie in 0 to 2


@dataclasses.dataclass(frozen=True)
class _MadeFor:
    """Ship of the samples."""

    ship: str
    L: float
    D: float
    A_R: float
    f_alpha: float
    eta: float

    def __post_init__(self):
        ranges = {"L": _LENGTH, "D": _LENGTH, "A_R": (1e-6, 1e6, "m2")}
        ranges |= {"f_alpha": (0.1, 10.0, "-"), "eta": (0.0, 2.0, "-")}
        check_fields("made_for", self, ranges)


@dataclasses.dataclass(frozen=True)
class _Inflow:
    """Law of the inflow to the rudder that was fitted to the samples."""

    epsilon: float
    kappa: float
    gamma_R: dict[str, float]
    rms_error_percent: float

    def __post_init__(self):
        check_fields("effective_inflow", self, {"epsilon": _INFLOW, "kappa": _INFLOW})
        check_fields("effective_inflow", self, {"rms_error_percent": (0.0, 1e3, "%")})
        for side, value in self.gamma_R.items():
            check_number(f"effective_inflow.gamma_R.{shown(side)}", value, *_INFLOW)
        if not self.gamma_R:
            raise ConfigError("effective_inflow.gamma_R is empty: allowed is one for each rudder")


@dataclasses.dataclass(frozen=True)
class _Domain:
    """Trained box: advance coefficients, drift angles, rudder angle; area of the rudder."""

    J_min: float
    J_max: float
    beta_min: float
    beta_max: float
    delta: float
    S_R: float

    def __post_init__(self):
        angle = (-math.pi, math.pi, "rad")
        ranges = {"J_min": (-10.0, 10.0, "-"), "J_max": (self.J_min, 10.0, "-")}
        ranges |= {"beta_min": angle, "beta_max": (self.beta_min, math.pi, "rad"), "delta": angle}
        check_fields("domain", self, ranges | {"S_R": (1e-6, 1e6, "m2")})


_PARTS = {"made_for": _MadeFor, "effective_inflow": _Inflow, "domain": _Domain}


def check_surrogate(table: Table, names: Mapping[int, tuple[str, ...]], name: str) -> None:
    """Refuse a table that is no surrogate.

    Parameters
    ----------
    table : Table
    names : mapping
        Quantities by the number of propellers (``records.surrogate_names``).
    name : str
        For the message.

    Raises
    ------
    ConfigError
        Other quantities or axes, values out of range, or a card without what sailing needs.
    """
    where = f"surrogate {name}"
    if table.names not in names.values():
        raise ConfigError(f"{where} has {shown(table.names)}: needed are {', '.join(names[1])}")
    for part, cls in _PARTS.items():
        _check_part(where, table.card, part, cls)
    *planes, epsilon, beta = table.axes
    if not 2 <= len(table.axes) <= 3:
        raise ConfigError(f"{where} has {len(table.axes)} axes: needed are 2 or 3")
    _check_axis(where, epsilon, 0.0, 0.5 * math.pi)
    for axis in (beta, *planes):
        _check_axis(where, axis, -math.pi, math.pi)
    for k, channel in enumerate(table.names):
        low, high = (0.0, 1.0) if channel.startswith("trust") else (-_LARGEST, _LARGEST)
        low = 0.0 if "_std" in channel else low
        values = table.values[..., k]
        check_array(f"{where}: {channel}", values, values.shape, low, high)


def _check_part(where: str, card: Mapping[str, Any], part: str, cls: type) -> None:
    """Refuse a section of a card that is missing or lacks a key; further keys are let be."""
    if part not in card:
        raise ConfigError(f"{where}: its card has no {part!r}; fit it again")
    Keys(card, where).table(part).build(cls)


def _check_axis(where: str, axis: Axis, low: float, high: float) -> None:
    slack = 1e-9  # the last point is a sum
    for end in (axis.start, axis.stop):
        if not low - slack <= end <= high + slack:
            raise ConfigError(
                f"{where}: axis {shown(axis.name)} reaches {end:g}: allowed is {low:g} to "
                f"{high:.4g} [rad]"
            )
