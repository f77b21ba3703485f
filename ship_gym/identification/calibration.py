"""A few numbers of a ship calibrated to records of her sailing free, by bounded least squares.

Each record is sailed with the measured rudder angle and propeller speed (``ShipSim``, calm water);
what is fitted is where she is and where she points, x / L, y / L and psi, at every half ship length
of time. Where and how each record begins is found along with the numbers, within what its first
rows tell (a normal prior with their covariance). Errors of a track follow each other: with the
correlation rho of neighbouring residuals, standard errors grow by sqrt((1 + rho) / (1 - rho)).
Numbers stay in the range that ships have (``ships.ranges``).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from ship_gym.config import ConfigError
from ship_gym.identification.estimate import (
    Estimate,
    check_told,
    of_some,
    scatter,
    spread,
    weights_of,
)
from ship_gym.identification.numbers import full_names, ranges_of, values_of, with_values
from ship_gym.identification.records import Record, read_record
from ship_gym.identification.sailed_records import (
    GROUPS,
    STARTS,
    check_rudder,
    distances,
    linear,
    rows_of,
)
from ship_gym.ships.particulars import Ship

MOST = 8  # numbers; a track tells few
_AT_BOUND = 1e-3  # of a number's range: the solver stays inside
_ROUNDS = 3  # of weighting the groups
_PRIOR = "start"  # group of what the first rows tell of the starts


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
    for record in (*records, *rest):
        check_rudder(ship, record)
    limits = np.array(list(ranges_of(ship, names).values()))
    start, k = values_of(ship, names), len(names)
    groups = np.append(rows_of(records, ship), [_PRIOR] * (STARTS * len(records)))
    sigma = dict.fromkeys((*GROUPS, _PRIOR), 1.0)
    x = np.append(np.clip(start, *limits.T), np.zeros(STARTS * len(records)))
    for _ in each(range(_ROUNDS)):
        x = _solve(ship, names, records, x, limits, groups, sigma)
        residuals, J = _rows(ship, names, records, x, limits)
        check_told(names, J[:, :k])
        sigma, freedom = scatter(J, residuals, groups, sigma, known=_PRIOR)
    values = x[:k]
    rho = {name: _neighbours(residuals[groups == name]) for name in GROUPS}
    growth = {name: (1.0 + r) / (1.0 - r) for name, r in rho.items()} | {_PRIOR: 1.0}
    grown = {name: s * growth[name] ** 0.5 for name, s in sigma.items()}
    rows = {name: int((groups == name).sum()) for name in GROUPS}
    freedom = {name: freedom[name] / growth[name] for name in GROUPS}
    errors, correlation, _ = spread(J, groups, grown)
    told = of_some(k, errors, correlation)
    scatters = {name: sigma[name] for name in GROUPS}
    left = residuals[groups != _PRIOR]
    estimate = Estimate(names, start, values, *told, scatters, rows, freedom, left)
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
        {one.path: distances(ship, one, scatters) for one in everything},
        {one.path: distances(fitted, one, scatters) for one in everything},
        rho,
    )


def _solve(
    ship: Ship,
    names: tuple[str, ...],
    records: list[Record],
    x: np.ndarray,
    limits: np.ndarray,
    groups: np.ndarray,
    sigma: dict[str, float],
) -> np.ndarray:
    """Numbers within their limits, and starts, that suit best with given weights of the groups."""
    weight = weights_of(groups, sigma)
    width = limits[:, 1] - limits[:, 0]
    free = np.full(len(x) - len(names), np.inf)
    low, high = np.append(limits[:, 0], -free), np.append(limits[:, 1], free)
    room = 1e-9 * width  # the solver wants to begin inside
    x = np.append(
        np.clip(x[: len(names)], low[: len(names)] + room, high[: len(names)] - room),
        x[len(names) :],
    )
    found = least_squares(
        lambda x: -_rows(ship, names, records, x, limits, jacobian=False)[0] * weight,
        x,
        lambda x: _rows(ship, names, records, x, limits)[1] * weight[:, None],
        bounds=(low, high),
        x_scale=np.append(width, np.ones(len(free))),
        xtol=1e-6,
        ftol=1e-8,
        max_nfev=40,
    )
    return found.x


def _rows(
    ship: Ship,
    names: tuple[str, ...],
    records: list[Record],
    x: np.ndarray,
    limits: np.ndarray,
    *,
    jacobian: bool = True,
) -> tuple[np.ndarray, np.ndarray]:
    """Measured minus sailed, and the derivative of what is sailed; last the starts' own rows."""
    k, z = len(names), x[len(names) :]
    gap, J = linear(ship, names, x[:k], z.reshape(-1, STARTS), records, limits, jacobian=jacobian)
    own = np.hstack([np.zeros((len(z), k)), np.eye(len(z))])
    return np.append(gap, -z), np.vstack([J, own])


def _neighbours(residuals: np.ndarray) -> float:
    """Correlation of neighbouring residuals, 0 to 0.99."""
    if len(residuals) < 3 or not (square := float(residuals @ residuals)) > 0.0:
        return 0.0
    return min(max(float(residuals[1:] @ residuals[:-1]) / square, 0.0), 0.99)
