import dataclasses
import math
import subprocess
import sys

import numpy as np
import pytest
from ship_gym_agents import CONTROLLERS, make_controller
from ship_gym_agents.gains_files import gains_path
from ship_gym_agents.pid import PID, Gains, gains_of, load_gains
from ship_gym_agents.tuning.objective import episode_costs

from ship_gym import available_ships, load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.evaluation.rollout import EVALUATION_SEED, TUNING_SEED, evaluation_seeds, rollout

MIRROR = np.array([-1, 1, -1, 1, -1, -1, 1, -1, 1])  # of the observation's columns
GAINS = Gains(K_p=1.0, K_d=1.0, K_i=0.2, K_v=-0.5)


def started(controller, count, ship="kcs", scenario="heading_keeping", **overrides):
    controller.reset(count, load_ship(ship), load_scenario(scenario, overrides))
    return controller


def observations(count, error_deg=None, seed=0, columns=9):
    rng = np.random.default_rng(seed)
    error = rng.uniform(-np.pi, np.pi, count) if error_deg is None else np.radians(error_deg)
    seen = rng.uniform(-1.0, 1.0, (count, columns))
    seen[:, 0], seen[:, 1] = np.sin(error), np.cos(error)
    return seen.astype(np.float32)


def test_controllers_follow_the_protocol():
    for name in CONTROLLERS:
        controller = make_controller(name)
        assert isinstance(controller, Controller) and controller.name == name
        on_track = "cross_track" in getattr(controller, "needs", ())
        seen = observations(3, columns=15 if on_track else 9)
        task = "track_economy" if name == "just_in_time" else "heading_keeping"
        task = "track_following" if on_track and name != "just_in_time" else task
        controls = ("rudder", "rudder+rpm")[name == "just_in_time" :]
        for control in controls:
            action = started(controller, 3, scenario=task, control=control).act(seen)
            assert action.shape == (3, 1 + (control == "rudder+rpm"))
            assert np.abs(action).max() <= 1.0


@pytest.mark.parametrize("error_deg", [0.5, 5.0, 170.0])
def test_steers_towards_the_ordered_heading(error_deg):
    straight = np.zeros((1, 9))
    straight[0, :2] = math.sin(math.radians(error_deg)), math.cos(math.radians(error_deg))
    assert started(PID(Gains(1.0, 1.0)), 1).act(straight)[0, 0] < 0.0  # to port
    turning = np.zeros((1, 9))
    turning[0, 1:3] = 1.0, 0.1
    assert started(PID(Gains(1.0, 1.0)), 1).act(turning)[0, 0] < 0.0


def test_law_in_numbers():
    ship = load_ship("kcs")
    seen = np.array([[math.sin(0.1), math.cos(0.1), 0.2, 1.0, 0.05, 0, 0, 0, 0]])
    step = ship.speed / ship.hull.L  # 1 s
    delta = -(1.0 * 0.1 + 1.0 * 0.2 + 0.2 * 0.1 * step - 0.5 * 0.05)
    action = started(PID(GAINS), 1).act(seen)
    assert action[0, 0] == pytest.approx(delta / ship.gear.delta_max, rel=1e-12)


def test_mirrored_observations_give_mirrored_actions():
    here, there = started(PID(GAINS), 64), started(PID(GAINS), 64)
    for k in range(20):
        seen = observations(64, seed=k)
        assert np.array_equal(here.act(seen), -there.act(seen * MIRROR.astype(np.float32)))


def test_batch_is_the_same_as_single_episodes():
    batch, single = started(PID(GAINS), 8), [started(PID(GAINS), 1) for _ in range(8)]
    for k in range(20):
        seen = observations(8, seed=k)
        rows = [pid.act(seen[i : i + 1]) for i, pid in enumerate(single)]
        assert np.array_equal(batch.act(seen), np.vstack(rows))


def test_reset_forgets():
    pid = started(PID(GAINS), 2)
    first = pid.act(observations(2))
    for _ in range(10):
        pid.act(observations(2))
    assert np.array_equal(started(pid, 2).act(observations(2)), first)


def test_no_wind_up_while_the_rudder_is_saturated():
    pid = started(PID(Gains(K_p=2.0, K_d=0.0, K_i=0.5)), 1)
    far, near = np.zeros((1, 9)), np.zeros((1, 9))
    far[0, :2], near[0, 1] = (math.sin(0.9), math.cos(0.9)), 1.0
    for _ in range(1000):
        assert pid.act(far)[0, 0] == -1.0
    assert abs(pid.act(near)[0, 0]) < 0.1


def test_integral_removes_a_steady_bias():
    """A yaw moment that hardly changes leaves an error, unless there is an integral."""
    env = {
        "overrides": {"sea.correlation_time": 1000.0, "duration": 1800.0},
        "seeds": evaluation_seeds(8),
    }
    late = slice(1500, None)
    errors = []
    for K_i in (0.0, 0.2):
        sailed = rollout(PID(Gains(1.5, 1.5, K_i)), **env)
        errors.append(np.mean([np.abs(t["psi_error"][late]).mean() for t in sailed.episodes]))
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2"])
def test_gains_carry_over_to_a_model(ship):
    """Non-dimensional gains of the full-scale ship do nearly as well as the model's own."""
    model, seeds = f"{ship}_model", evaluation_seeds(8)
    tuned = [gains_of(load_ship(name)) for name in (ship, model)]
    J = [episode_costs(PID(g), seeds, ship=model).mean() for g in tuned]
    assert J[0] == pytest.approx(J[1], rel=0.03)


@pytest.mark.parametrize("ship", available_ships())
def test_every_ship_has_gains_that_beat_doing_nothing_by_far(ship):
    found = load_gains(gains_path(ship))
    assert found.ship == ship
    assert TUNING_SEED <= min(found.tuning["seeds_tuning"])
    assert max(found.tuning["seeds_validation"]) < EVALUATION_SEED
    seeds = evaluation_seeds(8)
    J, nothing = (episode_costs(c, seeds, ship=ship).mean() for c in (PID(), ConstantController()))
    assert not rollout(PID(), seeds=seeds, ship=ship).terminated.any()
    assert J < 0.05 * nothing
    assert J < 1.5 * found.tuning["cost_validation"]


def test_rpm_stays_at_self_propulsion():
    sailed = rollout(
        PID(Gains(1.0, 1.0)), seeds=[1], control="rudder+rpm", overrides={"duration": 20.0}
    )
    t = sailed.trajectory(0)
    assert t["n_command"] == pytest.approx(t["n"][0], rel=1e-12)


def test_wrong_gains_are_refused(tmp_path):
    with pytest.raises(ConfigError, match="K_p"):
        Gains(K_p=-1.0, K_d=0.0)
    with pytest.raises(ConfigError, match="K_d"):
        Gains(K_p=1.0, K_d=math.nan)
    path = tmp_path / "gains.toml"
    path.write_text('ship = "kcs"\n[gains]\nKp = 1.0\nK_d = 1.0\n[tuning]\n[versions]\n')
    with pytest.raises(ConfigError, match=r"gains.toml.*'Kp'.*'K_p'"):
        load_gains(path)


def test_gains_of_older_files_load(tmp_path):
    """Files without filter, reference and guidance, as they were: a PID without them."""
    path = tmp_path / "gains.toml"
    text = 'ship = "kcs"\n[gains]\nK_p = 1.0\nK_d = 1.0\nK_i = 0.2\nK_v = -0.5\n'
    path.write_text(text + "error_limit = 3.141592653589793\n[tuning]\n[versions]\n")
    assert load_gains(path).gains == GAINS
    path.write_text(text + "[gains.observer]\nsway_nose = 1.0\n[tuning]\n[versions]\n")
    with pytest.raises(ConfigError, match=r"observer.*'sway_nose'.*'sway_noise'"):
        load_gains(path)


def test_a_ship_without_gains_says_how_to_tune():
    stranger = dataclasses.replace(load_ship("kcs"), name="stranger")
    with pytest.raises(ConfigError, match=r"'stranger'.*ship-gym tune"):
        PID().reset(1, stranger, load_scenario())


def test_unknown_controllers_are_refused():
    with pytest.raises(ConfigError, match="did you mean 'pid'"):
        make_controller("pidd")
    with pytest.raises(ConfigError, match="no such policy"):
        make_controller("runs/nowhere")


def test_importing_agents_is_light():
    code = "import sys, ship_gym_agents; print({'torch', 'stable_baselines3'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


@pytest.mark.parametrize(
    ("error_deg", "delta_deg"),
    [(5.0, -5.0), (-5.0, 5.0), (9.9, -9.9), (10.1, -10.0), (40.0, -10.0), (-170.0, 10.0)],
)
def test_the_error_is_limited_to_either_side(error_deg, delta_deg):
    """K_p = 1 and a limit of 10 deg: an error of 40 deg calls for no more rudder than 10 deg."""
    pid = started(PID(Gains(1.0, 0.0, error_limit=math.radians(10.0))), 1)
    seen = np.zeros((1, 9))
    seen[0, :2] = math.sin(math.radians(error_deg)), math.cos(math.radians(error_deg))
    delta = math.degrees(load_ship("kcs").gear.delta_max * pid.act(seen)[0, 0])
    assert delta == pytest.approx(delta_deg, rel=1e-6)


def test_the_integral_grows_with_the_limited_error():
    """Error 40 deg, limit 10 deg, K_i = 0.1: 10 deg more rudder after 1 / 0.1 lengths sailed."""
    pid = started(PID(Gains(0.0, 0.0, 0.1, error_limit=math.radians(10.0))), 1)
    seen = np.zeros((1, 9))
    seen[0, :2] = math.sin(math.radians(40.0)), math.cos(math.radians(40.0))
    ship = load_ship("kcs")
    steps = round(10.0 * ship.hull.L / ship.speed)  # of 1 s
    found = [math.degrees(ship.gear.delta_max * pid.act(seen)[0, 0]) for _ in range(steps)]
    assert found[-1] == pytest.approx(-10.0 * steps * ship.speed / ship.hull.L / 10.0, rel=1e-6)
    assert found[0] == pytest.approx(found[-1] / steps, rel=1e-6)
