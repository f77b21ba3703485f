"""The environment in waves, wind and current: bits, observation, info, bounds."""

import math

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.conventions import PSI
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation import rollout
from ship_gym.scenarios import sea_range
from ship_gym.sea import components
from ship_gym.sea.gusts import turbulence_intensity

ID = "ShipGym/HeadingKeeping-v0"
CALM = {"sea.states": [], "sea.gusts": False}
SEAWAY = CALM | {
    "sensors.noise": False,
    "sea.wave_height": 4.0,
    "sea.wave_height_min": 1.0,
    "sea.peak_period": 9.7,
    "sea.spreading": 1.0,
    "sea.wind_speed": 15.0,
    "sea.gusts": True,
}
ENDS_OFTEN = {"duration": 60.0, "start.heading_error_deg": 20.0, "limits.heading_error_deg": 24.0}


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_native_is_sync_of_scalars_bit_for_bit_in_a_seaway(mode):
    options = {"overrides": SEAWAY | ENDS_OFTEN}
    native = ship_gym.ShipVectorEnv(3, autoreset_mode=mode, **options)
    sync = SyncVectorEnv([lambda: gym.make(ID, **options).unwrapped] * 3, autoreset_mode=mode)
    (a, _), (b, _) = native.reset(seed=5), sync.reset(seed=5)
    assert (a == b).all()
    ended = 0
    for k in range(150):
        actions = np.full((3, 1), math.sin(0.05 * k), dtype=np.float32)
        one, other = native.step(actions), sync.step(actions)
        for x, y in zip(one[:4], other[:4], strict=True):
            assert (x == y).all(), k
        ended += one[2].sum() + one[3].sum()
    assert ended > 3


def test_the_observation_sees_the_wave_frequency_yaw_and_the_state_does_not():
    env = ShipEnv(overrides=SEAWAY)
    obs, _ = env.reset(seed=1)
    sim = env.episodes.sim
    yaw = sim.waves[0, 6]
    assert abs(yaw) > 1e-5
    psi_e = sim.state[0, PSI] + yaw - env.episodes.tasks["psi_ordered"][0]
    assert obs[0] == pytest.approx(math.sin(psi_e), abs=1e-6)


def test_forces_of_waves_and_wind_are_in_info():
    env = ShipEnv(overrides=SEAWAY)
    env.reset(seed=2)
    for _ in range(5):
        *_, info = env.step(np.array([0.0]))
    assert np.abs(info["forces"]["wave"]).min() > 0.0
    assert np.abs(info["forces"]["wind"]).min() > 0.0
    # the tail of the spectrum is shorter than the table's shortest wave: clamped, and told
    assert 0.0 < info["waves_outside"] < 0.3 and info["waves_extrapolation"] == 0.0
    calm = ShipEnv(overrides=CALM)
    calm.reset(seed=2)
    *_, info = calm.step(np.array([0.0]))
    assert "waves_extrapolation" not in info and "waves_outside" not in info
    assert (info["forces"]["wave"] == 0.0).all() and (info["forces"]["wind"] == 0.0).all()


def test_every_episode_has_another_sea_and_a_seed_has_one():
    env = ShipEnv(overrides=SEAWAY)

    def sea(seed):
        env.reset(seed=seed)
        sim = env.episodes.sim
        amplitude, _, _, phase, _ = sim.water.waves_of(0)
        height = 4.0 * math.sqrt(0.5 * (amplitude**2).sum())
        return height, phase, sim.seas["wind_north"][0]

    one, again, other = sea(3), sea(3), sea(4)
    assert one[0] == again[0] and (one[1] == again[1]).all() and one[2] == again[2]
    assert one[0] != other[0] and (one[1] != other[1]).all() and one[2] != other[2]
    heights = [sea(k)[0] for k in range(40)]
    assert 1.0 <= min(heights) < 1.6 and 3.4 < max(heights) <= 4.0 + 1e-9


@pytest.mark.parametrize("ship", ["kcs_model", "kvlcc2", "onrt", "dtc", "s175"])
def test_every_ship_sails_in_it_and_observations_stay_in_bounds(ship):
    env = ship_gym.ShipVectorEnv(8, ship=ship, overrides=SEAWAY)
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(60):
        obs, *_ = env.step(rng.uniform(-1.0, 1.0, (8, 1)).astype(np.float32))
        assert env.observation_space.contains(obs)


def gust_shares(env):
    """Amplitudes of the gusts' harmonics by the mean wind, of the one ship of an environment."""
    water = env.episodes.sim.water
    sea = water.records[0]
    return sea["gust_scale"] * water.gusts[sea["wind_table"], 0]


def test_a_model_gets_the_sea_scaled():
    full, model = ShipEnv(ship="kcs", overrides=SEAWAY), ShipEnv(ship="kcs_model", overrides=SEAWAY)
    for env in (full, model):
        env.reset(seed=9)
    scale = model.ship.scale
    a, b = (env.episodes.sim.water.waves_of(0) for env in (full, model))
    np.testing.assert_allclose(b[0] * scale, a[0])
    np.testing.assert_allclose(b[1] / math.sqrt(scale), a[1])
    np.testing.assert_allclose(*(gust_shares(env) for env in (full, model)))


def test_recordings_hold_the_waves():
    class Amidships:
        name = "amidships"

        def reset(self, n, ship, scenario):
            self.n = n

        def act(self, observations):
            return np.zeros((self.n, 1))

    episode = rollout(Amidships(), seeds=[1], overrides=SEAWAY | {"duration": 30.0}).episodes[0]
    for name in ("wave_sway", "wave_roll", "wave_yaw", "wave_yaw_rate", "X_wave", "N_wind"):
        assert np.abs(episode[name]).max() > 0.0, name


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"sea.wave_height": -1.0}, "wave"),
        ({"sea.wave_height": 2.0, "sea.wave_height_min": 3.0}, "wave_height_min = 3.0"),
        ({"sea.wave_height": 2.0, "sea.spectrum": "jonswop"}, "did you mean 'jonswap'"),
        ({"sea.gusts": True}, "gusts"),
        ({"sea.drift": "fast"}, "unknown drift"),
    ],
)
def test_seas_that_are_none(overrides, words):
    with pytest.raises(ConfigError, match=words):
        ShipEnv(overrides=CALM | overrides)


def test_a_smaller_wind_has_its_own_turbulence():
    wind = CALM | {"sea.wind_speed": 20.0, "sea.wind_speed_min": 2.0, "sea.gusts": True}
    env, found = ShipEnv(overrides=wind), []
    for seed in range(6):
        env.reset(seed=seed)
        sea = env.episodes.sim.seas[0]
        U = math.hypot(sea["wind_north"], sea["wind_east"])
        intensity = math.sqrt(0.5 * (gust_shares(env) ** 2).sum())
        found.append((U, intensity / turbulence_intensity(U)))
    U, ratio = np.array(found).T
    assert np.ptp(U) > 5.0
    # one factor for all winds: the height of the wind area, the frequencies of the largest wind
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)


def test_two_overrides_of_one_section_are_refused_where_one_would_be_lost():
    with pytest.raises(ConfigError, match="'sea' is given twice"):
        ShipEnv(overrides={"sea": 5, "sea.states": ["ss5"]})


@pytest.mark.parametrize(
    ("given", "most"),
    [
        ({}, 4),  # ss3 to ss6
        ({"overrides": {"sea.current_speed": 0.3, "duration": 300.0}}, 4),
        ({"ship": "kcs_model"}, 8),  # validated at full scale, sailed at that of the model
    ],
)
def test_every_weather_is_made_once_in_a_make(monkeypatch, given, most):
    sea_range._weathers.cache_clear()
    components._of_system.cache_clear()
    cut, calls = components.equal_energy, []
    monkeypatch.setattr(components, "equal_energy", lambda *a: (calls.append(1), cut(*a))[1])
    gym.make("ShipGym/HeadingKeeping-v0", **given)
    assert len(calls) == most
    gym.make("ShipGym/HeadingKeeping-v0", **given)
    assert len(calls) == most  # and the next environment of the same seas has them already
