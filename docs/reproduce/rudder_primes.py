"""Dimensionless rudder forces that Stern et al. (2021) print beside the forces, recomputed."""

from __future__ import annotations

import math
from typing import Any

from reproduce.rudder_formulas import ANGLE, PRINTED, movable_area
from ship_gym.csv_file import read_csv
from ship_gym.physics.rudder import beaufoy
from ship_gym.text import paragraph, table

PRIMES = PRINTED.with_name("stern_2021_rudder_primes.csv")
RHO = 1000.0  # kg/m3; with it Beaufoy's formula gives the printed 0.875
_DIGIT = 0.001  # last printed one
_U_DIGIT = 0.001  # m/s, of the printed speeds
COLUMNS = ("F_N'(U)", "F_N'(U0)", "Beaufoy", "C_F")


def primes() -> list[dict[str, Any]]:
    """Every printed dimensionless force beside ours.

    Ours: from the printed force, speeds and model length, with the movable area of Knight (2021)
    and 1000 kg/m3; Beaufoy's is the formula alone.

    Returns
    -------
    list of dict
        ``row`` (facility, Froude number, side), ``column``, ``printed``, ``computed``.
    """
    forces, printed = read_csv(PRINTED).columns, read_csv(PRIMES).columns
    found = []
    for i in range(len(printed["side"])):
        L, U, U0 = (float(forces[k][i]) for k in ("L", "U", "U0"))
        unit = 0.5 * RHO * movable_area(L)
        F_N = float(forces["F_N measured"][i])
        at_approach = F_N / (unit * U0**2)
        ours = (
            F_N / (unit * U**2),
            at_approach,
            beaufoy(U0, math.sin(ANGLE), movable_area(L)) / (unit * U0**2),
            at_approach,
        )
        row = f"{printed['facility'][i]} Fn {printed['Fn'][i]:g} {printed['side'][i]}"
        for column, value in zip(COLUMNS, ours, strict=True):
            if printed[column][i] != "-":
                cell = {"row": row, "column": column, "printed": float(printed[column][i])}
                found.append(cell | {"computed": float(value)})
    return found


def speed_ratios() -> list[dict[str, Any]]:
    """(U0/U)^2 from the two printed primes and from the printed speeds; no area enters.

    Returns
    -------
    list of dict
        ``row``, ``printed`` (ratio of the primes), ``computed`` and ``agrees``: within the rounding
        of the primes and of the speeds.
    """
    forces, printed = read_csv(PRINTED).columns, read_csv(PRIMES).columns
    found = []
    for i, steady in enumerate(printed["F_N'(U)"]):
        if steady == "-":
            continue
        a, b = float(steady), float(printed["F_N'(U0)"][i])
        U, U0 = float(forces["U"][i]), float(forces["U0"][i])
        ratio, expected = a / b, (U0 / U) ** 2
        slack = 0.5 * (_DIGIT / a + _DIGIT / b) + _U_DIGIT * (1.0 / U + 1.0 / U0)
        row = f"{printed['facility'][i]} Fn {printed['Fn'][i]:g} {printed['side'][i]}"
        agrees = bool(abs(ratio / expected - 1.0) <= slack)
        found.append({"row": row, "printed": ratio, "computed": expected, "agrees": agrees})
    return found


def as_text(cells: list[dict[str, Any]]) -> str:
    """The cells as a table for people, with a count."""
    near = sum(abs(c["computed"] / c["printed"] - 1.0) <= 0.01 for c in cells)
    exact = sum(abs(c["computed"] - c["printed"]) <= 0.5 * _DIGIT + 1e-9 for c in cells)
    rows = sorted({c["row"] for c in cells}, key=[c["row"] for c in cells].index)
    by_cell = {(c["row"], c["column"]): c for c in cells}
    header, lines = [""], []
    for column in COLUMNS:
        header += [column, "printed"]
    for row in rows:
        line = [row]
        for column in COLUMNS:
            cell = by_cell.get((row, column))
            line += [f"{cell[k]:.3f}" if cell else "-" for k in ("computed", "printed")]
        lines.append(line)
    return "\n".join(
        [
            f"dimensionless, 1/2 rho A_R U^2: {exact} of {len(cells)} cells within rounding, "
            f"{near} within 1 %",
            table(header, lines),
            paragraph(
                "Ours with the movable area of Knight (2021), Froude-scaled (45.3 m2 at full "
                "scale) and 1000 kg/m3. The printed forces and primes make it 45.5 m2 (HU, MARIN) "
                "and 0.0063 m2 (IIHR), but for HU's C_F, which is by 0.0080 m2."
            ),
        ]
    )
