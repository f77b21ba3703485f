"""The card of a recording: what was run, how it went, its moments, and how to run it again."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from ship_gym.recording.library import stored_metrics
from ship_gym.recording.marks import bearing, marks, seconds, time_unit
from ship_gym.recording.surroundings import Surroundings, section, surroundings
from ship_gym.recording.turns import is_manoeuvre
from ship_gym.text import table

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

_HASH, _COMMIT = 12, 10  # digits that are shown
_SHIPPED = "pretrained"  # folder of the policies that come with the package
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
    meta, around = trajectory.meta, surroundings(trajectory)
    rows = {
        "Ship": _ship(meta),
        "Waves": _waves(around),
        "Wind": _wind(around),
        "Current": _current(around),
        "Task": _task(meta),
        "Changed": ", ".join(_flat(section(meta, "overrides"))),
        "Controller": _controller(meta),
        "Seed": "" if meta.get("seed") is None or is_manoeuvre(trajectory) else str(meta["seed"]),
        "Recorded": _recorded(trajectory),
    }
    yield from ([name, text] for name, text in rows.items() if text)


def metric_rows(meta: Mapping) -> Iterator[list[str]]:
    """Rows of name, value and unit of the metrics in a meta; angles in degrees."""
    units = section(meta, "units")
    for name, value in stored_metrics(meta).items():
        value, unit = in_degrees(value, str(units.get(name, "")))
        yield [name, number(value), unit]


def in_degrees(value: float | None, unit: str) -> tuple[float | None, str]:
    """A value and its unit; degrees for radians."""
    if unit != "rad":
        return value, unit
    return None if value is None else math.degrees(value), "deg"


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


def _waves(around: Surroundings) -> str:
    if not around.wave_height:
        return "" if around.wave_height is None else "none"
    text = f"{'regular, ' if around.regular else ''}H {around.wave_height:.3g} m"
    text += "" if around.wave_period is None else f", T {around.wave_period:.3g} s"
    return f"{text}, from {bearing(around.wave_direction_to + math.pi)}"


def _wind(around: Surroundings) -> str:
    if not around.wind_speed:
        return "" if around.wind_speed is None else "none"
    return f"{around.wind_speed:.3g} m/s from {bearing(around.wind_direction_from)}"


def _current(around: Surroundings) -> str:
    if not around.current_speed:
        return "" if around.current_speed is None else "none"
    return f"{around.current_speed:.3g} m/s to {bearing(around.current_direction_to)}"


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
    """Name, and of a policy its file, whole only where that is short, with the hash."""
    policy, name = section(meta, "policy"), str(meta.get("controller") or "")
    if not policy.get("file"):
        return name
    digits = str(policy.get("sha256") or "")[:_HASH]
    path = PurePath(policy["file"])
    file = ".../" + "/".join(path.parts[-2:]) if path.is_absolute() else str(path)
    text = file + (f", sha256 {digits}" if digits else "")
    return f"{name}: {text}" if name else text


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
    config, steered = section(meta, "config"), _steered(meta)
    if any(part in (None, "") for part in (meta.get("scenario"), steered, meta.get("seed"))):
        return ""
    if not {"task", "ship", "control"} <= config.keys():
        return ""
    overrides = section(meta, "overrides")
    changed = [*_flat({k: v for k, v in overrides.items() if k not in ("ship", "control")})]
    if meta.get("task_file") == "":
        return ""
    words = ["ship-gym", "record", "--controller", steered]
    words += ["--task", str(meta["task_file"])] if "task_file" in meta else []
    if "task_file" not in meta or meta["scenario"] != meta.get("task"):
        words += ["--scenario", str(meta["scenario"])]
    words += ["--ship", str(config["ship"]), "--control", str(config["control"])]
    words += ["--seed", str(meta["seed"]), *(["--set", *changed] if changed else [])]
    return shlex.join(words)


def _steered(meta: Mapping) -> str:
    """How ``--controller`` calls who steered: by name if it comes with the package, else by file.

    "" for a program of one's own, whose class is not known.
    """
    file, name = section(meta, "policy").get("file"), str(meta.get("controller") or "")
    if not file or PurePath(file).parent.name == _SHIPPED:
        return name
    return "" if PurePath(file).suffix == ".py" else str(file)


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
