"""Numbers of a ship fitted to captive runs.

What a gauge measures (``captive.measure``) is linear in the hull's derivatives and in the added
masses: each column of the least squares is what one more of a number adds to the model, so that
the equations of motion stand in one place. Propeller, rudder and inertia are those of the ship
that is given; what they miss goes into the hull's numbers. But where the thrust was measured, it
is the measured one that is taken from X, (1 - t_P) T, unless a number of the propeller is fitted.
Of numbers that enter otherwise (those of the rudder's law) the columns are differences, and the fit
is repeated (Gauss-Newton).
"""

from __future__ import annotations

import dataclasses
import itertools
import warnings
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

from ship_gym.captive import Condition, measure
from ship_gym.config import ConfigError, ImplausibleShip
from ship_gym.identification.captive_runs import FULL_DRIFT, read_runs
from ship_gym.identification.estimate import Estimate, leverages, solve
from ship_gym.identification.numbers import DERIVATIVES, full_names, values_of, with_values
from ship_gym.reports.captive_file import Measured
from ship_gym.ships.particulars import Ship

USUAL = tuple(name for names in DERIVATIVES.values() for name in names)
_STEP = 1e-3  # of a number, or of one that is zero
_SILENT = 1e-9  # share of the largest entry of a row's columns below which it tells nothing
# Gauss-Newton: most rounds, and the step that ends it, in standard errors or of the number itself
_ROUNDS, _CLOSE, _DIGITS = 12, 1e-6, 1e-8


@dataclasses.dataclass(frozen=True)
class Row:
    """One measured coefficient: of which file and run, its name (``Y_out``), its axis."""

    file: str
    run: Condition
    name: str

    @property
    def axis(self) -> str:
        """X, Y, N or T."""
        return self.name[0]


@dataclasses.dataclass(frozen=True)
class CaptiveFit:
    """A ship with numbers fitted to captive runs.

    Attributes
    ----------
    ship, fitted : Ship
        Before, and with the numbers found.
    estimate : Estimate
    rows : tuple of Row
        What was fitted to, in the order of ``estimate.residuals``.
    measured, before, after : numpy.ndarray
        Of those rows, shape (m,): by 1/2 rho L d U^2, moments by that times L; a measured X is
        moved to the ship's own thrust.
    files : tuple of str
    copies, outside : int
        Runs left out: copies of others; beyond the largest drift or the polynomial's r', 1.2.
    drift : float
        The largest drift [rad].
    leverage : numpy.ndarray
        Of the rows, shape (m,): how far each draws the fit to itself.
    aside : tuple of Row
        Coefficients that none of the numbers changes, left out.
    aside_measured, aside_model : numpy.ndarray
        Of those, as the ship has them before and after.
    """

    ship: Ship
    fitted: Ship
    estimate: Estimate
    rows: tuple[Row, ...]
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    files: tuple[str, ...]
    copies: int
    outside: int
    drift: float
    leverage: np.ndarray
    aside: tuple[Row, ...]
    aside_measured: np.ndarray
    aside_model: np.ndarray


def fit_captive(
    ship: Ship,
    files: Sequence[str | Path],
    names: Sequence[str] = USUAL,
    each: Callable[[Iterable], Iterable] = iter,
    drift: float = FULL_DRIFT,
) -> CaptiveFit:
    """Fit numbers of a ship to the captive runs of some files.

    Parameters
    ----------
    ship : Ship
        Whose other numbers are kept.
    files : sequence of path
        As ``reports.captive_file.read_measured`` reads them. A run that stands twice, with all
        its digits, counts once, the first time.
    names : sequence of str
        Numbers to fit, ``Y_v`` or ``rudder.a_H``; the hull's 16 derivatives if omitted.
    each : callable
        Passes an iterable on, to show how far the fit is.
    drift : float
        Largest drift angle of a run to fit to [rad], at most that of the polynomial.

    Raises
    ------
    ConfigError
        A file that is none, or numbers that the runs do not tell.
    """
    names = full_names(names)
    within, copies, outside = read_runs(files, ship, drift)
    rows = [
        (Row(file, one.condition, name), value)
        for file, one in within
        for name, value in one.values.items()
    ]
    data = np.array([value for _, value in rows])
    conditions = [one.condition for _, one in within]
    asked = [row for row, _ in rows]
    if not any(name.startswith("propeller.") for name in names):
        data = data - _thrust_beyond(ship, [one for _, one in within], asked)
    kept, estimate, model, leverage = _gauss_newton(ship, names, conditions, asked, data, each)
    fitted = with_values(ship, names, estimate.values)
    before = _model(ship, conditions, asked)
    return CaptiveFit(
        ship,
        fitted,
        estimate,
        tuple(itertools.compress(asked, kept)),
        data[kept],
        before[kept],
        model[kept],
        tuple(map(str, files)),
        copies,
        outside,
        drift,
        leverage,
        tuple(itertools.compress(asked, ~kept)),
        data[~kept],
        model[~kept],
    )


def _gauss_newton(
    ship: Ship,
    names: Sequence[str],
    runs: list[Condition],
    rows: list[Row],
    data: np.ndarray,
    each: Callable[[Iterable], Iterable],
) -> tuple[np.ndarray, Estimate, np.ndarray, np.ndarray]:
    """Rows that tell something, the estimate, the model with it, and leverages of those rows."""
    start = values = values_of(ship, names)
    groups = np.array([row.axis for row in rows])
    for _ in range(_ROUNDS):
        here = with_values(ship, names, values)
        model, J = _model(here, runs, rows), _columns(here, names, runs, rows, each)
        kept = (np.abs(J) > _SILENT * np.abs(J).max(axis=0)).any(axis=1)
        found = solve(names, J[kept], (data - model)[kept], groups[kept], values)
        step, values = found.values - values, found.values
        close = np.maximum(_CLOSE * found.errors, _DIGITS * np.abs(values))
        if (np.abs(step) <= close).all() or _is_linear(names):
            model = _model(with_values(ship, names, values), runs, rows)
            leverage = leverages(J[kept], groups[kept], found.sigma)
            return kept, dataclasses.replace(found, start=start), model, leverage
    raise ConfigError("the fit does not converge: fit fewer numbers, or start from other ones")


def _is_linear(names: Sequence[str]) -> bool:
    """Whether the gauge's reading is linear in the numbers."""
    return all(name.partition(".")[2][:2] in ("X_", "Y_", "N_", "R_", "m_", "J_") for name in names)


def _columns(
    ship: Ship,
    names: Sequence[str],
    runs: list[Condition],
    rows: list[Row],
    each: Callable[[Iterable], Iterable],
) -> np.ndarray:
    """Derivative of every row by every number, shape (rows, numbers), by central differences.

    Derivatives of the hull that act along different axes are moved together, for speed.
    """
    values, axes = values_of(ship, names), np.array([row.axis for row in rows])
    steps = _STEP * np.where(values == 0.0, 1.0, np.abs(values))
    J = np.zeros((len(rows), len(names)))
    for together in each(_bundles(names)):
        moved = [names[k] for k in together]
        ends = [values[together] + side * steps[together] for side in (1.0, -1.0)]
        high, low = (_model(with_values(ship, moved, end), runs, rows) for end in ends)
        for k in together:
            own = axes == axis if (axis := _axis_of(names[k])) else slice(None)
            J[own, k] = (high - low)[own] / (2.0 * steps[k])
    return J


def _axis_of(name: str) -> str:
    """X, Y or N of a hull derivative, which acts along that axis alone; else empty."""
    return next((a for a, own in DERIVATIVES.items() if name.removeprefix("hull.") in own), "")


def _bundles(names: Sequence[str]) -> list[list[int]]:
    """Places of numbers to be moved together: a derivative of each axis, others alone."""
    alone = [[k] for k, name in enumerate(names) if not _axis_of(name)]
    queues = [[k for k, name in enumerate(names) if _axis_of(name) == a] for a in DERIVATIVES]
    together = [[k for k in some if k is not None] for some in itertools.zip_longest(*queues)]
    return together + alone


def _model(ship: Ship, runs: list[Condition], rows: list[Row]) -> np.ndarray:
    """What the gauge of a ship reads, shape (rows,)."""
    free = dataclasses.replace(ship, strict=False)  # on its way a number may be where no ship is
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleShip)
        found = dict(zip(map(id, runs), measure(free, runs), strict=True))
    return np.array([found[id(row.run)][row.name] for row in rows])


def _thrust_beyond(ship: Ship, runs: list[Measured], rows: list[Row]) -> np.ndarray:
    """What the measured thrust pushes more than the ship's own, in rows of X, shape (rows,)."""
    computed = measure(ship, [one.condition for one in runs])
    beyond = {
        (id(one.condition), f"X{name[1:]}"): (1.0 - ship.propeller.t_P) * (value - row[name])
        for one, row in zip(runs, computed, strict=True)
        for name, value in one.values.items()
        if name.startswith("T")
    }
    return np.array([beyond.get((id(row.run), row.name), 0.0) for row in rows])
