"""A few numbers of a ship calibrated to records of her sailing free, by bounded least squares.

Each record is sailed from its first state with the measured rudder angle and propeller speed
(``ShipSim``, calm water); what is fitted is where she is and where she points, x / L, y / L and
psi, at every half ship length of time. Errors of a track follow each other: with the correlation
rho of neighbouring residuals, standard errors grow by sqrt((1 + rho) / (1 - rho)). Numbers stay in
the range that ships have (``ships.ranges``).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, PSI, N, R, U, V, X, Y
from ship_gym.identification.estimate import Estimate, check_told, scatter, spread
from ship_gym.identification.numbers import full_names, ranges_of, values_of, with_values
from ship_gym.identification.records import Record, read_record
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim

GROUPS = ("x/L", "y/L", "psi")  # psi in rad
MOST = 8  # numbers; a track tells few
_EVERY = 0.5  # [L / U] of time between the rows that are compared
_DIFFERENCE = 1e-3  # of a number's range, for derivatives
_AT_BOUND = 1e-3  # of a number's range: the solver stays inside
_FAR = 1e3  # residual of a ship that is none any more
_ROUNDS = 3  # of weighting the groups


@dataclasses.dataclass(frozen=True)
class Calibration:
    """Numbers calibrated to records.

    Attributes
    ----------
    ship, fitted : Ship
    estimate : Estimate
    at_bound : tuple of str
        Numbers that the range of ships stopped.
    records, held_out : tuple of Record
        Fitted to, and not.
    before, after : dict
        File to the root mean square of x / L, y / L, psi [rad], shape (3,), of both kinds.
    rho : dict
        Correlation of neighbouring residuals of each group.
    """

    ship: Ship
    fitted: Ship
    estimate: Estimate
    at_bound: tuple[str, ...]
    records: tuple[Record, ...]
    held_out: tuple[Record, ...]
    before: dict[str, np.ndarray]
    after: dict[str, np.ndarray]
    rho: dict[str, float]


def calibrate(
    ship: Ship,
    files: Sequence[str | Path],
    names: Sequence[str],
    held_out: Sequence[str | Path] = (),
    each: Callable[[Iterable], Iterable] = iter,
) -> Calibration:
    """Calibrate numbers of a ship to records; other records are sailed but not fitted to.

    Raises
    ------
    ConfigError
        A file that is none, or one that is fitted to and held out; too many numbers, or numbers
        of which the records say nothing.
    """
    names = full_names(names)
    if not 1 <= len(names) <= MOST:
        raise ConfigError(f"{len(names)} numbers to calibrate: allowed are 1 to {MOST}")
    if both := {str(Path(f).resolve()) for f in files} & {str(Path(f).resolve()) for f in held_out}:
        raise ConfigError(f"{min(both)}: fitted to and held out; allowed is one of them")
    records = [read_record(file, ship) for file in files]
    rest = [read_record(file, ship) for file in held_out]
    limits = np.array(list(ranges_of(ship, names).values()))
    start = values_of(ship, names)
    groups = np.concatenate([_groups(record, ship) for record in records])
    sigma, values = dict.fromkeys(GROUPS, 1.0), np.clip(start, *limits.T)
    for _ in each(range(_ROUNDS)):
        values = _solve(ship, names, records, values, limits, groups, sigma)
        residuals, J = _linear(ship, names, values, records, limits)
        check_told(names, J)
        sigma, freedom = scatter(J, residuals, groups)
    rho = {name: _neighbours(residuals[groups == name]) for name in GROUPS}
    growth = {name: (1.0 + r) / (1.0 - r) for name, r in rho.items()}
    grown = {name: s * growth[name] ** 0.5 for name, s in sigma.items()}
    rows = {name: int((groups == name).sum()) for name in GROUPS}
    freedom = {name: f / growth[name] for name, f in freedom.items()}
    estimate = Estimate(
        names, start, values, *spread(J, groups, grown), sigma, rows, freedom, residuals
    )
    room = _AT_BOUND * (limits[:, 1] - limits[:, 0])
    stopped = (values <= limits[:, 0] + room) | (values >= limits[:, 1] - room)
    fitted = with_values(ship, names, values)
    everything = [*records, *rest]
    return Calibration(
        ship,
        fitted,
        estimate,
        tuple(name for name, s in zip(names, stopped, strict=True) if s),
        tuple(records),
        tuple(rest),
        _rms(ship, everything),
        _rms(fitted, everything),
        rho,
    )


def _solve(
    ship: Ship,
    names: tuple[str, ...],
    records: list[Record],
    values: np.ndarray,
    limits: np.ndarray,
    groups: np.ndarray,
    sigma: dict[str, float],
) -> np.ndarray:
    """Bounded least squares with given weights of the groups."""
    weight = np.array([1.0 / sigma[g] for g in groups.tolist()])
    width = limits[:, 1] - limits[:, 0]
    room = 1e-9 * width  # the solver wants to begin inside
    found = least_squares(
        lambda x: -_linear(ship, names, x, records, limits, jacobian=False)[0] * weight,
        np.clip(values, limits[:, 0] + room, limits[:, 1] - room),
        lambda x: _linear(ship, names, x, records, limits)[1] * weight[:, None],
        bounds=limits.T,
        x_scale=width,
        xtol=1e-6,
        ftol=1e-8,
        max_nfev=40,
    )
    return found.x


def _linear(
    ship: Ship,
    names: tuple[str, ...],
    values: np.ndarray,
    records: list[Record],
    limits: np.ndarray,
    *,
    jacobian: bool = True,
) -> tuple[np.ndarray, np.ndarray]:
    """Measured minus sailed, shape (m,), and the derivative of what is sailed, shape (m, k)."""
    steps = _DIFFERENCE * (limits[:, 1] - limits[:, 0])
    steps = np.where(values + steps > limits[:, 1], -steps, steps)
    sets = [values, *(values + np.diag(steps) if jacobian else ())]
    ships = [with_values(ship, names, one) for one in sets]
    there = [_sailed(ships, record) for record in records]
    rows = [np.concatenate([tracks[k] for tracks in there]) for k in range(len(ships))]
    measured = np.concatenate([_measured(record, ship) for record in records])
    columns = [(row - rows[0]) / s for row, s in zip(rows[1:], steps, strict=False)]
    return measured - rows[0], np.column_stack(columns) if columns else np.empty((len(rows[0]), 0))


def _sailed(ships: list[Ship], record: Record) -> list[np.ndarray]:
    """X / L, y / L and psi of some ships at the compared rows of a record, each shape (3 m,)."""
    sim = ShipSim(ships, len(ships), parallel=False)
    sim.reset(speed=record.motion[0], n=float(record.n[0]))
    sim.state[:, [U, V, R]] = record.motion
    sim.state[:, [X, Y, PSI]] = record.x[0], record.y[0], record.psi[0]
    kept, dt = set(_compared(record, ships[0]).tolist()), np.diff(record.t)
    found = []
    for k in range(len(record.t)):
        if k in kept:
            found.append(sim.state[:, [X, Y, PSI]].copy())
        if k < len(dt):
            sim.state[:, [DELTA, N]] = sim.commands[:] = record.delta[k], record.n[k]
            sim.set_interval(float(dt[k]))
            sim.sail()
    rows = np.array(found) / [ships[0].hull.L, ships[0].hull.L, 1.0]
    rows = np.where(np.isfinite(rows), np.clip(rows, -_FAR, _FAR), _FAR)
    return [rows[:, i].T.ravel() for i in range(len(ships))]


def _compared(record: Record, ship: Ship) -> np.ndarray:
    """Rows that are compared: one in `_EVERY`, without the start, where all agree."""
    step = _EVERY * ship.hull.L / record.motion[0] / float(np.median(np.diff(record.t)))
    k = max(round(step), 1)
    return np.arange(k, len(record.t), k)


def _measured(record: Record, ship: Ship) -> np.ndarray:
    at = _compared(record, ship)
    return np.concatenate([record.x[at] / ship.hull.L, record.y[at] / ship.hull.L, record.psi[at]])


def _groups(record: Record, ship: Ship) -> np.ndarray:
    return np.repeat(GROUPS, len(_compared(record, ship)))


def _rms(ship: Ship, records: list[Record]) -> dict[str, np.ndarray]:
    """Root mean square of x / L, y / L and psi of each record."""
    found = {}
    for record in records:
        gap = _measured(record, ship) - _sailed([ship], record)[0]
        found[record.path] = np.sqrt(np.mean(gap.reshape(3, -1) ** 2, axis=1))
    return found


def _neighbours(residuals: np.ndarray) -> float:
    """Correlation of neighbouring residuals, 0 to 0.99."""
    if len(residuals) < 3 or not (square := float(residuals @ residuals)) > 0.0:
        return 0.0
    return min(max(float(residuals[1:] @ residuals[:-1]) / square, 0.0), 0.99)
