"""All measured manoeuvres in one table: ours, the facilities' scatter, and ours at another time."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.csv_file import read_csv
from ship_gym.provenance import git_commit
from ship_gym.reading import read_toml
from ship_gym.reports.case import Case
from ship_gym.reports.measures import (
    DIRECTIONS,
    Row,
    deviations_text,
    difference_text,
    rows,
)
from ship_gym.ships.files import available_ships, base_of, file_of
from ship_gym.ships.particulars import Ship
from ship_gym.ships.trials import Trial
from ship_gym.text import paragraph, percent, table
from ship_gym.writing import atomic_path

SOURCE = "ship_gym, ship-gym trials; measured values: the ship files, with their sources"
_CSV_COLUMNS = ("ship", "trial", "measure", "computed [unit]", "measured [unit]", "unit")
_NOTE = "<!-- Written by `ship-gym trials`; run it again instead of editing. -->"


@dataclasses.dataclass(frozen=True)
class Comparison:
    """One measure of one trial; ``before`` is what was computed at another time, as a row."""

    ship: str
    trial: str
    row: Row
    before: Row | None = None

    @property
    def key(self) -> tuple[str, str, str]:
        """What finds it again in a file."""
        return self.ship, self.trial, self.row.name

    @property
    def closer(self) -> bool | None:
        """Whether it is nearer to the measured value than before; None if as near, or unknown."""
        if self.before is None:
            return None
        a, b = self.row.difference, self.before.difference
        if a is None or b is None:
            return None
        now, then = abs(a), abs(b)
        return None if math.isclose(now, then, rel_tol=1e-3, abs_tol=0.05) else now < then


def tested_ships() -> list[str]:
    """Ships of the package with trials of their own; a scaled ship only has those of its model."""
    own = [name for name in available_ships() if not base_of(read_toml(file_of(name)), Path())]
    return [name for name in own if "trial" in read_toml(file_of(name))]


def trial_name(ship: Ship, trial: Trial) -> str:
    """Who measured what, in words that do not change with the model."""
    side = "starboard" if trial.delta_deg > 0.0 else "port"
    delta, psi = abs(trial.delta_deg), abs(trial.psi_deg)
    what = f"{delta:g} deg to {side}"
    if trial.manoeuvre == "zigzag":
        what = f"{delta:g}/{psi:g} zig-zag, {side} first"
    parts = [what, f"Fn {ship.froude(trial.speed):.3f}"]
    parts += [f"{trial.n:.1f} rev/s"] if trial.n is not None else []
    if trial.waves:
        wave = f"waves {trial.wave_height:.3g} m high, {trial.wavelength:g} L long"
        parts.append(f"{wave}, from {trial.wave_from_deg:g} deg")
    return f"{trial.facility or 'trial'}: {', '.join(parts)}"


def comparisons(
    case: Case, before: dict[tuple[str, str, str], float] | None = None
) -> list[Comparison]:
    """What was measured in a trial beside what was computed, and computed before."""
    assert case.trial is not None
    name, found = trial_name(case.ship, case.trial), []
    for row in rows(case):
        if row.measured is not None:
            then = (before or {}).get((case.ship.name, name, row.name))
            old = None if then is None else dataclasses.replace(row, computed=then)
            found.append(Comparison(case.ship.name, name, row, old))
    return found


def read_values(path: str | Path) -> tuple[dict[tuple[str, str, str], float], str]:
    """Computed values of a file of `write_values` by ship, trial and measure, and its title."""
    found = read_csv(path).require("ship", "trial", "measure", "computed")
    columns = [found.columns[name] for name in ("ship", "trial", "measure", "computed")]
    values = {(str(a), str(b), str(c)): float(x) for a, b, c, x in zip(*columns, strict=True)}
    return values, found.header["title"]


def write_values(found: Sequence[Comparison], path: str | Path, title: str = "") -> None:
    """Write computed and measured values as csv, to be read as another time's."""
    lines = [
        f"# title: {title or f'trials computed at commit {git_commit()}'}",
        f"# source: {SOURCE}",
        f"# obtained: computed at commit {git_commit()}",
        "# conventions: units of display, in the last column; directions in deg from the approach "
        "course, to starboard",
        ";".join(_CSV_COLUMNS),
    ]
    for each in found:
        row = each.row
        numbers = f"{row.computed:.9g};{row.measured:.6g}"
        lines.append(f"{each.ship};{each.trial};{row.name};{numbers};{row.unit}")
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def summary(found: Iterable[Comparison]) -> dict[str, Any]:
    """Counts over all comparisons: how near, within how much of the scatter, nearer than before.

    Returns
    -------
    dict
        ``values``; ``mean_difference_percent``, of the absolute differences but of directions;
        ``with_deviation``, ``within_1_deviation``, ``within_2_deviations``; and, where there is a
        time before, ``mean_before_percent`` of the same values, ``closer`` and ``further``.
    """
    found = list(found)
    shares = [c for c in found if c.row.name not in DIRECTIONS]
    scattered = [abs(c.row.deviations) for c in found if c.row.deviations is not None]
    counts: dict[str, Any] = {
        "values": len(found),
        "mean_difference_percent": _mean_size(c.row for c in shares),
        "with_deviation": len(scattered),
        "within_1_deviation": sum(x <= 1.0 for x in scattered),
        "within_2_deviations": sum(x <= 2.0 for x in scattered),
    }
    old = [c for c in shares if c.before is not None]
    if old:
        counts["compared_with_before"] = len(old)
        counts["mean_before_percent"] = _mean_size(c.before for c in old)
        counts["mean_now_percent"] = _mean_size(c.row for c in old)
        counts["closer"] = sum(c.closer is True for c in found)
        counts["further"] = sum(c.closer is False for c in found)
    return counts


def _mean_size(rows: Iterable[Row | None]) -> float:
    """Mean size of the differences from what was measured."""
    found = [row.difference for row in rows if row is not None]
    return float(np.mean([abs(each) for each in found if each is not None]))


def as_dict(found: Sequence[Comparison]) -> dict[str, Any]:
    """The table as plain numbers, for ``--json``."""
    return {"trials": [_plain(each) for each in found], "summary": summary(found)}


def _plain(each: Comparison) -> dict[str, Any]:
    row = each.row
    unit = "difference_deg" if row.name in DIRECTIONS else "difference_percent"
    return {
        "ship": each.ship,
        "trial": each.trial,
        "measure": row.name,
        "unit": row.unit,
        "measured": row.measured,
        "deviation": row.deviation,
        "before": None if each.before is None else each.before.computed,
        "computed": row.computed,
        unit: row.difference,
        "difference_in_deviations": row.deviations,
        "others": row.others,
    }


def as_text(found: Sequence[Comparison], *, markdown: bool = False, before: str = "") -> str:
    """The table, a part for each ship, and its counts.

    Parameters
    ----------
    found : sequence of Comparison
    markdown : bool
        For a page.
    before : str
        What the column of another time is, in words.
    """
    old = any(each.before is not None for each in found)
    header = ["trial", "measure", "unit", "measured", *(["before"] if old else []), "here"]
    header += [*(["difference before"] if old else []), "difference", "in SD"]
    parts = []
    for ship in dict.fromkeys(each.ship for each in found):
        cells = _cells([each for each in found if each.ship == ship], old)
        head = f"## {ship}\n\n" if markdown else f"{ship}\n"
        parts.append(head + table(header, cells, 3, markdown=markdown))
    told = summary_text(found, before)
    return "\n\n".join([*parts, told if markdown else paragraph(told)])


def _cells(found: Sequence[Comparison], old: bool) -> list[list[str]]:
    """Rows of one ship; the name of a trial stands at its first measure."""
    cells, last = [], ""
    for each in found:
        row, then = each.row, each.before
        bar = f" ± {row.shown(row.deviation)}" if row.deviation else ""
        line = ["" if each.trial == last else each.trial, row.label.strip(), row.unit]
        line.append(row.shown(row.measured) + bar)
        line += [row.shown(then.computed) if then else ""] if old else []
        line.append(row.shown(row.computed))
        line += [difference_text(then) if then else ""] if old else []
        cells.append([*line, difference_text(row), deviations_text(row)])
        last = each.trial
    return cells


def summary_text(found: Sequence[Comparison], before: str = "") -> str:
    """The counts in words."""
    counts = summary(found)
    text = (
        f"{counts['values']} values: mean absolute difference "
        f"{counts['mean_difference_percent']:.1f} %, without directions. Of "
        f"{counts['with_deviation']} with scatter of the facilities "
        f"{counts['within_1_deviation']} are within one standard deviation (SD), "
        f"{counts['within_2_deviations']} within two."
    )
    if "closer" in counts:
        was, now = (percent(counts[f"mean_{k}_percent"]).lstrip("+") for k in ("before", "now"))
        text += (
            f" Before{f' ({before})' if before else ''}: mean {was}, now {now}; "
            f"{counts['closer']} values are closer, {counts['further']} further off."
        )
    return text


def page(found: Sequence[Comparison], sources: dict[str, str], before: str, picture: str) -> str:
    """The table as a page in Markdown.

    Parameters
    ----------
    found : sequence of Comparison
    sources : dict
        Ship and trial to where its numbers are printed.
    before : str
        What the column of another time is.
    picture : str
        File of `plotting.trials.plot_trials` beside the page; empty: none.
    """
    lines = [_NOTE, "# Every trial beside the model", _INTRODUCTION]
    lines += [f"![all trials]({picture})"] if picture else []
    lines += [as_text(found, markdown=True, before=before), "## Sources"]
    said: dict[str, list[str]] = {}
    for name, text in sources.items():
        said.setdefault(text, []).append(name)
    lines.append("\n".join(f"- {'; '.join(names)}: {text}" for text, names in said.items()))
    return "\n\n".join(lines) + "\n"


_INTRODUCTION = """\
Every measured manoeuvre of the ship files, sailed as it was measured: rudder, approach speed,
propeller speed where it is printed (else self-propulsion), waves. Measured values carry the
standard deviation (SD) of the facilities where one is printed, and the last column counts the
difference in it. The force of the movable part of the rudder is that of the whole rudder by a
factor of the ship file, whose source stands there. Full-scale ships have the trials of their models
and are left out. MARIN's rudder force of KCS is printed by the area of the movable part; whether it
was measured on it is not said. Its coefficient (to port, by the approach speed) is 0.627, Hiroshima
University's 0.876."""
