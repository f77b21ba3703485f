"""Ratios of speed within one run beside those of a baseline file, so that a slower kernel shows.

Seconds depend on the machine and on who else uses it, ratios within one run much less. Those to
CartPole and to fixed NumPy work see a step that became slower; those between our own steps tell
which part it was.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ship_gym.config import ConfigError, check_number
from ship_gym.keys import read_keys
from ship_gym.reports.speed_child import measure
from ship_gym.text import table

# The same code on two shared, busy cores differed by up to 25 % between runs; processors differ
# more, by what they make of vector instructions. Half as slow again is no accident.
MARGIN = 1.5
N = 4096  # ships of the vector steps
# name -> (work, what it is divided by), names of ``speed_child.MEASURES``; larger is slower
RATIOS: dict[str, tuple[str, str]] = {
    "calm to NumPy": ("calm", "NumPy reference"),
    "waves to NumPy": ("waves", "NumPy reference"),
    "environment to NumPy": ("heading", "NumPy reference"),
    "environment to CartPole's vector step": ("heading", "CartPole vector"),
    "scalar step to CartPole's": ("scalar", "CartPole scalar"),
    "waves to calm": ("waves", "calm"),
    "environment to physics": ("heading", "waves"),
    "scalar to vector": ("scalar", "heading"),
}


def run(
    rounds: int = 15,
    seconds: float = 0.04,
    progress: Callable[[Iterable, str], Iterable] = lambda rounds, _: rounds,
) -> dict[str, float]:
    """Measure everything in turns, for KCS.

    Returns
    -------
    dict
        Name in ``speed_child.MEASURES`` to the least processor time of one step [s].
    """
    names = list(dict.fromkeys(name for pair in RATIOS.values() for name in pair))
    kept: dict = {}
    best = dict.fromkeys(names, math.inf)
    for _ in progress(range(rounds), "in turns"):
        for name in names:
            found = measure(name, N, "kcs", 2, seconds, kept)
            best[name] = min(best[name], found["seconds"])
    return best


def ratios(seconds: Mapping[str, float]) -> dict[str, float]:
    """`RATIOS` of measured times [s]."""
    return {name: seconds[over] / seconds[under] for name, (over, under) in RATIOS.items()}


def compare(
    now: Mapping[str, float], baseline: Mapping[str, float], margin: float = MARGIN
) -> list[dict[str, Any]]:
    """Each ratio beside its baseline.

    Parameters
    ----------
    now, baseline : mapping
        As `ratios` gives them.
    margin : float
        Factor within which they count as equal, above 1.

    Returns
    -------
    list of dict
        ``name``, ``baseline``, ``now``, ``factor`` (now / baseline) and ``verdict``: ``slower``,
        ``faster`` or ``as before``.

    Raises
    ------
    ConfigError
        A ratio that only one of them has, or a margin that is none.
    """
    check_number("margin", margin, 1.0, 100.0)
    if different := sorted(set(now) ^ set(baseline)):
        raise ConfigError(f"baseline: {different[0]!r} is not in both; write the baseline anew")
    rows = []
    for name, value in now.items():
        factor = value / baseline[name]
        verdict = "slower" if factor > margin else "faster" if factor < 1 / margin else "as before"
        told = {"name": name, "baseline": baseline[name], "now": value}
        rows.append({**told, "factor": factor, "verdict": verdict})
    return rows


def load_baseline(path: str | os.PathLike) -> dict[str, float]:
    """Ratios of a baseline file.

    Raises
    ------
    ConfigError
        No such file, or not one of ours.
    """
    ratios = read_keys(path).table("ratios")
    return {name: ratios.number(name, 1e-9, 1e9) for name in ratios.values}


def as_text(rows: list[dict[str, Any]], margin: float = MARGIN) -> str:
    """Rows of `compare` as a table, and what they mean."""
    cells = [
        [r["name"], f"{r['baseline']:.3g}", f"{r['now']:.3g}", f"{r['factor']:.2f}", r["verdict"]]
        for r in rows
    ]
    lines = [table(["ratio", "baseline", "now", "now / baseline", ""], cells), ""]
    slower = [r["name"] for r in rows if r["verdict"] == "slower"]
    if slower:
        lines.append(
            f"slower by more than {margin:g} times: {', '.join(slower)}. If only ratios between "
            "our own steps are, the other one may have become faster: renew the baseline."
        )
    elif any(r["verdict"] == "faster" for r in rows):
        lines.append("faster than the baseline: renew it, so that the gain is kept")
    else:
        lines.append(f"all within {margin:g} times the baseline")
    return "\n".join(lines)
