"""Searches for hyperparameters, their training replaced by a formula where it is not the matter."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training import agent_search, search_confirm
from ship_gym_agents.training.agent_search import search, trials_of
from ship_gym_agents.training.score import Validation
from ship_gym_agents.training.search_plan import Plan
from ship_gym_agents.training.search_result import ranked, report
from ship_gym_agents.training.search_space import Range

from ship_gym.config import ConfigError

pytest.importorskip("optuna")
pytest.importorskip("stable_baselines3")

RANGES = {
    "training.learning_rate": Range(1e-4, 1e-2, log=True),
    "network.hidden": Range(choices=([32], [64, 64], [8, 8])),
    "algorithm.n_epochs": Range(2, 12),
}
BEST = 2e-3


def test_a_killed_search_leaves_a_journal_that_can_be_read(tmp_path):
    file = tmp_path / "trials.log"
    agent_search._mend_journal(file)
    file.write_bytes(b'{"op_code": 0}\n{"op_co')
    (tmp_path / "trials.log.lock").symlink_to(file)
    agent_search._mend_journal(file)
    assert file.read_bytes() == b'{"op_code": 0}\n' and os.listdir(tmp_path) == ["trials.log"]
    agent_search._mend_journal(file)
    assert file.read_bytes() == b'{"op_code": 0}\n'


def plan_of(trials, **more):
    return Plan({"algorithm": "ppo", "seed": 3}, RANGES, trials, steps=100, episodes=6, **more)


def score(config):
    """Smallest at `BEST`, with two hidden layers and many epochs."""
    hyper = config.hyperparameters
    near = np.log10(hyper.training.learning_rate / BEST) ** 2
    return 1.0 + near + 0.2 * (len(hyper.network.hidden) == 1) + 0.01 * hyper.algorithm.n_epochs


def sailed(values):
    means = {"J_steady": float(np.mean(values)), "success": 1.0, "rudder_travel": 900.0}
    return Validation(means, {"J_steady": list(values)}, 0.0)


@pytest.fixture
def runs(monkeypatch):
    """Training as a formula with noise of seas; the list has the configs that were trained."""
    done = []

    def trained(plan, given, folder, judging, report=None):
        config = run_config(**given)
        done.append(config)
        seas = np.random.default_rng(judging[0]).normal(0.0, 0.1, len(judging))
        return sailed(score(config) + seas)

    monkeypatch.setattr(agent_search, "trained", trained)
    monkeypatch.setattr(search_confirm, "trained", trained)
    return done


def test_it_begins_with_the_config_and_finds_better(runs, tmp_path):
    plan = plan_of(16)
    found = search(plan, tmp_path)
    assert [trial.number for trial in found] == list(range(16))
    assert runs[0] == run_config(**plan.given)
    best = ranked(found, agent_search.score_of(runs[0].scenario))[0]
    assert best.score < found[0].score - 0.1
    assert abs(np.log10(best.settings["training.learning_rate"] / BEST)) < 0.5
    assert all(len(trial.each) == 6 for trial in found)


def test_it_goes_on_with_more_trials(runs, tmp_path):
    before = search(plan_of(3), tmp_path)
    with pytest.raises(ConfigError, match="holds a search; resume it"):
        search(plan_of(5), tmp_path)
    with pytest.raises(ConfigError, match="cannot resume with other seeds"):
        search(plan_of(5, seeds=2), tmp_path, resume=True)
    after = search(plan_of(5), tmp_path, resume=True)
    assert after[:3] == before and len(after) == 5 and len(runs) == 5


def test_a_trial_that_was_killed_is_proposed_again(runs, tmp_path, monkeypatch):
    seen = []

    def killed(plan, out, trial, settings):
        seen.append(settings)
        raise KeyboardInterrupt

    search(plan_of(2), tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(agent_search, "_sailed_trial", killed)
        with pytest.raises(KeyboardInterrupt):
            search(plan_of(3), tmp_path, resume=True)
    assert len(trials_of(plan_of(3), tmp_path)) == 2
    found = search(plan_of(3), tmp_path, resume=True)
    assert len(found) == 3 and found[2].settings == seen[0]


def test_several_seeds_of_training_make_one_trial(runs, tmp_path):
    found = search(plan_of(2, seeds=3), tmp_path)
    assert [config.seed for config in runs] == [3, 4, 5] * 2
    assert all(len(trial.each) == 18 for trial in found)


def test_what_goes_badly_is_pruned(tmp_path, monkeypatch):
    """After the trials by chance, one that is far worse than the others ends early."""
    count = iter(range(100))

    def trained(plan, given, folder, judging, report=None):
        k = next(count)
        for used in (0.25, 0.5, 0.75):
            report(used, 50.0 if k == 10 else 1.0 + 0.01 * k)
        return sailed(np.full(len(judging), 1.0))

    monkeypatch.setattr(agent_search, "trained", trained)
    found = search(plan_of(12), tmp_path)
    assert [trial.number for trial in found if trial.state == "pruned"][:1] == [8]
    assert found[10].state == "pruned" and found[10].score == 50.0
    assert found[7].state == "complete"


def test_values_that_do_not_go_together_are_told_and_counted(tmp_path, monkeypatch):
    def trained(plan, given, folder, judging, report=None):
        if run_config(**given).hyperparameters.network.hidden == (32,):
            raise ConfigError("too small")
        return sailed(np.full(len(judging), 1.0))

    monkeypatch.setattr(agent_search, "trained", trained)
    found = search(plan_of(12), tmp_path)
    refused = [trial for trial in found if trial.state == "refused"]
    assert len(found) == 12 and refused
    assert all(t.note == "too small" and t.settings["network.hidden"] == [32] for t in refused)


def test_the_winner_is_confirmed_with_fresh_seeds(runs, tmp_path):
    plan = plan_of(6, confirm=2)
    trials = search(plan, tmp_path)
    best = ranked(trials, agent_search.score_of(runs[0].scenario))[0]
    runs.clear()
    found = list(search_confirm.confirm(plan, tmp_path, best.settings))
    assert [(who, place) for who, place, _ in found] == [
        ("best", 0), ("before", 0), ("best", 1), ("before", 1),
    ]  # fmt: skip
    assert {config.seed for config in runs} == {1003, 1004}
    result = report(plan, trials, tmp_path, found)
    assert result["confirmed"]["verdict"] == "better"
    assert "confirmed with fresh seeds" in result["text"]
    runs.clear()
    assert list(search_confirm.confirm(plan, tmp_path, best.settings)) == found and not runs
    assert list(search_confirm.confirm(plan, tmp_path, {})) == []


def test_episodes_without_a_score_are_refused_at_once(runs, tmp_path):
    plan = plan_of(1)
    short = {**plan.given, "overrides": {"duration": 60.0}}
    with pytest.raises(ConfigError, match="duration = 60 s: an episode has no J_steady"):
        search(Plan(short, RANGES, steps=1), tmp_path)
    assert not runs


def test_another_process_is_refused(runs, tmp_path):
    from ship_gym_agents.training.search_plan import held

    with held(tmp_path), pytest.raises(ConfigError, match="searches in this folder"):
        search(plan_of(1), tmp_path)


SMALL = ["--envs", 4, "--set", "duration=300", "training.validations=2", "algorithm.n_steps=8"]
SMALL += ["--minutes", 0.002, "--episodes", 4, "--confirm", 0, "--ranges", "ranges.toml"]


@pytest.fixture
def small(tmp_path):
    (tmp_path / "ranges.toml").write_text(
        "[training]\nlearning_rate = { low = 1e-4, high = 1e-3, log = true }\n"
    )
    program = "from ship_gym_agents.cli import main; main()"
    return [sys.executable, "-c", program, "tune-agent", *map(str, SMALL), "--out", "out"]


@pytest.mark.slow
@pytest.mark.compiled
@pytest.mark.parametrize("engine", ["local", "ray"])
def test_processes_share_a_search(small, tmp_path, engine):
    pytest.importorskip("ray" if engine == "ray" else "optuna")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [*small, "--trials", "3", "--jobs", "2", "--engine", engine, "--json"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert sorted(trial["number"] for trial in found["trials"]) == [0, 1, 2]
    rates = {trial["settings"]["training.learning_rate"] for trial in found["trials"]}
    assert len(rates) == 3 and 0.0005 in rates
    assert not list(tmp_path.glob("out/trials/*/*/checkpoint"))


@pytest.mark.slow
@pytest.mark.compiled
def test_a_kill_keeps_what_had_ended(small, tmp_path):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    options = {"cwd": tmp_path, "env": environment, "stdout": subprocess.PIPE, "text": True}
    running = subprocess.Popen([*small, "--trials", "50"], stderr=subprocess.PIPE, **options)
    told = [running.stderr.readline() for _ in range(2)]
    time.sleep(0.5)
    os.kill(running.pid, signal.SIGKILL)
    running.communicate()
    assert all(line.startswith("trial ") for line in told)
    count = sum(1 for line in told)
    resumed = [*small, "--trials", "4", "--resume", "--json"]
    done = subprocess.run(resumed, stderr=subprocess.PIPE, **options)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["trials"]
    assert len(found) >= 4 and [trial["number"] for trial in found][:count] == [0, 1]
