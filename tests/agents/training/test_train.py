import json
import sys
import zipfile

import numpy as np
import pytest
from ship_gym_agents.sb3.config import config_for, load_config, load_hyperparameters, run_config
from ship_gym_agents.sb3.policy import Normaliser, load_policy, save_policy

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.evaluation.rollout import rollout, tuning_seeds
from ship_gym.scenarios import load_scenario
from ship_gym.ships import load_ship
from ship_gym.tasks.bridge import N_BRIDGE

pytest.importorskip("stable_baselines3")

import torch
from ship_gym_agents.sb3.algorithms import explore
from ship_gym_agents.training.train import VALIDATION_SEED, _Run, train, validate

TINY = {
    "training": {"envs": 8, "validations": 2, "episode": 20.0, "threads": 1},
    "network": {"hidden": [8, 8]},
}
OPTIONS = {
    "ppo": {"n_steps": 16, "batch_size": 64, "n_epochs": 2},
    "sac": {"learning_starts": 32, "buffer_size": 500},
    "td3": {"learning_starts": 32, "buffer_size": 500},
}
OBSERVATIONS = np.random.default_rng(0).normal(0.0, 0.5, (5, N_BRIDGE)).astype(np.float32)


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    """Threads of torch that wait for a busy core make tiny networks very slow."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def tiny(algorithm="ppo", **arguments):
    hyper = {**TINY, "algorithm": OPTIONS[algorithm]}
    arguments = {"overrides": {"duration": 20.0}, **arguments}
    return run_config(algorithm, hyperparameters=hyper, **arguments)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A run of two iterations: config, folder, card."""
    out = tmp_path_factory.mktemp("runs") / "tiny"
    config = tiny()
    return config, out, train(config, out, steps=256)


def test_run_folder_and_card(made):
    config, out, card = made
    assert json.loads((out / "card.json").read_text()) == card
    assert load_config(out) == config
    assert card["status"] == "complete" and card["samples"] == 256
    assert [v["samples"] for v in card["validations"]] == [128, 256]
    assert card["best"] in card["validations"]
    assert card["versions"]["stable-baselines3"] and card["git_commit"]
    assert not list(out.rglob(".*")), "temporary files are left"


def test_validation_seas_are_neither_trained_nor_evaluated_on(made):
    config, out, card = made
    low, high = card["validation_seeds"]
    assert VALIDATION_SEED == low < high < tuning_seeds(1)[0]
    run = _Run(config, out.with_name("other"), None, 10, resume=False)
    assert max(run.model.get_env().unwrapped._seeds) < VALIDATION_SEED


@pytest.mark.parametrize("algorithm", ["ppo", "sac", "td3"])
def test_exported_policy_acts_as_the_model(algorithm, tmp_path):
    config = tiny(algorithm, control="rudder+rpm")
    run = _Run(config, tmp_path / "run", None, 192, resume=False)
    run.learn(bar=None)
    run.best = None
    run._validate()  # the last policy instead of the best
    policy = load_policy(tmp_path / "run")
    assert isinstance(policy, Controller)
    normalised = run.model.get_vec_normalize_env().normalize_obs(OBSERVATIONS)
    expected, _ = run.model.predict(normalised, deterministic=True)
    np.testing.assert_allclose(policy.act(OBSERVATIONS), expected, atol=2e-6)


def test_saved_policy_gives_the_same_actions(made, tmp_path):
    policy = load_policy(made[1])
    save_policy(policy, tmp_path / "copy.zip")
    again = load_policy(tmp_path / "copy.zip")
    np.testing.assert_array_equal(policy.act(OBSERVATIONS), again.act(OBSERVATIONS))
    assert again.name == "ppo-tiny"
    rows = np.concatenate([again.act(row[None]) for row in OBSERVATIONS])
    np.testing.assert_allclose(rows, again.act(OBSERVATIONS), atol=1e-12)


def same_state(one, two):
    """Whether two models have the same weights, optimisers, entropy and normalisers."""
    a, b = one.get_parameters(), two.get_parameters()
    assert a.keys() == b.keys()
    for key in a:
        left, right = (torch.nn.utils.parameters_to_vector(_tensors(p[key])) for p in (a, b))
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


@pytest.mark.parametrize("algorithm", ["ppo", "sac", "td3"])
def test_resume_begins_where_the_run_ended(tmp_path, algorithm):
    out, config = tmp_path / "run", tiny(algorithm)
    first = _Run(config, out, None, 256, resume=False)
    first.learn(None)
    resumed = _Run(config, out, None, 512, resume=True)
    same_state(first.model, resumed.model)
    assert resumed.model.num_timesteps == first.model.num_timesteps >= 256
    assert resumed.validations == first.validations
    if algorithm != "ppo":
        assert resumed.model.replay_buffer.size() == first.model.replay_buffer.size() > 0
    if algorithm == "sac":
        assert torch.equal(resumed.model.log_ent_coef, first.model.log_ent_coef)


def test_resume_continues(tmp_path):
    out, config = tmp_path / "run", tiny()
    first, before = train(config, out, steps=256), load_policy(out)
    card = train(config, out, steps=512, resume=True)
    assert card["samples"] == 512 and card["seconds"] > first["seconds"]
    assert card["validations"][:2] == first["validations"] and len(card["validations"]) > 2
    if card["best"] in first["validations"]:
        np.testing.assert_array_equal(load_policy(out).act(OBSERVATIONS), before.act(OBSERVATIONS))


def test_a_resumed_run_explores_with_other_noise_and_other_seas(tmp_path):
    config = tiny()
    observation = torch.zeros((4, N_BRIDGE))

    def noise(run):
        policy = run.model.policy
        actions, *_ = policy(observation)
        away = actions - policy.get_distribution(observation).mode()
        return (away / policy.log_std.exp()).detach().numpy()

    run = _Run(config, tmp_path / "run", None, 128, resume=False)
    seas = list(run.model.get_env().venv._seeds)
    begin = noise(run)
    run.learn(None)
    resumed = _Run(config, tmp_path / "run", None, 256, resume=True)
    assert not np.allclose(noise(resumed), begin, atol=1e-3)
    other = _Run(tiny(seed=1), tmp_path / "other", None, 128, resume=False)
    assert list(resumed.model.get_env().venv._seeds) != seas
    assert list(other.model.get_env().venv._seeds) != seas
    assert max(seas) < VALIDATION_SEED and run.model.get_env().venv.stagger


def test_noise_narrows_and_the_learning_rate_falls_over_the_budget(tmp_path):
    config = tiny()
    run = _Run(config, tmp_path / "run", None, 1000, resume=False)
    options = config.hyperparameters.algorithm
    for used in (0.0, 0.5, 1.0):
        explore(run.model, options, used)
        expected = (1.0 - used) * options.log_std_init + used * options.log_std_final
        np.testing.assert_allclose(run.model.policy.log_std.detach().numpy(), expected, rtol=1e-6)
    run.model.num_timesteps = 500
    start = config.hyperparameters.training.learning_rate
    assert run._learning_rate(1.0) == pytest.approx(0.5 * start)


@pytest.mark.parametrize(
    ("algorithm", "options", "word"),
    [
        ("ppo", {"gae_lambda": -3.0}, "algorithm.gae_lambda = -3"),
        ("ppo", {"batch_size": 1}, "algorithm.batch_size = 1"),
        ("sac", {"tau": -1.0}, "algorithm.tau = -1"),
        ("sac", {"learning_starts": 600, "buffer_size": 500}, "algorithm.learning_starts = 600"),
    ],
)
def test_options_out_of_range_are_refused(algorithm, options, word):
    with pytest.raises(ConfigError) as error:
        run_config(algorithm, hyperparameters={"algorithm": options})
    assert word in str(error.value)


def test_interrupted_run_keeps_what_it_had(tmp_path):
    class Interrupt:
        n, total = 0, 100

        def update(self, increment):
            self.n += increment
            if self.n > 60:
                raise KeyboardInterrupt

    config = tiny()
    with pytest.raises(KeyboardInterrupt):
        train(config, tmp_path / "run", steps=1024, bar=Interrupt())
    card = json.loads((tmp_path / "run" / "card.json").read_text())
    assert card["status"] == "interrupted" and 600 < card["samples"] < 1024
    load_policy(tmp_path / "run")
    assert train(config, tmp_path / "run", steps=1024, resume=True)["status"] == "complete"


def test_wall_clock_budget_and_same_seed(tmp_path):
    card = train(tiny(), tmp_path / "timed", minutes=0.02)
    assert 1.0 < card["seconds"] < 10.0 and card["samples"] > 0
    one, two, other = (
        train(tiny(seed=seed), tmp_path / name, steps=128)["best"]["return"]
        for name, seed in (("one", 1), ("two", 1), ("other", 2))
    )
    assert one == two != other


def test_refused_runs(made, tmp_path):
    config, out, _ = made
    with pytest.raises(ConfigError, match="holds a run"):
        train(config, out, steps=512)
    with pytest.raises(ConfigError, match="used up"):
        train(config, out, steps=256, resume=True)
    with pytest.raises(ConfigError, match="another config"):
        train(tiny(seed=3), out, steps=512, resume=True)
    with pytest.raises(ConfigError, match="no run to resume"):
        train(config, tmp_path / "nothing", steps=512, resume=True)
    with pytest.raises(ConfigError, match="budget is needed"):
        train(config, tmp_path / "nothing")
    with pytest.raises(ConfigError, match="leave out: seed"):
        config_for(out, True, {"seed": 1})


def test_wrong_hyperparameters_name_the_nearest(tmp_path):
    with pytest.raises(ConfigError, match="did you mean 'gae_lambda'"):
        load_hyperparameters("ppo", {"algorithm": {"gae_lamda": 0.9}})
    with pytest.raises(ConfigError, match="did you mean 'ppo'"):
        load_hyperparameters("ppo2")
    with pytest.raises(ConfigError, match="no such file"):
        load_hyperparameters("ppo", tmp_path / "none.toml")
    (tmp_path / "part.toml").write_text("[training]\n")
    with pytest.raises(ConfigError, match="no section"):
        load_hyperparameters("ppo", tmp_path / "part.toml")


def test_wrong_policies(made, tmp_path):
    policy = load_policy(made[1])
    with pytest.raises(ConfigError, match="no such policy"):
        load_policy(tmp_path / "none.zip")
    (tmp_path / "text.zip").write_text("not a zip")
    with pytest.raises(ConfigError, match="not a policy, or damaged"):
        load_policy(tmp_path / "text.zip")
    data = (made[1] / "policy.zip").read_bytes()
    (tmp_path / "half.zip").write_bytes(data[: len(data) // 2])
    with pytest.raises(ConfigError, match="not a policy, or damaged"):
        load_policy(tmp_path / "half.zip")
    with zipfile.ZipFile(tmp_path / "empty.zip", "w") as archive:
        archive.writestr("card.json", "{}")
    with pytest.raises(ConfigError, match="not a policy, or damaged"):
        load_policy(tmp_path / "empty.zip")
    policy.card["observations"] = ["psi"]
    save_policy(policy, tmp_path / "other.zip")
    with pytest.raises(ConfigError, match="observations"):
        load_policy(tmp_path / "other.zip")


def test_policy_refuses_another_control(made):
    scenario = load_scenario(overrides={"control": "rudder+rpm"})
    with pytest.raises(ConfigError, match=r"trained for control = 'rudder'"):
        load_policy(made[1]).reset(3, load_ship("kcs"), scenario)


def test_missing_extra_is_one_clear_line(monkeypatch):
    for name in [m for m in sys.modules if m.startswith("ship_gym_agents.sb3.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(ImportError, match=r'pip install "ship-gym\[rl\]"'):
        __import__("ship_gym_agents.training.train")


@pytest.mark.slow
def test_half_a_minute_of_training_beats_doing_nothing(tmp_path):
    """Under the slow disturbance; in waves it takes a minute, see ship_gym_agents/pretrained."""
    config = run_config(scenario="heading_slow_disturbance")
    card = train(config, tmp_path / "run", steps=600_000)
    policy, seeds = load_policy(tmp_path / "run"), range(VALIDATION_SEED, VALIDATION_SEED + 16)
    nothing = rollout(ConstantController(), config.scenario, seeds=seeds)
    assert card["best"]["success"] == 1.0
    assert nothing.terminated.mean() > 0.5
    assert validate(policy, config.scenario)["J_steady"] < 15.0  # doing nothing: about 1700


def test_a_normaliser_by_hand():
    scaled = Normaliser(np.array([1.0, 2.0]), np.array([0.5, 4.0]), 3.0)
    found = scaled(np.array([[2.0, 0.0], [9.0, -99.0]]))
    assert found.tolist() == [[2.0, -0.5], [3.0, -3.0]]
