"""Runs beside each other: whether they can be compared, and their lines; numpy only."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.recording.card import facts, scenario_name
from ship_gym.recording.marks import time_unit
from ship_gym.recording.panel import Panel, Series
from ship_gym.recording.surroundings import section, speed_through_water
from ship_gym.recording.task_error import task_error
from ship_gym.recording.turns import is_manoeuvre

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

# Of the runs in their order; apart with every kind of colour vision, on black and on white:
# Okabe and Ito (2008), "Color universal design", jfly.uni-koeln.de/color, two of them darkened.
COLOURS = (
    (0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167),
    (190, 140, 0), (86, 160, 213), (128, 128, 128), (140, 90, 60),
)  # fmt: skip
_COLUMNS = ("x", "y", "psi", "u", "v")
_TELLING = ("Waves", "Wind", "Current", "Task", "Changed")  # facts that may name a run
_FULL = 360.0  # [deg]


@dataclass(frozen=True, eq=False)
class Run:
    """One of the runs that are compared.

    Attributes
    ----------
    name : str
        In legends and tables.
    color : tuple of int
        Of its lines and its ship.
    trajectory : Trajectory
    t : numpy.ndarray
        Time since its first row [s], shape (T,).
    """

    name: str
    color: tuple[int, int, int]
    trajectory: Trajectory
    t: np.ndarray


@dataclass(frozen=True)
class Quantity:
    """What is drawn of each run: a title with the unit, and its values, shape (T,)."""

    name: str
    title: str
    values: Callable[[Trajectory], np.ndarray]
    turn: bool = False  # an angle in degrees, whose differences are the shorter way round


def runs_of(trajectories: Sequence[Trajectory], names: Sequence[str] | None = None) -> list[Run]:
    """Runs with names and colours, if they can be compared.

    Raises
    ------
    ConfigError
        Fewer than two or more than there are colours, different tasks or scales, a recording
        without the columns of a track, or as many names as there are not runs.
    """
    if not 2 <= len(trajectories) <= len(COLOURS):
        raise ConfigError(
            f"{len(trajectories)} recordings to compare: allowed are 2 to {len(COLOURS)}"
        )
    names = labels(trajectories) if names is None else list(names)
    if len(names) != len(trajectories):
        raise ConfigError(f"{len(names)} names for {len(trajectories)} recordings")
    _check_same("task", [one.meta.get("task") for one in trajectories], names)
    _check_same("scale of the ship", [time_unit(one.meta) ** 2 for one in trajectories], names)
    for name, one in zip(names, trajectories, strict=True):
        missing = [column for column in _COLUMNS if column not in one]
        if missing:
            raise ConfigError(
                f"{name}: a recording without {', '.join(missing)}: nothing to compare"
            )
    parts = zip(names, COLOURS, trajectories, strict=False)
    return [Run(name, color, one, one["t"] - one["t"][0]) for name, color, one in parts]


def _check_same(what: str, values: Sequence[Any], names: Sequence[str]) -> None:
    if any(value != values[0] for value in values):
        pairs = "; ".join(f"{name}: {value}" for name, value in zip(names, values, strict=True))
        raise ConfigError(f"recordings of different {what} are not compared ({pairs})")


def labels(trajectories: Sequence[Trajectory]) -> list[str]:
    """Names of runs: what differs of controller, seed, ship, scenario, else of the sea or changes.

    A number where all that is the same.
    """
    parts = [
        [one.meta.get("controller") or None for one in trajectories],
        [
            None if is_manoeuvre(one) or (seed := one.meta.get("seed")) is None else f"seed {seed}"
            for one in trajectories
        ],
        [section(one.meta, "ship").get("name") for one in trajectories],
        [scenario_name(one.meta) for one in trajectories],
    ]
    kept = [part for part in parts if len(set(part)) > 1] or parts[:1]
    found = [", ".join(filter(None, words)) for words in zip(*kept, strict=True)]
    if len(set(found)) == len(found):
        return [name or "run" for name in found]
    about = [dict(facts(one)) for one in trajectories]
    for key in about[0]:
        texts = [f"{key.lower()} {one.get(key, 'not known')}" for one in about]
        if key in _TELLING and len(set(texts)) == len(texts):
            return [", ".join(filter(None, both)) for both in zip(found, texts, strict=True)]
    return [f"{name or 'run'} ({k})" for k, name in enumerate(found, start=1)]


def _error(run: Trajectory) -> np.ndarray:
    found = task_error(run)
    assert found is not None
    return found.values


def quantities(runs: Sequence[Run]) -> list[Quantity]:
    """What all runs have of error or heading, rudder, speed and reward."""
    errors = [error for run in runs if (error := task_error(run.trajectory)) is not None]
    found = []
    if len(errors) == len(runs) and len({(error.label, error.unit) for error in errors}) == 1:
        label, unit, turn = errors[0].label, errors[0].unit, errors[0].stepped
        title = f"{label[0].upper()}{label[1:]} [{unit}]"
        title += ", + to starboard" if errors[0].sided else ""
        found.append(Quantity("error", title, _error, turn))
    else:
        title = "Heading without jumps [deg]"
        found.append(
            Quantity("heading", title, lambda run: np.degrees(np.unwrap(run["psi"])), True)
        )
    if _all_have(runs, "delta"):
        title = "Rudder [deg], + turns to starboard"
        found.append(Quantity("rudder", title, lambda run: np.degrees(run["delta"])))
    title = "Speed through the water [m/s]"
    found.append(Quantity("speed", title, lambda run: speed_through_water(run.columns)))
    if _all_have(runs, "reward"):
        title = "Reward so far, without what the end costs [-]"
        found.append(Quantity("reward", title, _reward_so_far))
    elif _all_have(runs, "r"):
        found.append(Quantity("yaw_rate", "Rate of turn [deg/s]", lambda run: np.degrees(run["r"])))
    return found


def _all_have(runs: Sequence[Run], name: str) -> bool:
    return all(name in run.trajectory for run in runs)


def _reward_so_far(run: Trajectory) -> np.ndarray:
    """Sum of the rewards before each row; the one payment for a failure would flatten the rest."""
    paid = run["reward"]
    if "reward_termination" in run:
        paid = paid - run["reward_termination"]
    return np.concatenate([[0.0], np.cumsum(paid[:-1])])


def difference(run: Run, first: Run, quantity: Quantity) -> tuple[np.ndarray, np.ndarray]:
    """Values of a run less those of the first, at the times of the first that both have.

    Returns
    -------
    t, values : numpy.ndarray
        [s] and in the unit of the quantity, shape (k,); between its rows a run is interpolated.
    """
    values = quantity.values(run.trajectory)
    if quantity.turn:
        values = np.unwrap(values, period=_FULL)
    t = common_times(run, first)
    found = np.interp(t, run.t, values) - quantity.values(first.trajectory)[: len(t)]
    if quantity.turn:
        found = (found + 0.5 * _FULL) % _FULL - 0.5 * _FULL
    return t, found


def distance(run: Run, first: Run) -> tuple[np.ndarray, np.ndarray]:
    """Distance between a run's ship and the first one's [m], as `difference`."""
    t = common_times(run, first)
    ways = [
        np.interp(t, run.t, run.trajectory[name]) - first.trajectory[name][: len(t)]
        for name in ("x", "y")
    ]
    return t, np.hypot(*ways)


def common_times(run: Run, first: Run) -> np.ndarray:
    """Times of the first run at which the other sails too [s]."""
    return first.t[first.t <= run.t[-1]]


def panels(runs: Sequence[Run]) -> tuple[list[Panel], list[Panel]]:
    """Plots of the runs and of their differences; the series of each are those of the runs.

    Each series has the length of its own run, or of what it has in common with the first.
    """
    first, rest = runs[0], runs[1:]
    found = [
        Panel(
            f"compare/{one.name}",
            one.title,
            [Series(run.name, one.values(run.trajectory), run.color) for run in runs],
        )
        for one in quantities(runs)
    ]
    less = [
        Panel(
            "compare/distance",
            f"Distance to the ship of {first.name} [m]",
            [Series(run.name, distance(run, first)[1], run.color) for run in rest],
        )
    ]
    for one in quantities(runs)[:3]:
        title, _, unit = one.title.partition(" [")
        series = [Series(run.name, difference(run, first, one)[1], run.color) for run in rest]
        less.append(
            Panel(f"compare/{one.name}_less", f"{title}, less that of {first.name} [{unit}", series)
        )
    return found, less
