"""What an environment says right after a reset, and what a model ship gets of the sea."""

import math

import gymnasium as gym
import numpy as np
import pytest

from ship_gym import load_ship
from ship_gym.conventions import PSI, R, U
from ship_gym.evaluation import rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.physics.waves import WAVE_YAW, WAVE_YAW_RATE
from ship_gym.sea.state import Sea
from ship_gym.simulation import ShipSim, self_propulsion
from ship_gym.tasks import observations_of

ID = "ShipGym/HeadingKeeping-v0"
CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
SEAWAY = CALM | {"sea.wave_height": 4.0, "sea.wave_height_min": 2.0, "sea.peak_period": 9.7}


def columns(obs, task="heading_keeping", privileged=False):
    """Observation by symbol."""
    rows = observations_of(task, privileged)
    return dict(zip([row.symbol for row in rows], obs.tolist(), strict=True))


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2_model", "onrt"])
@pytest.mark.parametrize("control", ["rudder", "rudder+rpm"])
def test_after_a_reset_the_propeller_command_is_self_propulsion_and_the_rudder_amidships(
    ship, control
):
    """Commanded and achieved alike, also after an episode that was sailed at full ahead."""
    env = gym.make(ID, ship=ship, control=control, overrides=CALM)
    given = load_ship(ship)
    share = self_propulsion(given, given.speed) / given.engine.n_max
    assert 0.2 < share < 0.98
    for seed in (0, 1):
        seen = columns(env.reset(seed=seed)[0])
        assert seen["n / n_max"] == pytest.approx(share, rel=1e-6)
        assert seen["n_c / n_max"] == pytest.approx(share, rel=1e-6)
        assert seen["delta / delta_max"] == seen["delta_c / delta_max"] == 0.0
        assert seen["u / U0"] == pytest.approx(1.0) and seen["r L / U0"] == 0.0
        for _ in range(3):
            obs, *_ = env.step(np.ones(env.action_space.shape))
        seen = columns(obs)
        assert seen["delta_c / delta_max"] == 1.0 > seen["delta / delta_max"] > 0.0
        if control == "rudder+rpm":
            assert seen["n_c / n_max"] == 1.0 > seen["n / n_max"] > share


@pytest.mark.parametrize("ship", ["kcs", "kcs_model"])
def test_waves_of_a_model_are_smaller_by_its_scale_and_shorter_in_time_by_its_root(ship):
    """H_s of 2 to 4 m and T_p of 9.7 s; the waves that are sailed have that height, 4 sqrt(m0)."""
    scale = load_ship(ship).scale
    env = gym.make(ID, ship=ship, privileged=True, overrides=SEAWAY)
    obs, _ = env.reset(seed=5)
    seen = columns(obs, privileged=True)
    sim = env.unwrapped.episodes.sim
    amplitude, omega, *_ = sim.water.waves_of(0)
    height = 4.0 * math.sqrt(0.5 * np.sum(amplitude**2))
    assert 2.0 <= height * scale <= 4.0
    given = load_ship(ship)
    assert seen["H_s / d"] * given.hull.d == pytest.approx(height, rel=0.01)
    period = seen["T_p sqrt(g/L) / 2 pi"] * 2.0 * math.pi * math.sqrt(given.hull.L / 9.80665)
    assert period * math.sqrt(scale) == pytest.approx(9.7, rel=1e-6)
    # of a Bretschneider spectrum exp(-1.25) = 28.7 % of the energy lies below the peak
    below = omega / math.sqrt(scale) < 2.0 * math.pi / 9.7
    share = np.sum(amplitude[below] ** 2) / np.sum(amplitude**2)
    assert share == pytest.approx(math.exp(-1.25), abs=0.03)


@pytest.mark.parametrize("ship", ["kcs", "kcs_model"])
def test_a_recording_says_the_waves_of_the_ship_that_sailed(ship):
    overrides = SEAWAY | {"sea.wave_height_min": 4.0, "duration": 3.0}
    meta = rollout(ConstantController(), seeds=[1], ship=ship, overrides=overrides)
    sea, scale = meta.trajectory(0).meta["sea"], load_ship(ship).scale
    assert sea["wave_height"] * scale == pytest.approx(4.0)
    assert sea["wave_period"] * math.sqrt(scale) == pytest.approx(9.7)


def test_froude_s_law_of_a_sea():
    """At scale 64: lengths 1/64, times, speeds and periods 1/8; the disturbance has no scale."""
    sea = Sea(
        current_speed=1.6,
        current_period=1200.0,
        current_variation=0.25,
        wind_speed=16.0,
        sway_disturbance=0.01,
        correlation_time=3.0,
    ).scaled(64.0)
    assert (sea.current_speed, sea.current_period, sea.wind_speed) == (0.2, 150.0, 2.0)
    assert (sea.current_variation, sea.sway_disturbance, sea.correlation_time) == (0.25, 0.01, 3.0)


@pytest.mark.parametrize(("scale", "period"), [(1.0, 1200.0), (64.0, 150.0)])
def test_the_current_varies_with_the_period_of_the_ship_s_scale(scale, period):
    """V (1 + 0.25 cos(2 pi t / T + phase)): the same after T, the mirror about V after T / 2."""
    full = Sea(current_speed=1.6, current_period=1200.0, current_variation=0.25)
    sim = ShipSim(load_ship("kcs_model"), 1, full.scaled(scale))
    sim.reset(2)
    V = 1.6 / math.sqrt(scale)
    phase = 2.0 * math.pi * sim.seas["variation_phase"][0]
    for turns in (0.0, 0.2, 0.5, 1.0):
        sim.time[:] = turns * period
        sim.step([[0.0, 5.0]], 1e-3)
        now = 2.0 * math.pi * sim.time[0] / period  # at the end of the step
        expected = V * (1.0 + 0.25 * math.cos(now + phase))
        assert sim.seas["V_north"][0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("loading", [0.2, 0.4])
def test_loading_goes_into_every_mass_and_into_the_hull_alike(loading):
    """Draught, m + m_x, m + m_y, m x_G and I_z + J_z by the same factor."""
    env = gym.make(ID, overrides=CALM | {"randomisation.loading": loading})
    nominal = gym.make(ID, overrides=CALM).unwrapped.episodes.sim.records[0]
    factors = []
    for seed in range(5):
        _, info = env.reset(seed=seed)
        (factor,) = info["randomisation"].values()
        record = env.unwrapped.episodes.sim.records[0]
        for name in ("m_u", "m_v", "m_xG", "I_r"):
            assert nominal["inertia"][name] != 0.0
            ratio = record["inertia"][name] / nominal["inertia"][name]
            assert ratio == pytest.approx(factor, rel=1e-12), name
        ratio = record["hull"]["d"] / nominal["hull"]["d"]
        assert ratio == pytest.approx(factor, rel=1e-12)
        assert record["hull"]["L"] == nominal["hull"]["L"]
        factors.append(factor)
    assert 1.0 - loading <= min(factors) < 1.0 < max(factors) <= 1.0 + loading


def test_the_gyro_sees_the_wave_frequency_yaw_and_its_rate():
    """Without noise: sin of heading + wave yaw less the order; r L / U0 of r + wave yaw rate."""
    env = gym.make(ID, overrides=SEAWAY)
    obs, info = env.reset(seed=7)
    episodes = env.unwrapped.episodes
    for _ in range(20):
        obs, *_, info = env.step(np.zeros(1))
        seen, state = columns(obs), episodes.sim.state[0]
        u, r, psi = state[[U, R, PSI]]
        waves = episodes.sim.waves[0]
        yaw, rate = waves[WAVE_YAW], waves[WAVE_YAW_RATE]
        assert abs(rate) > 1e-7
        assert seen["r L / U0"] == pytest.approx((r + rate) * 230.0 / episodes.ship.speed, rel=1e-5)
        error = psi + yaw - info["psi_ordered"]
        assert seen["sin(psi_e)"] == pytest.approx(math.sin(error), abs=1e-6)
        assert seen["u / U0"] == pytest.approx(u / episodes.ship.speed, rel=1e-6)


def test_time_begins_at_zero_with_every_episode():
    env = gym.make(ID, overrides=CALM | {"control_interval": 2.0})
    for seed in (0, 1):
        assert env.reset(seed=seed)[1]["time"] == 0.0
        times = [env.step(np.zeros(1))[4]["time"] for _ in range(3)]
        assert times == pytest.approx([2.0, 4.0, 6.0])


@pytest.mark.parametrize(("uniform", "sign"), [(1e-9, -1.0), (1.0 - 1e-9, 1.0)])
def test_normal_draws_of_a_ship_end_at_three_standard_deviations(uniform, sign):
    """1e-9 lies at six: cut to 3 * 0.05 off the resistance and every derivative."""
    env = gym.make(ID, overrides=CALM | {"randomisation.hull_std": 0.05})
    env.reset(seed=0)
    episodes = env.unwrapped.episodes
    episodes.start(np.array([0]), np.full((1, episodes.n_draws), uniform))
    drawn = episodes.randomisation()
    assert len(drawn) == 17
    for name, value in drawn.items():
        assert value[0] == pytest.approx(1.0 + sign * 0.15, rel=1e-12), name
