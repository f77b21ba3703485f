"""Ranges of hyperparameters: read, checked against the config, and kept as train takes them."""

import dataclasses

import pytest
from ship_gym_agents.sb3.config import OPTIONS, load_hyperparameters, run_config
from ship_gym_agents.training.search_plan import Plan, Trial
from ship_gym_agents.training.search_result import BEST_FILE, TABLE_FILE, report
from ship_gym_agents.training.search_space import load_ranges, start_of, with_settings

from ship_gym.config import ConfigError

FORM = {"action": "residual", "base": "pid", "scale": 0.3, "features": ["observer"]}


@pytest.mark.parametrize("algorithm", OPTIONS)
def test_the_package_has_ranges_for_each_algorithm(algorithm):
    """Every end and choice is allowed, and the package's own values lie inside."""
    on_base = algorithm == "gauss_newton"  # which corrects an autopilot
    given = {"algorithm": algorithm} | ({"hyperparameters": {"form": FORM}} if on_base else {})
    ranges = load_ranges(algorithm, None, given)
    assert ranges and any(name.startswith("form.") for name in ranges) == on_base
    assert set(start_of(ranges, given)) >= set(ranges) - {"algorithm.price"}


def test_keys_of_the_form_count_with_a_base():
    given = {"algorithm": "ppo", "hyperparameters": {"form": FORM}}
    assert "form.scale" in load_ranges("ppo", None, given)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "names no range"),
        ("[train]\nx = { low = 1, high = 2 }", "did you mean 'training'"),
        ("[training]\ngama = { low = 0.9, high = 0.95 }", "did you mean 'gamma'"),
        ("[training]\ngamma = 0.9", "training.gamma = 0.9: must be low, high or choices"),
        ("[training]\ngamma = { low = 0.9, hihg = 0.95 }", "did you mean 'high'"),
        ("[training]\ngamma = { low = 0.9 }", "needed are low < high"),
        ("[training]\ngamma = { low = 0.99, high = 0.9 }", "needed are low < high"),
        ("[training]\ngamma = { low = 0.9, high = 1.1 }", "training.gamma with 1.1"),
        ("[training]\ngamma = { low = 0.0, high = 0.9, log = true }", "allowed is low above 0"),
        ("[network]\nactivation = { choices = ['tanh', 'rellu'] }", "did you mean 'relu'"),
        ("[training]\ngamma = { choices = [0.9], low = 0.1 }", "one or the other"),
        ("[training]\ngamma = { low = 'a', high = 'b' }", "must be"),
    ],
)
def test_ranges_that_are_none_are_refused(tmp_path, text, words):
    file = tmp_path / "ranges.toml"
    file.write_text(text)
    with pytest.raises(ConfigError) as error:
        load_ranges("ppo", file, {"algorithm": "ppo"})
    assert words in str(error.value) and "ranges.toml" in str(error.value)


SETTINGS = {"training.learning_rate": 1.5e-3, "network.hidden": [32, 32], "algorithm.n_epochs": 3}


def test_the_file_of_the_best_is_what_was_trained(tmp_path):
    """Also keys that all trials shared, and tables, come back; what is the package's does not."""
    given = {
        "algorithm": "ppo",
        "envs": 17,
        "settings": {"training.overrides": {"sea.states": ["ss5"]}, "training.gamma": 0.99},
    }
    plan = Plan(given, load_ranges("ppo", None, given), trials=2, steps=1)
    means = {"rudder_travel": 1.0, "success": 1.0}
    trials = [
        Trial(0, "complete", {**SETTINGS, "algorithm.n_epochs": 4}, 2.0, [1.0, 3.0], means),
        Trial(1, "complete", SETTINGS, 1.0, [0.5, 1.5], means),
        Trial(2, "pruned", SETTINGS, 9.0, [], {}),
        Trial(3, "refused", SETTINGS, None, [], {}, "too small"),
    ]
    found = report(plan, trials, tmp_path)
    assert found["best"]["number"] == 1 and "(1 pruned, 1 refused)" in found["text"]
    read = load_hyperparameters("ppo", tmp_path / BEST_FILE)
    wanted = run_config(**with_settings(given, SETTINGS)).hyperparameters
    assert dataclasses.asdict(read) == dataclasses.asdict(wanted)
    text = (tmp_path / BEST_FILE).read_text()
    assert "envs = 17" in text and "gamma" not in text
    rows = (tmp_path / TABLE_FILE).read_text().splitlines()
    assert len(rows) == 5 and rows[4].endswith("too small")
    assert (tmp_path / "trials.png").stat().st_size > 5000


def test_without_a_complete_trial_there_is_no_best(tmp_path):
    given = {"algorithm": "ppo"}
    plan = Plan(given, load_ranges("ppo", None, given), steps=1)
    with pytest.raises(ConfigError, match="no trial is complete: too small"):
        report(plan, [Trial(0, "refused", SETTINGS, None, [], {}, "too small")], tmp_path)
