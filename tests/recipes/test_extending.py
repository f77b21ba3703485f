"""The recipes of docs/extending.md, each applied to a copy of the packages and sailed there."""

import json
import re

import pytest
from ship_gym_agents import make_controller
from ship_gym_agents.cli import main
from ship_gym_agents.tuning.objective import episode_costs

from tests.recipes.recipe import EXTENDING, ROOT, apply, copied, run

SAIL = """
import json
import gymnasium as gym
import numpy as np
import ship_gym
from ship_gym.evaluation import metrics, rollout
from ship_gym_agents import make_controller

def sailed(name, scenario, **more):
    run = rollout(make_controller(name), scenario, seeds=[1], overrides={"duration": 20.0} | more)
    return metrics(run.trajectory(0))

def step(env_id, **more):
    env = gym.make(env_id, **more)
    env.reset(seed=1)
    seen, reward, _, _, info = env.step(np.zeros(env.action_space.shape, np.float32))
    return seen.tolist(), reward, info["reward_terms"]
"""


def sail(code, folder):
    return json.loads(run(f"{SAIL}\nprint(json.dumps({code}))", folder))


def test_the_table_counts_the_files_of_each_recipe():
    text = EXTENDING.read_text(encoding="utf-8")
    heads = re.findall(r"^## (.*)$", text, re.M)
    links = re.findall(r"^\| \[(.*?)\]\(#(.*?)\)", text, re.M)
    assert sorted(head.lower() for head in heads) == sorted(name for name, _ in links)
    assert all(anchor == name.replace(" ", "-") for name, anchor in links)


def test_a_controller_is_one_file(tmp_path):
    assert apply("A controller", tmp_path) == {"heading_hold.py"}
    copied(tmp_path)
    own = f"{tmp_path / 'heading_hold.py'}:HeadingHold"
    code = f"[sailed({own!r}, 'heading_keeping', control=c) for c in ('rudder', 'rudder+rpm')]"
    still = "sailed('constant', 'heading_keeping')"
    held, with_rpm, nothing = sail(f"[*{code}, {still}]", tmp_path)
    assert held["rms_error"] < nothing["rms_error"]
    assert with_rpm["rms_error"] < nothing["rms_error"]


def test_a_controller_that_can_be_tuned_is_one_file(tmp_path, capsys):
    pytest.importorskip("optuna")
    assert apply("A controller that can be tuned", tmp_path) == {"tuned_hold.py"}
    own, out = f"{tmp_path / 'tuned_hold.py'}:TunedHold", str(tmp_path / "hold.toml")
    words = ["tune", "--controllers", own, "--ship", "kcs", "--out", out, "--episodes", "4"]
    words += ["--generations", "3", "--candidates", "6", "--polish", "0", "--set", "duration=120"]
    main(words)
    assert "12 validation seeds" in capsys.readouterr().out
    costs = [episode_costs(make_controller(name), [500_000]) for name in (own, out)]
    assert costs[0] != costs[1]


def test_a_task_from_outside_is_one_file_and_the_one_under_test(tmp_path):
    assert apply("A task from outside", tmp_path) == {"hold_yaw_rate.py"}
    ours = ROOT / "tests" / "recipes" / "hold_yaw_rate.py"
    assert (tmp_path / "hold_yaw_rate.py").read_text() == ours.read_text()


def test_a_task_of_the_package_is_one_folder_and_one_scenario(tmp_path):
    folder = copied(tmp_path)
    touched = apply("A task of the package", folder)
    assert {name for name in touched if not name.startswith("ship_gym/tasks/speed/")} == {
        "ship_gym/scenarios/speed_keeping.toml"
    }
    (seen, reward, terms), found, page = sail(
        "[step('ShipGym/SpeedKeeping-v0'), sailed('constant', 'speed_keeping'), "
        "ship_gym.SpeedKeeping.__doc__]",
        folder,
    )
    assert len(seen) == 9 and reward == pytest.approx(sum(terms.values()), rel=1e-12)
    assert next(iter(terms)) == "speed_error" and terms["speed_error"] < 0.0
    assert 0.0 < found["rms_speed_error"] < 1.0 and "rudder_travel" in found
    assert "Keep the nominal speed" in page and "- `speed_error`: -1 (u / U0 - 1)^2" in page


@pytest.mark.slow
def test_a_sensor_is_two_files_and_no_controller_notices(tmp_path):
    folder = copied(tmp_path)
    code = (
        "[step('ShipGym/TrackFollowing-v0')[0], sailed('ilos', 'track_following'), "
        "sailed('pid', 'heading_keeping')]"
    )
    before = sail(code, folder)
    assert apply("A sensor", folder) == {
        "ship_gym/tasks/sensors.py",
        "ship_gym/tasks/bridge.py",
    }
    after = sail(code, folder)
    # a column in the middle; all others as they were
    assert len(after[0]) == len(before[0]) + 1 and 0.5 < after[0][3] < 1.5
    assert after[0][:3] + after[0][4:] == before[0]
    # ILOS and PID steer to the last bit as before: they read by name
    assert after[1:] == before[1:]


def test_a_policy_refuses_observations_that_it_was_not_trained_with(tmp_path):
    folder = copied(tmp_path)
    apply("A sensor", folder)
    told = run(
        f"{SAIL}\ntry:\n    sailed('ppo_kcs', 'heading_keeping')\n"
        "except ship_gym.config.ConfigError as error:\n    print(error)",
        folder,
    )
    assert "policy ppo_kcs: made for other features" in told and "over_ground new" in told


@pytest.mark.slow
def test_a_reward_term_is_one_file(tmp_path):
    folder = copied(tmp_path)
    assert apply("A reward term", folder) == {"ship_gym/tasks/rewards.py"}
    weights = ("{}", "{'reward.turning': 2.0, 'start.heading_error_deg': 0.0}")
    code = ", ".join(f"step('ShipGym/TrackFollowing-v0', overrides={w})" for w in weights)
    off, on = sail(f"[{code}]", folder)
    assert list(off[2]) == ["cross_track", "rudder", "rudder_rate", "speed_loss", "turning",
                            "termination"]  # fmt: skip
    assert off[2]["turning"] == 0.0 and on[2]["turning"] < 0.0
    assert on[1] == pytest.approx(sum(on[2].values()), rel=1e-12)
    found = sail("sailed('constant', 'heading_keeping', **{'reward.turning': 1e6})", folder)
    assert found["return"] < -50.0
