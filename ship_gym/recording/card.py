"""The card of a recording: what was run, how it went, its moments, and how to run it again."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from ship_gym.recording.marks import bearing, marks, seconds, time_unit
from ship_gym.recording.task_error import section
from ship_gym.recording.turns import is_manoeuvre
from ship_gym.text import table

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

_HASH, _COMMIT = 12, 10  # digits that are shown
# Orders of a manoeuvre: key of its config, name, size and unit for people
_ORDERS = (
    ("delta", "rudder", math.degrees(1.0), "deg"),
    ("psi", "heading", math.degrees(1.0), "deg"),
    ("speed", "approach", 1.0, "m/s"),
    ("n", "propeller", 1.0, "rev/s"),
)


def card_text(trajectory: Trajectory) -> str:
    """Markdown card of a run, short enough to stand beside the plots.

    Parameters
    ----------
    trajectory : Trajectory
        The run to describe; what its meta lacks is left out.

    Returns
    -------
    str
        Markdown.
    """
    meta = trajectory.meta
    parts = [
        f"# {title(meta)}",
        _ending(trajectory),
        _facts([*facts(trajectory)]),
        _markdown(["Metric", "Value", "Unit"], [*metric_rows(meta)]),
        _markdown(["Time", "Moment"], [*_moments(trajectory)]),
        _again(meta),
        _origin(meta),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def run_name(meta: Mapping) -> str:
    """Short name of a run from what its meta has of scenario, ship, controller and seed."""
    seed = (
        None
        if meta.get("seed") is None or "manoeuvre" in section(meta, "config")
        else (f"seed {meta['seed']}")
    )
    parts = [scenario_name(meta), _ship_name(meta), meta.get("controller") or None, seed]
    return ", ".join(str(part) for part in parts if part is not None) or "Ship Gym run"


def scenario_name(meta: Mapping) -> str | None:
    """The scenario as it was asked for, of an own file its stem; else the task."""
    found = meta.get("scenario") or meta.get("task")
    return None if found is None else PurePath(str(found)).name.removesuffix(".toml")


def title(meta: Mapping) -> str:
    """Scenario and ship."""
    parts = [scenario_name(meta), _ship_name(meta)]
    return ", ".join(str(part) for part in parts if part) or "Ship Gym run"


def facts(trajectory: Trajectory) -> Iterator[list[str]]:
    """Rows of name and text: ship, sea, task, controller, seed, time."""
    meta = trajectory.meta
    rows = {
        "Ship": _ship(meta),
        "Waves": _waves(meta),
        "Wind": _wind(trajectory),
        "Current": _current(trajectory),
        "Task": _task(meta),
        "Changed": ", ".join(_flat(section(meta, "overrides"))),
        "Controller": _controller(meta),
        "Seed": "" if meta.get("seed") is None or is_manoeuvre(trajectory) else str(meta["seed"]),
        "Recorded": _recorded(trajectory),
    }
    yield from ([name, text] for name, text in rows.items() if text)


def metric_rows(meta: Mapping) -> Iterator[list[str]]:
    """Rows of name, value and unit of the metrics in a meta."""
    units = section(meta, "units")
    for name, value in section(meta, "metrics").items():
        yield [str(name), number(value), str(units.get(name, ""))]


def number(value: Any) -> str:
    """A value of a metric; a dash where an episode has none."""
    return "-" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


def _ending(trajectory: Trajectory) -> str:
    """How and when the run ended, as one sentence."""
    meta, time = trajectory.meta, seconds(float(trajectory["t"][-1]))
    if not meta.get("complete", True):
        return f"**Incomplete**: the recording breaks off after {time}."
    outcome = meta.get("outcome")
    if outcome is None:
        return ""
    return f"**{'Failed: ' if meta.get('failed') else ''}{outcome}** after {time}."


def _ship_name(meta: Mapping) -> str | None:
    ship = meta.get("ship")
    return ship.get("name") if isinstance(ship, Mapping) else ship


def _ship(meta: Mapping) -> str:
    ship = section(meta, "ship")
    text = str(ship.get("title") or _ship_name(meta) or "")
    for name in ("surrogate", "variant"):
        text += f", {name} {ship[name]}" if ship.get(name) else ""
    return text


def _recorded(trajectory: Trajectory) -> str:
    """How long and how many rows; of a model also the time at full scale."""
    time, unit = float(trajectory["t"][-1] - trajectory["t"][0]), time_unit(trajectory.meta)
    full = "" if unit == 1.0 else f" of the model, {seconds(unit * time)} at full scale"
    return f"{seconds(time)}{full}, {len(trajectory)} rows"


def _waves(meta: Mapping) -> str:
    sea, made = section(meta, "sea"), section(meta, "config", "sea")
    if "wave_height" not in sea and (made.get("regular") or made.get("waves")):
        come = bearing(made.get("wave_direction_to", 0.0) + math.pi)
        return f"{_systems(made)}, from {come}"
    if not sea.get("wave_height"):
        return "none" if sea else ""
    text = f"H {sea['wave_height']:.3g} m, T {sea.get('wave_period', 0.0):.3g} s"
    come = _from(sea, "wave")
    return text if come is None else f"{text}, from {come}"


def _systems(sea: Mapping[str, Any]) -> str:
    """Height and period of the waves of a manoeuvre: a regular one, or systems of an irregular sea.

    Energies of systems add up; the period is that of the highest.
    """
    if regular := sea.get("regular"):
        height, period = 2.0 * regular["amplitude"], 2.0 * math.pi / regular["omega"]
        return f"regular, H {height:.3g} m, T {period:.3g} s"
    height = math.hypot(*(system["height"] for system in sea["waves"]))
    highest = max(sea["waves"], key=lambda system: system["height"])
    return f"H {height:.3g} m, T {highest['peak_period']:.3g} s"


def _wind(trajectory: Trajectory) -> str:
    sea = section(trajectory.meta, "sea")
    speed, come = sea.get("wind_speed"), _from(sea, "wind")
    if speed is None and "wind_speed" in trajectory:
        speed, come = trajectory["wind_speed"][0], bearing(trajectory["wind_direction_from"][0])
    return "" if speed is None else "none" if not speed else f"{speed:.3g} m/s from {come}"


def _current(trajectory: Trajectory) -> str:
    if "current_speed" not in trajectory:
        return ""
    speed, to = trajectory["current_speed"][0], trajectory["current_direction_to"][0]
    return f"{speed:.3g} m/s to {bearing(to)}" if speed else "none"


def _from(sea: Mapping[str, Any], what: str) -> str | None:
    """Where waves or wind come from."""
    if f"{what}_from_deg" in sea:
        return bearing(math.radians(sea[f"{what}_from_deg"]))
    to = sea.get(f"{what}_direction_to")
    return None if to is None else bearing(to + math.pi)


def _task(meta: Mapping) -> str:
    task, scenario, config = meta.get("task"), meta.get("scenario"), section(meta, "config")
    if "manoeuvre" in config:
        orders = [f"{what} {config[k] * size:.3g} {unit}" for k, what, size, unit in _ORDERS
                  if isinstance(config.get(k), float)]  # fmt: skip
        return ", ".join([str(task), *orders])
    if not task or scenario in (None, task):
        return str(task or "")
    return f"{task}, scenario {scenario}"


def _controller(meta: Mapping) -> str:
    policy, name = section(meta, "policy"), str(meta.get("controller") or "")
    if not policy.get("file"):
        return name
    digits = str(policy.get("sha256") or "")[:_HASH]
    file = f"{policy['file']}" + (f", sha256 {digits}" if digits else "")
    return file if name in ("", policy["file"]) else f"{name}: {file}"


def _flat(values: Mapping[str, Any], before: str = "") -> Iterator[str]:
    """Overrides as KEY=VALUE, the values as TOML has them."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}={json.dumps(value)}"


def _moments(trajectory: Trajectory) -> Iterator[list[str]]:
    for mark in marks(trajectory):
        yield [seconds(mark.time), f"**{mark.text}**" if mark.kind == "error" else mark.text]


def _again(meta: Mapping) -> str:
    """The command that sails and records an episode again; "" where the meta cannot tell."""
    command = again(meta)
    return f"To record it again:\n\n```\n{command}\n```" if command else ""


def again(meta: Mapping) -> str:
    """The command that records an episode again, "" where the meta does not have all it needs."""
    if isinstance(meta.get("command"), str):
        return meta["command"]
    config = section(meta, "config")
    steered = section(meta, "policy").get("file") or meta.get("controller")
    needed = (meta.get("scenario"), steered, meta.get("seed"), config.get("task"))
    if any(part in (None, "") for part in needed):
        return ""
    overrides = section(meta, "overrides")
    changed = [*_flat({k: v for k, v in overrides.items() if k not in ("ship", "control")})]
    words = ["ship-gym", "record", "--controller", str(steered), "--scenario", meta["scenario"]]
    words += ["--ship", str(config["ship"]), "--control", str(config["control"])]
    words += ["--seed", str(meta["seed"]), *(["--set", *changed] if changed else [])]
    return shlex.join(words)


def _origin(meta: Mapping) -> str:
    """Versions and commit, and where everything else is."""
    versions = section(meta, "versions")
    made = [
        f"{name} {versions[name]}" for name in ("ship-gym", "numpy", "numba") if name in versions
    ]
    if meta.get("git_commit"):
        made.append(f"commit {_short(str(meta['git_commit']))}")
    more = "The whole configuration is in the recording's meta."
    return f"*{', '.join(made)}. {more}*" if made else f"*{more}*"


def _short(commit: str) -> str:
    """The first digits of a commit, and whether it was edited; other texts as they are."""
    digits, dash, edited = commit.partition("-")
    return f"{digits[:_COMMIT]}{dash}{edited}" if len(digits) == 40 else commit


def _facts(rows: list[list[str]]) -> str:
    """The facts as a table, the first of them as its head, as Markdown has none without."""
    return table(rows[0], rows[1:], markdown=True) if len(rows) > 1 else ""


def _markdown(header: list[str], rows: list[list[str]]) -> str:
    return table(header, rows, markdown=True) if rows else ""
