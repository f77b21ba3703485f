import numpy as np
import pytest
from ship_gym_agents import make_controller
from ship_gym_agents.pid import PID, Gains, load_gains
from ship_gym_agents.tune import (
    STRUCTURES,
    Tuned,
    _from_unit,
    _to_unit,
    episode_costs,
    gains_file,
    is_tuned,
    make_gains,
    mean_costs,
    settings,
    tune,
    write_gains,
)
from ship_gym_agents.wave_filter import LinearShip

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.metrics import metrics
from ship_gym.evaluation.rollout import rollout
from ship_gym.tasks.measures import control_cost

SHIP = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
OBSERVED = {"K_p": 2.5, "K_d": 0.4, "K_v": -4.0, "K_b": 0.8} | {
    f"observer.{name}": value
    for name, value in {"sway_noise": 0.5, "yaw_noise": 2.0, "bias_noise": 0.6}.items()
}


def test_costs_of_tuning_are_those_of_the_metrics():
    for controller in (PID(Gains(1.0, 1.0, 0.2, -0.5)), ConstantController(1.0)):
        sailed = rollout(controller, seeds=[1, 2], overrides={"duration": 120.0})
        expected = [metrics(t)["J_0.1"] for t in sailed.episodes]
        assert episode_costs(sailed) == pytest.approx(expected, rel=1e-12)
    assert control_cost(np.radians([3.0, 4.0]), np.zeros(2), 1.0) == pytest.approx(12.5)


def test_gains_as_shares_of_their_ranges():
    """Linear from 0 or below on, logarithmic above; limited to the range, and back again."""
    free = ("K_p", "K_d", "K_v")
    values = [2.0, 2.5, -2.0]
    shares = _to_unit(values, free)
    assert shares == pytest.approx([0.5, 0.25, 0.5])  # K_p from 0.2 to 20
    assert _from_unit(shares, free) == pytest.approx(values)
    assert _to_unit([0.01, 99.0, 0.0], free) == pytest.approx([0.0, 1.0, 8.0 / 12.0])


@pytest.mark.parametrize("values", [{"K_p": 3.0, "K_d": 2.0}, OBSERVED], ids=["PD", "observer"])
def test_candidates_sail_the_same_episodes_as_one(values):
    env = {"overrides": {"duration": 60.0}}
    other = {name: 0.7 * value for name, value in values.items()}
    candidates = np.array([list(values.values()), list(other.values())])
    both = mean_costs(candidates, list(values), [5, 6], SHIP, **env)
    for found, each in zip(both, (values, other), strict=True):
        sailed = rollout(PID(make_gains(each, SHIP)), seeds=[5, 6], **env)
        assert found == episode_costs(sailed).mean()


@pytest.mark.parametrize("structure", STRUCTURES)
def test_every_structure_makes_gains(structure):
    gains = make_gains(dict.fromkeys(STRUCTURES[structure], 1.0), SHIP)
    assert (gains.observer is not None) == ("observer" in structure)
    assert (gains.low_pass is not None) == ("low-pass" in structure)
    assert gains.K_p == gains.K_d == 1.0


def test_tuned_gains_can_be_stored_and_loaded(tmp_path):
    names = ("PD", "PD + sway, observer with waves")
    size = {"structures": names, "episodes": 2, "generations": 1}
    ranking = tune("kcs", **size, overrides={"duration": 30.0})
    assert ranking[0].J_validation <= ranking[1].J_validation
    ranking.sort(key=lambda tuned: "observer" not in tuned.structure)
    how = settings(**size)
    made = gains_file("kcs", ranking, how)
    path = write_gains(made, tmp_path / "my_pid.toml")
    assert load_gains(path) == made
    controller = make_controller(path)
    assert controller.name == "my_pid" and controller.gains == ranking[0].gains
    assert set(made.tuning["validation_of"]) == set(names)
    assert "rudder_reversals" in made.tuning["validation_of"]["PD"]


def test_a_tuning_resumes_only_with_the_same_settings(tmp_path):
    gains = make_gains(OBSERVED, SHIP)
    path, how = tmp_path / "pid.toml", settings(episodes=2)
    assert not is_tuned("kcs", how, path)
    write_gains(gains_file("kcs", [Tuned("", gains, 1.0, {"J_0.1": 2.0})], how), path)
    assert is_tuned("kcs", how, path)
    assert not is_tuned("kcs", settings(episodes=3), path)
    assert not is_tuned("kvlcc2", how, path)


def test_wrong_tunings_are_refused():
    with pytest.raises(ConfigError, match="did you mean 'kcs'"):
        tune("kcz")
    with pytest.raises(ConfigError, match="episodes = 0"):
        tune("kcs", episodes=0)
    with pytest.raises(ConfigError, match="scenario 'heading_keping'"):
        tune("kcs", scenario="heading_keping")
