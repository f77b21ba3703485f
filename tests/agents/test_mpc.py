import math
import sys
import time

import numpy as np
import pytest
from ship_gym_agents.horizon import Horizon, block_lengths
from ship_gym_agents.lqg import regulator
from ship_gym_agents.mpc import MPC, MPCGains, Program, TrackWeights
from ship_gym_agents.wave_filter import LinearShip, Observer

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.evaluation.rollout import rollout, tuning_seeds

pytest.importorskip("osqp")
SHIP = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
STEP, STROKE = 1.0 / 30.0, math.radians(2.32)
GAINS = MPCGains(Observer(SHIP, 0.5, 2.0, 0.8, 0.05, 0.25))


@pytest.mark.parametrize("x", [[0.02, 0.001, -0.01, 0.01], [-0.01, 0.0, 0.02, 0.0]])
def test_without_limits_the_plan_is_the_regulator(x):
    """Blocks of one interval, any horizon: the terminal cost makes it the infinite one."""
    horizon = Horizon(SHIP, STEP, STROKE, 0.1, 1e-4, blocks=(1,) * 12)
    plan = np.linalg.solve(horizon.H, -horizon.slope(np.array(x)))
    K, _ = regulator(SHIP, STEP, 0.1, 1e-4)
    assert plan[0] * STROKE == pytest.approx(-K @ x, rel=1e-6)
    found = Program(horizon, math.radians(35.0)).first(np.array(x), None, 0.0)
    assert found == pytest.approx(plan[0], abs=1e-4)


def test_the_blocks_in_use_come_close_to_it():
    x = np.array([0.02, 0.001, -0.01, 0.01])
    horizon = Horizon(SHIP, STEP, STROKE, 0.1, 1e-4)
    K, _ = regulator(SHIP, STEP, 0.1, 1e-4)
    plan = np.linalg.solve(horizon.H, -horizon.slope(x))
    assert plan[0] * STROKE == pytest.approx(-K @ x, rel=0.02)
    assert horizon.N == sum(block_lengths(STEP)) and len(block_lengths(1.0)) == horizon.blocks


def test_plans_keep_to_angle_and_rate():
    """From far off: at full rate to the limit, where it stays."""
    limit, horizon = math.radians(10.0), Horizon(SHIP, STEP, STROKE, 0.1, 1e-5)
    program, x = Program(horizon, limit), np.array([-1.0, 0.0, 0.0, 0.0])
    assert program.first(x, None, 0.0) == pytest.approx(1.0, abs=1e-3)
    angles = horizon.angles @ program._last * STROKE
    assert np.abs(program._last).max() < 1.0 + 1e-3
    assert angles.max() == pytest.approx(limit, abs=1e-3) and angles.min() > -limit - 1e-3
    assert program.first(x + [0, 0, 0, limit], None, limit) == pytest.approx(0.0, abs=1e-2)


def test_mpc_on_a_heading_turns_with_little_overshoot():
    """Calm water, 30 deg to turn, no reference model: less than 3 deg beyond, no failure."""
    sailed = rollout(
        MPC(MPC.first_gains(load_ship("kcs"))),
        "course_30",
        seeds=tuning_seeds(2),
        parallel=False,
        overrides={"sea": {"states": [], "gusts": False, "current_speed": 0.0}, "duration": 250.0},
    )
    for t in sailed.episodes:
        error = np.degrees(t["psi_error"])
        k = int(np.argmax(np.abs(np.diff(t["psi_ordered"])) > 0.1)) + 1
        side = np.sign(error[k])
        assert abs(error[k]) == pytest.approx(30.0, abs=1.0)
        turn = side * error[k : k + 170]
        assert turn.min() > -3.0 and abs(turn[-1]) < 1.2


def test_on_a_track_the_turn_begins_before_the_way_point_and_ends_on_the_next_leg():
    points = [[0.0, 0.0], [2400.0, 0.0], [2400.0, 3000.0]]
    overrides = {
        "track": {"kind": "points", "points": points},
        "sea": {"states": [], "gusts": False, "current_speed": 0.0},
        "start": {"heading_error_deg": 0.0, "cross_track": 0.0},
    }
    sailed = rollout(
        MPC(MPC.first_gains(load_ship("kcs"))),
        "track_calm",
        seeds=[1],
        parallel=False,
        overrides=overrides,
    )
    t = sailed.episodes[0]
    assert not sailed.failed.any()
    turning = np.argmax(np.abs(t["psi"]) > math.radians(5.0))
    assert 1.5 < (2400.0 - t["x"][turning]) / 230.0 < 3.5
    late = t["y"] > 1500.0
    assert np.abs(t["x"][late] - 2400.0).max() < 0.1 * 230.0


def test_time_of_a_decision():
    """1 Hz on one core needs less than a second; measured 0.2 ms, and 0.5 ms on a track."""
    made, scenario = MPC(GAINS), load_scenario()
    made.reset(1, load_ship("kcs"), scenario)
    rng, spent = np.random.default_rng(0), []
    for _ in range(50):
        seen = rng.uniform(-0.2, 0.2, (1, 9))
        seen[0, 1] = 1.0
        begun = time.perf_counter()
        made.act(seen)
        spent.append(time.perf_counter() - begun)
    assert np.median(spent) < 0.1


def test_without_osqp_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "osqp", None)
    with pytest.raises(ImportError, match=r"mpc needs osqp: pip install .ship-gym\[benchmark\]"):
        MPC(GAINS).reset(1, load_ship("kcs"), load_scenario())


def test_wrong_gains_are_refused():
    with pytest.raises(ConfigError, match=r"gains.track.cross_track = 0.0: must be positive"):
        TrackWeights(cross_track=0.0)
    with pytest.raises(ConfigError, match=r"gains.rate = -1"):
        MPCGains(GAINS.observer, rate=-1.0)
