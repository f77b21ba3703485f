"""Plots of forces, of each propeller and rudder, and of the flow there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.conventions import FORCES, UNITS
from ship_gym.recording.panel import (
    BLUE,
    DEG,
    FLOW,
    FORCE,
    GREEN,
    GREY,
    LOADS,
    ORANGE,
    PURPLE,
    RED,
    Columns,
    Panel,
    Series,
)

_SIDES = (GREEN, RED)  # starboard and port, as their lights
_SHARES = {"X": "surge", "Y": "sway", "N": "yaw"}
_PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""))


def force_panel(columns: Columns, axis: str, largest: Mapping[str, float] | None) -> Panel:
    """Draw one axis of the force breakdown: columns X_hull, X_propeller, ..., the known first.

    What is zero all the time, such as waves in calm water, is left out once the run is over.
    """
    colours = {f"{axis}_{force.name}": force for force in FORCES}
    names = [name for name in colours if name in columns]
    names += [name for name in columns if name.startswith(f"{axis}_") and name not in colours]
    most = max((float(np.abs(columns[name]).max()) for name in names), default=0.0)
    size, prefix = _prefix(most if largest is None else largest[axis])
    unit = f"{prefix}N m" if axis == "N" else f"{prefix}N"
    what = "moment" if axis == "N" else "force"
    series = [
        Series(
            colours[k].label if k in colours else k.removeprefix(f"{axis}_"),
            columns[k] / size,
            _rgb(colours[k].colour) if k in colours else GREY,
        )
        for k in names
        if largest is not None or columns[k].any()
    ]
    title = f"{axis}: {_SHARES[axis]} {what} [{unit}]"
    return Panel(f"plots/force_{axis}", title, series, FORCE)


def _rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue of ``#rrggbb``, lightened where black would swallow it."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return (red + 24, green + 24, blue + 24) if red + green + blue < 300 else (red, green, blue)


def units_panel(
    columns: Columns, name: str, title: str, largest: Mapping[str, float] | None
) -> Panel:
    """Draw a force of the starboard unit and of the port one; nothing of a ship with one."""
    names = [f"{name}_{side}" for side in UNITS if f"{name}_{side}" in columns]
    most = max((float(np.abs(columns[k]).max()) for k in names), default=0.0)
    size, prefix = _prefix(most if largest is None else largest["X"])
    series = [
        Series(k.removeprefix(f"{name}_"), columns[k] / size, colour)
        for k, colour in zip(names, _SIDES, strict=False)
    ]
    return Panel(f"plots/{name}_of_units", f"{title} [{prefix}N]", series, LOADS)


def flow_panels(columns: Columns, meta: Mapping[str, Any]) -> list[Panel]:
    """Advance ratio and drift of the flow with their trained box, and how far outside they are."""
    angles = (("beta_P", "at propeller", BLUE), ("beta_R", "at rudder", ORANGE))
    inflow = [Series(label, DEG * columns[k], c) for k, label, c in angles if k in columns]
    ratios = (("J", "J", BLUE), ("extrapolation", "outside: propeller, rudder", ORANGE),
              ("waves_extrapolation", "outside: wave table", PURPLE))  # fmt: skip
    advance = [Series(label, columns[k], c) for k, label, c in ratios if k in columns]
    ship = meta.get("ship")
    box = ship.get("trained_box") if isinstance(ship, Mapping) else None
    if box and "delta" in columns:
        whole = np.ones(len(columns["t"]))
        side = -1.0 if columns["delta"].mean() < 0.0 else 1.0  # the box of port is its mirror
        advance += [Series("trained box", end * whole, GREY, True) for end in box["J"]]
        inflow += [Series("trained box", side * DEG * k * whole, GREY, True) for k in box["beta"]]
    return [
        Panel("plots/advance", "Advance ratio J, and way outside what is known [-]", advance, FLOW),
        Panel("plots/inflow", "Drift angle of the flow [deg]", inflow, FLOW),
    ]


def _prefix(most: float) -> tuple[float, str]:
    """Size and prefix of the unit in which `most` is drawn."""
    return next((p for p in _PREFIXES if most >= p[0]), (1.0, ""))
