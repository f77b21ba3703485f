"""The error that a task is judged by, and where in a run it is worst."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ship_gym.recording.panels import heading_error
from ship_gym.recording.surroundings import section

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

DEGREE = "\N{DEGREE SIGN}"
_ANGLES = {"rad": "deg", "rad/s": "deg/s"}  # as people read them
# Columns of a distance across a track, positive to starboard, as people name them
_ACROSS = {"off_route": "distance to the route", "cross_track_error": "cross track error"}
_COME = 0.1  # share of its first value at which an error has come down, or by which it has grown
_MOST_STEPS = 60  # more changes of an order are no steps, but an order that moves all the time


@dataclass(frozen=True, eq=False)
class TaskError:
    """The error that a task is judged by.

    Attributes
    ----------
    label, unit : str
        For people.
    values : numpy.ndarray
        In that unit, shape (T,).
    stepped : bool
        Whether a new order makes a new error, as it does with a heading.
    sided : bool
        Whether it is a distance to starboard (positive) or to port.
    """

    label: str
    unit: str
    values: np.ndarray
    stepped: bool
    sided: bool = False

    def text(self, row: int) -> str:
        """The error in a row, with its sign and unit."""
        value = self.values[row]
        if self.unit == "deg":
            return f"{value:+.1f}{DEGREE}"
        if self.sided:
            size = f"{abs(value):.0f}" if abs(value) >= 100.0 else f"{abs(value):.3g}"
            return f"{size} {self.unit} to {'port' if value < 0.0 else 'starboard'}"
        return f"{value:+.0f} {self.unit}" if abs(value) >= 100.0 else f"{value:+.3g} {self.unit}"


def task_error(trajectory: Trajectory) -> TaskError | None:
    """The error of a task: what the meta's ``error`` names, else off a route, else of heading."""
    columns, named = trajectory.columns, section(trajectory.meta, "error")
    if named.get("column") in trajectory:
        values, unit = trajectory[named["column"]], str(named.get("unit", ""))
        label = str(named.get("label", named["column"]))
        if unit in _ANGLES:
            values, unit = np.degrees(values), _ANGLES[unit]
        return TaskError(label, unit, values, unit == "deg", named["column"] in _ACROSS)
    for name, label in _ACROSS.items():
        if name in trajectory:
            return TaskError(label, "m", trajectory[name], False, True)
    error = heading_error(columns)
    if error is None:
        return None
    return TaskError("heading error", "deg", np.degrees(error), True)


def worst_row(trajectory: Trajectory, error: TaskError) -> int:
    """Row of the largest error that was made and not given.

    A start or a new order gives an error, which no steering can avoid. What is left of it is not
    counted; an error counts where it grows by a tenth beyond the given one, or grows again after
    that has come down to a tenth or crossed zero.
    """
    size, made = np.abs(error.values), np.ones(len(trajectory), dtype=bool)
    begins = steps(trajectory, "psi_ordered") if error.stepped else []
    for begin, end in itertools.pairwise([0, *begins, len(size)]):
        given = begin + _rows_given(error.values[begin:end])
        made[begin:given] = size[begin:given] > (1.0 + _COME) * size[begin]
    return int(np.argmax(np.where(made, size, -1.0) if made.any() else size))


def _rows_given(error: np.ndarray) -> int:
    """Rows until an error that was given has come down and grows again."""
    down = error * np.sign(error[0]) <= _COME * abs(error[0])
    first = int(np.argmax(down)) if down.any() else len(error)
    grows = np.diff(np.abs(error[first:])) > 0.0
    return first + int(np.argmax(grows)) if grows.any() else len(error)


def steps(trajectory: Trajectory, name: str) -> list[int]:
    """Rows from which a column has another value; none if it moves all the time."""
    if name not in trajectory:
        return []
    rows = (np.flatnonzero(np.diff(trajectory[name])) + 1).tolist()
    return rows if len(rows) <= _MOST_STEPS else []
