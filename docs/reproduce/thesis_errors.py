"""Errors of grid and turbulence model that Knight (2021) prints, from the forces that he prints."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from reproduce.rounding import HALF_DIGIT, count_text, counted, interval
from reproduce.thesis_fits import errors_of_16, errors_of_fits, label
from ship_gym.config import ConfigError
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.reports.surrogate_printed import printed_errors_of_16
from ship_gym.surrogates.base import mean_size, percent_error
from ship_gym.surrogates.error_budget import (
    FINE_GRID,
    GRID,
    OTHER_TURBULENCE,
    TURBULENCE,
    grid_errors,
    turbulence_errors,
)
from ship_gym.surrogates.fit import fit
from ship_gym.surrogates.samples import DATA_SETS, KCS, ONRT, DataSet
from ship_gym.text import paragraph, table

DATA = Path(__file__).parent / "data"
_GRIDS = {"eps_23": GRID, "eps_13": "G1"}


def _side(data: DataSet, name: str) -> str:
    """Our name of a propeller from that of the source."""
    return next((ours for ours, theirs in data.sides.items() if theirs == name), name)


def cells() -> list[dict[str, Any]]:
    """Every cell of the epsilon columns, one entry per column of a printed table and side.

    Returns
    -------
    list of dict
        ``table``, ``ship``, ``side``, ``quantity``, ``column``, ``points``, ``ours`` and
        ``printed`` [%], ``within`` (rounding of the forces and of the cell).
    """
    return [*_grid_cells(), *_turbulence_cells()]


def _blocks(rows: CsvTable, *names: str) -> list[CsvTable]:
    """Rows that agree in some columns, in the order of the file."""
    keys = list(zip(*(rows.columns[n].tolist() for n in names), strict=True))
    return [rows.where(**dict(zip(names, key, strict=True))) for key in dict.fromkeys(keys)]


def _grid_cells() -> list[dict[str, Any]]:
    found = []
    for rows in _blocks(read_csv(DATA / "knight_grid_error.csv"), "table"):
        for column, grid in _GRIDS.items():
            found.append(_compared(rows, column, (FINE_GRID, TURBULENCE), (grid, TURBULENCE)))
    return found


def _turbulence_cells() -> list[dict[str, Any]]:
    found = []
    for rows in _blocks(read_csv(DATA / "knight_turbulence_error.csv"), "table", "side", "grid"):
        grid = str(rows.columns["grid"][0])
        found.append(_compared(rows, "eps_T", (grid, TURBULENCE), (grid, OTHER_TURBULENCE)))
    return found


def _compared(
    rows: CsvTable, column: str, truth: tuple[str, str], other: tuple[str, str]
) -> dict[str, Any]:
    """One printed column beside 100 (truth - other) / truth of our copies of the forces."""
    name, ship, side, quantity = (str(rows.columns[k][0]) for k in ("table", *_KEYS))
    data, points = DATA_SETS[ship], rows.columns["point"].astype(int)
    ours_side = _side(data, side)
    forces = [
        data.read(*choice, ours_side).pick(points).values[quantity] for choice in (truth, other)
    ]
    printed = rows.columns[column]
    low, high = interval(percent_error, *forces)
    within = (printed >= low - HALF_DIGIT) & (printed <= high + HALF_DIGIT)
    return {
        "table": name,
        "ship": ship,
        "side": ours_side,
        "quantity": quantity,
        "column": column if column != "eps_T" else f"eps_T {truth[0]}",
        "points": points.tolist(),
        "ours": percent_error(*forces).tolist(),
        "printed": printed.tolist(),
        "within": within.tolist(),
    }


_KEYS = ("ship", "side", "quantity")


def means() -> list[dict[str, Any]]:
    """Mean sizes and norms [%] that the text states, ours beside theirs.

    Ours are of the forces with three decimals; ``moved`` is how far those and the digits of the
    print can move them, and ``within`` has one cell.
    """
    rows, found = read_csv(DATA / "knight_mean_errors.csv"), []
    names = (*_KEYS, "kind", "grid", "points", "section")
    for *texts, printed, digits in zip(
        *(rows.columns[k].tolist() for k in (*names, "printed", "digits")), strict=True
    ):
        row: dict[str, Any] = dict(zip(names, texts, strict=True))
        row["side"] = _side(DATA_SETS[row["ship"]], row["side"])
        first, last = map(int, row["points"].split("-"))
        ours, moved = _stated(row, tuple(range(first, last + 1)))
        moved += 0.5 * 10.0**-digits
        row |= {"ours": ours, "printed": printed, "moved": moved}
        found.append(row | {"within": [bool(abs(ours - printed) <= moved)]})
    return found


def _stated(row: dict[str, Any], points: tuple[int, ...]) -> tuple[float, float]:
    """One mean or norm, and how far the digits of the forces move it [%]."""
    where = DATA_SETS[row["ship"]], row["quantity"], row["side"]
    kind, grid = row["kind"], row["grid"]
    if kind in ("13", "23"):
        return _moved_mean(*where, ((FINE_GRID, TURBULENCE), (grid, TURBULENCE)), points)
    if kind == "T":
        return _moved_mean(*where, ((grid, TURBULENCE), (grid, OTHER_TURBULENCE)), points)
    regression = _regression(*where, kind)
    if kind.startswith("r"):
        return regression
    parts = [
        _moved_mean(*where, ((FINE_GRID, TURBULENCE), (grid, TURBULENCE)), points),
        _moved_mean(*where, ((grid, TURBULENCE), (grid, OTHER_TURBULENCE)), points),
        regression,
    ]
    total = math.hypot(*(mean for mean, _ in parts))
    return total, sum(mean * moved for mean, moved in parts) / total


def _moved_mean(
    data: DataSet, quantity: str, side: str, choices: tuple, points: tuple[int, ...]
) -> tuple[float, float]:
    """Mean size of 100 (first - second) / first [%] of two grids or models, and its move."""
    forces = [data.read(*choice, side).pick(points).values[quantity] for choice in choices]
    errors = percent_error(*forces)
    low, high = interval(percent_error, *forces)
    return mean_size(errors), float(np.maximum(high - errors, errors - low).mean())


def _regression(data: DataSet, quantity: str, side: str, kind: str) -> tuple[float, float]:
    """Mean error of the regression of 8 points, or of 16, and its move [%]."""
    if kind.endswith("16") and data is KCS:  # by the print alone
        return mean_size(np.array(printed_errors_of_16(quantity))), 0.0
    rows = errors_of_16() if kind.endswith("16") else errors_of_fits(((data, GRID),))
    row = next(r for r in rows if (r["side"], r["quantity"]) == (side, quantity))
    return mean_size(np.array(row["ours"])), float(np.mean(row["moved"]))


def budgets() -> list[dict[str, Any]]:
    """Error budget on each grid: parts of Eqs. 3.2-3.4 and 3.6, and their norm (3.7) [%]."""
    found = []
    for data in (KCS, ONRT):
        for grid in ("G1", GRID, FINE_GRID):
            made = fit(data, grid=grid, turbulence=TURBULENCE)
            for side in data.sides:
                for quantity in data.quantities:
                    found.append(_budget(data, grid, side, quantity, made.errors(side)[quantity]))
    return found


def _budget(
    data: DataSet, grid: str, side: str, quantity: str, errors: list[float]
) -> dict[str, Any]:
    held = data.validation
    sst = _or_none(lambda: turbulence_errors(data, quantity, side, grid, held))
    if sst is None:  # ONRT: run at the training points of G2 only
        sst = _or_none(lambda: turbulence_errors(data, quantity, side, grid, data.training))
    parts = {
        "grid": mean_size(grid_errors(data, quantity, side, grid, held)),
        "grid_12": mean_size(grid_errors(data, quantity, side, grid, (*held, *data.training))),
        "turbulence": None if sst is None else mean_size(sst),
        "surrogate": mean_size(np.array(errors)),
    }
    three = [parts[k] for k in ("grid", "turbulence", "surrogate")]
    total = None if None in three else math.hypot(*three)
    row = {"model": data.name, "on_grid": grid, "side": side, "quantity": quantity}
    return row | parts | {"total": total}


def _or_none(compute: Callable[[], np.ndarray]) -> np.ndarray | None:
    """The array, or None where the points were not run."""
    try:
        return compute()
    except ConfigError:
        return None


def cell_text(rows: list[dict[str, Any]]) -> str:
    """Counts of the epsilon columns, and the cells that are not within rounding."""
    shown = []
    for row in rows:
        for point, ours, printed, good in zip(
            row["points"], row["ours"], row["printed"], row["within"], strict=True
        ):
            if not good:
                head = [row["table"], row["ship"], label(row), row["column"]]
                shown.append([*head, f"{point}", f"{ours:.3f}", f"{printed:.3f}"])
    header = ["table", "ship", "quantity", "column", "point", "ours", "printed"]
    return "\n".join(
        [
            "errors of grid and turbulence model, cells that are not within rounding [%]",
            table(header, shown, left=4),
            paragraph(count_text(counted(rows))),
        ]
    )


def mean_text(rows: list[dict[str, Any]]) -> str:
    """Means that the text states, ours beside theirs."""
    lines = [
        [
            *(row[k] for k in ("ship", "section")),
            label(row),
            *(row[k] for k in ("kind", "grid", "points")),
            f"{row['ours']:.2f}",
            f"{row['printed']:g}",
            "" if row["within"][0] else f"{row['ours'] - row['printed']:+.2f}",
        ]
        for row in rows
    ]
    header = ["ship", "section", "quantity", "error", "grid", "points", "ours", "printed", "beyond"]
    return "\n".join(
        [
            "mean sizes of the errors that the text states [%]",
            table(header, lines, left=6),
            paragraph(
                count_text(counted(rows, "section")) + " 13 and 23: of grids G1 and G2 against G3; "
                "T: of the turbulence models; r 8, r 16: of the regressions; norm: of the three. "
                "K_S of ONRT, port (leeward), G1: the text has 18.0 %, its own Table B.2 has 7.4 % "
                "(18.0 is the largest cell). The norms of 16 points of KCS take the printed "
                "errors, as the forces of points 13-28 are not in the thesis."
            ),
        ]
    )


def budget_text(rows: list[dict[str, Any]]) -> str:
    """Parts of the budget on each grid, and their norm."""
    keys = ("grid", "grid_12", "turbulence", "surrogate", "total")
    lines = [
        [
            *(row[k] for k in ("model", "on_grid")),
            label(row),
            *("" if row[k] is None else f"{row[k]:.2f}" for k in keys),
        ]
        for row in rows
    ]
    header = ["ship", "grid", "quantity", "against G3", "12 points", "turbulence", "regression"]
    return "\n".join(
        [
            "error budget, means over points 1-4 [%]",
            table([*header, "norm"], lines, left=3),
            paragraph(
                "12 points: of the grid part. The turbulence part of ONRT is of points 5-12, and "
                "of grid G2 alone: SST was run there only."
            ),
        ]
    )
