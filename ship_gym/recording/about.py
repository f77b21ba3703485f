"""What a recording says of its ship, and its page of what was run, and how to run it again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ship_gym.config import ConfigError
from ship_gym.ships.powering import largest_power, powering

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory
    from ship_gym.ships.particulars import Ship


def ship_meta(ship: Ship) -> dict[str, Any]:
    """What a recording keeps of a ship: names, what its metrics and pictures need, in SI."""
    return {
        "name": ship.name,
        "title": ship.title,
        "surrogate": ship.surrogate_name,
        "variant": ship.variant,
        "scale": ship.scale,
        "speed": ship.speed,
        "L": ship.hull.L,
        "B": ship.hull.B,
        "d": ship.hull.d,
        "A_R": ship.rudder.A_R,
        "D_P": ship.propeller.D,
        "delta_max": ship.gear.delta_max,
        "n_max": ship.engine.n_max,
        "power_max": largest_power(ship),
        "m_u": ship.inertia.m_u,
        "efficiency": _efficiency(ship),
    }


def _efficiency(ship: Ship) -> float | None:
    """Quasi-propulsive efficiency at the nominal speed; None if the engine cannot hold that."""
    try:
        return powering(ship).efficiency
    except ConfigError:
        return None


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
