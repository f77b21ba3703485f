"""What a fitted propeller and rudder surrogate says of itself, beside what the thesis prints."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from ship_gym.config import CsvTable, read_csv
from ship_gym.reports.case import sail
from ship_gym.reports.text import paragraph, table
from ship_gym.ships.loader import attach_surrogate
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import KCS_COEFFICIENTS, QUANTITIES
from ship_gym.tables import Table

# grid and turbulence model of the tables that come with the package
SHIPPED = (("G1", "SA"), ("G2", "SA"), ("G2", "SST"), ("G3", "SA"))


def printed_coefficients(name: str) -> dict[str, list[float]]:
    """Coefficients that the thesis prints for a model (``"G2_SA"``); empty if it prints none."""
    rows = read_csv(KCS_COEFFICIENTS).where(model=name.replace("_", " "))
    return {k: rows.columns[k].tolist() for k in QUANTITIES if len(rows.rows)}


def printed_errors(path: str | Path, name: str, points: list[int]) -> dict[str, list[float]]:
    """Held-out errors [%] that the thesis prints for the eight-point set of a model.

    Parameters
    ----------
    path : path-like
        CSV with columns quantity, point and ``8pt G2 [%]`` etc.; may be missing.
    name : str
        ``"G2_SA"``; the thesis prints the Spalart-Allmaras models only.
    points : list of int
        Order of the points.
    """
    grid, _, turbulence = name.partition("_")
    if turbulence != "SA" or not Path(path).is_file():
        return {}
    rows: CsvTable = read_csv(path).require("quantity", "point", f"8pt {grid}")
    found = {}
    for quantity in QUANTITIES:
        mine = rows.where(quantity=quantity)
        by_point = dict(zip(mine.columns["point"], mine.columns[f"8pt {grid}"], strict=True))
        found[quantity] = [float(by_point[p]) for p in points]
    return found


def as_dict(table_: Table, name: str, errors_path: str | Path = "", own: bool = False) -> dict:
    """A fitted table as plain numbers, for ``--json``.

    Parameters
    ----------
    table_ : Table
        Of ``surrogates.fit.fit_kcs``.
    name : str
        Grid and turbulence model, e.g. ``"G2_SA"``.
    errors_path : path-like
        As in `printed_errors`.
    own : bool
        Fitted to the user's samples: nothing printed belongs to it.
    """
    card: dict[str, Any] = table_.card
    second = len(card["features"]) == 6
    compare = second and not own
    points = card["held_out_points"]
    return {
        "name": name,
        "trained_on": card["trained_on"],
        "features": card["features"],
        "coefficients": {k: card["coefficients"][k] for k in QUANTITIES},
        "printed_coefficients": printed_coefficients(name) if compare else {},
        "held_out_points": points,
        "held_out_errors_percent": card["held_out_errors_percent"],
        "printed_errors_percent": printed_errors(errors_path, name, points) if compare else {},
        "held_out_scores": card["held_out_scores"],
        "interpolation_error": card["interpolation_error"],
        "effective_inflow": card["effective_inflow"],
        "domain": card["domain"],
    }


def turning_check(ship: Ship, table_: Table, name: str) -> dict[str, float]:
    """Measures of the ship's standard turning circle with this surrogate."""
    return sail(attach_surrogate(ship, table_, name)).result.measures()


def as_text(data: dict) -> str:
    """Fit as a report for people, from `as_dict`."""
    low = data["interpolation_error"]
    worst = max((k for k in low if k != "trust"), key=low.get)
    box = data["domain"]
    return "\n".join(
        [
            f"{data['name']}: rudder {math.degrees(box['delta']):.0f} deg, J {box['J_min']:g} to "
            f"{box['J_max']:g}, drift {math.degrees(box['beta_min']):.0f} to "
            f"{math.degrees(box['beta_max']):.0f} deg; trained on {data['trained_on']}",
            "",
            "coefficients (drift in rad)",
            _beside(data["features"], data["coefficients"], data["printed_coefficients"], "{:.6f}"),
            "",
            "error on points not trained on, 100 (CFD - model)/CFD [%]",
            _beside(
                [f"point {p}" for p in data["held_out_points"]],
                data["held_out_errors_percent"],
                data["printed_errors_percent"],
                "{:.2f}",
            ),
            "",
            f"interpolation error of the table: at most {100.0 * low[worst]:.2f} % of the range "
            f"({worst})",
            _inflow(data["effective_inflow"]),
            *([_turning(data["turning_circle"])] if "turning_circle" in data else []),
        ]
    )


def _beside(labels: list[str], fitted: dict, printed: dict, form: str) -> str:
    """Fitted and, if there are any, printed values of every quantity side by side."""
    header, columns = [""], []
    for quantity in QUANTITIES:
        header.append(quantity)
        columns.append(fitted[quantity])
        if printed:
            header.append("printed")
            columns.append(printed[quantity])
    cells = [
        [label, *(form.format(column[i]) for column in columns)] for i, label in enumerate(labels)
    ]
    return table(header, cells)


def _inflow(law: dict) -> str:
    errors = ", ".join(f"{e:+.1f}" for e in law["errors_percent"])
    return paragraph(
        f"effective-inflow law at other rudder angles: epsilon {law['epsilon']:.4f}, kappa "
        f"{law['kappa']:.4f}, gamma_R {law['gamma_R']:.4f}; error of the normal force at the "
        f"training points {errors} %, mean {law['mean_abs_error_percent']:.1f} %"
    )


def _turning(measures: dict[str, float]) -> str:
    names = ("max_advance", "max_transfer", "steady_diameter")
    lengths = ", ".join(f"{k.replace('_', ' ')} {measures[k]:.2f} L" for k in names)
    return paragraph(
        f"35 deg turning circle with it: {lengths}, U/U0 {measures['steady_speed_ratio']:.3f}, "
        f"thrust {measures['steady_thrust']:.2f} N"
    )


def how_to_use(path: str | Path, name: str) -> str:
    """Lines of Python that attach a table file to a ship."""
    return f"""use it:
  import gymnasium as gym, ship_gym
  from ship_gym.ships.loader import attach_surrogate
  from ship_gym.tables import Table
  ship = attach_surrogate(ship_gym.load_ship("kcs_model"), Table.load("{path}"), "{name}")
  env = gym.make("ShipGym/HeadingKeeping-v0", ship=ship)"""
