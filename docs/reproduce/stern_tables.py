"""Turns of KCS beside Stern et al. (2021): force balance by side, findings, and what is printed."""

from __future__ import annotations

import math
import os
from typing import Any

from reproduce.stern_findings import (
    ATTACK,
    MET,
    NOT_OURS,
    WAKE,
    attack,
    evaluate,
    record,
)
from reproduce.stern_turns import AXES, FROUDE_NUMBERS, Pair, thrust_identity, turns
from ship_gym.text import paragraph, table

LABELS = {"R_0": "R_0", "hull": "H", "propeller": "P", "rudder": "R", "inertia": "inertia"}
# 1 - w by thrust identity to starboard and port (Table 5, appendix): facilities
PRINTED_WAKE = {
    0.157: {"HU": (0.605, 0.711), "IIHR": (0.739, 0.805)},
    0.26: {"IIHR": (0.659, 0.806)},
}
PRINTED_J_B = {
    0.157: {"HU": (0.3724, 0.3514), "IIHR": (0.3693, 0.3362)},
    0.26: {"IIHR": (0.3480, 0.3200), "CFD": (0.4431, 0.4322)},
}


def balance(pair: Pair) -> list[dict[str, Any]]:
    """Every component of the steady balance to both sides, in primes and in newtons.

    Returns
    -------
    list of dict
        ``axis``, ``component``, ``starboard``, ``port`` (1e-3, as if to starboard),
        ``difference`` and ``difference_percent`` (magnitude to port less that to starboard, and in
        percent of the mean), ``newtons_percent`` (the same of the forces themselves).
    """
    found = []
    starboard, port = (pair.turns[side] for side in ("starboard", "port"))
    for axis in AXES:
        for name in LABELS:
            if name not in port.forces[axis]:
                continue
            primes = [1e3 * t.prime(axis, name) for t in (starboard, port)]
            forces = [abs(t.forces[axis][name]) for t in (starboard, port)]
            found.append(
                {
                    "axis": axis,
                    "component": name,
                    "starboard": primes[0],
                    "port": primes[1],
                    "difference": abs(primes[1]) - abs(primes[0]),
                    "difference_percent": Pair.percent(*map(abs, primes)),
                    "newtons_percent": Pair.percent(*forces),
                }
            )
    return found


def beside(pair: Pair) -> list[dict[str, Any]]:
    """Printed numbers of the propeller in the turn beside ours: starboard, then port."""
    sides = ("starboard", "port")
    wakes = [
        thrust_identity(t.ship, t.circle.steady_thrust, t.speed, t.n)
        for t in (pair.turns[s] for s in sides)
    ]
    approach, *turned = ATTACK[pair.froude]
    rows = [
        ("U/(nD)", PRINTED_J_B[pair.froude], [pair.turns[s].J_B for s in sides]),
        ("1 - w, thrust identity", PRINTED_WAKE[pair.froude], wakes),
        (
            "growth of the blade's angle of attack [deg]",
            {"CFD": tuple(x - approach for x in turned)},
            [attack(pair, s) for s in sides],
        ),
    ]
    return [
        {"what": what, "by": by, "printed": list(values), "ours": ours}
        for what, printed, ours in rows
        for by, values in printed.items()
    ]


def drift(pair: Pair) -> list[dict[str, Any]]:
    """Drift angle [deg] along the hull by side, from FP to AP."""
    places = {"FP": 0.5, "midship": 0.0, "AP": -0.5}
    return [
        {"side": side, **{k: math.degrees(t.drift(x)) for k, x in places.items()}}
        for side, t in pair.turns.items()
    ]


def as_dict() -> dict[str, Any]:
    """All tables as plain data, for ``--json``."""
    pairs = [turns(fn) for fn in FROUDE_NUMBERS]
    return {
        "balance": balance(pairs[0]),
        "printed": [row | {"froude": p.froude} for p in pairs for row in beside(p)],
        "drift": drift(pairs[1]),
        "findings": evaluate(turns),
    }


def write_record(data: dict[str, Any]) -> str:
    """Write the table of findings; return where."""
    from reproduce.stern_findings import RECORD

    record(data["findings"])
    return os.path.relpath(RECORD)


def as_text(data: dict[str, Any]) -> str:
    """All tables for people, from `as_dict`."""
    met = sum(row["verdict"] == MET for row in data["findings"])
    return "\n".join(
        [
            "KCS, 35 deg turns at Fn 0.157: steady balance, signs as to starboard, in 1e-3",
            _balance_text(data["balance"]),
            paragraph(_PRIMES),
            "",
            "propeller in the turn, beside the print",
            _printed_text(data["printed"]),
            paragraph(_WAKE),
            "",
            "drift angle along the hull at Fn 0.26 [deg]; printed: about 10 at FP, 40 at AP",
            _drift_text(data["drift"]),
            paragraph(_DRIFT),
            "",
            f"findings that sentences state: {met} of {len(data['findings'])} met",
            _findings_text(data["findings"]),
            paragraph(f"Stated too, but of what this model does not have: {NOT_OURS}"),
            paragraph(_TWICE),
        ]
    )


_PRIMES = (
    "Divided by 1/2 rho L d U^2 (N: L^2 d) with the steady speed U of each turn. The slides do not "
    "say by which speed they divide, but that every component is larger to port holds for the "
    "rudder force that HU measured only so: 2.589 N to port, 2.922 N to starboard, 4.415 and 4.325 "
    "by the steady speed, 0.871 and 0.984 by the approach speed (Table 1). In newtons see the last "
    "column. R_0 is a constant of our hull. The bars of the slides carry no numbers in the text we "
    "have."
)
_WAKE = (
    "Thrust identity: with NMRI's open-water points. By it 1 - w is larger to port (Table 5); by "
    "the velocities of the CFD, propeller induced ones included, larger to starboard (Table 4: "
    "0.583 against 0.563). Angle of attack at 70 % radius: ours by momentum theory without swirl, "
    "estimated; printed are the angles themselves, "
    + "; ".join(f"Fn {fn:g}: " + ", ".join(f"{x:.2f}" for x in a) for fn, a in ATTACK.items())
    + " (approach, starboard, port)."
)
_DRIFT = (
    "By their formula, beta_0 - x' r'. The printed radii 1.24 and 1.17 L make 46 and 49 deg "
    "between FP and AP, so the 10 deg at the bow have the other sign than the 40 at the stern."
)
_TWICE = (
    "Our model scales by Froude's law alone, so its two Froude numbers agree but for the approach "
    f"phase. Wake of the approach: {', '.join(f'{w} at Fn {fn:g}' for fn, w in WAKE.items())} "
    "(IIHR). The standard deviations printed for Fn 0.157 to starboard (5.9, 3.2, 4.1 %) are those "
    "of Fn 0.26, figure by figure."
)


def _balance_text(rows: list[dict[str, Any]]) -> str:
    header = ["", "starboard", "port", "port - starboard", "of mean", "in newtons"]
    cells = [
        [
            f"{row['axis']} {LABELS[row['component']]}",
            *(f"{row[k] + 0.0:.2f}" for k in ("starboard", "port")),
            f"{row['difference']:+.2f}",
            f"{row['difference_percent']:+.1f} %",
            f"{row['newtons_percent']:+.1f} %",
        ]
        for row in rows
    ]
    return table(header, cells)


def _printed_text(rows: list[dict[str, Any]]) -> str:
    header = ["Fn", "", "", "starboard", "port", "ours, starboard", "port"]
    cells = [
        [
            f"{row['froude']:g}",
            row["what"],
            row["by"],
            *(f"{x:.3f}" for x in (*row["printed"], *row["ours"])),
        ]
        for row in rows
    ]
    return table(header, cells, left=3)


def _drift_text(rows: list[dict[str, Any]]) -> str:
    cells = [
        [r["side"], *(f"{r[k]:.1f}" for k in ("FP", "midship", "AP")), f"{r['AP'] - r['FP']:.1f}"]
        for r in rows
    ]
    return table(["", "FP", "midship", "AP", "AP - FP"], cells)


def _findings_text(rows: list[dict[str, Any]]) -> str:
    cells = []
    for r in rows:
        low, high = (None if x is None else f"{x:.4g}" for x in (r["low"], r["high"]))
        if high is None:
            limits = f"above {low}"
        elif low == "0":
            limits = f"below {high}"
        else:
            limits = f"{low} to {high}"
        cells.append(
            [f"{r['froude']:g}", r["says"], r["place"], limits, f"{r['ours']:.3g}", r["verdict"]]
        )
    return table(["Fn", "", "", "source", "ours", ""], cells, left=3)
