"""Gains by dotted name, ``observer.sway_noise``, and the ranges that tuning searches."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import ConfigError, nearest

_NEAR = 0.01  # share of a range within which an optimum lies at its bound


class Range(NamedTuple):
    """Where tuning searches one gain: on a logarithmic scale if `low` is positive."""

    low: float
    high: float
    start: float


def ranges_of(controller: type[Any], gains: Any, free: Sequence[str]) -> dict[str, Range]:
    """Ranges of the free gains of a controller.

    Parameters
    ----------
    controller : type
        With `TUNED`: name -> lowest, highest, start; a start of None is the value in `gains`.
    gains : dataclass
        What the tuning begins at.
    free : sequence of str

    Raises
    ------
    ConfigError
        A name that is not in `TUNED`, a range that is none or a start outside it.
    """
    found = {}
    for name in free:
        if name not in controller.TUNED:
            raise ConfigError(
                f"{controller.__name__}.TUNED has no {name!r};{nearest(name, controller.TUNED)}"
            )
        low, high, start = controller.TUNED[name]
        start = leaf(gains, name) if start is None else start
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ConfigError(f"{controller.__name__}.TUNED[{name!r}]: {low} to {high} is no range")
        found[name] = Range(float(low), float(high), float(min(max(start, low), high)))
    return found


def has_leaf(gains: Any, name: str) -> bool:
    """Whether gains have a value of this dotted name."""
    for part in name.split("."):
        gains = getattr(gains, part, None)
    return gains is not None


def leaf(gains: Any, name: str) -> Any:
    """Value of a gain by its dotted name."""
    if not has_leaf(gains, name):
        raise ConfigError(f"gains have no {name!r} to tune")
    for part in name.split("."):
        gains = getattr(gains, part)
    return gains


def with_leaves(gains: Any, values: Mapping[str, Any]) -> Any:
    """Gains with values by dotted name, numbers or arrays of shape (count,), put in."""
    parts: dict[str, dict[str, Any]] = {}
    own = {}
    for name, value in values.items():
        first, _, rest = name.partition(".")
        leaf(gains, name)
        if rest:
            parts.setdefault(first, {})[rest] = value
        else:
            own[first] = value
    own |= {part: with_leaves(getattr(gains, part), inner) for part, inner in parts.items()}
    return dataclasses.replace(gains, **own)


def to_shares(values: Mapping[str, float], ranges: Mapping[str, Range]) -> np.ndarray:
    """Values as shares of their ranges, in the order of `ranges`, limited to 0 and 1."""
    shares = []
    for name, (low, high, _) in ranges.items():
        scale = math.log if low > 0.0 else float
        value = min(max(values[name], low), high)
        shares.append((scale(value) - scale(low)) / (scale(high) - scale(low)))
    return np.array(shares)


def from_shares(shares: np.ndarray, ranges: Mapping[str, Range]) -> dict[str, float]:
    """Values from shares of their ranges, with the digits that a file keeps."""
    found = {}
    for share, (name, (low, high, _)) in zip(shares, ranges.items(), strict=True):
        value = low * (high / low) ** share if low > 0.0 else low + (high - low) * share
        found[name] = float(f"{value:.4g}")
    return found


def at_bounds(values: Mapping[str, float], ranges: Mapping[str, Range]) -> dict[str, float]:
    """Gains that lie at a bound of their range, with that bound: wider ones may do better."""
    found = {}
    for (name, one), share in zip(ranges.items(), to_shares(values, ranges), strict=True):
        if share < _NEAR or share > 1.0 - _NEAR:
            found[name] = one.low if share < 0.5 else one.high
    return found


def can_widen(gains: Any, bounds: Mapping[str, float], ranges: Mapping[str, Range]) -> list[str]:
    """Which gains of `at_bounds` may lie beyond; the others the gains themselves refuse there."""
    found = []
    for name, bound in bounds.items():
        low, high, _ = ranges[name]
        beyond = _NEAR * (low if low > 0.0 else high - low)
        try:
            with_leaves(gains, {name: bound - beyond if bound == low else bound + beyond})
        except ConfigError:
            continue
        found.append(name)
    return found
