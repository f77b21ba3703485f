"""Observations and actions by name: what a controller reads and writes, never a column number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, nearest
from ship_gym.tasks import observations_of

# control of a scenario -> what an action holds, each in [-1, 1]
ACTIONS: dict[str, tuple[str, ...]] = {"rudder": ("rudder",), "rudder+rpm": ("rudder", "rpm")}


class NoColumn(ConfigError, AttributeError):
    """A column that is not there."""


class Columns:
    """Names of the columns of an array.

    Parameters
    ----------
    names : sequence of str
        In the order of the columns.
    what : str
        Of what, for messages.
    """

    def __init__(self, names: Sequence[str], what: str):
        self.names, self._what = tuple(names), what
        self._index = {name: k for k, name in enumerate(self.names)}
        if len(self._index) < len(self.names):
            double = next(name for name in self.names if self.names.count(name) > 1)
            raise ConfigError(f"{what} has {double!r} twice; each column needs its own name")

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self._index

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __getitem__(self, name: str) -> int:
        """Column of a name; a ConfigError if there is none."""
        if name not in self._index:
            raise NoColumn(f"{self._what} has no {name!r};{nearest(name, self.names)}")
        return self._index[name]

    def require(self, names: Sequence[str], who: str) -> Columns:
        """Return self if all names are there, else a ConfigError that says who needs which."""
        missing = [name for name in names if name not in self._index]
        if missing:
            raise ConfigError(
                f"{who} needs {', '.join(missing)}: {self._what} does not have "
                f"{'it' if len(missing) == 1 else 'them'}; it has {', '.join(self.names)}"
            )
        return self

    def view(self, array: np.ndarray) -> View:
        """An array (count, n) of these columns, float64, read by name."""
        return View(self, np.asarray(array, dtype=np.float64))

    def refuse(self, shape: tuple[int, ...]) -> None:
        """Refuse an array that cannot have these columns."""
        if len(shape) != 2 or shape[1] != len(self.names):
            raise ConfigError(
                f"{self._what} has {len(self.names)} columns, an array of shape {shape} was given"
            )


class View:
    """Columns of one array as attributes: ``seen.yaw_rate``, shape (count,).

    Parameters
    ----------
    columns : Columns
    array : numpy.ndarray
        Shape (count, n).

    Raises
    ------
    ConfigError
        Another number of columns; a name that is not there.
    """

    __slots__ = ("_array", "_columns")

    def __init__(self, columns: Columns, array: np.ndarray):
        columns.refuse(array.shape)
        self._columns, self._array = columns, array

    def __len__(self) -> int:
        return len(self._array)

    def __getattr__(self, name: str) -> np.ndarray:
        if name.startswith("__"):
            raise AttributeError(name)
        return self._array[:, self._columns[name]]


def observation_columns(scenario: Any) -> Columns:
    """Columns of the observation of a scenario, by the environment's own list."""
    rows = observations_of(scenario.task, scenario.privileged)
    what = f"the observation of task {scenario.task!r}"
    return Columns([row.name for row in rows], what)


def action_columns(scenario: Any) -> Columns:
    """Columns of the action of a scenario."""
    return Columns(ACTIONS[scenario.control], f"the action of control {scenario.control!r}")
