import dataclasses

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.sb3.config import load_hyperparameters
from ship_gym_agents.training.residuals import movement, residuals_of

from ship_gym.config import ConfigError
from ship_gym.conventions import wrap_angle
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import begin, rollout

OPTIONS = load_hyperparameters("gauss_newton").algorithm
SEEDS = range(500_000, 500_006)


def sailed(name, scenario, **options):
    """Residuals (T, parts, n) of a controller, and recordings of the same episodes."""
    env = {"scenario": scenario, "parallel": False}
    batch = begin(SEEDS, **env)
    controller = make_controller(name)
    controller.reset(batch.n, batch.ship, batch.scenario)
    residuals = residuals_of(batch, dataclasses.replace(OPTIONS, **options))
    found = []
    for _ in range(batch.scenario.steps):
        residuals.begin()
        batch.step(controller.act(batch.observations))
        found.append(residuals.end())
    return np.array(found), rollout(make_controller(name), seeds=SEEDS, **env).episodes


def scenario(base, **keys):
    return {"base": base, **keys}


@pytest.mark.parametrize("name", ["pid", "constant"])
def test_cost_of_a_heading_is_J(name):
    """Also of episodes that a limit ends, which without steering most do."""
    limits = {"heading_error_deg": 35.0}
    made, episodes = sailed(
        name, scenario("heading_keeping", duration=200.0, limits=limits), price=0.0, turn=1.0
    )
    if name == "constant":
        assert any(episode.meta["failed"] for episode in episodes)
    cost = (made**2).sum(axis=(0, 1)) / len(made)
    np.testing.assert_allclose(cost, [metrics(e)["J_0.1"] for e in episodes], rtol=1e-9)


def test_without_weight_of_the_turn_it_is_the_steady_part():
    made, episodes = sailed("pid", scenario("heading_keeping", duration=200.0), price=0.0, turn=0.0)
    cost = (made**2).sum(axis=(0, 1)) / (200 - 120)
    np.testing.assert_allclose(cost, [metrics(e)["J_steady"] for e in episodes], rtol=1e-9)


def test_cost_of_a_track_is_the_squared_distance_to_the_route():
    track = {"legs": 1, "leg_min": 3.0, "leg_max": 4.0}
    made, episodes = sailed(
        "drift_los", scenario("track_following", duration=900.0, track=track), price=0.0
    )
    assert all(episode.meta["outcome"] == "arrived" for episode in episodes)
    lengths = [len(episode["t"]) - 1 for episode in episodes]
    cost = (made**2).sum(axis=(0, 1)) / lengths
    np.testing.assert_allclose(cost, [metrics(e)["rms_route"] ** 2 for e in episodes], rtol=1e-9)


def test_course_counts_time_off_the_order_and_what_is_beyond_it():
    made, episodes = sailed(
        "pid", scenario("course_changing", duration=300.0), price=0.0, band=3.0, overshoot=4.0
    )
    for i, episode in enumerate(episodes):
        ordered = episode["psi_ordered"]
        error = np.degrees(wrap_angle(episode["psi"][1:] - ordered[:-1]))
        np.testing.assert_allclose(made[:, 0, i], 3.0 * np.tanh(error / 3.0), atol=1e-9)
        (step,) = np.flatnonzero(np.diff(ordered) != 0.0)[:1] + 1
        came_from = np.sign(wrap_angle(episode["psi"][step] - ordered[step]))
        beyond = np.maximum(-came_from * error[step : step + 120], 0.0)
        np.testing.assert_allclose(made[step : step + 120, 2, i], 2.0 * beyond, atol=1e-9)
        assert np.all(made[:step, 2, i] == 0.0)


def test_movement_costs_by_its_size():
    assert movement(np.array([2.0]), 3.0)[0] ** 2 == pytest.approx(3.0 * 2.0, rel=0.2)
    small = 1e-4
    assert movement(np.array([small]), 3.0)[0] ** 2 == pytest.approx(3.0 * small**2 / 0.6, rel=1e-3)
    np.testing.assert_array_equal(movement(np.array([-1.0]), 2.0), -movement(np.array([1.0]), 2.0))
    assert np.all(movement(np.linspace(-3, 3, 7), 0.0) == 0.0)


def test_the_last_part_is_the_movement_of_the_rudder():
    made, episodes = sailed("pid", scenario("heading_keeping", duration=60.0), price=0.5)
    moved = np.degrees(np.diff(np.stack([e["delta"] for e in episodes], axis=1), axis=0))
    np.testing.assert_allclose(made[:, -1], movement(moved, 0.5), atol=1e-9)


def test_task_without_residuals_is_refused():
    batch = begin([1], "heading_keeping", parallel=False)
    batch.task = dataclasses.replace(batch.task, headline="return")
    with pytest.raises(ConfigError, match="has no residuals; allowed are tasks whose headline"):
        residuals_of(batch, OPTIONS)


def test_economy_counts_delivered_energy_and_late_arrivals():
    batch = begin(SEEDS, "track_economy", parallel=False)
    controller = make_controller("just_in_time")
    controller.reset(batch.n, batch.ship, batch.scenario)
    residuals = residuals_of(batch, dataclasses.replace(OPTIONS, price=0.0))
    made, energy, arrival = [], np.zeros(batch.n), np.zeros(batch.n)
    for k in range(batch.scenario.steps):
        sailing = residuals.sailing
        residuals.begin()
        batch.step(controller.act(batch.observations))
        made.append(residuals.end())
        energy = np.where(sailing, batch.energy, energy)
        arrival = np.where(sailing, k + 1, arrival)
    made = np.array(made)
    assert np.all(arrival < batch.scenario.steps), "all arrive"
    delivered = (made[:, 0] ** 2).sum(axis=0) * batch.dt
    ratio = delivered / energy  # the power at self-propulsion, one over it
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)
    late = np.maximum(arrival / batch.scenario.steps - 0.98, 0.0)
    found = (made[:, 1] ** 2).sum(axis=0) / batch.scenario.steps
    np.testing.assert_allclose(found, (10.0 * late) ** 2, atol=1e-12)
