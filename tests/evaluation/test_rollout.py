import numpy as np
import pytest
from ship_gym_agents.pid import PID, Gains

from ship_gym import ShipEnv, load_ship
from ship_gym.config import ConfigError
from ship_gym.conventions import PSI
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.rollout import (
    EVALUATION_SEED,
    TUNING_SEED,
    evaluation_seeds,
    rollout,
    tuning_seeds,
)
from ship_gym.recording import Trajectory

SHORT = {"duration": 60.0}
GAINS = Gains(K_p=2.0, K_d=2.0, K_i=0.1, K_v=-1.0)


def sail_env(controller, seed, **env):
    """The same episode through ShipEnv, one row for each step."""
    ship_env = ShipEnv(**env)
    observation, info = ship_env.reset(seed=seed)
    controller.reset(1, ship_env.ship, ship_env.scenario)
    rows, done = [], False
    while not done:
        state = ship_env.episodes.sim.state[0].copy()
        action = controller.act(observation[None])[0]
        observation, reward, terminated, truncated, info = ship_env.step(action)
        rows.append((state, reward, info, ship_env.episodes.sim.commands[0].copy()))
        done = terminated or truncated
    return rows, ship_env.episodes.sim.state[0], terminated


@pytest.mark.parametrize("control", ["rudder", "rudder+rpm"])
def test_episode_is_that_of_the_environment_bit_for_bit(control):
    seeds = [3, 1_000_000, 17]
    env = {"control": control, "overrides": SHORT}
    sailed = rollout(PID(GAINS), seeds=seeds, **env)
    for i, seed in enumerate(seeds):
        rows, final, terminated = sail_env(PID(GAINS), seed, **env)
        n = sailed.lengths[i]
        assert (n, sailed.terminated[i]) == (len(rows), terminated)
        histories = {name: values[:, i] for name, values in sailed.histories.items()}
        assert np.array_equal(histories["states"][:n], [row[0] for row in rows])
        assert np.array_equal(histories["states"][n], final)
        assert np.array_equal(histories["rewards"][:n], [row[1] for row in rows])
        assert np.array_equal(histories["commands"][:n], [row[3] for row in rows])
        for k, name in enumerate(rows[0][2]["reward_terms"]):
            assert histories["terms"][:n, k].tolist() == [r[2]["reward_terms"][name] for r in rows]
        assert np.array_equal(histories["forces"][:n, 2], [r[2]["forces"]["rudder"] for r in rows])
        assert histories["flow"][:n, 4].tolist() == [r[2]["flow"]["torque"] for r in rows]
        assert sailed.histories["psi_ordered"][0, i] == rows[0][2]["psi_ordered"]


def test_a_recording_has_wind_where_there_is_some():
    calm = {"sea.states": [], "sea.gusts": False, "duration": 10.0}
    for more, there in (({}, False), ({"sea.wind_speed": 9.0, "sea.wind_speed_min": 9.0}, True)):
        run = rollout(PID(GAINS), seeds=[3], overrides=calm | more).trajectory(0)
        assert ("wind_speed" in run) == ("wind_direction_from" in run) == there
        assert not there or (run["wind_speed"] == 9.0).all()


def test_episode_that_terminates_is_cut_at_its_end():
    sailed = rollout(ConstantController(1.0), seeds=[0, 1, 2], overrides={"duration": 300.0})
    assert sailed.terminated.all()
    for i, seed in enumerate(sailed.seeds):
        rows, final, _ = sail_env(ConstantController(1.0), seed, overrides={"duration": 300.0})
        t = sailed.trajectory(i)
        assert len(t) == len(rows) + 1 < 300
        assert t["psi"][-1] == final[PSI]
        assert abs(t["psi_error"][-1]) > np.radians(60.0) >= abs(t["psi_error"][-2])
        assert t.meta["terminated"] and not t.meta["truncated"]
        assert t["reward"].sum() == pytest.approx(sum(row[1] for row in rows), rel=1e-12)


def test_last_row_holds_the_final_state_and_its_forces():
    sailed = rollout(PID(GAINS), seeds=[5], overrides={"duration": 30.0})
    longer = rollout(PID(GAINS), seeds=[5], overrides={"duration": 31.0}).trajectory(0)
    t = sailed.trajectory(0)
    for name in t.names:
        assert np.array_equal(t[name][:-1], longer[name][: len(t) - 1])
    for name in ("psi", "Y_rudder", "Y_disturbance", "torque", "beta_R"):
        assert t[name][-1] == longer[name][len(t) - 1]
    assert t["delta_command"][-1] == t["delta_command"][-2]
    assert t["reward"][-1] == 0.0


def test_recording_has_what_reproduces_it():
    t = rollout(PID(GAINS, name="mine"), seeds=[9], overrides=SHORT, ship="kvlcc2").trajectory(0)
    assert isinstance(t, Trajectory)
    assert (t.meta["controller"], t.meta["seed"], t.meta["task"]) == ("mine", 9, "heading_keeping")
    assert t.meta["ship"]["name"] == t.meta["config"]["ship"] == "kvlcc2"
    again = rollout(PID(GAINS), t.meta["config"], seeds=[t.meta["seed"]]).trajectory(0)
    assert all(np.array_equal(t[name], again[name]) for name in t.names)
    terms = [name for name in t.names if name.startswith("reward_")]
    assert len(terms) == 5
    total = sum(t[name] for name in terms)
    assert t["reward"] == pytest.approx(total, rel=1e-12)
    assert t.meta["versions"] and t.meta["git_commit"]


def test_a_ship_object_sails_too():
    ship = load_ship("kcs", surrogate="none")
    sailed = rollout(PID(GAINS), seeds=[1], ship=ship, overrides=SHORT)
    assert sailed.ship is ship
    assert sailed.trajectory(0).meta["ship"]["surrogate"] == "none"


def test_current_is_recorded_as_it_flows():
    sailed = rollout(ConstantController(), seeds=[4], overrides={"duration": 5.0})
    t = sailed.trajectory(0)
    start = t["psi"][0]
    along = t["current_speed"][0] * np.cos(t["current_direction_to"][0] - start)
    assert t["u"][0] == pytest.approx(sailed.ship.speed + along, rel=1e-12)


def test_seed_ranges_do_not_overlap():
    assert evaluation_seeds(3) == [EVALUATION_SEED + k for k in range(3)]
    assert tuning_seeds(2) == [TUNING_SEED, TUNING_SEED + 1]
    assert evaluation_seeds(1) == [EVALUATION_SEED] and tuning_seeds(1) == [TUNING_SEED]
    assert len(evaluation_seeds(10**6)) == 10**6
    for n in (0, 10**6 + 1):
        with pytest.raises(ConfigError, match=f"episodes = {n}: allowed is 1 to 1e"):
            evaluation_seeds(n)
    assert 0 < TUNING_SEED < EVALUATION_SEED
    with pytest.raises(ConfigError, match="episodes"):
        tuning_seeds(EVALUATION_SEED - TUNING_SEED + 1)


@pytest.mark.parametrize("seeds", [[], [-1]])
def test_seeds_that_cannot_be_used_are_refused(seeds):
    with pytest.raises(ConfigError, match="seeds"):
        rollout(ConstantController(), seeds=seeds)


def test_progress_wraps_the_intervals():
    seen = []
    rollout(
        ConstantController(),
        seeds=[0],
        overrides={"duration": 5.0},
        progress=lambda steps: seen.append(len(steps)) or steps,
    )
    assert seen == [5]
