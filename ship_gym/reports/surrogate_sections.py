"""Sections of the report on a surrogate, from the plain data of ``reports.surrogate.as_dict``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.reports.page import Grid, Picture, Section, Text
from ship_gym.surrogates.fit import PRINTED_FORCES

# Keys of the pictures that `sections` puts in their places.
PICTURES = ("parity", "surfaces", "std", "rudder", "next")


def sections(data: Mapping[str, Any], pictures: Mapping[str, Sequence[Picture]]) -> list[Section]:
    """The report as sections, in reading order.

    Parameters
    ----------
    data : mapping
        Of ``reports.surrogate.as_dict``; ``turning_circle`` of ``turning_check`` may be in it.
    pictures : mapping
        Some of `PICTURES` to what was drawn.
    """

    def drawn(name: str) -> list[Picture]:
        return list(pictures.get(name, ()))

    sides = data["sides"].items()
    return [
        Section("What it is", [_facts(data)]),
        Section(
            "Errors on points not trained on",
            [*(_errors(data, name, side) for name, side in sides), *drawn("parity")],
        ),
        Section("Error budget", _budget(data["error_budget"])),
        Section("Response surfaces", drawn("surfaces")),
        Section("Standard deviation of the model", drawn("std")),
        Section("Fitted models", [b for name, side in sides for b in _models(data, name, side)]),
        Section("Table and other rudder angles", [*_table(data), *drawn("rudder")]),
        Section("Turning circle", _turning(data.get("turning_circle"))),
        Section("Where to sample next", [*_next(data["next_samples"]), *drawn("next")]),
    ]


def provenance(data: Mapping[str, Any]) -> Section:
    """Where everything comes from."""
    rows = [
        ["source of the samples", data["source"]],
        *([f"SHA-256 of {name}", value] for name, value in data["inputs"].items()),
        ["commit", data["git_commit"]],
        *([name, version] for name, version in data["versions"].items()),
    ]
    return Section("Provenance", [Grid("", ["", ""], rows, left=2)])


def _facts(data: Mapping[str, Any]) -> Grid:
    box, options = data["domain"], data["options"]
    angles = data.get("rudder_angles") or [box["delta"]]
    order = f", {options['order']} order" if options["family"] == "regression" else ""
    noise = f", noise {options['noise']}" if options["family"] == "gp" else ""
    # a model of printed coefficients knows the places of its points only
    note = "" if data["trained_on"] == PRINTED_FORCES else f", by their {data['trained_on']}"
    rows = [
        ["model", options["family"] + order + noise],
        ["grid, turbulence model", f"{data['grid'] or '-'}, {data['turbulence'] or '-'}"],
        ["trained on", _list(data["training_points"]) + note],
        ["held out", _list(data["held_out_points"])],
        ["made for", f"{data['made_for']['ship']}, L {data['made_for']['L']:g} m"],
        ["rudder angle", ", ".join(f"{x:.1f}" for x in np.degrees(angles)) + " deg"],
        ["J", f"{box['J_min']:g} to {box['J_max']:g}"],
        ["drift", "{:.1f} to {:.1f} deg".format(*np.degrees([box["beta_min"], box["beta_max"]]))],
        ["torque", data["torque"]],
    ]
    return Grid(data["title"], ["", ""], rows, left=2)


def _list(points: Sequence[int]) -> str:
    return f"points {', '.join(str(p) for p in points)}" if points else "none"


def _of(name: str) -> str:
    """``, leeward`` of two propellers; nothing of one."""
    return "" if name == "single" else f", {name}"


def _errors(data: Mapping[str, Any], name: str, side: Mapping[str, Any]) -> Grid | Text:
    """Held-out errors beside the printed ones, or those of leaving one out."""
    caption = f"error 100 (CFD - model)/CFD [%]{_of(name)}"
    if side["held_out_errors_percent"]:
        caption += ", points not trained on"
        points, errors = data["held_out_points"], side["held_out_errors_percent"]
    elif side["leave_one_out_errors_percent"]:
        caption += ", each point left out of the fit in turn, because none is held out"
        return _by_point(caption, data["training_points"], side["leave_one_out_errors_percent"])
    else:
        return Text(f"No error on unseen points{_of(name)}: {side['leave_one_out_refused']}.")
    header = ["", *(f"point {p}" for p in points), "mean size"]
    rows, printed = [], side["printed_errors_percent"]
    for quantity, values in errors.items():
        rows.append([quantity, *_signed(values), f"{np.abs(values).mean():.2f}"])
        if quantity in printed:
            theirs = printed[quantity]
            rows.append(["  printed", *_signed(theirs), f"{np.abs(theirs).mean():.2f}"])
        if quantity in (means := side["printed_mean_errors_percent"]):
            rows.append(["  printed", *[""] * len(points), f"{means[quantity]:.2f}"])
    return Grid(caption, header, rows)


def _by_point(caption: str, points: Sequence[int], errors: Mapping[str, Any]) -> Grid:
    """A line for each point, because there may be many, and the mean size."""
    columns = [_signed(values) for values in errors.values()]
    rows = [[f"point {p}", *(column[i] for column in columns)] for i, p in enumerate(points)]
    rows.append(["mean size", *(f"{np.abs(values).mean():.2f}" for values in errors.values())])
    return Grid(caption, ["", *errors], rows)


def _signed(values: Sequence[float]) -> list[str]:
    return [f"{value:+.2f}" for value in values]


def _budget(rows: Sequence[Mapping[str, Any]]) -> list[Grid | Text]:
    if not rows:
        return []
    printed = any(row["printed_total"] is not None for row in rows)
    cells = []
    for row in rows:
        parts = [f"{row[k]:.2f}" for k in ("grid", "turbulence", "surrogate", "total")]
        theirs = [f"{row['printed_total']:.2f}" if row["printed_total"] is not None else ""]
        cells.append([row["quantity"] + _of(row["side"]), *parts, *(theirs if printed else [])])
    header = ["", "grid", "turbulence", "surrogate", "norm", *(["printed norm"] if printed else [])]
    return [Grid("mean size of each error [%], and the norm of the three", header, cells)]


def _models(data: Mapping[str, Any], name: str, side: Mapping[str, Any]) -> list[Grid]:
    """Coefficients of regressions beside the printed ones, and numbers of other models."""
    found, printed = [], side["printed_coefficients"]
    if side["coefficients"]:
        header, columns = [""], []
        for quantity, values in side["coefficients"].items():
            fitted = quantity in side["fitted"]
            header.append(quantity if fitted else f"{quantity} (printed)")
            columns.append(values)
            if fitted and quantity in printed:
                header.append("printed")
                columns.append(printed[quantity])
        cells = [[f, *(f"{c[i]:.4f}" for c in columns)] for i, f in enumerate(data["features"])]
        found.append(Grid(f"coefficients, drift in rad{_of(name)}", header, cells))
    others = {q: m for q, m in side["models"].items() if q not in side["coefficients"]}
    if others:
        keys = [k for k, v in next(iter(others.values())).items() if _short(v)]
        cells = [[q, *(_plain(model[k]) for k in keys)] for q, model in others.items()]
        found.append(Grid(f"fitted models{_of(name)}", ["", *keys], cells))
    return found


def _short(value: Any) -> bool:
    """Whether it can stand in a cell."""
    pair = isinstance(value, list) and len(value) == 2
    return isinstance(value, int | float) or (pair and all(map(_short, value)))


def _plain(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_plain, value))
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _table(data: Mapping[str, Any]) -> list[Text]:
    errors, law = data["interpolation_error"], data["effective_inflow"]
    judged = [k for k in errors if k.split()[0] in ("C_T", "C_Q", "C_S", "C_N", "C_A")]
    worst = max(judged, key=errors.get)
    gammas = ", ".join(f"gamma_R{_of(side)} {g:.4f}" for side, g in law["gamma_R"].items())
    misses = "; ".join(
        f"{_of(side)[2:]} {', '.join(f'{e:+.1f}' for e in part)} %".strip()
        for side, part in law["errors_percent"].items()
    )
    return [
        Text(
            f"Interpolation error of the table: at most {100.0 * errors[worst]:.2f} % of the range "
            f"({worst})."
        ),
        Text(
            f"Effective-inflow law fitted to the samples (at other rudder angles that of a ship "
            f"without a captive set of its own): epsilon {law['epsilon']:.4f}, kappa "
            f"{law['kappa']:.4f}, {gammas}. Its error of the normal force at the training points: "
            f"{misses}; mean size {law['mean_abs_error_percent']:.1f} %."
        ),
    ]


def _turning(turn: Mapping[str, Any] | None) -> list[Grid]:
    """Turning circle beside the trial."""
    if turn is None:
        return []
    units = {
        **dict.fromkeys(("max_advance", "max_transfer", "tactical_diameter"), "L"),
        "steady_diameter": "L",
        "steady_speed_ratio": "-",
        "steady_thrust": "N",
    }
    rows = []
    for name, unit in units.items():
        trial = turn["trial"].get(name)
        theirs = "" if trial is None else f"{trial:.3f}"
        label = f"{name.replace('_', ' ')} [{unit}]"
        rows.append([label, f"{turn['measures'][name]:.3f}", theirs])
    header = ["", "computed", "trial" if turn["trial"] else ""]
    return [Grid(f"turning circle, rudder {turn['delta_deg']:.0f} deg", header, rows)]


def _next(proposals: Mapping[str, Any]) -> list[Grid]:
    """Least sure places and space-filling points."""

    def place(row: Mapping[str, float]) -> list[str]:
        return [f"{row['J']:.3f}", f"{math.degrees(row['beta']):.1f}"]

    found = []
    if least := proposals["least_sure"]:
        rows = [
            [row["quantity"] + _of(row["side"]), *place(row), f"{100.0 * row['share']:.1f}"]
            for row in least
        ]
        header = ["", "J", "drift [deg]", "std [% of range]"]
        found.append(Grid("where to sample next: largest std inside the box", header, rows))
    rows = [[str(i), *place(row)] for i, row in enumerate(proposals["space_filling"], start=1)]
    caption = "where to sample next: Latin hypercube away from the points that are there"
    return [*found, Grid(caption, ["new", "J", "drift [deg]"], rows)]
