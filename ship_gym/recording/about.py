"""The page of a recording that says what was run, with what, and how to run it again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory


def run_name(meta: Mapping) -> str:
    """Short name of a run from what its meta has of task, ship, controller and seed."""
    ship = meta.get("ship")
    ship = ship.get("name") if isinstance(ship, Mapping) else ship
    seed = None if meta.get("seed") is None else f"seed {meta['seed']}"
    parts = [meta.get("task"), ship, meta.get("controller"), seed]
    return ", ".join(str(part) for part in parts if part is not None) or "Ship Gym run"


def about_text(trajectory: Trajectory) -> str:
    """Markdown page: name, duration, a table of the short entries, then the rest as JSON.

    Parameters
    ----------
    trajectory : Trajectory
        The run to describe.

    Returns
    -------
    str
        Markdown.
    """
    meta, t = trajectory.meta, trajectory["t"]
    short = {key: value for key, value in meta.items() if not isinstance(value, dict | list)}
    rest = {key: value for key, value in meta.items() if key not in short}
    lines = [f"# {run_name(meta)}", "", "| | |", "|---|---|"]
    lines.append(f"| time | {t[0]:g} to {t[-1]:g} s, {len(t)} rows |")
    lines += [f"| {key} | {value} |" for key, value in short.items()]
    for key, value in rest.items():
        lines += ["", f"**{key}**", "", "```json", json.dumps(value, indent=1), "```"]
    return "\n".join(lines) + "\n"
