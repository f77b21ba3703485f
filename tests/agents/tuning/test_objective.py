from types import SimpleNamespace

import pytest
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.tuning import objective
from ship_gym_agents.tuning.objective import episode_costs, objective_of

from ship_gym.config import ConfigError
from ship_gym.evaluation.comparison import per_episode
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.rollout import rollout
from ship_gym.tasks import TASKS

WEAK, HARD_OVER = PID(Gains(1.0, 1.0, 0.2, -0.5)), ConstantController(1.0)
TRACK = {"track.legs": 2, "track.leg_min": 3.0, "track.leg_max": 3.0, "duration": 900.0}
CASES = [
    ("heading_keeping", WEAK, {"duration": 120.0}),
    ("heading_keeping", HARD_OVER, {"duration": 240.0}),  # fails
    ("course_changing", WEAK, {"duration": 400.0}),
    ("course_changing", HARD_OVER, {"duration": 600.0}),  # fails
    ("track_following", DriftLOS(), TRACK),  # arrives
    ("track_following", HARD_OVER, {"limits.cross_track": 1.5, "duration": 600.0}),  # fails
]


@pytest.mark.parametrize(("scenario", "controller", "overrides"), CASES)
def test_costs_of_tuning_are_the_metrics(scenario, controller, overrides):
    env = {"scenario": scenario, "overrides": overrides, "seeds": [1, 2]}
    sailed = rollout(controller, **env)
    expected = objective_of(sailed.scenario.task).of(per_episode(sailed))
    assert episode_costs(controller, **env) == pytest.approx(expected, rel=1e-12)
    assert sailed.failed.all() == (controller is HARD_OVER)


def test_what_tasks_are_tuned_for(monkeypatch):
    assert objective_of("heading_keeping").name == "J_0.1"
    track = objective_of("track_following")
    assert track.of({"rms_route": [0.2], "rudder_travel": [1000.0]}) == pytest.approx(0.22)
    course = objective_of("course_changing")
    assert course.name == "settling_time" and course.beside == ("overshoot", "J_0.1")
    rows = {"settling_time": [80.0, 30.0], "rudder_travel": [1000.0, 1000.0], "success": [1.0, 0.0]}
    assert course.of(rows) == pytest.approx([85.0, 245.0])  # failing early is not settling early
    known = {"mine": SimpleNamespace(metrics={}), "heading_keeping": TASKS["heading_keeping"]}
    monkeypatch.setattr(objective, "TASKS", known)
    with pytest.raises(ConfigError, match=r"task 'mine'.*allowed are heading_keeping"):
        objective_of("mine")


def test_a_track_whose_reward_does_not_see_it_is_refused():
    with pytest.raises(ConfigError, match=r"reward.cross_track = 0.0.*positive weight"):
        episode_costs(
            DriftLOS(), [1], scenario="track_following", overrides={"reward.cross_track": 0.0}
        )
