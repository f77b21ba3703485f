"""The suite of manoeuvres in ``ship-gym benchmark``: table, page and what is printed."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

FILE, PAGE = "manoeuvres.parquet", "manoeuvres.html"


@dataclasses.dataclass(frozen=True)
class Shown:
    """What the verb prints of the manoeuvres, as data and as text."""

    data: dict[str, Any]
    text: str


@dataclasses.dataclass(frozen=True)
class Hulls:
    """Suites of manoeuvres, and the folder of measured histories, None without."""

    suites: tuple[Any, ...]
    trials: Path | None


def split(suites: Sequence[str], trials: Path | None) -> tuple[list[str], Hulls]:
    """Suites of episodes, by name or file, and those of manoeuvres.

    Parameters
    ----------
    suites : sequence of str
        As in the verb.
    trials : Path or None
        Folder of measured histories that was asked for.

    Raises
    ------
    ConfigError
        An unknown suite, or a folder without histories.
    """
    from ship_gym.evaluation.suite import ALL, available_suites, load_suites
    from ship_gym.reports.histories import find_trials

    names = [name for one in suites for name in (available_suites() if one == ALL else [one])]
    loaded = dict(zip(dict.fromkeys(names), load_suites(list(suites)), strict=True))
    hulls = tuple(suite for suite in loaded.values() if suite.kind == "manoeuvres")
    episodes = [name for name, suite in loaded.items() if suite not in hulls]
    return episodes, Hulls(hulls, find_trials(trials))


def sail_suites(hulls: Hulls, *, out: Path, **options: Any) -> Shown:
    """Sail suites of manoeuvres; write their table and, with `report`, their page into `out`.

    Parameters
    ----------
    hulls : Hulls
    out : Path
        Folder.
    **options
        ``ships``, instead of those of the suites; ``report``; ``command``, kept with the results.

    Raises
    ------
    ConfigError
        Another process writes into the folder.
    """
    from ship_gym.evaluation.run_folder import RunFolder

    with RunFolder(out).locked():
        return _sail_suites(hulls, out, **options)


def _sail_suites(
    hulls: Hulls,
    out: Path,
    ships: Sequence[str] = (),
    report: bool = True,
    command: str = "",
    **_: Any,
) -> Shown:
    from ship_gym.evaluation.episodes_table import arrow
    from ship_gym.evaluation.manoeuvres.sailing import sail_manoeuvres
    from ship_gym.evaluation.manoeuvres.table import rows_of, write_manoeuvres
    from ship_gym.provenance import provenance
    from ship_gym.reports.speed import machine
    from ship_gym_agents.cli.output import progress

    arrow()  # refuses before the work
    suites = hulls.suites
    manoeuvres = list(dict.fromkeys(each for suite in suites for each in suite.manoeuvre))
    chosen = list(ships) or list(dict.fromkeys(ship for suite in suites for ship in suite.ships))
    sailed = sail_manoeuvres(manoeuvres, chosen, progress)
    rows = rows_of(sailed)
    about = {
        "version": ", ".join(dict.fromkeys(suite.version for suite in suites)),
        "suites": {suite.name: suite.sha256 for suite in suites},
        "ships": list(dict.fromkeys(each.ship.name for each in sailed)),
        "trials": None if hulls.trials is None else hulls.trials.name,
        "command": command,
        "machine": machine(),
        **provenance(),
    }
    files = [out / FILE]
    write_manoeuvres(files[0], rows, about)
    if report:
        from ship_gym.evaluation.manoeuvres.report import write_manoeuvres_report

        files.append(out / PAGE)
        bar = lambda found: progress(found, "pictures")  # noqa: E731
        write_manoeuvres_report(files[1], sailed, rows, about, hulls.trials, bar)
    return Shown({"rows": rows, "files": [str(file) for file in files]}, _text(rows, files))


def _text(rows: Sequence[dict[str, Any]], files: Sequence[Path]) -> str:
    """Limits of IMO as a table, what could not be sailed, and the files."""
    from ship_gym.text import table

    judged = [row for row in rows if row["limit"] is not None]
    cells = [
        [
            row["ship"],
            f"{row['manoeuvre']} {row['side']}".strip(),
            row["label"],
            row["unit"],
            f"{row['value']:.2f}",
            f"{row['limit']:.4g}",
            "pass" if row["passes"] else "above it",
        ]
        for row in judged
    ]
    header = ["ship", "manoeuvre", "measure", "unit", "computed", "IMO limit", ""]
    lines = [table(header, cells, left=4), ""]
    lines += [
        f"{row['ship']}: {row['manoeuvre']} {row['side']} {row['sea']} not sailed: {row['error']}"
        for row in rows
        if row["error"]
    ]
    return "\n".join([*lines, *(f"wrote {file}" for file in files)])
