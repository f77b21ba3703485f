"""Two systems, regular waves, measured spectra and a varying current in scenarios; elevation."""

import copy
import math
import pickle

import gymnasium as gym
import numpy as np
import pytest

import ship_gym
from ship_gym import ShipSim, load_ship
from ship_gym.config import ConfigError
from ship_gym.conventions import G
from ship_gym.envs.env import ShipEnv
from ship_gym.evaluation import rollout
from ship_gym.scenarios import load_scenario
from ship_gym.sea import (
    MeasuredSpectrum,
    Sea,
    irregular_sea,
    measured_sea,
    read_spectrum,
    regular_sea,
)
from ship_gym.sea.spectra import WaveSystem, jonswap

CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
BOTH = CALM | {
    "sea.wave_height": 2.0,
    "sea.wave_height_min": 1.0,
    "sea.peak_period": 7.0,
    "sea.spreading": 2.0,
    "sea.swell_height": 3.0,
    "sea.swell_height_min": 1.5,
    "sea.swell_period": 15.0,
    "sea.swell_spreading": 12.0,
}
ONE = {"sea.wave_height_min": 2.0, "sea.swell_height_min": 3.0, "sea.wave_encounter_deg": 180.0,
       "sea.swell_encounter_deg": 90.0}  # fmt: skip


def angle(a, b):
    return math.degrees((a - b + math.pi) % (2.0 * math.pi) - math.pi)


def systems(env):
    """Waves of the wind sea and of the swell of the only episode, shapes (5, N)."""
    waves = env.episodes.sim.water.waves_of(0)
    first = env.episodes._weathers._choices[0].sea.first_count
    return waves[:, :first], waves[:, first:]


def height(waves):
    return 4.0 * math.sqrt(0.5 * (waves[0] ** 2).sum())


@pytest.mark.parametrize("ship", ["kcs", "kcs_model"])
def test_wind_sea_and_swell_have_their_heights_periods_and_directions(ship):
    env = ShipEnv(ship=ship, overrides=BOTH | ONE)
    scale = load_ship(ship).scale
    _, info = env.reset(seed=3)
    task = env.episodes.tasks[0]
    for waves, H, T, encounter in zip(systems(env), (2.0, 3.0), (7.0, 15.0), (180.0, 90.0),
                                      strict=True):  # fmt: skip
        assert height(waves) * scale == pytest.approx(H, rel=1e-9)
        mean = np.angle((waves[0] ** 2 * np.exp(1j * waves[4])).sum())
        assert angle(info["psi_ordered"] - math.radians(encounter), mean) == pytest.approx(
            0.0, abs=0.1
        )
        T_1 = 2.0 * np.pi * (waves[0] ** 2).sum() / (waves[0] ** 2 @ waves[1]) * math.sqrt(scale)
        assert 0.75 * T < T_1 < 0.9 * T  # a Bretschneider's is 0.77 T_p, a JONSWAP's 0.83
    # what the bridge is not told: the height of both, the period and direction of the higher
    assert task["wave_height"] * scale == pytest.approx(math.hypot(2.0, 3.0))
    assert task["wave_period"] * math.sqrt(scale) == pytest.approx(15.0)
    assert angle(info["psi_ordered"], task["wave_to"]) == pytest.approx(90.0, abs=1e-9)


def test_heights_and_directions_of_the_two_are_drawn_each_for_itself():
    env, found = ShipEnv(overrides=BOTH), []
    for seed in range(60):
        env.reset(seed=seed)
        sea, swell = systems(env)
        found.append([height(sea), height(swell), sea[4].mean(), swell[4].mean()])
        task = env.episodes.tasks[0]
        assert task["wave_height"] == pytest.approx(math.hypot(*found[-1][:2]))
        assert task["wave_period"] == (15.0 if found[-1][1] > found[-1][0] else 7.0)
    found = np.array(found)
    assert 1.0 <= found[:, 0].min() < 1.1 and 1.9 < found[:, 0].max() <= 2.0 + 1e-9
    assert 1.5 <= found[:, 1].min() < 1.65 and 2.85 < found[:, 1].max() <= 3.0 + 1e-9
    assert abs(np.corrcoef(found[:, 0], found[:, 1])[0, 1]) < 0.3
    apart = np.exp(1j * (found[:, 2] - found[:, 3]))
    assert abs(apart.mean()) < 0.3


def test_the_elevation_of_two_systems_has_the_statistics_of_their_sum():
    """Over an hour and a square kilometre: H_s^2 adds up, no skewness, kurtosis of a normal one."""
    env = ShipEnv(overrides=BOTH | ONE)
    env.reset(seed=1)
    rng = np.random.default_rng(0)
    x, y, t = rng.uniform([-1000.0, -1000.0, 0.0], [1000.0, 1000.0, 3600.0], (100_000, 3)).T
    zeta = env.elevation(x, y, t)
    assert 4.0 * zeta.std() == pytest.approx(math.hypot(2.0, 3.0), rel=0.02)
    unit = (zeta - zeta.mean()) / zeta.std()
    assert zeta.mean() == pytest.approx(0.0, abs=0.02)
    assert (unit**3).mean() == pytest.approx(0.0, abs=0.05)
    assert (unit**4).mean() == pytest.approx(3.0, abs=0.15)


def test_a_swell_alone_is_the_sea_of_that_system():
    swell = BOTH | {"sea.wave_height": 0.0, "sea.wave_height_min": 0.0, "sea.peak_period": 8.8}
    swell |= {"sea.swell_height_min": 3.0, "sea.swell_encounter_deg": 180.0}
    env = ShipEnv(overrides=swell)
    _, info = env.reset(seed=2)
    sea, waves = systems(env)
    assert sea.shape[1] == 0 and height(waves) == pytest.approx(3.0)
    wanted = Sea(waves=(WaveSystem("jonswap", 3.0, 15.0, spreading=12.0),)).components()
    np.testing.assert_allclose(waves[1], wanted.omega)
    assert angle(info["psi_ordered"], env.episodes.tasks["wave_to"][0]) == pytest.approx(-180.0)


def test_forces_of_a_swell_apart_are_those_of_the_same_waves_of_one_sea():
    """The same waves, once as a swell of its own and once with fixed directions in `ShipSim`."""
    env = ShipEnv(overrides=BOTH | ONE)
    _, info = env.reset(seed=5)
    order, sim = info["psi_ordered"], env.episodes.sim
    one = WaveSystem("bretschneider", 2.0, 7.0, spreading=2.0)
    two = WaveSystem("jonswap", 3.0, 15.0, spreading=12.0, direction=math.pi / 2.0)
    sea = Sea(waves=(one, two), wave_direction_to=order - math.pi)
    other = ShipSim("kcs", 1, sea)
    other.reset(0)
    mine, theirs = (s.water.waves_of(0) for s in (sim, other))
    turns = {tuple(np.round(w[[1, 4]], 9) % [9.0, 2.0 * np.pi]): w[3] for w in mine.T}
    phases = [turns[tuple(np.round(w[[1, 4]], 9) % [9.0, 2.0 * np.pi])] for w in theirs.T]
    other.water.waves.phases[0, other.water.columns] = phases
    other.state[:] = sim.state
    other.set_interval(1.0)
    other.see_waves(np.array([0]))
    np.testing.assert_allclose(other.waves, sim.waves, rtol=1e-6, atol=1e-9)
    found, wanted = (s.loads_now(np.array([0]))[0] for s in (sim, other))
    np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize("ship", ["kcs", "kcs_model"])
@pytest.mark.parametrize("length", [0.0, 150.0])
def test_a_regular_wave_in_a_scenario(ship, length):
    regular = CALM | {"sea.spectrum": "regular", "sea.wave_height": 4.0, "sea.wave_height_min": 4.0,
                      "sea.wave_encounter_deg": 180.0, "sea.wavelength": length}  # fmt: skip
    regular |= {} if length else {"sea.peak_period": 10.0}
    env = ShipEnv(ship=ship, overrides=regular)
    env.reset(seed=1)
    scale = load_ship(ship).scale
    waves = env.episodes.sim.water.waves_of(0)
    omega = math.sqrt(2.0 * np.pi * G / length) if length else 2.0 * np.pi / 10.0
    assert waves.shape == (5, 1)
    assert waves[0, 0] * scale == pytest.approx(2.0) and waves[1, 0] == pytest.approx(
        omega * math.sqrt(scale)
    )
    task = env.episodes.tasks[0]
    assert task["wave_height"] * scale == pytest.approx(4.0)
    assert task["wave_period"] * math.sqrt(scale) == pytest.approx(2.0 * np.pi / omega)
    env.step(np.zeros(1))
    assert np.abs(env.episodes.sim.waves[0, :2]).max() > 0.0
    crest = env.elevation(0.0, 0.0, np.linspace(0.0, 20.0, 4001)).max()
    assert crest * scale == pytest.approx(2.0, rel=1e-4)


F = np.linspace(0.04, 0.4, 60)
S = 2.0 * np.pi * jonswap(2.0 * np.pi * F, 3.0, 9.0)


@pytest.fixture
def buoy(tmp_path):
    """A file whose waves come from 250 deg, with a spread of 30 deg."""
    rows = "".join(f"{f!r},{s!r},250,30\n" for f, s in zip(F.tolist(), S.tolist(), strict=True))
    path = tmp_path / "buoy.csv"
    path.write_text("frequency [Hz],density [m2/Hz],direction_from [deg],spread [deg]\n" + rows)
    return path


@pytest.mark.parametrize("ship", ["kcs", "kcs_model"])
def test_a_measured_spectrum_in_a_scenario(buoy, ship):
    file = CALM | {"sea.spectrum_file": str(buoy)}
    scale, m_0 = load_ship(ship).scale, np.trapezoid(S, F)
    env = ShipEnv(ship=ship, overrides=file | {"sea.wave_encounter_deg": 180.0})
    _, info = env.reset(seed=1)
    waves = env.episodes.sim.water.waves_of(0)
    assert 0.5 * (waves[0] ** 2).sum() * scale**2 == pytest.approx(m_0, rel=1e-12)
    mean = np.angle(np.exp(1j * waves[4]).sum())
    assert angle(info["psi_ordered"] - math.pi, mean) == pytest.approx(0.0, abs=1e-6)
    task = env.episodes.tasks[0]
    assert task["wave_height"] * scale == pytest.approx(4.0 * math.sqrt(m_0))
    assert task["wave_period"] * math.sqrt(scale) == pytest.approx(1.0 / F[np.argmax(S)])
    north = ShipEnv(ship=ship, overrides=file | {"sea.spectrum_north": True,
                                                 "sea.wave_height": 5.0})  # fmt: skip
    for seed in range(3):
        north.reset(seed=seed)
        waves = north.episodes.sim.water.waves_of(0)
        mean = np.angle(np.exp(1j * waves[4]).sum())
        assert math.degrees(mean) == pytest.approx(70.0, abs=1e-6)
        assert 0.0 < height(waves) * scale <= 5.0


def test_a_scenario_file_names_a_spectrum_in_its_own_folder(buoy):
    path = buoy.with_name("mine.toml")
    path.write_text(
        'base = "heading_keeping"\n[sea]\nstates = []\ngusts = false\nspectrum_file = "buoy.csv"\n'
    )
    scenario = load_scenario(path)
    assert scenario.sea.spectrum_file == str(buoy)
    env = ShipEnv(scenario=path)
    env.reset(seed=0)
    for again in (pickle.loads(pickle.dumps(env)), copy.deepcopy(env)):
        assert (again.step(np.zeros(1))[0] == copy.deepcopy(env).step(np.zeros(1))[0]).all()
    buoy.write_text(buoy.read_text().replace(",250,30", ",200,30"))  # the file has changed
    assert load_scenario(path).sea.weathers()[0].sea.spectrum.mean_direction == pytest.approx(
        math.radians(20.0)
    )


def test_a_current_that_varies():
    """V(t) = mean (1 + 0.4 cos(omega t + phase)), in the water and in the recording."""
    varying = CALM | {"sea.current_speed": 1.0, "sea.current_speed_min": 1.0, "duration": 1200.0,
                      "sea.current_variation": 0.4, "sea.current_period": 600.0}  # fmt: skip
    env = ShipEnv(overrides=varying)
    env.reset(seed=4)
    phase = env.episodes.sim.seas["variation_phase"][0]
    for _ in range(200):
        env.step(np.zeros(1))
    seas, time = env.episodes.sim.seas[0], env.episodes.sim.time[0]
    speed = math.hypot(seas["V_north"], seas["V_east"])
    last = time - env.episodes.sim.longest[0]  # the current of the last integration step
    found = [1.0 + 0.4 * math.cos(2.0 * np.pi * (t / 600.0 + phase)) for t in (time, last)]
    assert min(found) - 1e-9 <= speed <= max(found) + 1e-9

    class Amidships:
        name = "amidships"
        file = None

        def reset(self, n, ship, scenario):
            self.n = n

        def act(self, observations):
            return np.zeros((self.n, 1))

    episode = rollout(Amidships(), seeds=[4], overrides=varying).episodes[0]
    wanted = 1.0 + 0.4 * np.cos(2.0 * np.pi * (episode["t"] / 600.0 + phase))
    np.testing.assert_allclose(episode["current_speed"], wanted, rtol=1e-9)
    model = ShipEnv(ship="kcs_model", overrides=varying)
    model.reset(seed=4)
    period = 2.0 * np.pi / model.episodes.sim.seas["variation_omega"][0]
    assert period * math.sqrt(model.ship.scale) == pytest.approx(600.0)


def test_native_is_sync_of_scalars_with_all_of_it():
    options = {"overrides": BOTH | {"sea.current_speed": 1.0, "sea.current_variation": 0.3}}
    native = ship_gym.ShipVectorEnv(2, **options)
    alone = [gym.make("ShipGym/HeadingKeeping-v0", **options) for _ in range(2)]
    seen, _ = native.reset(seed=7)
    for i, env in enumerate(alone):
        assert (env.reset(seed=7 + i)[0] == seen[i]).all()
    for _ in range(20):
        seen, *_ = native.step(np.zeros((2, 1)))
        for i, env in enumerate(alone):
            assert (env.step(np.zeros(1))[0] == seen[i]).all()
    x = np.linspace(-300.0, 300.0, 7)
    found = native.elevation(x, 0.0, index=1)
    np.testing.assert_array_equal(found, alone[1].unwrapped.elevation(x, 0.0))
    assert native.elevation(0.0, 0.0).shape == ()


SEAS = {
    "regular": regular_sea(1.5, wavelength=200.0),
    "irregular": irregular_sea(3.0, 9.0, spreading=2.0),
    "two": Sea(waves=(WaveSystem("jonswap", 2.0, 8.0, spreading=2.0),
                      WaveSystem("jonswap", 1.0, 14.0, direction=1.0)), wave_direction_to=0.5),
    "calm": Sea(),
}  # fmt: skip


@pytest.mark.parametrize("name", SEAS)
def test_elevation_of_a_sea_is_that_of_the_simulation(name):
    sea = SEAS[name]
    sim = ShipSim("kcs", 2, sea)
    sim.reset(11)
    x, y, t = np.meshgrid([0.0, 50.0], [-20.0, 300.0, 5.0], [0.0, 7.0, 900.0], indexing="ij")
    found = sea.elevation(x, y, t, seed=12)
    np.testing.assert_allclose(found, sim.elevation(x, y, t, ship=1), atol=1e-12)
    assert found.shape == (2, 3, 3)
    # by hand, wave by wave
    a, omega, k, turns, to = sim.water.waves_of(1)
    at = sum(
        one[0] * math.cos(one[1] * 7.0 - one[2] * (50.0 * math.cos(one[4]) - 20.0
                                                   * math.sin(one[4])) + 2.0 * np.pi * one[3])
        for one in zip(a, omega, k, turns, to, strict=True)
    )  # fmt: skip
    assert found[1, 0, 1] == pytest.approx(at, abs=1e-12)
    if name == "regular":
        crest = sea.elevation(0.0, 0.0, 0.0, phases=[0.0])
        assert crest == pytest.approx(1.5)
        assert sea.elevation(-200.0, 0.0, 0.0, phases=[0.0]) == pytest.approx(1.5)
        with pytest.raises(ConfigError, match="phases have shape"):
            sea.elevation(0.0, 0.0, 0.0, phases=[0.0, 0.1])
    sim.step([[0.0, 1.5]] * 2, 10.0)
    np.testing.assert_array_equal(sim.elevation(1.0, 2.0), sim.elevation(1.0, 2.0, sim.time[0]))


def test_elevation_of_a_measured_sea_has_its_height():
    sea = measured_sea(MeasuredSpectrum(F, S))
    sim = ShipSim("kcs", 1, sea)
    sim.reset(0)
    zeta = sim.elevation(0.0, 0.0, np.arange(0.0, 10_800.0, 1.0))
    assert 4.0 * zeta.std() == pytest.approx(sea.height, rel=0.03)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"sea.spectrum": "regular", "sea.spreading": 2.0}, "spreading = 2.0 together with"),
        ({"sea.wavelength": 100.0}, "wavelength = 100.0 with spectrum"),
        ({"sea.spectrum": "regular", "sea.wavelength": 100.0, "sea.peak_period": 9.0},
         "peak_period = 9.0 together with"),
        ({"sea.spectrum": "regular", "sea.swell_height": 1.0}, "swell_height = 1.0 together"),
        ({"sea.spectrum": "regular", "sea.wave_height": 9.0, "sea.wavelength": 30.0}, "breaks"),
        ({"sea.swell_height": 2.0, "sea.swell_period": 2.0},
         r"sea.swell_...: waves.height = 2.0 m.*breaks"),
        ({"sea.gusts": True, "sea.swell_height": 2.0}, "or gusts = false"),
        ({"sea.swell_height": 2.0, "sea.swell_height_min": 3.0}, "swell_height_min = 3.0"),
        ({"sea.swell_spectrum": "flat", "sea.swell_height": 2.0}, "unknown spectrum 'flat'"),
        ({"sea.current_variation": 1.5}, "current_variation = 1.5"),
        ({"sea.spectrum_file": "none.csv"}, "none.csv: no such file"),
        ({"sea.spectrum_file": "a.txt"}, "suffix '.txt'"),
        ({"sea.spectrum_file": "none.csv", "sea.swell_height": 1.0}, "swell_height = 1.0"),
        ({"sea.spectrum_pick": "time=#0"}, "spectrum_pick = 'time=#0' together with"),
        ({"sea.states": ["ss5"], "sea.spectrum": "regular"}, "spectrum = 'regular' together"),
        ({"sea.states": ["ss5"], "sea.spectrum_file": "a.csv"}, "spectrum_file = 'a.csv' tog"),
    ],
)  # fmt: skip
def test_what_excludes_each_other(overrides, words):
    with pytest.raises(ConfigError, match=words) as error:
        ShipEnv(overrides=CALM | overrides)
    assert str(error.value).count("\n") == 0


def test_a_file_without_directions_has_none_from_north(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("frequency [Hz],density [m2/Hz]\n0.05,0\n0.1,1\n0.2,0\n")
    assert read_spectrum(path).direction == ()
    with pytest.raises(ConfigError, match="has no directions"):
        ShipEnv(overrides=CALM | {"sea.spectrum_file": str(path), "sea.spectrum_north": True})
    env = ShipEnv(overrides=CALM | {"sea.spectrum_file": str(path), "sea.spreading": 3.0})
    env.reset(seed=0)
    assert len(np.unique(env.episodes.sim.water.waves_of(0)[4])) == 12
