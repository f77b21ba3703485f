"""Estimate of what control can reach: the best plan with full knowledge of each episode.

For every seed the rudder angles of the whole voyage are optimised through the simulator itself, the
sea to come included (Gauss-Newton, `gauss_newton`). What comes out is a local optimum: an estimate
of the bound that no controller can pass, itself never a bound. It is the smaller of several starts,
and with the reference among them never worse than that.

Corrections are added to a pilot that goes on steering, because the same corrections alone would
sail a ship that holds no course far away. Finally the actions are written down and sailed once more
as a `Plan`, which looks at nothing; its metrics are computed as any controller's.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.envs.env import resolved_scenario
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.evaluation.gauss_newton import Problem, minimise
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.objectives import ERRORS, Objective, objective_of, scale_of, traded
from ship_gym.evaluation.rollout import Rollout, rollout
from ship_gym.evaluation.statistics import interquartile_mean
from ship_gym.evaluation.voyages import Beside, Helm, Pilot, Sailings, Steered
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks import TASKS
from ship_gym.tasks.columns import action_columns

NAME = "optimum"
ITERATIONS = 8
# Of headings (True) and of tracks [L / U0]: spacing of the knots, between which corrections are
# linear, and how long a correction is felt under a pilot. Knots twice as dense lower J_steady of
# headings by 1 %.
_SPACING = {True: 0.7, False: 1.0}
_REACH = {True: 20.0, False: 12.0}


class Plan:
    """Actions that were written down, whatever is observed.

    Parameters
    ----------
    actions : numpy.ndarray
        Of every interval and episode, shape (T, n, n_actions), in [-1, 1].
    name : str
    """

    def __init__(self, actions: np.ndarray, name: str = NAME):
        self.actions, self.name = np.asarray(actions), name

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Begin at the first interval.

        Raises
        ------
        ConfigError
            The plan is of another number of episodes, or of other actions.
        """
        shape, wanted = self.actions.shape[1:], (count, len(action_columns(scenario)))
        if shape != wanted:
            raise ConfigError(f"plan {self.name!r} has actions {shape} an interval, needs {wanted}")
        self._next = 0

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions of the next interval; the last one again after the end."""
        found = self.actions[min(self._next, len(self.actions) - 1)]
        self._next += 1
        return found


@dataclasses.dataclass(frozen=True, eq=False)
class Optimum:
    """The best plans that were found, an estimate of the bound.

    Attributes
    ----------
    rollout : Rollout
        Of the plans, sailed open loop.
    measure : str
        What was minimised for, a metric of the task.
    objective : Objective
        With what was sailed beyond the end.
    costs : dict
        Cost of every episode by the name of the start, and ``reference``, that of the first
        controller as it is; shapes (n,).
    starts : tuple of str
        From which the best plan of each episode comes, shape (n,).
    """

    rollout: Rollout
    measure: str
    objective: Objective
    costs: dict[str, np.ndarray]
    starts: tuple[str, ...]


def optimum(
    controllers: Sequence[Controller],
    scenario: str | Mapping[str, Any] | Scenario = "heading_keeping",
    *,
    seeds: Sequence[int],
    measure: str | None = None,
    objective: Objective | None = None,
    iterations: int = ITERATIONS,
    ship: str | Ship | None = None,
    control: str | None = None,
    overrides: Mapping[str, Any] | None = None,
    parallel: bool | None = None,
    progress: Callable[[Iterable, str], Iterable] | None = None,
) -> Optimum:
    """Seek the best open-loop plan of every seed.

    Parameters
    ----------
    controllers : sequence of Controller
        Starts, the reference first. For headings its own rudder history, smoothed to the knots, on
        top of a feedback of the true heading is one more.
    scenario, seeds, ship, control, overrides, parallel
        As in ``rollout``.
    measure : str, optional
        A metric; the task's headline if omitted.
    objective : Objective, optional
        Instead of the one that belongs to the measure.
    iterations : int
        At most, from each start.
    progress : callable, optional
        ``progress(iterable, text)`` wraps the iterations of a start.

    Raises
    ------
    ConfigError
        No controllers, a task without residuals, a measure that is no mean of squares or that an
        episode is too short for.
    """
    if not controllers:
        raise ConfigError("controllers: at least one is needed, where the search starts")
    check_number("iterations", iterations, 0, 1000)
    resolved, given = resolved_scenario(scenario, ship, control, None, None, overrides)
    measure = TASKS[resolved.task].headline if measure is None else measure
    objective = objective_of(resolved.task, measure) if objective is None else objective
    first = rollout(controllers[0], resolved, seeds=seeds[:1], ship=given, parallel=False)
    if metrics(first.trajectory(0)).get(measure) is None:
        raise ConfigError(
            f"duration = {resolved.duration:g} s: an episode has no {measure}; allowed is a longer "
            "one"
        )
    problem = _problem(resolved, given, objective, seeds, parallel)
    costs: dict[str, Any] = {}
    actions: dict[str, Any] = {}
    for pilot, start in _starts(problem, controllers):
        bar = (lambda it, p=pilot: progress(it, f"from {p.name}")) if progress else iter
        if not costs:
            everyone = np.arange(len(seeds))
            costs["reference"] = problem.evaluate(pilot, everyone, np.zeros_like(start))[1]
        found, costs[pilot.name] = minimise(problem, pilot, start, iterations, bar)
        actions[pilot.name] = _actions(problem, pilot, found)
    best, starts = _best({name: costs[name] for name in actions}, actions)
    plans = rollout(Plan(best), resolved, seeds=seeds, ship=given, parallel=parallel)
    return Optimum(plans, measure, objective, costs, starts)


def _problem(scenario, ship, objective, seeds, parallel) -> Problem:
    sailor = ship if isinstance(ship, Ship) else None
    beyond = round(objective.beyond / scenario.control_interval)
    steps = scenario.steps + beyond
    probe = Sailings(seeds, scenario, sailor, np.zeros(1), 1, parallel)
    unit = probe.ship.hull.L / probe.speed * probe.ship.time_unit  # full-scale s
    turns = ERRORS[scenario.task].turns
    spacing = max(round(_SPACING[turns] * unit / scenario.control_interval), 1)
    knots = np.arange(0, steps + spacing, spacing)
    sailings = Sailings(seeds, scenario, sailor, knots, steps, parallel)
    scale = scale_of(objective, sailings.begin(np.arange(len(seeds))), steps)
    reach = round(_REACH[turns] / _SPACING[turns])
    return Problem(sailings, objective, scale, min(reach, len(knots)))


def _starts(problem: Problem, controllers: Sequence[Controller]):
    """Pilots with the corrections (n, K) that the search begins at."""
    knots = problem.sailings.knots
    nothing = np.zeros((len(problem.sailings.seeds), len(knots)))
    for controller in controllers:
        yield Steered(controller), nothing
    if ERRORS[problem.sailings.scenario.task].turns:
        helm = Helm(ConstantController())
        yield helm, _smoothed(problem, Beside(Steered(controllers[0]), helm))


def _smoothed(problem: Problem, both: Beside) -> np.ndarray:
    """Corrections (n, K) with which the second pilot gives the rudder of the first, smoothed."""
    sailings = problem.sailings
    rows = np.arange(len(sailings.seeds))
    sailings.sail(both, rows, np.zeros((len(rows), len(sailings.knots))))
    return sailings.at_knots(np.stack(both.differences))


def _actions(problem: Problem, pilot: Pilot, corrections: np.ndarray) -> np.ndarray:
    rows = np.arange(len(corrections))
    actions = problem.sailings.sail(pilot, rows, corrections, keep_actions=True).actions
    assert actions is not None
    return actions


def _best(costs: Mapping[str, np.ndarray], actions: Mapping[str, np.ndarray]):
    """Actions of the cheapest start of each episode, (T, n, n_actions), and its name."""
    names = list(costs)
    which = np.argmin([costs[name] for name in names], axis=0).tolist()
    best = np.stack([actions[names[k]][:, i] for i, k in enumerate(which)], axis=1)
    return best, tuple(names[k] for k in which)


def front(
    controllers: Sequence[Controller],
    lambdas: Sequence[float],
    scenario: str | Mapping[str, Any] | Scenario = "heading_keeping",
    *,
    seeds: Sequence[int],
    measure: str | None = None,
    **how: Any,
) -> list[dict[str, float]]:
    """Error against wear: the optimum for each weight of the rudder, see ``objectives.traded``.

    Parameters
    ----------
    controllers, scenario, seeds, measure, how
        As in `optimum`.
    lambdas : sequence of float

    Returns
    -------
    list of dict
        One for each lambda, in the order given: ``lambda``, then interquartile means of the
        metrics of the optimum.
    """
    env = (how.get(key) for key in ("ship", "control", "surrogate", "privileged", "overrides"))
    task = resolved_scenario(scenario, *env)[0].task
    measure = TASKS[task].headline if measure is None else measure
    points = []
    for lam in lambdas:
        check_number("lambda", lam, 0.0, 1e6)
        weights = traded(task, measure, lam)
        found = optimum(
            controllers, scenario, seeds=seeds, measure=measure, objective=weights, **how
        )
        rows = [metrics(found.rollout.trajectory(i)) for i in range(len(seeds))]
        table = np.array([list(row.values()) for row in rows], dtype=float)  # None becomes nan
        middle = interquartile_mean(table, axis=0)
        points.append({"lambda": float(lam)} | dict(zip(rows[0], middle.tolist(), strict=True)))
    known = [
        name for name in (points or [{}])[0] if all(np.isfinite(point[name]) for point in points)
    ]
    return [{name: point[name] for name in known} for point in points]
