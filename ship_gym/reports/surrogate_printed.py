"""What Knight (2021) prints of his surrogates, for the reports to put beside ours."""

from __future__ import annotations

from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.surrogates.samples import DATA, DataSet

_ERRORS = {"kcs": "kcs_regression_error.csv", "onrt": "onrt_regression_error.csv"}
_PROCESS = {"kcs": "kcs_surrogate_comparison.csv", "onrt": "onrt_surrogate_comparison.csv"}
_PROCESS_COLUMN = {"printed": "GP sigma_n calculated", "none": "GP sigma_n 0.0001"}
# Table 3.11 calls 10K_Q K_Q; its rudder rows are of the movable part, whose forces are not in the
# thesis (Tables A.5, A.6, 3.3, 3.4 are of the whole rudder, section 3.2.3)
_TABLE_3_11 = {"K_T": "K_T", "10K_Q": "K_Q"}


def printed_errors(data: DataSet, grid: str, turbulence: str, side: str) -> dict[str, list[float]]:
    """Errors [%] on points 1-4 that the thesis prints for the eight-point regression.

    Tables 3.7-3.10 (KCS, Spalart-Allmaras) and 5.9 (ONRT, grid G2 only).

    Returns
    -------
    dict
        Quantity to errors in the order of ``data.validation``; empty if none are printed.
    """
    if data.name not in _ERRORS or turbulence != "SA" or (data.name == "onrt" and grid != "G2"):
        return {}
    rows = read_csv(DATA / _ERRORS[data.name])
    if data.name == "onrt":
        rows = rows.where(set=8.0, side=data.sides[side])
    found = {}
    for quantity in data.quantities:
        mine = rows.where(quantity=quantity)
        found[quantity] = [_error(mine, grid, point) for point in data.validation]
    return found


def _error(rows: CsvTable, grid: str, point: int) -> float:
    """Error of a point in the rows of one quantity: points are columns for ONRT, rows for KCS."""
    if f"point {point}" in rows.columns:
        return float(rows.columns[f"point {point}"][0])
    return float(rows.where(point=float(point)).columns[f"8pt {grid}"][0])


def printed_errors_of_16(quantity: str) -> list[float]:
    """Errors [%] on points 1-4 of the 16-point regression of KCS on grid G2, Tables 3.7-3.10."""
    rows = read_csv(DATA / _ERRORS["kcs"]).where(quantity=quantity)
    return [float(x) for x in rows.columns["16pt G2"]]


def printed_means(data: DataSet, noise: str, side: str) -> dict[str, float]:
    """Mean sizes of the held-out errors [%] that the thesis prints for the process on 8 points.

    Table 3.11 and chapter 5, with the printed sigma_n (``noise = "printed"``) or 1e-4 (``none``).
    """
    if data.name not in _PROCESS or noise not in _PROCESS_COLUMN:
        return {}
    rows, column = read_csv(DATA / _PROCESS[data.name]), _PROCESS_COLUMN[noise]
    if data.name == "onrt":
        rows = rows.where(side=data.sides[side])
        return dict(zip(rows.columns["quantity"].tolist(), rows.columns[column], strict=True))
    return {name: _of_table_3_11(rows, printed, column) for name, printed in _TABLE_3_11.items()}


def printed_regression_means() -> dict[str, float]:
    """Mean sizes of the held-out errors [%] of the 8-point regression of KCS in Table 3.11."""
    rows = read_csv(DATA / _PROCESS["kcs"])
    return {k: _of_table_3_11(rows, v, "linear regression") for k, v in _TABLE_3_11.items()}


def _of_table_3_11(rows: CsvTable, quantity: str, column: str) -> float:
    mine = rows.where(**{"training set": "8 point", "quantity": quantity})
    return float(mine.columns[column][0])


def printed_totals(data: DataSet) -> dict[str, float]:
    """Norms [%] of the error budget that the thesis prints, of the regression of KCS on grid G2."""
    if data.name != "kcs":
        return {}
    rows = read_csv(DATA / "error_budget.csv")
    return dict(zip(rows.columns["quantity"].tolist(), rows.columns["total"].tolist(), strict=True))
