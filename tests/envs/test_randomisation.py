"""Per-episode draws from the standard deviation of a surrogate."""

import dataclasses

import gymnasium as gym
import numpy as np
import pytest

from ship_gym import load_ship
from ship_gym.config import ConfigError
from ship_gym.envs.env import ShipEnv
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.randomisation import SURROGATE_DRAWS
from ship_gym.evaluation import rollout
from ship_gym.scenarios import load_scenario

ID = "ShipGym/HeadingKeeping-v0"
WAKE = {"randomisation.interaction_std": 0.3}
ON = {"randomisation.surrogate_std": 1.0}
HARD_OVER = np.array([1.0])


def batch(n, std, seed=0, surrogate="gp"):
    scenario = load_scenario(overrides={"randomisation.surrogate_std": std, "surrogate": surrogate})
    episodes = EpisodeBatch(n, scenario)
    episodes.start(np.arange(n), np.random.default_rng(seed).random((n, episodes.n_draws)))
    return episodes


def test_draws_are_normal_with_the_size_asked_for_and_cut_at_three():
    drawn = batch(4000, 0.5).randomisation()
    assert sorted(drawn) == sorted(f"surrogate.{name}" for name in SURROGATE_DRAWS)
    z = np.stack(list(drawn.values()))
    np.testing.assert_allclose(z.mean(axis=1), 0.0, atol=0.03)
    np.testing.assert_allclose(z.std(axis=1), 0.5, rtol=0.04)
    assert np.abs(z).max() <= 1.5
    correlation = np.corrcoef(z)[~np.eye(len(z), dtype=bool)]
    assert np.abs(correlation).max() < 0.06


def test_the_surrogate_moves_by_that_many_of_its_standard_deviations():
    """At the trained angle inside the box the kernel's normal force is mean + z std."""
    ship = load_ship("kcs", surrogate="gp")
    table, J, beta = ship.surrogate, 0.5, 0.35
    at = dict(zip(table.names, table(np.arctan(J / (0.7 * np.pi)), beta), strict=True))
    forces = []
    for z in (0.0, 1.0):
        episodes = EpisodeBatch(1, load_scenario(overrides={"surrogate": "gp"}))
        sim = episodes.sim
        sim.reset(0)
        sim.records["surrogate"]["z_N"] = z
        n = 1.5
        u = J * n * ship.propeller.D
        sim.state[0, [0, 1, 2, 6, 7]] = u, -u * np.tan(beta), 0.0, np.radians(35.0), n
        sim.step([[np.radians(35.0), n]], 0.01)
        forces.append(sim.flow[0, 5])
    assert forces[1] / forces[0] == pytest.approx(1.0 + at["C_N_std"] / at["C_N"], rel=2e-3)
    assert at["C_N_std"] > 0.01 * at["C_N"]


def test_same_seed_same_draw_and_it_is_in_info():
    env = ShipEnv(surrogate="gp", overrides=ON)
    infos = [env.reset(seed=seed)[1]["randomisation"] for seed in (3, 3, 4)]
    assert infos[0] == infos[1] != infos[2]
    assert env.step(HARD_OVER)[4]["randomisation"] == infos[2]
    assert "randomisation" not in ShipEnv(surrogate="gp").reset(seed=3)[1]


def test_vector_environment_draws_as_scalar_ones_do():
    envs = gym.make_vec(
        ID, num_envs=3, vectorization_mode="vector_entry_point", surrogate="gp", overrides=ON
    )
    obs, info = envs.reset(seed=7)
    for i in range(3):
        env = ShipEnv(surrogate="gp", overrides=ON)
        single, alone = env.reset(seed=7 + i)
        assert (single == obs[i]).all()
        for name, value in alone["randomisation"].items():
            assert info["randomisation"][name][i] == value
    for _ in range(20):
        obs, *_ = envs.step(np.ones((3, 1)))
        single, *_ = env.step(HARD_OVER)
    assert (single == obs[2]).all()


def test_a_recorded_episode_says_what_was_drawn():
    class HardOver:
        name = "hard over"

        def reset(self, n, ship, scenario):
            self.n = n

        def act(self, observations):
            return np.ones((self.n, 1))

    overrides = {**ON, "duration": 20.0}
    runs = rollout(HardOver(), seeds=[1, 2], surrogate="gp", overrides=overrides)
    metas = [episode.meta["randomisation"] for episode in runs.episodes]
    assert metas[0]["surrogate.propeller"] != metas[1]["surrogate.propeller"]
    assert metas[0] == ShipEnv(surrogate="gp", overrides=ON).reset(seed=1)[1]["randomisation"]


@pytest.mark.parametrize("surrogate", ["none", "G2_SST"])
def test_a_surrogate_without_standard_deviation_is_refused(surrogate):
    with pytest.raises(ConfigError, match="has no standard deviation"):
        ShipEnv(surrogate=surrogate, overrides=ON)


@pytest.mark.parametrize(
    ("size", "words"), [(-1.0, "surrogate_std = -1.0: allowed"), (np.nan, "must be finite")]
)
def test_a_size_that_is_none_is_refused(size, words):
    with pytest.raises(ConfigError, match=words):
        ShipEnv(overrides={"randomisation.surrogate_std": size})


def test_no_draw_takes_all_of_the_flow_from_a_propeller():
    """w_P0 = 0.6 times 1.9 would be above 1."""
    ship = load_ship("kvlcc2")
    full = dataclasses.replace(ship, propeller=dataclasses.replace(ship.propeller, w_P0=0.6))
    words = (
        r"interaction_std = 0.3: propeller.w_P0 = 0.6 of kvlcc2 .* up to 1.14; allowed is 0 to 0.19"
    )
    with pytest.raises(ConfigError, match=words):
        ShipEnv(ship=full, overrides=WAKE)
    ShipEnv(ship=full, overrides={"randomisation.interaction_std": 0.19})
    ShipEnv(ship=ship, overrides=WAKE)
