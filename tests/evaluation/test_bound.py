"""The estimate of the bound: residuals, Gauss-Newton, plans that are sailed open loop."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA
from ship_gym.evaluation import metrics
from ship_gym.evaluation.bound import Plan, front, optimum
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.gauss_newton import Problem, minimise
from ship_gym.evaluation.objectives import (
    ERRORS,
    Objective,
    Scale,
    objective_of,
    objectives_of,
    residuals,
    scale_of,
    traded,
)
from ship_gym.evaluation.rollout import begin, rollout
from ship_gym.evaluation.voyages import Beside, Helm, Sailings, Steered, Voyages
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.tasks import TASKS
from ship_gym.tasks.columns import observation_columns

SEEDS = [2_000_003, 2_000_011, 2_000_017]
SHORT = {"base": "heading_ss5_beam", "duration": 150.0}


class Proportional:
    """Rudder against the heading error and the yaw rate."""

    name = "proportional"

    def reset(self, count, ship, scenario):
        self._columns = observation_columns(scenario)

    def act(self, observations):
        seen = self._columns.view(observations)
        angle = -(2.0 * np.arctan2(seen.sin_error, seen.cos_error) + seen.yaw_rate)
        return np.clip(angle / math.radians(35.0), -1.0, 1.0)[:, None].astype(np.float64)


def voyages(error, delta, lengths, failed):
    return Voyages(np.array(error), np.array(delta), np.array(lengths), np.array(failed))


def test_residuals_by_hand():
    # Three intervals, unit 2 m: the second voyage fails after one, limit 5, rudder 35 deg.
    error = [[2.0, 2.0], [4.0, 8.0], [-2.0, 8.0]]
    delta = np.radians([[10.0, 0.0], [0.0, 0.0], [-10.0, 0.0]])
    sailed = voyages(error, delta, [3, 1], [False, True])
    scale = Scale(np.array([2.0, 2.0]), np.ones((3, 2)), (5.0, 35.0), 2.0)
    parts, costs = residuals(Objective(0.1), scale, sailed)
    assert parts.shape == (2, 3, 2)
    assert costs == pytest.approx([(1 + 4 + 1 + 0.1 * 200) / 3, (1 + 2 * (25 + 0.1 * 1225)) / 3])
    # With a price of the rate: 10 deg down in 2 s and again, times 10 s.
    _, costs = residuals(Objective(0.0, rate=1.0), scale, sailed)
    assert costs[0] == pytest.approx((1 + 4 + 1 + 2 * 50.0**2) / 3)


def test_intervals_after_an_arrival_do_not_count():
    sailed = voyages([[1.0], [3.0], [99.0]], np.zeros((3, 1)), [2], [False])
    scale = Scale(np.ones(1), np.ones((3, 1)), (5.0, 35.0), 1.0)
    assert residuals(Objective(0.1), scale, sailed)[1] == pytest.approx([(1 + 9) / 2])


def test_weights_leave_out_the_turn_after_every_order():
    scenario = load_scenario("course_changing", {"sensors.noise": False})
    batch = begin(SEEDS[:1], scenario)
    steps = scenario.steps + 60
    counts = scale_of(objective_of("course_changing", "J_steady"), batch, steps).counts[:, 0]
    begins = batch.plans[0, :, 0].astype(int)
    turns = np.zeros(steps, dtype=bool)
    for k in begins:
        turns[k : k + 120] = True
    assert (counts[~turns] == 1.0).all() and (counts[turns] < 0.01).all()
    assert 0 < turns.sum() < steps
    every = scale_of(objective_of("course_changing", "J_0.1"), batch, steps).counts
    assert (every == 1.0).all()


def linear_problem(n=2, T=40, K=8, reach=8, seed=0):
    """Residuals A x - b, each knot felt from the knot before it on, as rudders are."""
    rng = np.random.default_rng(seed)
    knots = np.arange(0, T, T // K)
    A, b = rng.standard_normal((n, T, K)), rng.standard_normal((n, T))
    for k in range(K):
        A[:, : knots[max(k - 1, 0)], k] = 0.0
        if k + reach - 1 < K:
            A[:, knots[k + reach - 1] :, k] = 0.0
    ship = SimpleNamespace(gear=SimpleNamespace(delta_max=100.0))
    stub = SimpleNamespace(knots=knots.astype(float), ship=ship)

    class Linear(Problem):
        def evaluate(self, pilot, rows, corrections):
            found = np.einsum("mtk,mk->tm", A[rows], corrections) - b[rows].T
            return found[None], (found**2).mean(axis=0)

    return Linear(stub, None, None, reach), A, b


@pytest.mark.parametrize("reach", [8, 3])
def test_gauss_newton_solves_least_squares(reach):
    problem, A, b = linear_problem(reach=reach)
    found, costs = minimise(problem, None, np.zeros((2, 8)), 12)
    for i in range(2):
        exact, *_ = np.linalg.lstsq(A[i], b[i], rcond=None)
        assert found[i] == pytest.approx(exact, abs=1e-3)
        assert costs[i] == pytest.approx(np.mean((A[i] @ exact - b[i]) ** 2), rel=1e-6)


def test_gauss_newton_keeps_what_it_cannot_better():
    problem, A, b = linear_problem()
    exact = np.stack([np.linalg.lstsq(A[i], b[i], rcond=None)[0] for i in range(2)])
    found, _ = minimise(problem, None, exact, 3)
    assert found == pytest.approx(exact, abs=1e-9)


def test_voyages_are_those_of_a_rollout():
    controller = Proportional()
    scenario = load_scenario(SHORT)
    sailings = Sailings(SEEDS, scenario, None, np.arange(0, 160, 15), scenario.steps)
    rows = np.array([0, 1, 2, 1])
    found = sailings.sail(Steered(controller), rows, np.zeros((4, 11)), keep_actions=True)
    plain = rollout(controller, SHORT, seeds=SEEDS)
    assert np.array_equal(found.delta[:, :3], plain.histories["states"][1:, :, DELTA])
    assert np.array_equal(found.error[:, 3], found.error[:, 1])
    again = sailings.sail(Steered(controller), rows, np.zeros((4, 11)))
    assert np.array_equal(again.error, found.error), "a batch that is begun again is a new one"


def test_helm_with_the_history_of_another_pilot_sails_like_it():
    scenario = load_scenario(SHORT)
    sailings = Sailings(SEEDS, scenario, None, np.arange(0, 160, 2), scenario.steps)
    rows, nothing = np.arange(3), np.zeros((3, 80))
    helm, other = Helm(ConstantController()), Steered(Proportional())
    both = Beside(other, helm)
    first = sailings.sail(both, rows, nothing)
    copied = sailings.sail(helm, rows, sailings.at_knots(np.stack(both.differences)))
    alone = sailings.sail(helm, rows, nothing)
    off = [np.abs(one.error - first.error).mean() for one in (copied, alone)]
    assert off[0] < 0.2 * off[1]


@pytest.fixture(scope="module")
def found():
    how = {"seeds": SEEDS, "iterations": 2, "parallel": False}
    return optimum([Proportional()], SHORT, measure="J_0.1", **how)


def test_optimum_is_never_worse_than_the_reference(found):
    best = np.minimum(found.costs["proportional"], found.costs["helm"])
    assert (best <= found.costs["reference"]).all() and best.mean() < found.costs[
        "reference"
    ].mean()
    assert set(found.starts) <= {"proportional", "helm"} and len(found.starts) == 3
    reference = rollout(Proportional(), SHORT, seeds=SEEDS)
    lower = [metrics(one.trajectory(0))["J_0.1"] for one in (found.rollout, reference)]
    assert lower[0] < lower[1]


def test_costs_are_the_metrics_of_the_plan_sailed_open_loop():
    objective = Objective(0.1, beyond=0.0)
    how = {"seeds": SEEDS, "iterations": 1, "parallel": False, "measure": "J_0.1"}
    found = optimum([Proportional()], SHORT, objective=objective, **how)
    best = np.minimum(found.costs["proportional"], found.costs["helm"])
    values = [metrics(found.rollout.trajectory(i))["J_0.1"] for i in range(3)]
    assert values == pytest.approx(best, rel=1e-9)


def test_optimum_is_the_same_again_and_alone(found):
    how = {"iterations": 2, "parallel": False, "measure": "J_0.1"}
    again = optimum([Proportional()], SHORT, seeds=SEEDS, **how)
    states = again.rollout.histories["states"]
    assert np.array_equal(states, found.rollout.histories["states"])
    alone = optimum([Proportional()], SHORT, seeds=SEEDS[1:2], **how)
    one = alone.rollout.histories["states"][:, 0]
    assert one == pytest.approx(found.rollout.histories["states"][:, 1], rel=1e-6, abs=1e-6)


def test_a_plan_that_goes_on_does_not_let_go_before_the_end(found):
    assert found.objective.beyond == 60.0
    assert found.rollout.lengths.tolist() == [150] * 3


@pytest.mark.slow
def test_front_trades_error_for_travel():
    how = {"seeds": SEEDS, "iterations": 3, "parallel": False}
    points = front([Proportional()], [0.1, 8.0], "heading_ss5_beam", measure="J_0.1", **how)
    light, heavy = points
    assert light["lambda"] == 0.1 and heavy["rudder_travel"] < light["rudder_travel"]
    assert heavy["rms_error"] > light["rms_error"]


def test_weights_of_the_front():
    weights = traded("heading_keeping", "J_steady", 2.0)
    assert (weights.rudder, weights.rate, weights.steady) == (2.0, 2.0, True)


def test_plan_refuses_another_batch():
    plan = Plan(np.zeros((10, 3, 1)))
    batch = begin(SEEDS, SHORT)
    plan.reset(3, batch.ship, batch.scenario)
    with pytest.raises(ConfigError, match=r"plan 'optimum' has actions \(3, 1\)"):
        plan.reset(2, batch.ship, batch.scenario)


def test_refusals():
    with pytest.raises(ConfigError, match="controllers: at least one"):
        optimum([], SHORT, seeds=SEEDS)
    with pytest.raises(ConfigError, match=r"'overshoot' .* no mean of squares; allowed are J_0"):
        optimum([Proportional()], SHORT, seeds=SEEDS, measure="overshoot")
    with pytest.raises(ConfigError, match=r"duration = 20 s: an episode has no J_steady"):
        optimum([Proportional()], SHORT, seeds=SEEDS, overrides={"duration": 20.0})
    with pytest.raises(ConfigError, match="task 'docking' has no residuals"):
        objectives_of("docking")
    with pytest.raises(ConfigError, match="iterations"):
        optimum([Proportional()], SHORT, seeds=SEEDS, iterations=-1)


def test_every_measure_that_can_be_bounded_is_a_metric():
    for task in ERRORS:
        assert set(objectives_of(task)) <= set(TASKS[task].metrics)
        assert all(dataclasses.is_dataclass(one) for one in objectives_of(task).values())
