"""What came out of a manoeuvre beside what was measured and what IMO allows, as data and text."""

from __future__ import annotations

import math
import shlex
from typing import Any

from ship_gym.reports.balance import steady_balance
from ship_gym.reports.case import Case, has_waves
from ship_gym.reports.measures import (
    DIRECTIONS,
    Row,
    deviations_text,
    difference_text,
    in_kilo,
    rows,
)
from ship_gym.sea.wave_response import energy_outside
from ship_gym.ships.particulars import Ship
from ship_gym.text import paragraph, table

CONDITION = "; "  # between manoeuvre and condition in a title
_NOTED = 0.01  # share of the waves' energy outside the wave table from which it is said

_RESISTING = ("hull", "rudder", "wave")


def wave_share(case: Case) -> dict[str, float]:
    """Share of the wave drift in the resistance of hull, rudder and waves of a turning circle.

    Returns
    -------
    dict
        ``first``: at rudder execution, of a regular wave only, since the drift of an irregular sea
        at one instant says little; ``to_90_deg``: of the mean forces up to 90 deg of heading. Empty
        for another manoeuvre or without waves.
    """
    if case.calm is None or case.manoeuvre != "turning_circle":
        return {}
    t = case.result.trajectory
    turning = abs(t["psi"]) <= 0.5 * math.pi
    found = {}
    if case.water.regular is not None:
        found["first"] = _share({k: float(t[f"X_{k}"][0]) for k in _RESISTING})
    means = {k: float(t[f"X_{k}"][turning].mean()) for k in _RESISTING}
    return found | {"to_90_deg": _share(means)}


def _share(surge: dict[str, float]) -> float:
    return surge["wave"] / sum(surge.values())


def title(case: Case) -> str:
    """One line: ship, manoeuvre; condition."""
    side = "starboard" if case.delta > 0.0 else "port"
    if case.manoeuvre == "turning_circle":
        what = f"turning circle, {abs(math.degrees(case.delta)):.3g} deg rudder to {side}"
    else:
        angles = f"{abs(math.degrees(case.delta)):.3g}/{abs(math.degrees(case.psi)):.3g}"
        what = f"{angles} zig-zag, first to {side}"
    fn = case.ship.froude(case.speed)
    speed = f"{case.speed:.4g} m/s (Fn {fn:.3f}), {case.n:.4g} rev/s"
    return f"{case.ship.name}: {what}{CONDITION}{speed}, sea: {case.sea}"


def as_dict(case: Case) -> dict[str, Any]:
    """The case as plain numbers, for ``--json``."""
    found = rows(case)
    compared = [row for row in found if row.measured is not None]
    directions = [row for row in compared if row.name in DIRECTIONS]
    percents = [row for row in compared if row not in directions]
    return {
        "ship": case.ship.name,
        "surrogate": case.ship.surrogate_name,
        "variant": case.ship.variant,
        "manoeuvre": case.manoeuvre,
        "delta_deg": math.degrees(case.delta),
        "psi_deg": math.degrees(case.psi),
        "speed": case.speed,
        "n": case.n,
        "sea": case.sea,
        "units": {row.name: row.unit for row in found},
        "measures": {r.name: r.computed if math.isfinite(r.computed) else None for r in found},
        "measured": {r.name: r.measured for r in found if r.measured is not None},
        "difference_percent": {r.name: r.difference for r in percents},
        "difference_deg": {r.name: r.difference for r in directions},
        "deviation": {r.name: r.deviation for r in found if r.deviation is not None},
        "difference_in_deviations": {
            r.name: r.deviations for r in found if r.deviations is not None
        },
        "others": {r.name: r.others for r in found if r.others},
        "imo": {r.name: {"limit": r.limit, "pass": r.passes} for r in found if r.limit is not None},
        "calm": {r.name: r.calm for r in found if r.calm is not None},
        "wave_share": wave_share(case),
        "trial_source": case.trial.source if case.trial else None,
        "facility": case.trial.facility if case.trial else None,
        "estimated": case.ship.estimated,
        "implausible": list(case.ship.implausible),
    }


def as_text(case: Case) -> str:
    """The case as a report for people."""
    found = rows(case)
    lines = [title(case)]
    lines.append(f"hull set {case.ship.variant}, surrogate {case.ship.surrogate_name}")
    lines += ["", _measure_table(found)]
    if case.trial:
        who = f"{case.trial.facility}: " if case.trial.facility else ""
        lines.append(paragraph(f"measured: {who}{case.trial.source}"))
        if case.trial.others:
            lines += ["", _others_table(found, list(case.trial.others))]
    if has_waves(case.water):
        lines += ["", _wave_text(case)]
    lines += ["", _imo_table(found)]
    if case.manoeuvre == "turning_circle" and case.sea == "calm":
        lines += ["", "force balance of the steady turn", _balance_table(case)]
    return "\n".join(lines)


def _measure_table(found: list[Row]) -> str:
    """Measures, in waves beside those in calm water, and beside what was measured."""
    calm, scatter = (any(getattr(r, k) is not None for r in found) for k in ("calm", "deviation"))
    trial = any(row.measured is not None for row in found) or not calm
    header = ["measure", "unit", *(["in waves", "calm water"] if calm else ["computed"])]
    header += ["measured", "difference"] if trial else []
    header += ["in SD"] if scatter else []
    cells = []
    for row in found:
        unit, computed, still = _shown(row, row.calm)
        line = [row.label, unit, computed, *([still] if calm else [])]
        line += [_measured_cell(row), difference_text(row)] if trial else []
        cells.append(line + ([deviations_text(row)] if scatter else []))
    return table(header, cells, left=2)


def _measured_cell(row: Row) -> str:
    _, _, measured = _shown(row, row.measured)
    _, _, deviation = _shown(row, row.deviation)
    return f"{measured} ± {deviation}" if deviation else measured


def _others_table(found: list[Row], names: list[str]) -> str:
    """What others computed for the trial, beside ours and the measured values."""
    cells = [
        [row.label, *(_shown(row, x)[2] for x in (row.computed, row.measured))]
        + [_shown(row, row.others.get(name))[2] for name in names]
        for row in found
        if row.others
    ]
    return table(["computed by others", "here", "measured", *names], cells)


def _wave_text(case: Case) -> str:
    """How large the wave drift is, and what of the waves the ship's table does not hold."""
    share = wave_share(case)
    lines = []
    if "first" in share:
        lines.append(f"wave drift is {share['first']:.0%} of the resistance at first")
    if share:
        lines.append(
            f"wave drift is {share['to_90_deg']:.0%} of the resistance up to 90 deg of heading"
        )
    outside = energy_outside(case.ship, case.water.components())
    if outside > _NOTED:
        lines.append(f"{outside:.0%} of the waves' energy is outside the ship's wave table")
    return "\n".join(lines) or "drift and wave-frequency motion are in the recording (--csv, --rrd)"


def _imo_table(found: list[Row]) -> str:
    judged = [row for row in found if row.limit is not None]
    if not judged:
        return "IMO MSC.137(76) has no limit for this manoeuvre"
    cells = []
    for row in judged:
        verdict = "pass" if row.passes else "FAIL"
        cells.append([row.label, *_shown(row, row.limit), verdict])
    return table(["IMO MSC.137(76)", "unit", "computed", "at most", ""], cells, left=2)


def _shown(row: Row, other: float | None) -> tuple[str, str, str]:
    """Unit, computed value and the one to compare with; large forces in kN."""
    unit, factor, digits = in_kilo(row.unit, row.computed, row.digits)
    text = "" if other is None else f"{other * factor:.{digits}f}"
    return f"[{unit}]", f"{row.computed * factor:.{digits}f}", text


def _balance_table(case: Case) -> str:
    balance = steady_balance(case.ship, case.result.trajectory)
    largest = max(abs(value) for values in balance.values() for value in values)
    unit, factor, digits = in_kilo("N", largest, 3)
    cells = [
        [name, *(f"{round(factor * value, digits) + 0.0:.{digits}f}" for value in values)]
        for name, values in balance.items()
    ]
    return table(["", f"X [{unit}]", f"Y [{unit}]", f"N [{unit} m]"], cells)


def estimates(ship: Ship) -> str:
    """Which numbers of a ship no source prints, in short, and which no ship has."""
    text = "every number of this ship is published"
    if ship.estimated:
        text = paragraph(
            f"estimated for this ship: {', '.join(sorted(ship.estimated))} "
            "(reasons: ship_gym.load_ship(...).describe())"
        )
    return "\n".join([text, *(f"implausible: {line}" for line in ship.implausible)])


def all_as_text(cases: list[Case], files: list[list[str]], ship: str) -> str:
    """Reports of several cases, where each was written, and what to do next.

    Parameters
    ----------
    cases : list of Case
    files : list of list of str
        What was written of each.
    ship : str
        Name or ship file, as it was given.
    """
    parts = [
        f"{as_text(case)}\nwrote {', '.join(written)}"
        for case, written in zip(cases, files, strict=True)
    ]
    return "\n\n".join([*parts, estimates(cases[0].ship) + "\n" + _what_next(cases, ship)])


def _what_next(cases: list[Case], name: str) -> str:
    name, delta = shlex.quote(name), math.degrees(cases[0].delta)
    if len(cases) > 1:
        return f"next: ship-gym simulate turning --ship {name} --variant ... --surrogate ..."
    what, other = ("turning", "zigzag")
    if cases[0].manoeuvre == "zigzag":
        what, other = other, what
    return (
        f"next: ship-gym simulate {what} --ship {name} --delta {-delta:.3g}"
        f"   # the other side\n      ship-gym simulate {other} --ship {name}"
    )
