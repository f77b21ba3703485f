"""The card says what was run, how it went and how to run it again, and nothing made up."""

from __future__ import annotations

import math
import shlex

import numpy as np
import pytest

from ship_gym.recording import Trajectory
from ship_gym.recording.card import again, card_text, metric_rows, run_name

SHIP = {"name": "kcs", "title": "KRISO container ship", "scale": 1.0, "L": 230.0}
META = {
    "task": "heading_keeping",
    "scenario": "drill_thrust_loss",
    "overrides": {"sea": {"states": ["ss6"]}, "sensors": {"noise": False}, "ship": "kcs"},
    "config": {"task": "heading_keeping", "ship": "kcs", "control": "rudder"},
    "controller": "ppo",
    "policy": {"file": "runs/my policy/policy.zip", "sha256": "0123456789abcdef" * 4},
    "seed": 7,
    "ship": SHIP,
    "sea": {"wave_height": 4.87, "wave_period": 12.4, "wave_direction_to": math.radians(100.0),
            "wind_speed": 17.35, "wind_direction_to": math.radians(100.0)},
    "outcome": "heading limit",
    "failed": True,
    "metrics": {"J_1": 12.345678, "settling_time": None, "success": 0.0},
    "units": {"J_1": "deg2", "settling_time": "s", "success": "-"},
    "versions": {"python": "3.11.7", "ship-gym": "0.1.0", "numpy": "2.4.6"},
    "git_commit": "0123456789" * 4 + "-dirty",
}  # fmt: skip


def run(**changes) -> Trajectory:
    t = np.arange(11) * 10.0
    columns = {"t": t, "psi": 0.01 * t, "psi_ordered": 0.0 * t}
    columns |= {"current_speed": 0.5 + 0.0 * t, "current_direction_to": 0.5 * math.pi + 0.0 * t}
    return Trajectory(columns, {**META, **changes})


def rows(text: str) -> list[list[str]]:
    return [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]


def test_card_has_ship_sea_controller_seed_outcome_and_metrics():
    text = card_text(run())
    assert text.startswith("# drill_thrust_loss, kcs\n")
    assert "**Failed: heading limit** after 100 s." in text
    found = dict(row for row in rows(text) if len(row) == 2)
    assert found["Ship"] == "KRISO container ship"
    assert found["Waves"] == "H 4.87 m, T 12.4 s, from 280\N{DEGREE SIGN}"
    assert found["Wind"] == "17.4 m/s from 280\N{DEGREE SIGN}"
    assert found["Current"] == "0.5 m/s to 090\N{DEGREE SIGN}"
    assert found["Task"] == "heading_keeping, scenario drill_thrust_loss"
    assert found["Controller"] == "ppo: runs/my policy/policy.zip, sha256 0123456789ab"
    assert found["Seed"] == "7"
    assert found["Recorded"] == "100 s, 11 rows"
    assert ["J_1", "12.346", "deg2"] in rows(text)
    assert ["settling_time", "-", "s"] in rows(text)
    assert "commit 0123456789-dirty" in text
    assert '"sea"' not in text  # no dump


def test_card_has_the_marks_with_their_times():
    found = dict(row for row in rows(card_text(run())) if len(row) == 2)
    assert found["100 s"] == "heading limit: the episode has failed"


def test_card_of_an_incomplete_run_says_so():
    text = card_text(run(complete=False, outcome=None, failed=None))
    assert "**Incomplete**: the recording breaks off after 100 s." in text


def test_card_of_a_model_has_both_times():
    text = card_text(run(ship=SHIP | {"scale": 100.0}))
    assert "| Recorded | 100 s of the model, 1000 s at full scale, 11 rows |" in text


def test_command_sails_it_again():
    words = shlex.split(again(run().meta))
    assert words[:2] == ["ship-gym", "record"]
    given = dict(zip(words[2:12:2], words[3:12:2], strict=True))
    assert given == {
        "--controller": "runs/my policy/policy.zip",
        "--scenario": "drill_thrust_loss",
        "--ship": "kcs",
        "--control": "rudder",
        "--seed": "7",
    }
    assert words[12:] == ["--set", 'sea.states=["ss6"]', "sensors.noise=false"]


@pytest.mark.parametrize("missing", ["seed", "scenario", "config"])
def test_no_command_is_made_up(missing):
    assert again({key: value for key, value in META.items() if key != missing}) == ""


def test_policy_of_the_package_is_called_by_its_name_and_shown_short():
    policy = {"file": "/opt/site/ship_gym_agents/pretrained/ppo.safetensors", "sha256": "ab" * 32}
    meta = META | {"policy": policy}
    assert "--controller ppo " in again(meta)
    assert "ppo: .../pretrained/ppo.safetensors, sha256 abababababab" in card_text(
        run(policy=policy)
    )


def test_program_of_one_s_own_has_no_command():
    assert again(META | {"policy": {"file": "mine.py", "sha256": "ab"}}) == ""


def test_a_task_of_one_s_own_is_called_by_its_file():
    own = META | {"task": "hold", "scenario": "hold", "task_file": "my tasks/hold.py:HOLD"}
    words = shlex.split(again(own))
    assert words[4:6] == ["--task", "my tasks/hold.py:HOLD"] and "--scenario" not in words
    assert "--scenario rough.toml" in again(own | {"scenario": "rough.toml"})
    assert again(own | {"task_file": ""}) == ""  # registered in Python, which no command can


def test_angles_among_metrics_are_in_degrees():
    meta = {"metrics": {"drift": math.pi / 4.0, "turn": None}, "units": {"drift": "rad"}}
    assert [*metric_rows(meta)] == [["drift", "45", "deg"], ["turn", "-", ""]]


def test_given_command_comes_first():
    assert again(META | {"command": "ship-gym record --seed 1"}) == "ship-gym record --seed 1"


def test_metrics_without_units_are_shown():
    assert [*metric_rows({"metrics": {"J": 1.5, "n": 2}})] == [["J", "1.5", ""], ["n", "2", ""]]


def test_name_of_a_run_is_that_of_its_scenario():
    assert run_name(META) == "drill_thrust_loss, kcs, ppo, seed 7"
    assert run_name(META | {"scenario": "/home/me/beam sea.toml"}).startswith("beam sea, kcs")
    assert run_name({key: META[key] for key in ("task", "ship")}) == "heading_keeping, kcs"
    assert run_name({"config": {"manoeuvre": "zigzag"}, "task": "zigzag", "seed": 0}) == "zigzag"


def test_card_of_a_manoeuvre_has_its_orders_and_waves():
    sea = {"regular": {"amplitude": 1.5, "omega": 0.5}, "wave_direction_to": math.pi, "waves": []}
    config = {"manoeuvre": "turning_circle", "delta": math.radians(35.0), "speed": 7.5, "sea": sea}
    meta = {"task": "turning_circle", "config": config, "ship": SHIP, "seed": 0}
    text = card_text(Trajectory(run().columns, meta))
    assert "| Task | turning_circle, rudder 35 deg, approach 7.5 m/s |" in text
    assert "| Waves | regular, H 3 m, T 12.6 s, from 000\N{DEGREE SIGN} |" in text
    assert "Seed" not in text
    systems = [{"height": 3.0, "peak_period": 9.0}, {"height": 4.0, "peak_period": 14.0}]
    config["sea"] = {"regular": None, "waves": systems}
    assert "| Waves | H 5 m, T 14 s, from 180\N{DEGREE SIGN} |" in card_text(
        Trajectory(run().columns, meta)
    )


def test_bare_recording_has_a_card():
    assert card_text(Trajectory({"t": [0.0, 1.0]})).startswith("# Ship Gym run\n")
