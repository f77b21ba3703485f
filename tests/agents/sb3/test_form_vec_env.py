import numpy as np
import pytest
from ship_gym_agents.forms.form import Form
from ship_gym_agents.forms.helm import Helm

from ship_gym.conventions import DELTA
from ship_gym.evaluation.rollout import rollout
from ship_gym.scenarios import load_scenario
from ship_gym.tasks.columns import observation_columns

pytest.importorskip("stable_baselines3")

from ship_gym_agents.controllers import make_controller
from ship_gym_agents.sb3.form_vec_env import FormVecEnv
from ship_gym_agents.sb3.sections import Price
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv

N = 3
SEEDS = range(11, 11 + N)
SHORT = {"duration": 12.0}
RESIDUAL = Form("residual", "pid", scale=0.3, features=("observer", "reference"))


def made(form=RESIDUAL, price=None, levels=0, count=N, **given):
    given = {"overrides": SHORT, **given}
    env = FormVecEnv(ShipVecEnv(count, **given), form, price, levels)
    env.seed(11)
    return env


def sailed(env, steps, decide):
    """Rewards, dones, infos and observations of some steps; `decide` gives decisions by step."""
    found = [env.reset()], [], [], []
    for k in range(steps):
        for column, value in zip(found, env.step(decide(k)), strict=True):
            column.append(value)
    return found


def nothing(k):
    return np.zeros((N, 1))


def by_chance(k):
    return np.random.default_rng(k).uniform(-1.0, 1.0, (N, 1))


@pytest.mark.parametrize("every", [1, 3])
def test_without_decisions_the_base_earns_its_own_rewards(every):
    env = made(Form("residual", "pid", scale=0.3, every=every, features=("observer",)))
    _, rewards, dones, _ = sailed(env, 12 // every, nothing)
    assert dones[-1].all() and not np.any(dones[:-1])
    alone = rollout(make_controller("pid"), load_scenario(overrides=SHORT), seeds=SEEDS)
    expected = alone.histories["rewards"].reshape(12 // every, every, N).sum(axis=1)
    np.testing.assert_allclose(rewards, expected, rtol=1e-6)
    assert rewards[0].dtype == np.float32 and np.abs(expected).min() > 0.0


def test_a_step_is_the_sum_of_its_intervals():
    def thrice(k):
        return by_chance(k // 3)

    _, held, _, _ = sailed(made(Form("direct", every=3)), 4, by_chance)
    _, single, _, _ = sailed(made(Form("direct")), 12, thrice)
    np.testing.assert_allclose(held, np.reshape(single, (4, 3, N)).sum(axis=1), rtol=1e-6)


def test_a_new_episode_sails_by_the_base_alone_until_the_step_is_over():
    """Of 12 intervals an episode has two and a half steps of 5."""
    form = Form("residual", "pid", scale=0.3, every=5, features=("observation",))
    env = made(form)
    seen, rewards, dones, infos = sailed(env, 3, by_chance)
    assert dones[-1].all() and [info["episode"]["l"] for info in infos[-1]] == [12] * N
    # the new episodes have sailed three intervals, those of the base
    venv, helm = ShipVecEnv(N, overrides=SHORT), Helm(form)
    venv.seed(11)
    helm.reset(N, venv.env.ships, venv.env.scenario)
    observations = venv.reset()
    total = np.zeros(N)
    for k in range(12):
        helm.look(observations)
        actions = helm.act(by_chance(k // 5) if k % 5 == 0 else None)
        observations, reward, *_ = venv.step(actions)
        total += reward if k >= 10 else 0.0
    np.testing.assert_allclose(rewards[-1], total, rtol=1e-6)
    base = make_controller("pid")
    base.reset(N, venv.env.ships[0], venv.env.scenario)
    for _ in range(3):
        observations, *_ = venv.step(base.act(observations))
    np.testing.assert_allclose(seen[-1], observations, rtol=1e-6)


def test_features_are_those_of_a_fresh_helm_in_each_episode():
    env = made(RESIDUAL, stagger=True, overrides={"duration": 30.0})
    plain = ShipVecEnv(N, stagger=True, overrides={"duration": 30.0})
    plain.seed(11)
    helms = [_fresh(plain) for _ in range(N)]
    raw, seen = plain.reset(), env.reset()
    features = [helm.look(raw[i : i + 1])[0] for i, helm in enumerate(helms)]
    ends = 0
    for k in range(70):
        np.testing.assert_allclose(seen, features, rtol=1e-5, atol=1e-6)
        decisions = by_chance(k)
        actions = [h.act(d[None])[0] for h, d in zip(helms, decisions, strict=True)]
        raw, _, over, told = plain.step(np.array(actions))
        seen, _, dones, infos = env.step(decisions)
        np.testing.assert_array_equal(dones, over)
        for i in np.flatnonzero(over):
            last = told[i]["terminal_observation"][None]
            expected = helms[i].look(last)[0]
            found = infos[i]["terminal_observation"]
            np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-6)
            same = ("TimeLimit.truncated", "reward_terms", "is_success")
            assert all(infos[i][key] == told[i][key] for key in same)
            assert infos[i]["episode"]["r"] == pytest.approx(told[i]["episode"]["r"])
            helms[i] = _fresh(plain)
            ends += 1
        features = [helm.look(raw[i : i + 1])[0] for i, helm in enumerate(helms)]
    assert ends > N


def _fresh(venv):
    helm = Helm(RESIDUAL)
    helm.reset(1, venv.env.ships[0], venv.env.scenario)
    return helm


def test_the_price_is_that_of_the_travel_sailed():
    """Hard over from amidships: the rudder moves at its largest rate."""
    env = made(Form("direct", every=4))
    dear = made(Form("direct", every=4), Price(travel=0.5))
    _, rewards, _, _ = sailed(env, 2, lambda k: np.full((N, 1), 1.0 - 2.0 * k))
    column = observation_columns(env.scenario)["rudder"]
    seen, less, _, _ = sailed(dear, 2, lambda k: np.full((N, 1), 1.0 - 2.0 * k))
    limit = np.degrees(env.venv.env.ship.gear.delta_max)
    angle = np.array(seen)[:, :, column] * limit
    assert angle[1].min() > 5.0 and angle[2].max() < angle[1].min()  # there and back: one reversal
    np.testing.assert_allclose(
        np.array(rewards) - np.array(less), 0.5 * np.abs(np.diff(angle, axis=0)), rtol=1e-3
    )
    turns = made(Form("direct", every=4), Price(reversals=7.0))
    _, turned, _, _ = sailed(turns, 2, lambda k: np.full((N, 1), 1.0 - 2.0 * k))
    np.testing.assert_allclose(np.subtract(rewards, turned), [[0.0] * N, [7.0] * N], atol=1e-4)


def test_the_limit_is_the_travel_of_the_base():
    env = made(price=Price(limit="base", rate=0.1))
    seen, *_ = sailed(env, 0, nothing)
    alone = rollout(make_controller("pid"), load_scenario(overrides=SHORT), seeds=SEEDS)
    angles = np.degrees(alone.histories["states"][:, :, DELTA])
    travel = np.abs(np.diff(angles, axis=0)).sum() / N / (12.0 / 3600.0)
    assert env.price.limit == pytest.approx(travel, rel=1e-3)
    assert env.price.rate_so_far() == 0.0
    np.testing.assert_array_equal(seen[0], sailed(made(), 0, nothing)[0][0])  # and then as without


def test_privileged_columns_follow_the_features():
    plain, more = made(), made(privileged=True)
    seen, all_seen = plain.reset(), more.reset()
    n = plain.n_features
    assert more.n_features == n == seen.shape[1] < all_seen.shape[1]
    np.testing.assert_array_equal(all_seen[:, :n], seen)
    raw = ShipVecEnv(N, overrides=SHORT, privileged=True)
    raw.seed(11)
    columns = len(observation_columns(plain.scenario))
    np.testing.assert_array_equal(all_seen[:, n:], raw.reset()[:, columns:])


def test_levels_make_decisions_a_choice():
    env = made(Form("direct"), levels=3, control="rudder+rpm")
    assert env.action_space.n == 9 and env.choices.shape == (9, 2)
    numbers = made(Form("direct"), control="rudder+rpm")
    chosen = np.array([0, 4, 8])
    _, first, _, _ = sailed(env, 3, lambda k: chosen)
    _, second, _, _ = sailed(numbers, 3, lambda k: env.choices[chosen])
    np.testing.assert_array_equal(first, second)
    assert env.choices[4].tolist() == [0.0, 0.0]


def test_each_ship_of_a_fleet_is_steered_by_its_own_base():
    ships = ["kcs", "onrt", "kvlcc2"]
    env = made(ship=ships)
    _, rewards, _, _ = sailed(env, 6, nothing)
    for i, ship in enumerate(ships):
        alone = rollout(
            make_controller("pid"), load_scenario(overrides={**SHORT, "ship": ship}), seeds=[11 + i]
        )
        np.testing.assert_allclose(
            np.array(rewards)[:, i], alone.histories["rewards"][:6, 0], rtol=1e-5
        )
