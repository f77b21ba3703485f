"""The page of the manoeuvres: limits of IMO, trials, either side, waves, measured histories."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym.evaluation.manoeuvres.definition import CALM
from ship_gym.evaluation.manoeuvres.pictures import pictures
from ship_gym.evaluation.manoeuvres.sailing import Sailed
from ship_gym.reports.balance import steady_balance
from ship_gym.reports.case import Case
from ship_gym.reports.histories import SOURCE, computed_history, difference, measured_history
from ship_gym.reports.measures import Row as Shown
from ship_gym.reports.measures import difference_text
from ship_gym.reports.page import Block, Cell, Folded, Grid, Section, Text, write_page

Row = Mapping[str, Any]
_INTRODUCTION = (
    "Standard manoeuvres of the hulls, without a controller: rudder and propeller as ordered, from "
    "a straight course at the nominal speed and self-propulsion. In a sea waves and wind come from "
    "ahead of the approach, one realisation of them, so a value there is one draw. The limits are "
    "those of IMO MSC.137(76), at the ship's nominal speed; the calm water values are judged. "
    "Measured values are those of the ship files, with the standard deviation (SD) of the "
    "facilities where one is printed."
)
_STOP = (
    "Engines are estimates and a reversed propeller has no side force here: of the stop the track "
    "reach is the weakest number."
)


def write_manoeuvres_report(
    path: str | os.PathLike,
    sailed: Sequence[Sailed],
    rows: Sequence[Row],
    about: Mapping[str, Any],
    trials: Path | None = None,
    progress: Callable[[Iterable], Iterable] = iter,
) -> None:
    """Write the page as one HTML file, whole or not at all.

    Parameters
    ----------
    path : path-like
    sailed : sequence of Sailed
    rows : sequence of mapping
        Of ``table.rows_of``.
    about : mapping
        As of the table.
    trials : Path, optional
        Folder of measured histories.
    progress : callable
        Wraps what takes long.
    """
    ships = list(dict.fromkeys(row["ship"] for row in rows))
    sections = [Section("Limits of IMO", [Text(_INTRODUCTION), _imo(rows), Text(_STOP)], "imo")]
    sections += [_scatter(rows)]
    for ship in progress(ships):
        mine = [row for row in rows if row["ship"] == ship]
        cases = [each for each in sailed if each.ship.name == ship]
        sections.append(_of_ship(ship, cases, mine, trials))
    sections.append(Section("How this was made", [_made(about)], "made"))
    under = f"{about['version']}; {', '.join(ships)}; no controllers"
    write_page(path, "Benchmark: manoeuvres", under, sections)


def _imo(rows: Sequence[Row]) -> Grid:
    judged = [row for row in rows if row["limit"] is not None]
    cells = [
        [
            row["ship"],
            f"{row['manoeuvre']} {row['side']}".strip(),
            row["label"],
            row["unit"],
            f"{row['limit']:.4g}",
            f"{row['value']:.2f}",
            Cell("pass", mark="better") if row["passes"] else Cell("above it", mark="worse"),
        ]
        for row in judged
    ]
    header = ["ship", "manoeuvre", "measure", "unit", "limit", "computed", ""]
    return Grid("IMO MSC.137(76), calm water", header, cells, 4)


def _scatter(rows: Sequence[Row]) -> Section:
    """Trials beside the simulation."""
    found = [row for row in rows if row["trial"] is not None]
    cells = []
    for row in found:
        off, sd = row["value"] - row["trial"], row["trial_scatter"]
        cells.append([
            row["ship"],
            f"{row['manoeuvre']} {row['side']}".strip(),
            row["label"],
            row["unit"],
            f"{row['trial']:.4g}" + (f" ± {sd:.2g}" if sd else ""),
            f"{row['value']:.4g}",
            _off(row),
            f"{off / sd:+.1f}" if sd else "",
        ])  # fmt: skip
    header = ["ship", "manoeuvre", "measure", "unit", "measured", "computed", "off", "in SD"]
    sources = dict.fromkeys(f"{row['ship']}, {row['source']}" for row in found)
    table = Grid("Trials of the ship files", header, cells, 4)
    blocks: list[Block] = [table] if cells else []
    blocks += [Folded("Sources", [Text(source) for source in sources])] if sources else []
    return Section("Trials", blocks, "trials")


def _off(row: Row) -> str:
    """By how much the computed value is off: of a direction an angle, else a share."""
    shown = Shown(row["measure"], row["value"], row["trial"])
    return difference_text(shown)


def _of_ship(
    ship: str, cases: Sequence[Sailed], rows: Sequence[Row], trials: Path | None
) -> Section:
    cases = [each for each in cases if each.trial is None]
    blocks: list[Any] = list(pictures(cases, trials))
    for table in (_histories(cases, trials), _sides(rows), _forces(cases)):
        blocks += table
    blocks.append(Folded("All measures, calm and in waves", [_all(rows)]))
    lost = [row for row in rows if row["error"]]
    blocks += [
        Text(f"{row['manoeuvre']} {row['side']}, {row['sea']}: not sailed: {row['error']}")
        for row in lost
    ]
    return Section(ship, blocks, f"ship-{ship}")


def _histories(cases: Sequence[Sailed], trials: Path | None) -> list[Any]:
    cells = []
    for each in cases:
        if not isinstance(each.case, Case):
            continue
        measured = measured_history(each.case, trials)
        if measured is not None:
            off = difference(computed_history(each.case), measured)
            numbers = [f"{off['time']:.0f}", f"{off['heading']:.1f}", f"{off['track']:.2f}"]
            name = f"{each.manoeuvre.name} {each.side}"
            cells.append([name, *numbers, f"{off['speed']:.3f}"])
    header = ["manoeuvre", "over [s]", "heading, rms [deg]", "track, rms [L]", "U/U0, rms"]
    return [Grid(f"Apart from the histories of {SOURCE}", header, cells)] if cells else []


def _sides(rows: Sequence[Row]) -> list[Any]:
    """Port minus starboard of every measure that both sides have, computed and measured."""
    port = {(r["manoeuvre"], r["measure"]): r for r in rows if r["side"] == "port" and _calm(r)}
    cells = []
    for row in rows:
        other = port.get((row["manoeuvre"], row["measure"]))
        if row["side"] != "starboard" or not _calm(row) or other is None:
            continue
        if row["value"] is None or other["value"] is None or _signed(row):
            continue
        measured = _difference(row["trial"], other["trial"])
        computed = _difference(row["value"], other["value"])
        numbers = [f"{row['value']:.4g}", f"{other['value']:.4g}", computed, measured]
        cells.append([row["manoeuvre"], row["label"], row["unit"], *numbers])
    header = ["manoeuvre", "measure", "unit", "starboard", "port"]
    header += ["port - starboard", "the same, measured"]
    return [Folded("Port beside starboard", [Grid("Calm water", header, cells, 3)])]


def _signed(row: Row) -> bool:
    """Whether the sign of a measure is that of the side."""
    return row["measure"] in ("steady_drift", "steady_yaw_rate", "drift_direction")


def _difference(starboard: float | None, port: float | None) -> str:
    """Of the mean of both [%]; nothing where one is missing."""
    if starboard is None or port is None or starboard + port == 0.0:
        return ""
    return f"{200.0 * (port - starboard) / (port + starboard):+.1f} %"


def _calm(row: Row) -> bool:
    return row["sea"] == CALM and row["measure"] != ""


def _forces(cases: Sequence[Sailed]) -> list[Any]:
    """Balance of forces in the steady turns to either side."""
    found = {
        each.side: steady_balance(each.ship, each.case.result.trajectory)
        for each in cases
        if each.manoeuvre.kind == "turning" and each.sea == CALM and each.case is not None
    }
    if len(found) < 2:
        return []
    L = cases[0].ship.hull.L
    cells = []
    for part in found["starboard"]:
        row = [part]
        for k, unit in enumerate((1e3, 1e3, 1e3 * L)):
            row += [f"{balance[part][k] / unit:,.1f}" for balance in found.values()]
        cells.append(row)
    header = ["", *(f"{axis} {side}" for axis in ("X", "Y", "N/L") for side in found)]
    return [Folded("Forces in the steady turns", [Grid("[kN], midship", header, cells)])]


def _all(rows: Sequence[Row]) -> Grid:
    cells = [
        [
            f"{row['manoeuvre']} {row['side']}".strip(),
            row["sea"],
            row["label"],
            row["unit"],
            "none" if row["value"] is None else f"{row['value']:.4g}",
            "" if row["calm"] is None else f"{row['calm']:.4g}",
        ]
        for row in rows
        if row["measure"]
    ]
    header = ["manoeuvre", "sea", "measure", "unit", "computed", "in calm water"]
    return Grid("Every measure", header, cells, 4)


def _made(about: Mapping[str, Any]) -> Text:
    parts = [f"{key}: {value}" for key, value in about.items()]
    return Text("; ".join(parts))
