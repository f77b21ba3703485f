import json

import pytest
from ship_gym_agents.sb3.config import is_config_of, load_recipe, plain, run_config
from ship_gym_agents.sb3.options import OPTIONS
from ship_gym_agents.sb3.sections import Price, algorithm_name, load_hyperparameters

from ship_gym.config import ConfigError


def test_every_algorithm_has_its_own_complete_file():
    for name, options in OPTIONS.items():
        hyper = load_hyperparameters(name)
        assert isinstance(hyper.algorithm, options)
        assert hyper.form.base == "" and not hyper.price.any and hyper.training.critic == "same"


@pytest.mark.parametrize("name", ["PPO", "Recurrent-PPO", "sac", "Td3", "TQC", "dqn"])
def test_names_in_any_case(name):
    assert run_config(name).algorithm == name.lower().replace("-", "_")


def test_names_as_their_papers_and_libraries_write_them():
    names = ["RecurrentPPO", "Gauss-Newton", "GaussNewton"]
    assert [*map(algorithm_name, names)] == ["recurrent_ppo", "gauss_newton", "gauss_newton"]


def test_a_partial_file_then_single_settings(tmp_path):
    (tmp_path / "own.toml").write_text(
        "[training]\ngamma = 0.9\nenvs = 7\n[network]\nhidden = []\n"
    )
    hyper = load_hyperparameters(
        "ppo",
        tmp_path / "own.toml",
        settings={
            "training.gamma": 0.95,
            "form.action": "increment",
            "price.limit": 900,
            "price.rate": 0.1,
        },
    )
    package = load_hyperparameters("ppo")
    assert hyper.training.gamma == 0.95 and hyper.training.envs == 7
    assert hyper.network.hidden == () and hyper.form.action == "increment"
    assert hyper.training.episode == package.training.episode
    assert hyper.algorithm == package.algorithm


def test_settings_reach_into_overrides():
    settings = {"training.overrides.sea.states": ["ss6"], "training.overrides.duration": 50.0}
    hyper = load_hyperparameters("ppo", settings=settings)
    assert hyper.training.overrides == {"sea.states": ["ss6"], "duration": 50.0}


def test_hyperparameters_of_a_task(tmp_path, monkeypatch):
    from ship_gym_agents.sb3 import sections

    for file in sections._FOLDER.glob("ppo.toml"):
        (tmp_path / file.name).write_text(file.read_text())
    (tmp_path / "ppo.course_changing.toml").write_text("[training]\ngamma = 0.5\n")
    monkeypatch.setattr(sections, "_FOLDER", tmp_path)
    assert run_config("ppo", "course_changing").hyperparameters.training.gamma == 0.5
    assert run_config("ppo").hyperparameters.training.gamma != 0.5


RECIPE = """
algo = "SAC"
scenario = "course_changing"
ship = "kvlcc2"
control = "rudder+rpm"

[overrides]
duration = 300.0

[form]
action = "residual"
base = "pid"
scale = 0.3
features = ["observer", "reference"]

[training]
gamma = 0.97

[algorithm]
tau = 0.02
"""


def test_a_recipe(tmp_path):
    (tmp_path / "mine.toml").write_text(RECIPE)
    config = run_config(recipe=tmp_path / "mine.toml", seed=3, settings={"training.envs": 5})
    assert (config.algorithm, config.seed) == ("sac", 3)
    assert config.scenario.task == "course_changing" and config.scenario.ship == "kvlcc2"
    assert config.scenario.duration == 300.0 and config.scenario.control == "rudder+rpm"
    hyper = config.hyperparameters
    assert hyper.form.base == "pid" and hyper.form.features == ("observer", "reference")
    assert hyper.training.gamma == 0.97 and hyper.training.envs == 5 and hyper.algorithm.tau == 0.02
    other = run_config("ppo", recipe=tmp_path / "mine.toml", ship="kcs")
    assert other.algorithm == "ppo" and other.scenario.ship == "kcs"
    assert other.hyperparameters.algorithm == load_hyperparameters("ppo").algorithm


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("algorithm = 'ppo'", "algorithm = 'ppo': must be a table of keys"),
        ("alg = 'ppo'", "did you mean 'algo'"),
        ("algo = 'ppp'", "did you mean 'ppo'"),
        ("[trainig]\ngamma = 0.9", "did you mean 'training'"),
        ("[training]\ngama = 0.9", "did you mean 'gamma'"),
    ],
)
def test_wrong_recipes(tmp_path, text, word):
    (tmp_path / "mine.toml").write_text(text)
    with pytest.raises(ConfigError) as error:
        run_config(recipe=tmp_path / "mine.toml")
    assert word in str(error.value)


def test_an_unknown_recipe():
    with pytest.raises(ConfigError, match="unknown recipe 'nonsense'"):
        load_recipe("nonsense")


@pytest.mark.parametrize(
    ("algorithm", "settings", "word"),
    [
        ("ppo", {"training": 3}, "must be section.key"),
        ("ppo", {"nonsense.key": 3}, "must be section.key"),
        ("ppo", {"training.gama": 0.9}, "did you mean 'gamma'"),
        ("ppo", {"training.critic": "privilegd"}, "did you mean 'privileged'"),
        ("ppo", {"training.checkpoint": -1.0}, "training.checkpoint = -1"),
        ("ppo", {"price.travel": -1.0}, "price.travel = -1"),
        ("ppo", {"price.limit": "pid", "price.rate": 0.1}, "price.limit = 'pid'"),
        ("ppo", {"price.limit": 900}, "price.limit without price.rate"),
        ("ppo", {"price.limit": "base", "price.rate": 0.1}, "without form.base"),
        ("recurrent_ppo", {"form.symmetric": True}, "form.symmetric = true with recurrent_ppo"),
        ("dqn", {"form.symmetric": True}, "form.symmetric = true with dqn"),
        ("dqn", {"training.critic": "privileged"}, "training.critic = 'privileged' with dqn"),
        ("dqn", {"algorithm.levels": 4}, "algorithm.levels = 4: allowed is an odd number"),
        ("td3", {"algorithm.policy_delay": 0}, "algorithm.policy_delay = 0"),
        ("tqc", {"algorithm.top_quantiles_to_drop_per_net": 25}, "top_quantiles_to_drop_per_net"),
        ("gauss_newton", {"price.travel": 0.1}, "allowed is algorithm.price"),
    ],
)
def test_what_cannot_be(algorithm, settings, word):
    with pytest.raises(ConfigError) as error:
        load_hyperparameters(algorithm, settings=settings)
    assert word in str(error.value)


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ({"form.base": "drift_los", "form.action": "guidance"}, "drift_los"),
        ({"form.features": ["observer"]}, "observer"),
        ({"training.ships": ["kcz"]}, "did you mean 'kcs'"),
        ({"training.overrides.duratoin": 9.0}, "did you mean 'duration'"),
    ],
)
def test_what_cannot_sail_is_refused_before_any_work(settings, word):
    with pytest.raises(ConfigError) as error:
        run_config(settings=settings)
    assert word in str(error.value)


def test_gauss_newton_needs_a_base():
    with pytest.raises(ConfigError, match="corrects a classical autopilot"):
        run_config("gauss_newton")


def test_keys_that_are_newer_than_a_run_are_the_default(tmp_path):
    config = run_config()
    card = {"status": "running", "config": plain(config), "budget": {"minutes": 1.0}}
    del card["config"]["hyperparameters"]["form"]["lags"]
    (tmp_path / "card.json").write_text(json.dumps(card))
    assert is_config_of(tmp_path, config)
    assert not is_config_of(tmp_path, run_config(settings={"form.lags": [2]}))


def test_errors_name_the_file(tmp_path):
    (tmp_path / "own.toml").write_text("[training]\ngama = 0.9\n")
    with pytest.raises(ConfigError, match=r"own\.toml"):
        run_config(hyperparameters=tmp_path / "own.toml")


def test_a_policy_never_sees_the_sea():
    with pytest.raises(ConfigError, match=r"training\.critic = 'privileged'"):
        run_config(privileged=True)


def test_a_limit_may_be_a_number():
    assert Price(limit="900", rate=0.1).any
    values = {"price": {"limit": 900.5, "rate": 0.1}}
    hyper = load_hyperparameters("ppo", values)
    assert hyper.price.limit == "900.5"
    config = run_config(hyperparameters=values)
    assert load_hyperparameters("ppo", plain(config)["hyperparameters"]) == hyper
