"""Search for the smallest cost: CMA-ES in batches, then Nelder-Mead; the door of Optuna.

CMA-ES (Hansen, covariance matrix adaptation) samples a generation of candidates at a time, which
sail in one batch. Nelder-Mead goes on from the best of them, the corners of its first simplex in
one batch too.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec

import numpy as np
from scipy.optimize import minimize

from ship_gym.config import check_number
from ship_gym_agents.tuning.ranges import Range, from_shares, to_shares

# costs (m,) of m candidates, each a value for every name
Costs = Callable[[Sequence[Mapping[str, float]]], np.ndarray]
_CORNER = 0.04  # distance of the first simplex's corners, share of a range


@dataclasses.dataclass(frozen=True)
class Size:
    """How much is searched.

    Attributes
    ----------
    episodes : int
        Tuning seeds; three times as many more validate.
    generations, candidates : int
        Of CMA-ES.
    polish : int
        Evaluations of Nelder-Mead after the corners of its first simplex; 0: none.
    seed : int
        Of the search.
    """

    episodes: int = 24
    generations: int = 16
    candidates: int = 20
    polish: int = 40
    seed: int = 0

    def __post_init__(self):
        check_number("episodes", self.episodes, 2, 10_000)
        check_number("generations", self.generations, 1, 10_000)
        check_number("candidates", self.candidates, 4, 10_000)
        check_number("polish", self.polish, 0, 10_000)


def need_optuna() -> None:
    """Refuse, before any work, that Optuna or its CMA-ES is not installed.

    Raises
    ------
    ImportError
        Names the extra that brings it.
    """
    for library in ("optuna", "cmaes"):
        if find_spec(library) is None:
            raise ImportError(f'tuning needs {library}: pip install "ship-gym[tune]"')


def search(
    costs: Costs, ranges: Mapping[str, Range], size: Size, tick: Callable[[], None]
) -> tuple[dict[str, float], float]:
    """Values with the smallest cost that was found, and that cost; begins at the starts.

    Parameters
    ----------
    costs : callable
    ranges : mapping
    size : Size
    tick : callable
        Called after every generation, and after the polish.
    """
    best = _evolve(costs, ranges, size, tick)
    if size.polish:
        best = _polish(costs, ranges, best, size.polish)
        tick()
    return best


def _evolve(costs, ranges, size, tick) -> tuple[dict[str, float], float]:
    """CMA-ES from the starts; the start itself is the first candidate."""
    need_optuna()
    import optuna  # late, and only here: it takes a second

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    space = {
        name: optuna.distributions.FloatDistribution(one.low, one.high, log=one.low > 0.0)
        for name, one in ranges.items()
    }
    start = {name: one.start for name, one in ranges.items()}
    with warnings.catch_warnings():
        # x0 moves to another package with Optuna 6, which pyproject.toml excludes
        warnings.simplefilter("ignore", FutureWarning)
        sampler = optuna.samplers.CmaEsSampler(
            x0=start, seed=size.seed, popsize=size.candidates, warn_independent_sampling=False
        )
    study = optuna.create_study(sampler=sampler)
    study.enqueue_trial(start)
    first = study.ask(space)
    value = float(costs([start])[0])
    study.tell(first, value)
    best = (start, value)
    for _ in range(size.generations):
        asked = [study.ask(space) for _ in range(size.candidates)]
        values = [{name: float(f"{x:.4g}") for name, x in one.params.items()} for one in asked]
        for one, candidate, found in zip(asked, values, costs(values), strict=True):
            study.tell(one, float(found))
            if found < best[1]:
                best = (candidate, float(found))
        tick()
    return best


def _polish(costs, ranges, best, evaluations) -> tuple[dict[str, float], float]:
    """Nelder-Mead from the best, by shares of the ranges."""
    centre = to_shares(best[0], ranges)
    corners = np.tile(centre, (len(centre) + 1, 1))
    for k in range(len(centre)):
        corners[k + 1, k] += _CORNER if centre[k] < 0.5 else -_CORNER
    values = [from_shares(corner, ranges) for corner in corners]
    known = dict(zip(map(_key, values), costs(values).tolist(), strict=True))

    def cost(shares: np.ndarray) -> float:
        values = from_shares(np.clip(shares, 0.0, 1.0), ranges)
        if _key(values) not in known:
            known[_key(values)] = float(costs([values])[0])
        return known[_key(values)]

    options = {"initial_simplex": corners, "maxfev": evaluations + len(corners)}
    minimize(cost, centre, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(centre), options=options)
    found = min(known, key=lambda key: known[key])
    return (dict(found), known[found]) if known[found] < best[1] else best


def _key(values: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    return tuple(values.items())
