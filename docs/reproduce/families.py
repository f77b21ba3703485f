"""The same manoeuvres of KCS with each family of surrogate, fitted to the same eight points."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ship_gym.reports.case import sail, sail_trial
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.text import paragraph, percent, table

FAMILIES = {"regression": "G2_SA", "process": "gp", "network": "nn"}
TURNING = ("max_advance", "max_transfer", "steady_diameter", "steady_speed_ratio", "steady_thrust")
# Knight (2021) Tables 4.2 and 4.3: free-surface CFD with the eight-point regression on G2, n 10.2
THESIS_CFD = {"max_advance": 3.07, "max_transfer": 3.13, "steady_diameter": 2.70}
# Knight (2021) Table 4.3: case, our surrogate, n [rev/s], and THESIS_CFD's three measures
TABLE_4_3 = (
    ("G2", "G2_SA", 10.2, (3.07, 3.13, 2.70)),
    ("G2 k-omega SST", "G2_SST", 10.2, (3.21, 3.35, 2.93)),
    ("G2, n = 10.6", "G2_SA", 10.6, (3.05, 3.12, 2.70)),
    ("G2, n = 10.8", "G2_SA", 10.8, (3.03, 3.11, 2.70)),
    ("G3", "G3_SA", 10.2, (2.93, 3.00, 2.60)),
)
FROUDE_NUMBERS = (0.157, 0.26)
ZIGZAGS_DEG = (10.0, -10.0, 20.0, -20.0)
# First and second overshoot [deg] by hull sets A and B with the MMG rudder, as collected in the
# project's reference ships.md section 1.2 (simulated there, not measured); B has no row at 0.157.
HULL_SETS = {
    0.157: {10: [(5.0, 10.3)], -10: [(6.3, 7.8)], 20: [(10.4, 12.5)], -20: [(12.3, 10.7)]},
    0.26: {
        10: [(6.1, 12.1), (6.0, 11.0)],
        -10: [(7.7, 9.3), (7.6, 8.4)],
        20: [(13.8, 15.9), (13.7, 15.4)],
        -20: [(16.2, 13.7), (16.1, 13.2)],
    },
}


def turning(ship: str = "kcs_model") -> dict[str, Any]:
    """Measures of the 35 deg starboard turn with each family, beside the trial and the CFD.

    Returns
    -------
    dict
        ``trial`` and ``cfd`` by measure; ``families``: family to measures (lengths in L, thrust in
        N).
    """
    found, measured = {}, {}
    for family, name in FAMILIES.items():
        loaded = load_ship(ship, surrogate=name)
        trial = loaded.trials[0]
        measures = sail_trial(loaded, trial).result.measures()
        found[family] = {k: measures[k] for k in TURNING}
        measured = {k: trial.measures[k] for k in TURNING if k in trial.measures}
    return {"trial": measured, "cfd": THESIS_CFD, "families": found}


def table_4_3(ship: str = "kcs_model") -> list[dict[str, Any]]:
    """Turning circles of Table 4.3: surrogates, and faster propellers, beside the thesis' CFD.

    Returns
    -------
    list of dict
        ``case``, ``n`` [rev/s], ``ours`` and ``printed`` by measure (lengths in L) and our
        ``speed_ratio``, of which the thesis only draws the counterpart.
    """
    found = []
    for case, surrogate, n, printed in TABLE_4_3:
        loaded = load_ship(ship, surrogate=surrogate)
        trial = dataclasses.replace(loaded.trials[0], n=n)
        measures = sail_trial(loaded, trial).result.measures()
        found.append(
            {
                "case": case,
                "n": n,
                "ours": {k: measures[k] for k in THESIS_CFD},
                "printed": dict(zip(THESIS_CFD, printed, strict=True)),
                "speed_ratio": measures["steady_speed_ratio"],
            }
        )
    return found


def overshoots(ship: Ship, angle_deg: float, froude: float) -> list[float]:
    """First and second overshoot [deg] of a zig-zag with that rudder and heading."""
    speed = froude * math.sqrt(9.80665 * ship.hull.L)
    case = sail(ship, "zigzag", delta_deg=angle_deg, psi_deg=angle_deg, speed=speed)
    return [math.degrees(x) for x in case.result.measures()["overshoots"][:2]]


def zigzags(ship: str = "kcs_model") -> list[dict[str, Any]]:
    """Overshoots [deg] of 10/10 and 20/20 to both sides with each family, beside the hull sets."""
    ships = {family: load_ship(ship, surrogate=name) for family, name in FAMILIES.items()}
    mmg = [load_ship(ship, surrogate="none", variant=hull) for hull in ("hull_a", None)]
    return [
        {
            "froude": froude,
            "angle_deg": angle,
            "hull_sets": HULL_SETS[froude][int(angle)],
            "computed": [overshoots(s, angle, froude) for s in mmg],
            "families": {k: overshoots(s, angle, froude) for k, s in ships.items()},
        }
        for froude in FROUDE_NUMBERS
        for angle in ZIGZAGS_DEG
    ]


def as_dict() -> dict[str, Any]:
    """Turning circles and zig-zags as plain data, for ``--json``."""
    return {"turning": turning(), "table_4_3": table_4_3(), "zigzag": zigzags()}


def as_text(data: dict[str, Any]) -> str:
    """Turning circles and zig-zags for people, from `as_dict`."""
    parts = _turning_text(data["turning"]), _table_4_3_text(data["table_4_3"])
    return "\n\n".join([*parts, _zigzag_text(data["zigzag"])])


def _turning_text(data: dict[str, Any]) -> str:
    cells = []
    for name in TURNING:
        trial, cfd = data["trial"].get(name), data["cfd"].get(name)
        row = [name.replace("_", " "), *(f"{x:.3f}" if x else "" for x in (trial, cfd))]
        for measures in data["families"].values():
            value = measures[name]
            row += [f"{value:.3f}", percent(100.0 * (value / trial - 1.0)) if trial else ""]
        cells.append(row)
    header = ["", "trial", "CFD"]
    for family in data["families"]:
        header += [family, ""]
    return "\n".join(
        [
            "kcs_model, 35 deg turn to starboard at 0.860 m/s, lengths in L, thrust in N",
            table(header, cells),
            paragraph(
                "trial: SIMMAN 2020 at Hiroshima University. CFD: Knight (2021), free surface, "
                "with the regression. Percent: of the trial. All three families are fitted to the "
                "same eight points (grid G2, Spalart-Allmaras)."
            ),
        ]
    )


def _table_4_3_text(rows: list[dict[str, Any]]) -> str:
    cells = []
    for row in rows:
        line = [row["case"]]
        for name, printed in row["printed"].items():
            ours = row["ours"][name]
            line += [f"{ours:.2f}", f"{printed:.2f}", percent(100.0 * (ours / printed - 1.0))]
        cells.append([*line, f"{row['speed_ratio']:.3f}"])
    header = ["case"]
    for name in ("advance", "transfer", "diameter"):
        header += [name, "CFD", ""]
    return "\n".join(
        [
            "kcs_model, the same turn beside the CFD of Knight (2021) Table 4.3, lengths in L",
            table([*header, "U/U0"], cells),
        ]
    )


def _zigzag_text(rows: list[dict[str, Any]]) -> str:
    def pair(values) -> str:
        return " / ".join(f"{x:.1f}" for x in values)

    cells = [
        [
            f"{row['froude']:g}",
            f"{row['angle_deg']:+g}/{row['angle_deg']:+g}",
            *(pair(row["families"][family]) for family in FAMILIES),
            ", ".join(pair(values) for values in row["computed"]),
            ", ".join(pair(values) for values in row["hull_sets"]),
        ]
        for row in rows
    ]
    header = ["Fn", "zig-zag", *FAMILIES, "hull sets A, B with MMG rudder", "in the reference"]
    return "\n".join(
        [
            "kcs_model, first / second overshoot [deg]; + first to starboard",
            table(header, cells, left=2),
        ]
    )
