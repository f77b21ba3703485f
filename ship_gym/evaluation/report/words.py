"""Numbers of the report as text."""

from __future__ import annotations

import math

from ship_gym.evaluation.statistics import Estimate, Paired

NONE = "-"


def number(value: float | None, digits: int = 3) -> str:
    """A value with some digits, without an exponent; a dash for none."""
    if value is None or not math.isfinite(value):
        return NONE
    if value == 0.0:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{value:.{max(0, min(decimals, 6))}f}"


def interval(found: Estimate | Paired | None, digits: int = 3) -> str:
    """Value and interval."""
    if found is None:
        return NONE
    text = number(found.value, digits)
    if found.low is None:
        return text
    return f"{text} [{number(found.low, digits)}, {number(found.high, digits)}]"


def score(value: float | None) -> str:
    """A score, whole."""
    return NONE if value is None else f"{value:.0f}"


def score_interval(found: Estimate | None) -> str:
    """A score and its interval, whole."""
    if found is None or found.low is None:
        return score(None if found is None else found.value)
    return f"{found.value:.0f} [{found.low:.0f}, {found.high:.0f}]"


def share(value: float | None) -> str:
    """A share in per cent."""
    return NONE if value is None else f"{100.0 * value:.0f} %"


def signed_share(value: float) -> str:
    """A signed share in per cent; beyond 1000 %, how many times as large the whole is."""
    if math.isfinite(value) and value > 10.0:
        return f"{1.0 + value:.0f} times"
    return f"{100.0 * value:+.1f} %" if math.isfinite(value) else NONE


def p_value(p: float) -> str:
    """A p-value; small ones only as such."""
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def plural(count: int, of: str) -> str:
    """``1 episode``, ``2 episodes``."""
    return f"{count} {of}" if count == 1 else f"{count} {of}s"
