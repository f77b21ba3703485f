"""Learning curves: the validations of a run as a table, and those of several as a picture."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ship_gym.plain_csv import read_plain_csv
from ship_gym.writing import atomic_path
from ship_gym_agents.sb3.run_card import CARD_FILE, read_run_card

CURVE_FILE, CURVE_PICTURE = "curve.csv", "curve.png"


def write_curve(validations: Sequence[Mapping[str, Any]], path: str | Path) -> None:
    """Write one row for each validation: samples and seconds first; empty where there is none."""
    names = list(dict.fromkeys(name for found in validations for name in found))
    names = ["samples", "seconds", *(n for n in names if n not in ("samples", "seconds"))]
    with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names, lineterminator="\n")
        table.writeheader()
        table.writerows(validations)


def read_curve(path: str | Path) -> dict[str, list[float | None]]:
    """Columns of a curve by name; a wrong cell is refused with its line."""
    table = read_plain_csv(path, least=0)
    return {name: table.maybe_numbers(name) for name in table.columns if table.lines}


def is_stale(folder: str | Path) -> bool:
    """Whether the picture of a run is older than its curve, or missing."""
    curve, picture = (Path(folder) / name for name in (CURVE_FILE, CURVE_PICTURE))
    if not curve.is_file():
        return False
    return not picture.is_file() or picture.stat().st_mtime_ns < curve.stat().st_mtime_ns


def draw_curves(out: str | Path, folders: Sequence[str | Path] | None = None) -> Path | None:
    """Draw what the validations of a run show, or those of several seeds in one picture.

    Parameters
    ----------
    out : path
        Folder that the picture goes into.
    folders : sequence of path, optional
        Folders of the seeds; `out` itself if omitted.

    Returns
    -------
    Path or None
        The picture; None without matplotlib or without any validation.
    """
    runs = [Path(folder) for folder in ([out] if folders is None else folders)]
    runs = [run for run in runs if (run / CURVE_FILE).is_file()]
    if not runs or find_spec("matplotlib") is None:
        return None
    from ship_gym.plotting.learning_curve import plot_learning_curves  # late: it takes a second

    card = read_run_card(runs[0] / CARD_FILE)
    scenario = card["config"]["scenario"]
    measure = card["measure"]
    first, last = card["validation_seeds"]
    references = card.get("final", {}).get("references", {})
    path = Path(out) / CURVE_PICTURE
    plot_learning_curves(
        [read_curve(run / CURVE_FILE) for run in runs],
        measure["name"],
        measure["unit"],
        path,
        f"{card['config']['algorithm']}, {scenario['task']}, {scenario['ship']}",
        f"mean of {last - first + 1} validation seas, the same for all",
        {name: each["validation"] for name, each in references.items() if each.get("validation")},
    )
    return path
