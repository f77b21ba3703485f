"""Tables of the page of co-simulation, from the variables of a unit."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from pages.docstrings import table
from pages.marks import with_tables, write_tables
from ship_gym.cosim.osp import osp_description
from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.values import start_values
from ship_gym.cosim.variables import INPUT, OUTPUT, PARAMETER, Variable
from ship_gym.ships.loader import load_ship

PAGE = Path(__file__).resolve().parents[1] / "cosimulation.md"
_SHIP = "onrt"  # with two propellers: her unit has every variable


def tables() -> dict[str, str]:
    """Each table of the page by the name of its marks."""
    place = {"start.latitude": 0.0, "start.longitude": 0.0}
    values = start_values(_SHIP, **place)
    unit = ShipUnit(values, load_ship(_SHIP).propellers, Path())
    kcs = start_values("kcs", **place)
    found = list(unit.variables.values())
    return {
        "inputs": _plain([v for v in found if v.causality == INPUT]),
        "outputs": _plain([v for v in found if v.causality == OUTPUT]),
        "parameters": _parameters([v for v in found if v.causality == PARAMETER], kcs),
        "groups": _groups(unit),
    }


def outdated() -> bool:
    """Whether the page does not say what the code says."""
    text = PAGE.read_text(encoding="utf-8")
    return with_tables(text, tables(), PAGE) != text


def write() -> Path:
    """Bring the page up to date."""
    write_tables(PAGE, tables())
    return PAGE


def _plain(variables: list[Variable]) -> str:
    rows = [[f"`{v.name}`", v.unit or "-", v.meaning] for v in variables]
    return table(("Name", "Unit", "What it is"), rows)


def _parameters(variables: list[Variable], values: dict[str, Any]) -> str:
    rows = [
        [f"`{v.name}`", v.kind, v.unit or "-", _start(values[v.name]), _limits(v), v.meaning]
        for v in variables
    ]
    return table(("Name", "Type", "Unit", "Start, of KCS", "Allowed", "What it is"), rows)


def _start(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"`{value}`" if value else "empty"
    return f"{value:.6g}"


def _limits(variable: Variable) -> str:
    if variable.low is None or variable.high is None:
        return ""
    if math.isclose(variable.high, 2.0 * math.pi):
        return "-2 pi to 2 pi"
    return f"{variable.low:.10g} to {variable.high:.10g}"


def _groups(unit: ShipUnit) -> str:
    rows = [
        [group.tag, f"`{group.get('name')}`", ", ".join(f"`{v.get('ref')}`" for v in group)]
        for group in osp_description(unit).find("VariableGroups")
    ]
    return table(("Kind", "Group", "Variables"), rows)
