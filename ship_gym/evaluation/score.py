"""Normalised scores: 0 is doing nothing, 100 the tuned reference controller of a scenario and ship.

A score is logarithmic, because errors are ratios: halving the error earns the same wherever one
stands. What it is measured against is frozen with the benchmark's version, in
``shipbench_1.json`` (``scripts/measure_headroom.py`` makes it).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known, check_number, shown
from ship_gym.evaluation.metrics import all_metrics
from ship_gym.evaluation.statistics import (
    Estimate,
    draws,
    interquartile_mean,
    interquartile_weights,
    tails,
)
from ship_gym.keys import Keys, read_keys

VERSION = "ShipBench-1"
FILE = Path(__file__).with_name("shipbench_1.json")
LEAST = 1.05  # nothing / reference below it: the scenario tells no one from doing nothing
OPTIMA = ("gauss-newton plan", "minimum-time turn")
_LEAST, _MOST = 1e-12, 1e12  # of a measure
_KEYS = ("measure", "nothing", "reference", "reference_controller", "optimum", "optimum_kind")
_MORE = ("optimum_seeds", "headroom")
# what ``evaluation.headroom`` keeps beside
_BESIDE = ("second", "second_controller", "difference", "separates", "inputs")


def normalised(x: float, nothing: float, reference: float) -> float | None:
    """Score of a measure: 100 ln(nothing / x) / ln(nothing / reference).

    Parameters
    ----------
    x, nothing, reference : float
        Interquartile means over the same seeds, of a measure that is positive and lower is better:
        of the controller, of doing nothing and of the reference controller.

    Returns
    -------
    float or None
        None where the reference is not at least `LEAST` times better than doing nothing.
    """
    for name, value in (("x", x), ("nothing", nothing), ("reference", reference)):
        if not (isinstance(value, int | float | np.number) and 0.0 < value < math.inf):
            raise ConfigError(f"{name} = {shown(value)}: a score needs a positive, finite measure")
    return None if nothing / reference < LEAST else float(_score(x, nothing, reference))


def _score(x: float | np.ndarray, nothing: float, reference: float) -> np.ndarray:
    return 100.0 * np.log(nothing / x) / math.log(nothing / reference)


@dataclasses.dataclass(frozen=True)
class Reference:
    """What the scores of one cell, a scenario with a ship, are measured against.

    Attributes
    ----------
    scenario, ship : str
    measure : str
        Name of the metric.
    nothing, reference : float
        Its interquartile means for doing nothing and for the reference controller.
    reference_controller : str
    optimum : float or None
        That of the reference optimum, an estimate of what is possible.
    optimum_kind : str or None
        One of `OPTIMA`.
    optimum_seeds : int or None
        Number of seeds that the optimum was computed for.
    headroom : Estimate or None
        What the optimum is below the reference [%], on the optimum's seeds.
    """

    scenario: str
    ship: str
    measure: str
    nothing: float
    reference: float
    reference_controller: str
    optimum: float | None = None
    optimum_kind: str | None = None
    optimum_seeds: int | None = None
    headroom: Estimate | None = None

    @property
    def name(self) -> str:
        """As in the file."""
        return f"{self.scenario}/{self.ship}"

    @property
    def scored(self) -> bool:
        """Whether the reference is far enough from doing nothing for a score."""
        return self.nothing / self.reference >= LEAST

    def score(self, x: float) -> float | None:
        """Score of an interquartile mean, see `normalised`."""
        return normalised(x, self.nothing, self.reference)

    def scores(self, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """Scores of single episodes, for performance profiles; nan where one has no value.

        Their mean is not the score of the cell, which is that of the interquartile mean.
        """
        if not self.scored:
            raise ConfigError(f"cell {self.name!r} has no score: see Reference.scored")
        return _score(np.asarray(values, dtype=np.float64), self.nothing, self.reference)

    @property
    def optimum_score(self) -> float | None:
        """Score of the reference optimum; None without one."""
        return None if self.optimum is None else self.score(self.optimum)


@dataclasses.dataclass(frozen=True)
class References:
    """The frozen reference values of a benchmark.

    Attributes
    ----------
    version : str
    seeds : tuple of int
        First one and how many.
    cells : mapping
        ``scenario/ship`` to `Reference`.
    about : mapping
        Whatever else the file holds: how it was made.
    """

    version: str
    seeds: tuple[int, int]
    cells: Mapping[str, Reference]
    about: Mapping[str, Any]

    def of(self, scenario: str, ship: str) -> Reference | None:
        """Reference of a cell; None: there is none, so it has no score."""
        return self.cells.get(f"{scenario}/{ship}")


def read_references(path: str | Path = FILE) -> References:
    """Read the reference values of a benchmark.

    Raises
    ------
    ConfigError
        No such file, one of another version, a key that is missing or unknown, or a value that is
        not allowed; the message names the cell.
    """
    found = read_keys(path)
    found.known("version", (VERSION,))
    about = {k: v for k, v in found.values.items() if k not in ("version", "seeds", "cells")}
    cells = {name: _cell(name, cell) for name, cell in found.table("cells").tables()}
    return References(VERSION, _seeds(found), cells, about)


def _seeds(found: Keys) -> tuple[int, int]:
    given = found.items("seeds")
    if not (len(given) == 2 and all(type(k) is int for k in given)):
        raise ConfigError(f"{found.label('seeds')} = {shown(given)}: allowed is [first, number]")
    first, number = found.numbers("seeds", 0, 2**32 - 1)
    return int(first), int(check_number(f"{found.where}: number of seeds", number, 1, 10**6))


def _cell(name: str, cell: Keys) -> Reference:
    """One cell of the file, strictly."""
    scenario, slash, ship = name.partition("/")
    if not (scenario and slash and ship):
        raise ConfigError(f"{cell.where}: cell {shown(name)}: its name must be scenario/ship")
    for key in cell.values:
        check_known(f"key of {cell.where}: cell {shown(name)}:", key, (*_KEYS, *_MORE, *_BESIDE))
    lower = [metric for metric, what in all_metrics().items() if what.better == "lower"]
    optimum = cell.number("optimum", _LEAST, _MOST, instead=None)
    kind = None if optimum is None else cell.known("optimum_kind", OPTIMA)
    headroom = cell.value("headroom", None)
    return Reference(
        scenario=scenario,
        ship=ship,
        measure=cell.known("measure", lower),
        nothing=cell.number("nothing", _LEAST, _MOST),
        reference=cell.number("reference", _LEAST, _MOST),
        reference_controller=cell.text("reference_controller"),
        optimum=optimum,
        optimum_kind=kind,
        optimum_seeds=cell.whole("optimum_seeds", 0, 10**6, None),
        headroom=None if headroom is None else _estimate(cell.table("headroom")),
    )


def _estimate(given: Keys) -> Estimate:
    """A value and its interval, which may be missing."""
    names = [field.name for field in dataclasses.fields(Estimate)]
    for key in given.values:
        check_known(f"key of {given.where}: {given.name}", key, names)
    ends = {key: given.number(key, instead=None) for key in ("low", "high")}
    return Estimate(given.number("value"), **ends)


def cell_score(values: Sequence[float] | np.ndarray, cell: Reference) -> Estimate | None:
    """Score of a controller in one cell with its 95 % interval over the seeds.

    Parameters
    ----------
    values : array_like
        The cell's measure, one per seed, shape (n,).

    Returns
    -------
    Estimate or None
        None where the cell has no score, or where an episode has no value (nan).
    """
    return mean_score([(values, cell)])


def mean_score(cells: Sequence[tuple[Sequence[float] | np.ndarray, Reference]]) -> Estimate | None:
    """Mean of a controller's scores over cells with its 95 % interval.

    A percentile bootstrap over the seeds, which a logarithm leaves as good as it is for the
    interquartile mean. Cells with equally many seeds are taken to have the same ones, in the same
    order, and are drawn together: a seed brings similar seas to all scenarios and ships, so that
    cells drawn one by one would make the interval too short. Cells of other numbers of seeds are
    strata of their own.

    Parameters
    ----------
    cells : sequence of (values, Reference)
        Of each cell the measure by seed, shape (n,), and what it is scored against. Cells that
        have no score (`Reference.scored`) are left out.

    Returns
    -------
    Estimate or None
        None where no cell has a score, or where an episode of one has no value (nan): a controller
        that failed to answer has no score, whatever its other episodes were like.
    """
    scored = [(np.asarray(v, dtype=np.float64), cell) for v, cell in cells if cell.scored]
    if not scored or not all(len(v) and np.isfinite(v).all() for v, _ in scored):
        return None
    value = float(np.mean([cell.score(float(interquartile_mean(v))) for v, cell in scored]))
    if min(len(v) for v, _ in scored) < 2:
        return Estimate(value, None, None)
    counts = {n: draws(n) for n in {len(v) for v, _ in scored}}
    resampled = [_resampled(v, cell, counts[len(v)]) for v, cell in scored]
    low, high = tails(np.mean(resampled, axis=0))
    return Estimate(value, float(low), float(high))


def _resampled(values: np.ndarray, cell: Reference, counts: np.ndarray) -> np.ndarray:
    """Scores of a cell in resamples of its seeds, shape (resamples,)."""
    order = np.argsort(values, kind="stable")
    found = interquartile_weights(counts[:, order]) @ values[order]
    return cell.scores(found)
