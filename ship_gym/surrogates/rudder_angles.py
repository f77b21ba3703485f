"""Rudder angle as third input: samples at several angles become planes of one force table.

A file of samples with a column ``delta`` (see ``own``) is read in one of two ways:

- *planes*: each angle has enough points for a model of its own, of any family;
- *scattered*: the angles differ from point to point; one Gaussian process in (J, beta, delta) is
  fitted to all points and read off at regular angles between the smallest and the largest.

Either way the table holds planes over the rudder angle. Between two of them the coefficients are
linear in the angle; below the smallest and above the largest the force law goes on as it does with
one trained angle.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.ships.files import Named
from ship_gym.ships.loader import bare
from ship_gym.ships.particulars import Ship
from ship_gym.surrogates.fit import Fit, Options, fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.samples import DataSet
from ship_gym.tables import Axis, Table

FEWEST = 6  # points of an angle that has a model of its own: a regression of second order
LARGEST_STEP = math.radians(5.0)  # between the planes that are read off a scattered set
SMALLEST = math.radians(1.0)  # plane; the force law leads down to amidships
MESH = math.radians(0.5)  # planes lie on multiples of it
MOST_PLANES = 20


@dataclasses.dataclass(frozen=True)
class AtAngle:
    """A model in (J, beta, delta) at one rudder angle [rad]: a model in (J, beta)."""

    model: Any
    delta: float

    def predict(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation at X (n, 2), or at (n, 3) with angles of its own."""
        if X.shape[1] == 2:
            X = np.column_stack([X, np.full(len(X), self.delta)])
        return self.model.predict(X)

    def leave_one_out(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the model of all angles."""
        return self.model.leave_one_out()

    def describe(self) -> dict[str, Any]:
        """What was fitted to all angles, and the angle of this plane."""
        return self.model.describe() | {"delta": self.delta}


def fit_rudder_angles(
    data: DataSet, options: Options | None = None, grid: str | None = None, turbulence: str = ""
) -> tuple[Fit, ...]:
    """Fit a user's samples at several rudder angles.

    Parameters
    ----------
    data : DataSet
        Of `own.own_data_set` without an angle: all of the file.
    options, grid, turbulence
        As in `fit.fit`. A scattered set needs the Gaussian process.

    Returns
    -------
    tuple of Fit
        One for each plane, by rising angle.

    Raises
    ------
    ConfigError
        Fewer than two angles of at least 1 deg, too few points at one of them for the family asked
        for, or angles that do not lie on a common mesh of 0.5 deg.
    """
    options = options or Options()
    parts = sets_of(data)
    if parts != (data,):
        return tuple(fit(plane, options, grid, turbulence) for plane in parts)
    if options.family != "gp":
        raise ConfigError(
            f"{data.path}: fewer than {FEWEST} training points at some rudder angles: such a "
            f"scattered set needs the Gaussian process, not {options.family!r}"
        )
    whole = fit(data, options, grid, turbulence)
    first, last = _usable(data)[0], data.angles[-1]
    count = math.ceil((last - first) / LARGEST_STEP - 1e-9) + 1
    return tuple(at_angle(whole, angle) for angle in np.linspace(first, last, count).tolist())


def sets_of(data: DataSet) -> tuple[DataSet, ...]:
    """A set for each plane, in the region that all share; a scattered set as it is."""
    planes = [_plane(data, angle) for angle in _usable(data)]
    if min(len(plane.training) for plane in planes) < FEWEST:
        return (data,)
    box = _common_box(planes)
    return tuple(dataclasses.replace(plane, box=box) for plane in planes)


def _usable(data: DataSet) -> list[float]:
    """Angles of a set [rad] that can be planes."""
    angles = [angle for angle in data.angles if angle >= SMALLEST]
    if len(angles) < 2:
        raise ConfigError(f"{data.path}: rudder angles {_degrees(data.angles)}: needed are two")
    return angles


def at_angle(whole: Fit, delta: float) -> Fit:
    """One plane [rad] of a fit to a scattered set; its samples stay those of all angles."""
    models: dict[str, dict[str, Any]] = {
        side: {name: AtAngle(model, delta) for name, model in models.items()}
        for side, models in whole.models.items()
    }
    data = dataclasses.replace(whole.data, delta=delta)
    return dataclasses.replace(whole, data=data, models=models)


def table_of_angles(fits: tuple[Fit, ...], ship: Named | Ship) -> Table:
    """One table over rudder angle, advance angle and drift, see `force_table.table_of`.

    Angles that are not regular are brought onto a regular axis by the same linear interpolation
    that the simulation uses between planes, so nothing is lost. The law of the rudder is fitted to
    the samples of the largest angle, of a scattered set to those from half of it on.
    """
    ship = bare(ship)
    angles = np.array([f.data.delta for f in fits])
    tables = [table_of(f, ship) for f in fits]
    last = tables[-1]
    axis = _rudder_axis(angles, str(fits[0].data.path))
    values = np.stack([table.values for table in tables])
    places = np.interp(axis.points, angles, np.arange(len(angles)))
    low = np.minimum(places.astype(int), len(angles) - 2)
    weight = (places - low)[:, None, None, None]
    values = (1.0 - weight) * values[low] + weight * values[low + 1]
    planes = [
        {"delta": table.card["domain"]["delta"], "models": table.card["models"]}
        | {k: table.card[k] for k in ("held_out_scores", "interpolation_error")}
        for table in tables
    ]
    title = f"{fits[0].data.name}: propeller and rudder behind the hull, rudder "
    title += f"{_degrees(angles)}, surrogate {fits[-1].name}"
    card = {**last.card, "title": title, "planes": planes}
    return Table((axis, *last.axes), last.names, values, card)


def _plane(data: DataSet, angle: float) -> DataSet:
    """Samples of one angle; held out are those that are held out of all."""
    plane = dataclasses.replace(data, delta=angle, angles=(angle,))
    choice = data.choices[0] if data.choices else ("", "")
    samples = plane.read(*choice, next(iter(data.sides)))
    fitted = np.isin(samples.points, data.training)
    J, beta = samples.X[fitted].T if fitted.any() else np.zeros((2, 1))
    return dataclasses.replace(
        plane,
        box=(float(J.min()), float(J.max()), float(beta.min()), float(beta.max())),
        training=tuple(samples.points[fitted].tolist()),
        validation=tuple(samples.points[~fitted].tolist()),
    )


def _common_box(planes: list[DataSet]) -> tuple[float, float, float, float]:
    """Region of J and beta that the samples of every angle span."""
    boxes = np.array([plane.box for plane in planes])
    low, high = boxes[:, 0::2].max(axis=0), boxes[:, 1::2].min(axis=0)
    if (low >= high).any():
        raise ConfigError(
            f"{planes[0].path}: the samples of the rudder angles have no region of J and beta in "
            "common"
        )
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _rudder_axis(angles: np.ndarray, path: str) -> Axis:
    """Regular axis that holds every angle."""
    if np.allclose(np.diff(angles), angles[1] - angles[0], rtol=1e-9, atol=0.0):
        step, count = float(angles[1] - angles[0]), len(angles)
    else:
        parts = np.diff(angles) / MESH
        if not np.allclose(parts, np.round(parts), atol=1e-3):
            raise ConfigError(f"{path}: rudder angles {_degrees(angles)}: must be 0.5 deg apart")
        step = MESH * int(np.gcd.reduce(np.round(parts).astype(int)))
        count = round((angles[-1] - angles[0]) / step) + 1
    if count > MOST_PLANES:
        raise ConfigError(
            f"{path}: rudder angles {_degrees(angles)}: {count} regular steps hold them, allowed "
            f"are {MOST_PLANES}; choose rounder angles"
        )
    return Axis("rudder angle", float(angles[0]), step, count)


def _degrees(angles) -> str:
    return ", ".join(f"{math.degrees(a):.4g}" for a in angles) + " deg"
