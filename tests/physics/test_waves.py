"""Waves at run time: Newman's sum, its limits, and wave-frequency motion on top of the state."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.conventions import FORCE_COMPONENTS, PSI
from ship_gym.physics.quantities import Body
from ship_gym.physics.scratch import N_SUMS
from ship_gym.physics.waves import (
    AMPLITUDE,
    DIRECTION,
    NUMBER,
    OMEGA,
    WAVE_ROLL,
    WAVE_SWAY,
    WAVE_YAW,
    WAVE_YAW_RATE,
    wave_loads,
)
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import RegularWave, Sea, irregular_sea, regular_sea
from ship_gym.sea.wave_response import wave_response
from ship_gym.sea.wave_table import WaveTable
from ship_gym.ships import load_ship
from ship_gym.simulation import ShipSim

SPEED_STEP = 0.05 * math.sqrt(9.80665 * 230.0)


@pytest.fixture(scope="module")
def ship(tmp_path_factory):
    """KCS with a smooth made-up wave table: tests of the sums need no boundary elements."""
    froude, mu = np.array([0.0, 0.1, 0.15, 0.2, 0.26, 0.3]), np.linspace(0.0, np.pi, 13)
    omega = np.linspace(1.38, 5.6, 40)
    F, M, W = np.meshgrid(froude, mu, omega, indexing="ij")
    CX = np.cos(M) * (1.0 + 3.0 * F) * 3.0 * np.exp(-((W - 2.5) ** 2))
    CY, CN = -0.5 * np.sin(M) * W / 4.0, -0.05 * np.sin(2.0 * M)
    motions = np.zeros((*F.shape, 6), dtype=np.complex64)
    motions[..., 1] = 0.5j * np.sin(M) / W
    motions[..., 3] = 0.3 * np.sin(M) * (1.0 + 0.5j)
    motions[..., 5] = 0.2j * np.sin(2.0 * M) / W
    f4 = np.float32
    table = WaveTable(
        froude, mu, omega, CX.astype(f4), CX.astype(f4), CY.astype(f4), CN.astype(f4), motions,
        np.zeros(F.shape, dtype=np.uint8), {"ship": "made up"},
    )  # fmt: skip
    path = tmp_path_factory.mktemp("waves") / "waves.npz"
    table.save(path)
    return dataclasses.replace(load_ship("kcs"), wave_table=str(path))


def made(ship, sea, n=1, seed=3):
    sim = ShipSim(ship, n, sea, parallel=False)
    sim.reset(seed)
    return sim


def loads(sim, time, body, mean_only=False):
    """What waves do at one instant, without a coming step."""
    sim.seas["mean_drift"][0] = mean_only
    work = np.zeros((N_SUMS, 8))
    return np.array(wave_loads(time, 0.0, Body(*body), sim.seas[0], sim.water.waves, 0, work))


def coefficients(ship, sim, psi, u):
    """Drift coefficients and complex motions of each wave, by numpy from the response table."""
    waves = sim.water.waves_of(0)
    omega, _ = sim.water.waves.components[0, 1:, sim.water.columns].T
    response = np.moveaxis(wave_response(ship, omega, "blend"), -2, -1)
    mu = (psi - waves[DIRECTION] + np.pi) % (2.0 * np.pi) - np.pi
    side, mu = np.where(mu >= 0.0, 1.0, -1.0), np.abs(mu)
    i, j = u / SPEED_STEP, mu / (np.pi / 12)
    i0, j0 = int(i), np.minimum(j.astype(int), 11)
    w, q = i - i0, (j - j0)[:, None]
    k = np.arange(waves.shape[1])
    low = (1 - q) * response[i0, j0, k] + q * response[i0, j0 + 1, k]
    high = (1 - q) * response[i0 + 1, j0, k] + q * response[i0 + 1, j0 + 1, k]
    T = (1 - w) * low + w * high
    T[:, 1:] *= side[:, None]
    return T


BODY = (7.0, 0.2, 0.001, 120.0, -340.0, 0.7)
SEA = Sea(
    waves=(WaveSystem("jonswap", 3.0, 9.0, spreading=1.0), WaveSystem("bretschneider", 1.5, 13.0)),
    wave_direction_to=2.0,
    wave_count=40,
)


def phases_at(waves, time, body):
    """omega t - k (x cos chi + y sin chi) + phase of each wave [rad], by numpy."""
    _, omega, number, phase, direction = waves
    along = body[3] * np.cos(direction) + body[4] * np.sin(direction)
    return omega * time - number * along + 2.0 * np.pi * phase


def test_waves_are_met_at_the_place_of_the_ship(ship):
    """Motions Re[T a exp(i theta)] of all waves, also where they do not fill the last eight."""
    sim, time = made(ship, dataclasses.replace(SEA, wave_count=37)), 77.0
    waves = sim.water.waves_of(0)
    assert waves.shape == (5, 37)
    np.testing.assert_allclose(waves[NUMBER], waves[OMEGA] ** 2 / 9.80665, rtol=1e-12)
    wave = waves[AMPLITUDE] * np.exp(1j * phases_at(waves, time, BODY))
    T = coefficients(ship, sim, BODY[5], BODY[0])
    found = loads(sim, time, BODY)
    for channel, k in ((WAVE_SWAY, 3), (WAVE_ROLL, 5), (WAVE_YAW, 7)):
        expected = ((T[:, k] + 1j * T[:, k + 1]) * wave).real.sum()
        assert found[channel] == pytest.approx(expected, abs=1e-9)


def test_drift_is_the_double_sum_of_newman_with_the_arithmetic_mean(ship):
    """F = sum_mn a_m a_n (T_m + T_n)/2 cos(theta_m - theta_n), exactly."""
    sim = made(ship, SEA)
    waves, time = sim.water.waves_of(0), 77.0
    a, theta = waves[AMPLITUDE], phases_at(waves, time, BODY)
    T = coefficients(ship, sim, BODY[5], BODY[0])[:, :3]
    cosine = np.outer(a, a) * np.cos(theta[:, None] - theta[None, :])
    expected = [(cosine * 0.5 * (T[:, None, k] + T[None, :, k])).sum() for k in range(3)]
    np.testing.assert_allclose(loads(sim, time, BODY)[:3], expected, rtol=1e-9)


def test_one_wave_gives_its_constant_drift(ship):
    sim = made(ship, regular_sea(1.5, wavelength=230.0, direction_from=1.0))
    T = coefficients(ship, sim, BODY[5], BODY[0])[0, :3]
    for time in (0.0, 3.3, 1000.0):
        np.testing.assert_allclose(loads(sim, time, BODY)[:3], 1.5**2 * T, rtol=1e-9)


@pytest.mark.compiled
def test_time_mean_of_the_drift_is_that_of_the_spectrum(ship):
    """2 Int S T d omega = sum a^2 T, which `mean` gives at every time."""
    sim = made(ship, irregular_sea(3.0, 9.0, direction_from=1.0))
    T = coefficients(ship, sim, BODY[5], BODY[0])[:, :3]
    expected = sim.water.waves_of(0)[AMPLITUDE] ** 2 @ T
    np.testing.assert_allclose(loads(sim, 5.0, BODY, mean_only=True)[:3], expected, rtol=1e-9)
    still = (BODY[0], *BODY[1:])
    times = np.arange(0.0, 60000.0, 1.7)
    mean = np.mean([loads(sim, t, still)[:3] for t in times], axis=0)
    np.testing.assert_allclose(mean, expected, rtol=0.05)


@pytest.mark.compiled
def test_motion_is_the_sum_of_response_times_wave_and_its_rate_the_derivative(ship):
    sim = made(ship, SEA)
    T = coefficients(ship, sim, BODY[5], BODY[0])
    waves = sim.water.waves_of(0)
    variance = 0.5 * (waves[AMPLITUDE] ** 2 * (T[:, 7] ** 2 + T[:, 8] ** 2)).sum()
    times = np.arange(0.0, 20000.0, 0.9)
    yaw = np.array([loads(sim, t, BODY)[WAVE_YAW] for t in times])
    assert yaw.std() == pytest.approx(math.sqrt(variance), rel=0.03)
    # the rate is that seen from the moving ship: it moves on while the time runs
    u, v, r, x, y, psi = BODY
    north = u * math.cos(psi) - v * math.sin(psi)
    east = u * math.sin(psi) + v * math.cos(psi)
    h = 1e-3
    before, after = (
        loads(sim, 50.0 + s * h, (u, v, r, x + s * h * north, y + s * h * east, psi))
        for s in (-1, 1)
    )
    now = loads(sim, 50.0, BODY)
    assert now[WAVE_YAW_RATE] == pytest.approx((after - before)[WAVE_YAW] / (2 * h), rel=1e-4)
    assert now[WAVE_SWAY + 1] == pytest.approx((after - before)[WAVE_SWAY] / (2 * h), rel=1e-4)


def test_waves_from_starboard_push_to_port_and_mirror(ship):
    starboard = made(ship, regular_sea(2.0, wavelength=200.0, direction_from=math.pi / 2))
    port = made(ship, regular_sea(2.0, wavelength=200.0, direction_from=-math.pi / 2))
    body = (7.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    one, other = loads(starboard, 4.0, body), loads(port, 4.0, body)
    assert one[1] < 0.0
    np.testing.assert_allclose(one[:2], other[:2] * [1.0, -1.0], rtol=1e-11)


def test_off_costs_nothing_and_drift_can_be_switched_off(ship):
    calm, flat = made(ship, Sea()), made(ship, Sea(waves=(WaveSystem(height=0.0),)))
    none = made(ship, dataclasses.replace(SEA, drift="none"))
    for sim in (calm, flat, none):
        for _ in range(5):
            sim.step(np.array([[0.1, sim.state[0, 7]]]), 1.0)
    assert calm.water.n_waves == 0 and (calm.state == flat.state).all()
    assert (calm.state == none.state).all() and (
        none.forces[0, FORCE_COMPONENTS.index("wave")] == 0.0
    ).all()
    assert none.waves[0, WAVE_YAW] != 0.0


@pytest.mark.compiled
def test_batch_of_one_serial_and_parallel_are_the_same_bits(ship):
    def sailed(n, parallel, seed):
        sim = ShipSim(ship, n, dataclasses.replace(SEA, wind_speed=12.0, gusts=True), parallel)
        sim.reset(seed)
        for k in range(40):
            sim.step(np.tile([0.3 * math.sin(0.1 * k), 1.2], (n, 1)), 1.0)
        return sim

    serial, parallel, alone = sailed(3, False, 5), sailed(3, True, 5), sailed(1, False, 7)
    for name in ("state", "forces", "waves"):
        assert (getattr(serial, name) == getattr(parallel, name)).all(), name
        assert (getattr(serial, name)[2] == getattr(alone, name)[0]).all(), name


def test_ships_with_tables_of_another_length_sail_together():
    ships = [load_ship("kcs"), load_ship("kvlcc2"), load_ship("onrt")]
    sea = irregular_sea(3.0, 9.0, direction_from=1.0)
    fleet = ShipSim(ships, 3, sea, parallel=False)
    fleet.reset(4)
    commands = np.array([[0.1, n] for n in fleet.state[:, 7]])
    for _ in range(20):
        fleet.step(commands, 1.0)
    for i, ship in enumerate(ships):
        alone = ShipSim(ship, 1, sea)
        alone.reset(4 + i)
        for _ in range(20):
            alone.step(commands[i : i + 1], 1.0)
        assert (alone.state[0] == fleet.state[i]).all(), ship.name


@pytest.mark.compiled
def test_wave_frequency_motion_does_not_enter_the_state(ship):
    """Energy of the integrated heading at the encounter frequency: below 5 % of the wave yaw."""
    sim = made(ship, irregular_sea(4.0, 9.0, direction_from=0.8))
    command = np.array([[0.0, sim.state[0, 7]]])
    heading, seen = [], []
    for _ in range(1500):
        sim.step(command, 1.0)
        sim.commands[0, 0] = 0.0
        heading.append(sim.state[0, PSI])
        seen.append(sim.waves[0, WAVE_YAW])
    spectrum, yaw = (np.abs(np.fft.rfft(np.diff(x))) ** 2 for x in (heading, seen))
    band = slice(int(len(yaw) * 0.12), None)  # faster than 0.06 Hz
    assert spectrum[band].sum() < 0.05**2 * yaw[band].sum()


def test_speed_and_frequency_outside_the_table_are_clamped_and_told(ship):
    sim = made(ship, regular_sea(1.0, wavelength=230.0))
    fast = loads(sim, 0.0, (20.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    last = loads(sim, 0.0, (6 * SPEED_STEP, 0.0, 0.0, 0.0, 0.0, 0.0))
    np.testing.assert_allclose(fast[:3], last[:3])
    assert fast[8] == pytest.approx(20.0 / (6 * SPEED_STEP) - 1.0) and last[8] == 0.0
    short = made(ship, Sea(regular=RegularWave(0.2, 3.0)))
    assert short.seas["waves_outside"][0] == 1.0  # all of its energy
    assert np.isfinite(wave_response(ship, np.array([0.01, 30.0]), "blend")).all()
