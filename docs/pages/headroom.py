"""Headroom of the scenarios in Markdown, from the reference values of the standard suites."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pages.docstrings import table
from ship_gym.evaluation import headroom
from ship_gym.evaluation.metrics import all_metrics
from ship_gym.text import percent

INTRO = (
    "What doing nothing, the best classical controllers and the optimum reach, by interquartile "
    "means over test seeds; the reference was chosen on other seeds. The optimum is an open-loop "
    "plan made with full knowledge of the sea, optimised from several starts, or the mean of the "
    "minimum-time turns in calm water: an estimate of what control can reach, no bound, and no "
    "autopilot has its knowledge. Headroom: by how much it lies below the reference, with its 95 % "
    "interval. `python scripts/measure_headroom.py --write` makes the values again."
)
_HEADER = (
    "Scenario", "Ship", "Measure", "Nothing", "Reference", "Second best", "Difference", "Optimum",
    "Headroom",
)  # fmt: skip


def headroom_table(names: Sequence[str] | None = None) -> str:
    """Table of the cells of some scenarios, or of all that have values; a sentence if none has."""
    rows = []
    for key, cell in headroom.read().items():
        scenario, ship = key.split("/")
        if names is None or scenario in names:
            rows.append([f"`{scenario}`", ship, *_row(cell)])
    if not rows:
        return "No suite of the package scores it: no reference values."
    return table(_HEADER, rows)


def _row(cell: Mapping[str, Any]) -> list[str]:
    measure, difference = cell["measure"], cell["difference"]
    second = apart = "-"
    if cell["second"] is not None:
        second = f"{cell['second']:.3g} `{cell['second_controller']}`"
        apart = f"{difference['value']:.2g} [{difference['low']:.2g}, {difference['high']:.2g}]"
    optimum = room = "-"
    if cell["optimum"] is not None:
        value, low, high = (cell["headroom"][name] for name in ("value", "low", "high"))
        optimum = f"{cell['optimum']:.3g}"
        room = f"{percent(value).lstrip('+')} [{low:.0f}, {high:.0f}]"
    reference = f"{cell['reference']:.3g} `{cell['reference_controller']}`"
    unit = all_metrics()[measure].unit
    measure = f"`{measure}` [{unit}]"
    return [measure, f"{cell['nothing']:.4g}", reference, second, apart, optimum, room]
