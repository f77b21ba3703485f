"""Records sailed by a ship and by slightly other ones, from slightly other starts.

The start of a record is known no better than its first rows tell; it is moved by z standard
deviations, z of shape (6,), by the Cholesky factor of its covariance.
"""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from ship_gym.config import ConfigError, ImplausibleShip, told_of
from ship_gym.conventions import DELTA, PSI, N, R, U, V, X, Y
from ship_gym.identification.estimate import weights_of
from ship_gym.identification.numbers import with_values
from ship_gym.identification.record_checks import compared
from ship_gym.identification.records import Record
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim

GROUPS = ("x/L", "y/L", "psi")  # psi in rad
STARTS = 6  # numbers of a start
_SHIFT = 0.1  # standard deviations of a start, for derivatives
_DIFFERENCE = 1e-3  # of a number's range, for derivatives
_FAR = 1e3  # of a ship that is none any more
_TURNED, _HALF = math.radians(10.0), 0.5  # rms of psi, and its share with the rudder reversed


class _Unlooked(ShipSim):
    """Ships on the way of a search, which need not do what ships do: the last one is looked at."""

    def _check_ships(self) -> None:
        pass


def rows_of(records: Sequence[Record], ship: Ship) -> np.ndarray:
    """Group of every compared value, shape (m,)."""
    return np.concatenate([np.repeat(GROUPS, len(_at(record))) for record in records])


def measured(record: Record, ship: Ship) -> np.ndarray:
    """X / L, y / L and psi at the compared rows, shape (3 m,)."""
    at, L = _at(record), ship.hull.L
    return np.concatenate([record.x[at] / L, record.y[at] / L, record.psi[at]])


def linear(
    ship: Ship,
    names: Sequence[str],
    values: np.ndarray,
    z: np.ndarray,
    records: Sequence[Record],
    limits: np.ndarray,
    *,
    jacobian: bool = True,
) -> tuple[np.ndarray, np.ndarray]:
    """Measured minus sailed, shape (m,), and what is sailed by numbers and starts, (m, k + 6 l).

    Parameters
    ----------
    values : numpy.ndarray
        Of the named numbers, shape (k,), within `limits`, shape (k, 2).
    z : numpy.ndarray
        Of the l records' starts, shape (l, 6).
    """
    steps = _DIFFERENCE * (limits[:, 1] - limits[:, 0])
    steps = np.where(values + steps > limits[:, 1], -steps, steps)
    sets = [values, *(values + np.diag(steps) if jacobian else ())]
    ships = [free(with_values(ship, names, one)) for one in sets]
    gaps, blocks, k = [], [], len(names)
    for i, record in enumerate(records):
        starts = [z[i]] * len(sets) + ([*(z[i] + _SHIFT * np.eye(STARTS))] if jacobian else [])
        fleet = ships + [ships[0]] * (len(starts) - len(ships))
        tracks = sailed(fleet, record, np.array(starts))
        gaps.append(measured(record, ship) - tracks[0])
        block = np.zeros((len(tracks[0]), k + STARTS * len(records)))
        if jacobian:
            own = slice(k + STARTS * i, k + STARTS * (i + 1))
            block[:, :k] = ((tracks[1 : k + 1] - tracks[0]) / steps[:, None]).T
            block[:, own] = ((tracks[k + 1 :] - tracks[0]) / _SHIFT).T
        blocks.append(block)
    return np.concatenate(gaps), np.vstack(blocks)


def sailed(ships: Sequence[Ship], record: Record, z: np.ndarray) -> np.ndarray:
    """X / L, y / L and psi of some ships at the compared rows, shape (ships, 3 m)."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleShip)
        sim = _Unlooked([*ships], len(ships), parallel=False)
    starts = record.start + z @ np.linalg.cholesky(record.covariance).T
    with told_of(record.path):
        sim.reset(speed=float(record.start[3]), n=float(record.n[0]))
    sim.state[:, [X, Y, PSI, U, V, R]] = starts
    kept, dt = set(_at(record).tolist()), np.diff(record.t)
    found = []
    for k in range(len(record.t)):
        if k in kept:
            found.append(sim.state[:, [X, Y, PSI]].copy())
        if k < len(dt):
            sim.state[:, [DELTA, N]] = sim.commands[:] = record.delta[k], record.n[k]
            if not k or dt[k] != dt[k - 1]:
                sim.set_interval(float(dt[k]))
            sim.sail()
    rows = np.array(found) / [ships[0].hull.L, ships[0].hull.L, 1.0]
    rows = np.where(np.isfinite(rows), np.clip(rows, -_FAR, _FAR), _FAR)
    return rows.transpose(1, 2, 0).reshape(len(ships), -1)


def distances(ship: Ship, record: Record, sigma: dict[str, float]) -> np.ndarray:
    """Root mean square of x / L, y / L and psi, from the start that suits best, shape (3,)."""
    weight = weights_of(rows_of([record], ship), sigma)
    ships = [free(ship)]

    def tracks(z: np.ndarray) -> np.ndarray:
        return sailed(ships * len(z), record, z)

    def gap(z: np.ndarray) -> np.ndarray:
        return np.append((tracks(z[None])[0] - measured(record, ship)) * weight, z)

    def slope(z: np.ndarray) -> np.ndarray:
        found = tracks(np.vstack([z, z + _SHIFT * np.eye(STARTS)]))
        return np.vstack([((found[1:] - found[0]) / _SHIFT).T * weight[:, None], np.eye(STARTS)])

    z = least_squares(gap, np.zeros(STARTS), slope, xtol=1e-4, ftol=1e-6, max_nfev=20).x
    left = tracks(z[None])[0] - measured(record, ship)
    return np.sqrt(np.mean(left.reshape(3, -1) ** 2, axis=1))


def check_rudder(ship: Ship, record: Record) -> None:
    """Refuse a record whose heading the ship follows with the rudder reversed, and else not."""
    there = len(_at(record))
    gaps = []
    for sign in (1.0, -1.0):
        other = dataclasses.replace(record, delta=sign * record.delta)
        psi = sailed([free(ship)], other, np.zeros((1, STARTS)))[0, 2 * there :]
        gaps.append(math.sqrt(np.mean((record.psi[_at(record)] - psi) ** 2)))
    if gaps[0] > _TURNED and gaps[1] < _HALF * gaps[0]:
        far, near = map(math.degrees, gaps)
        raise ConfigError(
            f"{record.path}: psi is {far:.3g} deg off (rms), with delta reversed {near:.3g}: "
            "delta is positive to starboard"
        )


def free(ship: Ship) -> Ship:
    """The ship without ranges: on its way a number may be where no ship is."""
    return dataclasses.replace(ship, strict=False)


def _at(record: Record) -> np.ndarray:
    return compared(record.t, record.time)
