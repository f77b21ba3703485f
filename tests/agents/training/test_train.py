import csv
import json
import shutil
import sys

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.sb3.config import config_for, load_config, run_config

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.evaluation.rollout import rollout, tuning_seeds
from ship_gym.evaluation.splits import VALIDATION_SEED

pytest.importorskip("stable_baselines3")

import torch
from ship_gym_agents.training.run import Run
from ship_gym_agents.training.run_folder import TrainingFolder
from ship_gym_agents.training.sb3_run import SB3Run
from ship_gym_agents.training.score import validate
from ship_gym_agents.training.seeds import train_seeds
from ship_gym_agents.training.train import train


def begun(config, out, steps, resume=False, init=None):
    """A run with its model, not yet learning."""
    return SB3Run(Run(config, TrainingFolder(out), None, steps, resume), init)


def bounds(card):
    first, last = card["validation_seeds"]
    return first, last + 1


def columns(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_run_folder_and_card(tiny, tmp_path):
    config, out = tiny(), tmp_path / "run"
    card = train(config, out, steps=256, command="ship-gym train --steps 256")
    assert json.loads((out / "card.json").read_text()) == card
    assert load_config(out) == config
    assert card["status"] == "complete" and card["samples"] == 256 and card["used"] == 1.0
    assert [v["samples"] for v in card["validations"]] == [0, 128, 256]
    assert card["best"] in card["validations"]
    assert card["command"] == "ship-gym train --steps 256"
    assert card["versions"]["stable-baselines3"] and card["git_commit"]
    assert set(card["final"]["references"]) == {"pid", "adaptive"}
    low, high = card["validation_seeds"]
    assert VALIDATION_SEED == low < high < card["final"]["seeds"][0] < tuning_seeds(1)[0]
    assert [row["samples"] for row in columns(out / "curve.csv")] == ["0", "128", "256"]
    assert (out / "curve.png").read_bytes().startswith(b"\x89PNG")
    assert not list(out.rglob(".*")), "temporary files are left"
    policy = load_policy(out)
    assert isinstance(policy, Controller) and policy.card["best"] == card["best"]
    assert policy.card["final"] == card["final"] and policy.name == "ppo-run"
    refused(config, out, card)


def refused(config, out, card):
    """What a folder with a complete run refuses."""
    with pytest.raises(ConfigError, match="holds a run"):
        train(config, out, steps=512)
    with pytest.raises(ConfigError, match="used up"):
        train(config, out, steps=256, resume=True)
    with pytest.raises(ConfigError, match="another config"):
        train(run_config(seed=3), out, steps=512, resume=True)
    with pytest.raises(ConfigError, match="budget is needed"):
        train(config, out.with_name("nothing"))
    with pytest.raises(ConfigError, match="leave out: seed"):
        config_for(out, True, {"seed": 1})
    assert json.loads((out / "card.json").read_text()) == card
    assert not (out.with_name("nothing") / "card.json").exists()


@pytest.mark.parametrize("kill", [KeyboardInterrupt, MemoryError])
def test_a_run_that_is_killed_in_its_end_goes_on_to_it(tiny, tmp_path, monkeypatch, kill):
    from ship_gym_agents.training import train as module

    def killed(*_):
        raise kill

    out, judge = tmp_path / "run", module.judge
    monkeypatch.setattr(module, "judge", killed)
    with pytest.raises(kill):
        train(tiny(), out, steps=256)
    before = json.loads((out / "card.json").read_text())
    assert before["status"] != "complete" and before["used"] == 1.0
    monkeypatch.setattr(module, "judge", judge)
    card = train(tiny(), out, steps=256, resume=True)
    assert card["status"] == "complete" and card["samples"] == 256 and card["final"]
    assert card["validations"] == before["validations"] and card["best"] == before["best"]
    with pytest.raises(ConfigError, match="used up"):
        train(tiny(), out, steps=256, resume=True)


def test_validation_seas_are_not_trained_on(tiny, tmp_path):
    run = begun(tiny(), tmp_path / "run", 10)
    assert max(run.model.get_env().unwrapped._seeds) < VALIDATION_SEED


def same_state(one, two):
    """Whether two models have the same weights, optimisers, entropy and normalisers."""
    a, b = one.get_parameters(), two.get_parameters()
    assert a.keys() == b.keys()
    for key in a:
        left, right = (torch.cat(_tensors(p[key])) for p in (a, b))
        assert torch.equal(left, right), key
    for name in ("obs_rms", "ret_rms"):
        left, right = (getattr(m.get_vec_normalize_env(), name) for m in (one, two))
        np.testing.assert_array_equal(left.mean, right.mean)
        np.testing.assert_array_equal(left.var, right.var)
        assert left.count == right.count


def _tensors(state):
    """All tensors of a nested state, flat and as float."""
    if isinstance(state, torch.Tensor):
        return [state.detach().double().flatten()]
    items = state.values() if isinstance(state, dict) else state
    if not isinstance(items, list | tuple | type({}.values())):
        return []
    return [t for item in items for t in _tensors(item)]


@pytest.mark.parametrize(
    "algorithm",
    [
        "ppo",
        pytest.param("sac", marks=pytest.mark.slow),
        pytest.param("td3", marks=pytest.mark.slow),
    ],
)
def test_resume_begins_where_the_run_ended(tiny, tmp_path, algorithm):
    out, config = tmp_path / "run", tiny(algorithm)
    first = begun(config, out, 256)
    first.learn(None, None)
    resumed = begun(config, out, 512, resume=True)
    same_state(first.model, resumed.model)
    assert resumed.model.num_timesteps == first.model.num_timesteps >= 256
    assert resumed.run.validations == first.run.validations
    assert resumed.run.chosen == first.run.chosen
    if algorithm != "ppo":
        assert resumed.model.replay_buffer.size() == first.model.replay_buffer.size() > 0
    if algorithm == "sac":
        assert torch.equal(resumed.model.log_ent_coef, first.model.log_ent_coef)


def test_resume_continues(tiny, tmp_path):
    out, config = tmp_path / "run", tiny()
    first = train(config, out, steps=256, final=False, command="the first")
    card = train(config, out, steps=512, resume=True, final=False, command="the second")
    assert card["samples"] == 512 and card["seconds"] > first["seconds"]
    assert card["validations"][:3] == first["validations"] and len(card["validations"]) > 3
    assert card["command"] == "the first", "the run is what began it"
    assert load_policy(out).card["best"] == card["best"]


def test_a_resumed_run_explores_with_other_noise_and_other_seas(tiny, tmp_path):
    config = tiny()
    seas = {}
    for name in ("run", "again", "other"):
        run = begun(tiny(seed=1) if name == "other" else config, tmp_path / name, 128)
        seas[name] = list(run.model.get_env().unwrapped._seeds)
    run.learn(None, None)
    resumed = begun(tiny(seed=1), tmp_path / "other", 256, resume=True)
    seas["resumed"] = list(resumed.model.get_env().unwrapped._seeds)
    assert seas["run"] == seas["again"]
    assert len({tuple(each) for each in seas.values()}) == 3


def test_a_run_killed_before_its_first_checkpoint_begins_anew(tiny, tmp_path):
    config, out = tiny(), tmp_path / "run"
    begun(config, out, 128)  # killed here: there is a card, no checkpoint
    assert json.loads((out / "card.json").read_text())["status"] == "running"
    (out / "policy.safetensors").write_bytes(b"left over")
    card = train(config, out, steps=128, resume=True, final=False)
    assert card["status"] == "complete" and card["validations"][0]["samples"] == 0
    load_policy(out)
    other = tmp_path / "nothing"  # killed even before its card
    assert train(config, other, steps=128, resume=True, final=False)["samples"] == 128


def test_the_learning_rate_falls_over_the_budget(tiny, tmp_path):
    config = tiny()
    run = begun(config, tmp_path / "run", 1000)
    run.model.num_timesteps = 500
    start = config.hyperparameters.training.learning_rate
    assert run._learning_rate(1.0) == pytest.approx(0.5 * start)


class Bar:
    """A bar that does something once it has come to `at`."""

    def __init__(self, at, then):
        self.n, self.total, self.at, self.then, self.texts = 0, 100, at, then, []

    def update(self, increment):
        self.n += increment
        if self.n > self.at:
            self.then()

    def set_postfix_str(self, text):
        self.texts.append(text)


def interrupt():
    raise KeyboardInterrupt


def test_interrupted_run_keeps_what_it_had(tiny, tmp_path):
    config, bar = tiny(), Bar(60, interrupt)
    with pytest.raises(KeyboardInterrupt):
        train(config, tmp_path / "run", steps=1024, bar=bar)
    card = json.loads((tmp_path / "run" / "card.json").read_text())
    assert card["status"] == "interrupted" and 600 < card["samples"] < 1024
    assert "samples/s" in bar.texts[0] and "rudder_travel" in bar.texts[0]
    load_policy(tmp_path / "run")
    resumed = train(config, tmp_path / "run", steps=1024, resume=True, final=False)
    assert resumed["status"] == "complete" and resumed["samples"] >= 1024


def test_reports_may_end_a_run(tiny, tmp_path):
    told = []

    def report(share, score):
        told.append((share, score))
        raise RuntimeError("pruned")

    with pytest.raises(RuntimeError, match="pruned"):
        train(tiny(), tmp_path / "run", steps=512, report=report)
    assert told[0][0] == pytest.approx(0.5) and len(told) == 1
    assert json.loads((tmp_path / "run" / "card.json").read_text())["status"] == "stopped"


def test_time_of_training_is_what_a_budget_counts(tiny, tmp_path):
    card = train(tiny(), tmp_path / "timed", minutes=0.02, final=False)
    assert 1.2 <= card["seconds"] < 3.0 and card["samples"] > 0
    assert card["validation_seeds"][1] - VALIDATION_SEED + 1 in (2, 4)


def test_the_same_seed_gives_the_same_run(tiny, tmp_path):
    one, two, other = (
        train(tiny(seed=seed), tmp_path / name, steps=128, final=False)["validations"][-1]["return"]
        for name, seed in (("one", 1), ("two", 1), ("other", 2))
    )
    assert one == two != other


def test_a_policy_to_begin_with(tiny, tmp_path):
    first = begun(tiny(), tmp_path / "first", 256)
    first.learn(None, None)
    init = tmp_path / "first" / "policy.safetensors"
    second = begun(tiny(seed=5), tmp_path / "second", 256, init=init)
    bridge = np.random.default_rng(0).normal(0.0, 0.5, (5, len(load_policy(init).normaliser.mean)))
    theirs = load_policy(init).network(load_policy(init).normaliser(bridge))
    ours = second.policy().network(second.policy().normaliser(bridge))
    np.testing.assert_allclose(ours, theirs, atol=1e-5)


def test_a_price_with_a_limit_decides_what_is_chosen(tiny, tmp_path):
    price = {"form": {"action": "residual", "base": "pid", "scale": 0.1}}
    price["price"] = {"limit": "base", "rate": 0.01}
    out = tmp_path / "run"
    card = train(tiny(more=price), out, steps=128, final=False)
    own = validate(make_controller("pid"), tiny().scenario, range(*bounds(card)))
    assert f"rudder travel up to {own.means['rudder_travel']:.4g} deg/h" in card["score"]
    assert all(v["multiplier"] >= 0.0 for v in card["validations"] if "multiplier" in v)
    assert "multiplier" in columns(out / "curve.csv")[-1]


def test_what_is_refused_leaves_the_folder_free(tiny, tmp_path):
    track = {"form": {"action": "residual", "base": "drift_los"}}  # cannot steer a heading
    with pytest.raises(ConfigError, match="drift_los"):
        train(tiny(more=track), tmp_path / "run", steps=64)
    with pytest.raises(ConfigError, match="no such policy"):
        train(tiny(), tmp_path / "run", steps=64, init=tmp_path / "none.safetensors")
    with pytest.raises(ConfigError, match="drift_los"):
        train_seeds(tiny(more=track), tmp_path / "run", 2, steps=64)
    assert not (tmp_path / "run" / "card.json").exists()


def test_missing_extra_is_one_clear_line(monkeypatch, tiny, tmp_path):
    config = tiny()
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(ImportError, match=r'pip install "ship-gym\[rl\]"'):
        train(config, tmp_path / "run", steps=64)
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_half_a_minute_of_training_beats_doing_nothing(tmp_path):
    """Under the slow disturbance; in waves it takes a minute, see ship_gym_agents/pretrained."""
    config = run_config(scenario="heading_slow_disturbance")
    card = train(config, tmp_path / "run", steps=600_000)
    policy, seeds = load_policy(tmp_path / "run"), range(VALIDATION_SEED, VALIDATION_SEED + 16)
    nothing = rollout(ConstantController(), config.scenario, seeds=seeds)
    assert card["best"]["success"] == 1.0
    assert nothing.terminated.mean() > 0.5
    assert validate(policy, config.scenario, seeds).means["J_steady"] < 15.0  # nothing: about 1700


def test_a_resumed_run_keeps_the_policy_it_began_with(tiny, tmp_path):
    init = tmp_path / "first"
    train(tiny(), init, steps=64, final=False)
    with pytest.raises(ConfigError, match="no such policy"):
        train(tiny(), tmp_path / "none", steps=64, init=tmp_path / "nothing")
    assert not (tmp_path / "none" / "card.json").exists(), "refused before any work"
    out = tmp_path / "run"
    train(tiny(), out, steps=128, init=init, final=False)
    card = train(tiny(), out, steps=256, resume=True, final=False)
    assert card["init"] == str(init)
    with pytest.raises(ConfigError, match=r"init = other: a resumed run began with .*first"):
        train(tiny(), out, steps=512, resume=True, init="other")
    next(out.glob("checkpoint/*/model.zip")).write_bytes(b"damaged")
    with pytest.raises(ConfigError, match="damaged"):
        train(tiny(), out, steps=512, resume=True)
    assert json.loads((out / "card.json").read_text()) == card, "still the complete run that it was"
    shutil.rmtree(out / "checkpoint")  # as if killed before the first one
    again = train(tiny(), out, steps=64, resume=True, final=False)
    first = train(tiny(), tmp_path / "same", steps=64, init=init, final=False)
    assert again["init"] == str(init)
    assert again["validations"][0]["return"] == first["validations"][0]["return"]


def test_seeds_that_are_resumed_begin_with_the_same_policy(tiny, tmp_path):
    init, out = tmp_path / "first", tmp_path / "run"
    train(tiny(), init, steps=64, final=False)
    train_seeds(tiny(), out, 2, steps=64, init=init, final=False)
    shutil.rmtree(out / "seed_1")  # as if killed before it
    train_seeds(tiny(), out, 2, steps=64, resume=True, final=False)
    card = json.loads((out / "seed_1" / "card.json").read_text())
    assert card["init"] == str(init)
