"""Table: values of several quantities over regular axes, the common form of every surrogate.

Regression, Gaussian process and network all become a table before the loop, so the kernels have
one code path: a linear lookup on a regular grid.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_number, nearest, shown, told_of
from ship_gym.reading import check_array, json_head, read_npz
from ship_gym.writing import atomic_path

_MOST_POINTS = 1_000_000  # of an axis


@dataclasses.dataclass(frozen=True)
class Axis:
    """Regular axis: `count` points from `start` with distance `step` (SI units)."""

    name: str
    start: float
    step: float
    count: int

    def __post_init__(self):
        where = f"table axis {shown(self.name)}"
        check_number(f"{where}.start", self.start)
        check_number(f"{where}.step", self.step)
        check_number(f"{where}.count", self.count, 2, _MOST_POINTS)
        if self.step <= 0.0:
            raise ConfigError(f"{where}.step = {self.step}: allowed is above 0")

    @property
    def points(self) -> np.ndarray:
        """Grid points, shape (count,)."""
        return self.start + self.step * np.arange(self.count)

    @property
    def stop(self) -> float:
        """Last grid point."""
        return self.start + self.step * (self.count - 1)

    @property
    def midpoints(self) -> np.ndarray:
        """Middle of each cell, shape (count - 1,): where linear interpolation is worst."""
        return self.points[:-1] + 0.5 * self.step


@dataclasses.dataclass(frozen=True)
class Table:
    """Values on the product of one to three regular axes.

    Attributes
    ----------
    axes : tuple of Axis
        One to three axes.
    names : tuple of str
        Name of each quantity, in the order of the last dimension of `values`.
    values : numpy.ndarray
        float64, shape (*axis counts, len(names)), all finite.
    card : dict
        How it was made: source data with hashes, options, scores, trained domain, versions.
    """

    axes: tuple[Axis, ...]
    names: tuple[str, ...]
    values: np.ndarray
    card: dict[str, Any] = dataclasses.field(default_factory=dict)

    def __post_init__(self):
        if not 1 <= len(self.axes) <= 3:
            raise ConfigError(f"table: {len(self.axes)} axes: allowed are 1 to 3")
        if not self.names or len(set(self.names)) < len(self.names):
            raise ConfigError(f"table names = {shown(self.names)}: each is allowed once, none not")
        if self.values.dtype != np.float64:
            raise ConfigError(f"table values are of type {self.values.dtype}: allowed is float64")
        shape = (*(axis.count for axis in self.axes), len(self.names))
        check_array("table values", self.values, shape)
        frozen = self.values.view()  # one table may serve many ships
        frozen.flags.writeable = False
        object.__setattr__(self, "values", frozen)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Table):
            return NotImplemented
        same = (self.axes, self.names, self.card) == (other.axes, other.names, other.card)
        return same and np.array_equal(self.values, other.values)

    def __hash__(self) -> int:
        return hash((self.axes, self.names))

    def __call__(self, *coordinates) -> np.ndarray:
        """Linear interpolation, clamped to the axes' ends.

        Parameters
        ----------
        *coordinates : array_like
            One value per axis, broadcast against each other.

        Returns
        -------
        numpy.ndarray
            Shape (*broadcast shape, len(names)).
        """
        if len(coordinates) != len(self.axes):
            raise ValueError(f"{len(self.axes)} coordinates needed, {len(coordinates)} given")
        points = np.broadcast_arrays(*coordinates)
        cells = [
            _cell(axis, np.asarray(p, float)) for axis, p in zip(self.axes, points, strict=True)
        ]
        return self._between(cells)

    def _between(self, cells, *corner: np.ndarray) -> np.ndarray:
        """Interpolate along the first of the remaining axes, whose cells are given."""
        if not cells:
            return self.values[corner]
        (i, w), *rest = cells
        low, high = (self._between(rest, *corner, end) for end in (i, i + 1))
        return (1.0 - w) * low + w * high

    def channel(self, name: str) -> int:
        """Index of a named quantity."""
        if name not in self.names:
            raise ConfigError(f"table has no quantity {name!r};{nearest(name, self.names)}")
        return self.names.index(name)

    def save(self, path: str | Path) -> None:
        """Write one .npz file (values, axes and card), atomically; same table, same bytes."""
        meta = {
            "axes": [dataclasses.asdict(axis) for axis in self.axes],
            "names": list(self.names),
            "card": self.card,
        }
        text = np.frombuffer(json.dumps(meta, sort_keys=True, indent=1).encode(), dtype=np.uint8)
        with atomic_path(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, values=self.values, meta=text)

    @classmethod
    def load(cls, path: str | Path) -> Table:
        """Read a table written by `save`; a missing or damaged file is a ConfigError."""
        if not Path(path).exists():
            raise ConfigError(f"{path}: no such table file")
        arrays = read_npz(path, "values", "meta", what="a table file")
        meta = build(_Meta, json_head(arrays["meta"], path), str(path))
        with told_of(path):
            axes = tuple(build(Axis, axis, f"axis {k}") for k, axis in enumerate(meta.axes))
            return cls(axes, meta.names, arrays["values"], meta.card)


@dataclasses.dataclass(frozen=True)
class _Meta:
    """What a file says of its table beside the values."""

    axes: tuple[dict, ...]
    names: tuple[str, ...]
    card: dict


def _cell(axis: Axis, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Index of the cell that holds x and the weight (..., 1) of its upper end, clamped."""
    s = np.clip((x - axis.start) / axis.step, 0.0, axis.count - 1.0)
    i = np.minimum(s.astype(np.int64), axis.count - 2)
    return i, (s - i)[..., None]


def smoothstep(x: np.ndarray) -> np.ndarray:
    """0 for x <= 0, 1 for x >= 1, cubic with flat ends between; of one number in a kernel, see
    ``physics.hull``.
    """
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def tabulate(
    model: Callable[..., np.ndarray],
    axes: tuple[Axis, ...],
    names: tuple[str, ...],
    card: dict[str, Any] | None = None,
    tolerance: float = 0.005,
    unchecked: tuple[str, ...] = (),
) -> Table:
    """Evaluate a model on a grid and check the error of linear interpolation between its points.

    Parameters
    ----------
    model : callable
        Takes one array per axis (broadcast), returns shape (*broadcast shape, len(names)).
    axes : tuple of Axis
        One or two axes.
    names : tuple of str
        Quantities that the model returns.
    card : dict, optional
        Stored with the table; the measured interpolation errors are added to it.
    tolerance : float
        Largest allowed difference at the cell middles as a fraction of each quantity's range.
    unchecked : tuple of str
        Quantities whose error is measured and recorded, but not judged.

    Raises
    ------
    ConfigError
        The grid is too coarse for the tolerance; names the quantity and the measured error.
    """
    grid = np.meshgrid(*(axis.points for axis in axes), indexing="ij")
    values = np.ascontiguousarray(model(*grid), dtype=np.float64)
    table = Table(tuple(axes), tuple(names), values, {})
    middle = np.meshgrid(*(axis.midpoints for axis in axes), indexing="ij")
    difference = np.abs(table(*middle) - model(*middle)).reshape(-1, len(names)).max(axis=0)
    spread = values.reshape(-1, len(names))
    span = spread.max(axis=0) - spread.min(axis=0)
    errors = difference / np.where(span > 0.0, span, 1.0)
    for name, error in zip(names, errors, strict=True):
        if name not in unchecked and error > tolerance:
            raise ConfigError(
                f"table of {name}: interpolation error {error:.2e} of its range, "
                f"allowed {tolerance:.2e}; use a finer grid"
            )
    errors = {name: float(error) for name, error in zip(names, errors, strict=True)}
    return Table(table.axes, table.names, values, {**(card or {}), "interpolation_error": errors})
