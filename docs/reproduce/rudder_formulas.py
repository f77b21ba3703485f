"""Rudder normal force of KCS in steady 35 deg turns: Beaufoy and MMG beside Stern et al. (2021).

The source prints the forces by both formulas for two tanks and, by its text, for IIHR's CFD, but
not all that goes in: no rudder coefficient but l_R and gamma_R, and a drift angle of one turn only.
Here they are computed again from what it prints; the rest is ours, and named.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.conventions import DELTA, FLOW_F_N, FLOW_J, N, R, U, V
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.physics.rudder import beaufoy
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.scaling import scaled
from ship_gym.simulation import ShipSim, longest_step, self_propulsion
from ship_gym.text import paragraph, percent, table

PRINTED = Path(__file__).parent / "data" / "stern_2021_rudder.csv"
ANGLE = math.radians(35.0)
_SETTLED = 80  # approach times L / U0 after which the turn is steady
A_MOVABLE, OF_LENGTH = 0.0080, 3.057  # [m2] at [m], Knight (2021); F_N is measured on it
J_APPROACH = 0.8  # U0/(nD) at self-propulsion of the models, "about" (text beside Fig. 17)
# printed with Fig. 3 for IIHR at Fn 0.26: about 10 deg at FP, 40 at AP; the radius makes the one at
# FP negative, so that midship has
DRIFT_DEG = {("IIHR", 0.26): 0.5 * (40.0 - 10.0)}


def facility_ship(row: dict[str, Any], base: Ship) -> Ship:
    """The model of a facility: `base` at its length, with its l_R and gamma_R of this turn.

    No friction correction: all are self-propelled models without towing force.
    """
    ship = scaled(base, row["L"], rho=base.rho, nu=base.nu, friction_correction=False)
    law = {"l_R": row["l_R"] * row["L"], "gamma_R_p": row["gamma_R"], "gamma_R_n": row["gamma_R"]}
    return dataclasses.replace(ship, rudder=dataclasses.replace(ship.rudder, **law))


def movable_area(L: float) -> float:
    """Lateral area of the movable part of the rudder [m2] at length `L` [m]."""
    return A_MOVABLE * (L / OF_LENGTH) ** 2


def beaufoy_forces(row: dict[str, Any]) -> tuple[float, float]:
    """Beaufoy's F_N [N] of the movable rudder at approach speed and at the steady speed."""
    area = movable_area(row["L"])
    at_approach, steady = (beaufoy(row[k], math.sin(ANGLE), area) for k in ("U0", "U"))
    return at_approach, steady


def steady_turn(ship: Ship, delta: float, speed: float, n: float) -> tuple[float, float]:
    """Drift angle [rad] and speed [m/s] of a steady turn, as of ``manoeuvres.turning_circle``.

    Parameters
    ----------
    ship : Ship
    delta : float
        Rudder angle [rad].
    speed : float
        Approach speed [m/s].
    n : float
        Propeller speed [rev/s].
    """
    sim = ShipSim(ship)
    sim.reset(0, speed=speed, n=n)
    for _ in range(_SETTLED):
        sim.step(np.array([[delta, n]]), ship.hull.L / speed)
    u, v = sim.state[0, U], sim.state[0, V]
    return math.atan2(-v, u), math.hypot(u, v)


def normal_force(ship: Ship, row: dict[str, Any], turn: dict[str, float], n: float):
    """F_N [N] of the movable rudder by YY15 and J = u/(nD), at the printed steady speed.

    Parameters
    ----------
    ship : Ship
        Of `facility_ship`.
    row : dict
        Printed values; ``U`` [m/s] is used.
    turn : dict
        ``delta``, ``beta`` [rad] and ``yaw_rate`` r L/U [-] of the steady turn.
    n : float
        Propeller speed [rev/s].
    """
    sim = ShipSim(ship)
    state, speed = sim.state[0], row["U"]
    state[U], state[V] = speed * math.cos(turn["beta"]), -speed * math.sin(turn["beta"])
    state[R], state[DELTA], state[N] = turn["yaw_rate"] * speed / row["L"], turn["delta"], n
    sim.step(np.array([[turn["delta"], n]]), longest_step(ship))  # reports the start of the step
    share = movable_area(row["L"]) / ship.rudder.A_R
    return share * abs(float(sim.flow[0, FLOW_F_N])), float(sim.flow[0, FLOW_J])


def as_dict() -> dict[str, Any]:
    """Every row of the printed table with our values beside it, as plain numbers.

    Returns
    -------
    dict
        ``source`` and ``rows``; each row has what is printed (``printed``), ``beaufoy`` and
        ``mmg`` (``computed`` [N], ``difference_percent`` from the printed force) and ``inputs``
        (drift, n, J, U/U0 are ours, beside them n of the printed J of the approach and the drift
        where it is printed; yaw_rate is of the printed radius).
    """
    base = load_ship("kcs_model", surrogate="none")
    printed = read_csv(PRINTED)
    rows = [_compared(row, base) for row in _rows(printed)]
    return {"source": printed.header["source"], "rows": rows}


def _rows(printed: CsvTable) -> list[dict[str, Any]]:
    """Rows of the file; text columns of numbers become floats, or None where the file has none."""
    numbers = ("J_B", "F_N measured", "F_N Beaufoy", "F_N MMG")
    rows = []
    for i in range(len(printed.rows)):
        row = {name: values[i].item() for name, values in printed.columns.items()}
        rows.append(row | {k: None if row[k] == "-" else float(row[k]) for k in numbers})
    return rows


def _compared(row: dict[str, Any], base: Ship) -> dict[str, Any]:
    """One row of the table computed again."""
    ship = facility_ship(row, base)
    delta = ANGLE if row["side"] == "starboard" else -ANGLE
    n = self_propulsion(ship, row["U0"])
    beta, speed = steady_turn(ship, delta, row["U0"], n)
    turn = {"delta": delta, "beta": beta, "yaw_rate": math.copysign(1.0 / row["R"], delta)}
    at_approach, at_steady = beaufoy_forces(row)
    law, J = normal_force(ship, row, turn, n)
    mmg: dict[str, Any] = {"computed": law, "difference_percent": _difference(law, row["F_N MMG"])}
    inputs = {"beta_deg": math.degrees(beta), "yaw_rate": turn["yaw_rate"], "n": n, "J": J}
    inputs["U/U0"] = speed / row["U0"]
    inputs["n_of_J_approach"] = row["U0"] / (J_APPROACH * ship.propeller.D)
    inputs["beta_printed_deg"] = DRIFT_DEG.get((row["facility"], row["Fn"]))
    if row["J_B"] is not None:
        inputs["n_of_J_B"] = row["U"] / (row["J_B"] * ship.propeller.D)
        mmg["at_printed_J_B"] = normal_force(ship, row, turn, inputs["n_of_J_B"])[0]
    return {
        "printed": row,
        "beaufoy": {
            "computed": at_approach,
            "difference_percent": _difference(at_approach, row["F_N Beaufoy"]),
            "at_steady_speed": at_steady,
        },
        "mmg": mmg,
        "inputs": inputs,
    }


def _difference(force: float | None, reference: float | None) -> float | None:
    """100 (force - reference) / reference [%]; None where the file has none."""
    return None if force is None or reference is None else 100.0 * (force / reference - 1.0)


def as_text(data: dict[str, Any]) -> str:
    """The comparison as a report for people, from `as_dict`."""
    rows = data["rows"]
    return "\n".join(
        [
            "rudder normal force of KCS in steady 35 deg turns [N], on the movable part",
            "",
            _forces(rows),
            *(paragraph(text) for text in (_BEAUFOY, _MMG)),
            "",
            "difference from the measured force",
            _errors(rows),
            "",
            "what the MMG law was given [deg], [rev/s], and J_B",
            _inputs(rows),
            *(paragraph(text) for text in (_ours(rows), _J_B)),
            paragraph(f"source: {data['source']}"),
        ]
    )


_BEAUFOY = (
    "Beaufoy: 58.8 g A_R (1.15 U)^2 sin 35 deg. The printed column is at the approach speed U0 (it "
    "is the same for both sides); at the steady speed U the formula gives 16 to 29 % of it. It "
    "knows neither the loss of speed nor the loaded propeller: it is near HU's forces by chance."
)
_MMG = (
    "MMG: effective-inflow law of Yasukawa & Yoshimura (2015), rudder of hull set B, 5/6 of it for "
    "the movable part, as a formula by area has it (Knight's CFD has 1.07 there, which the trials "
    "take). Printed: U, l_R, gamma_R, and r' = L/R of the facilities' mean circle."
)
_J_B = (
    "n of J_B = U/(J_B D) with the printed J_B. For HU it is within 3 % of self-propulsion. For "
    "IIHR it is 16 to 23 % above, and the force then far above the printed one: J_B of Table 6 is "
    "of its tank, U and F_N of Table 1 are by its marks and the text of its CFD. With the CFD's "
    "J_B, 0.4322 at Fn 0.26, n is 16.4. So what stands for IIHR as measured is computed."
)


def _ours(rows: list[dict[str, Any]]) -> str:
    """What of the inputs is ours, and what of it is printed all the same."""
    gaps = [abs(r["inputs"]["n"] / r["inputs"]["n_of_J_approach"] - 1.0) for r in rows]
    known = [r for r in rows if r["inputs"]["beta_printed_deg"] is not None]
    drifts = "; ".join(
        f"{_name(r)}: {r['inputs']['beta_printed_deg']:.0f} deg, ours "
        f"{abs(r['inputs']['beta_deg']):.1f}"
        for r in known
    )
    return (
        "Ours: drift beta of our steady turn with hull set B and the facility's l_R and gamma_R. "
        f"Printed along the hull, at midship for {drifts}. Propeller speed n held at "
        f"self-propulsion: within {max(gaps):.1%} of what the printed J of about {J_APPROACH} "
        "there gives. With HU's l_R and gamma_R that hull turns tighter than the model did and "
        "loses more speed (U/U0 of our turn beside the printed one)."
    )


def _name(row: dict[str, Any]) -> str:
    p = row["printed"]
    return f"{p['facility']} Fn {p['Fn']:g} {p['side']}"


def _number(value: float | None, form: str = "{:.3f}") -> str:
    return "-" if value is None else form.format(value)


def _forces(rows: list[dict[str, Any]]) -> str:
    header = ["", "measured", "Beaufoy", "printed", "", "at steady U", "MMG", "printed", ""]
    cells = []
    for row in rows:
        p, b, m = row["printed"], row["beaufoy"], row["mmg"]
        cells.append(
            [
                _name(row),
                _number(p["F_N measured"]),
                _number(b["computed"]),
                _number(p["F_N Beaufoy"]),
                percent(b["difference_percent"]),
                _number(b["at_steady_speed"]),
                _number(m["computed"]),
                _number(p["F_N MMG"]),
                percent(m["difference_percent"]),
            ]
        )
    return table(header, cells)


def _errors(rows: list[dict[str, Any]]) -> str:
    header = ["", "Beaufoy", "printed", "MMG", "printed"]
    cells = []
    for row in rows:
        measured, printed = row["printed"]["F_N measured"], row["printed"]
        forces = (
            row["beaufoy"]["computed"],
            printed["F_N Beaufoy"],
            row["mmg"]["computed"],
            printed["F_N MMG"],
        )
        errors = (_difference(F, measured) for F in forces)
        cells.append([_name(row), *(percent(e) or "-" for e in errors)])
    return table(header, cells)


def _inputs(rows: list[dict[str, Any]]) -> str:
    header = ["", "U/U0", "ours", "beta", "r'", "n", "u/(nD)", "J_B", "n of J_B", "MMG at it"]
    cells = []
    for row in rows:
        p, o = row["printed"], row["inputs"]
        cells.append(
            [
                _name(row),
                f"{p['U'] / p['U0']:.3f}",
                f"{o['U/U0']:.3f}",
                f"{o['beta_deg']:.1f}",
                f"{o['yaw_rate']:.3f}",
                f"{o['n']:.2f}",
                f"{o['J']:.3f}",
                _number(p["J_B"], "{:.4f}"),
                _number(o.get("n_of_J_B"), "{:.2f}"),
                _number(row["mmg"].get("at_printed_J_B")),
            ]
        )
    return table(header, cells)
