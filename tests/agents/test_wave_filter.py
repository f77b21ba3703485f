import dataclasses
import math

import numpy as np
import pytest
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.wave_filter import LinearShip, LowPass, Observer, identify

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, N, R, U, V
from ship_gym.simulation import ShipSim, self_propulsion

SHIP = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
OBSERVER = Observer(SHIP, 0.5, 2.0, 0.8, 0.05, 0.25)
WAVES = dataclasses.replace(OBSERVER, wave_frequency=18.0, wave_damping=0.3, wave_noise=30.0)
FILTERS = {"low-pass": LowPass(0.05, 0.2, 0.2), "observer": OBSERVER, "waves": WAVES}
STEP = 1.0 / 30.0


def sailing(ship, rudder, bias=0.0, psi=0.0):
    """Motion psi, v', r' of a linear ship at the ends of intervals, to rudder angles there."""
    A = np.array([[0.0, 0.0, 1.0], [0.0, ship.Y_v, ship.Y_r], [0.0, ship.N_v, ship.N_r]])
    B = np.array([0.0, ship.Y_delta, ship.N_delta])
    x, rows, fine = np.array([psi, 0.0, 0.0]), [], 20
    before = np.append(rudder[0], rudder[:-1])
    for first, last in zip(before, rudder, strict=True):
        for delta in np.linspace(first, last, fine, endpoint=False):
            middle = x + 0.5 * STEP / fine * (A @ x + B * (delta - bias))
            x = x + STEP / fine * (A @ middle + B * (delta - bias))
        rows.append(x)
    return np.array(rows)


def run(parameters, motion, rudder, jump=None):
    """Estimates, shape (T, 4), of a filter that sees `motion` (psi, v', r') and the rudder."""
    made, found = parameters.start(1, STEP), []
    for k, (psi, v, r) in enumerate(motion):
        shift = np.zeros(1) if jump is None else jump[k : k + 1]
        seen = (np.array([z]) for z in (psi, r, v, rudder[k]))
        found.append([np.ravel(z)[0] for z in made(*seen, shift)])
    return np.array(found)


def held_rudder(T, seed=0):
    return np.repeat(np.random.default_rng(seed).uniform(-0.1, 0.1, T // 20), 20)


@pytest.mark.parametrize("name", ["kcs", "kvlcc2_model"])
def test_identified_ship_turns_as_the_ship_does(name):
    """A gentle turn: rudder 3 deg, rate and drift of the linear ship beside the simulated one."""
    ship = load_ship(name)
    linear = identify(ship)
    sim, n = ShipSim(ship, 2, parallel=False), self_propulsion(ship, ship.speed)
    sim.set_interval(1.0 / ship.time_unit)
    sim.state[:, U], sim.state[:, N] = ship.speed, n
    sim.commands[:] = [[math.radians(3.0), n], [math.radians(-3.0), n]]
    seen = []
    for _ in range(60):
        sim.advance()
        seen.append(sim.state[:, [V, R, DELTA]])
    # half the difference of the two turns is free of the ship's own asymmetry
    turn = np.array(seen)
    turn = 0.5 * (turn[:, 0] - turn[:, 1])
    U0, L = ship.speed, ship.hull.L
    step, x = U0 / L / ship.time_unit, np.zeros(2)
    A = np.array([[linear.Y_v, linear.Y_r], [linear.N_v, linear.N_r]])
    for delta in turn[:, 2]:
        B = np.array([linear.Y_delta, linear.N_delta]) * delta
        x = np.linalg.solve(np.eye(2) - 0.5 * step * A, x + 0.5 * step * A @ x + step * B)
    assert x == pytest.approx(turn[-1, :2] * [1.0 / U0, L / U0], rel=0.1)


def test_rudder_for_a_turn_gives_that_turn():
    x = sailing(SHIP, held_rudder(100))
    v, r = x[-1, 1:]
    delta = SHIP.rudder_for(v, r, 0.7)
    assert SHIP.N_v * v + SHIP.N_r * r + SHIP.N_delta * delta == pytest.approx(0.7)
    ahead = sailing(SHIP, np.zeros(1))[0, 1]
    assert ahead == 0.0 and SHIP.sway_acceleration(0.0, 1.0, 0.0) == SHIP.Y_r


@pytest.mark.parametrize("parameters", [OBSERVER, WAVES])
def test_observer_follows_its_own_ship_and_finds_the_bias(parameters):
    rudder, bias = held_rudder(600), math.radians(2.0)
    x = sailing(SHIP, rudder, bias, psi=0.3)
    found = run(parameters, x, rudder)
    assert found[-1, 3] == pytest.approx(bias, rel=0.02)
    assert np.abs(found[300:, :3] - x[300:, [0, 2, 1]]).max() < 5e-4


@pytest.mark.parametrize("parameters", FILTERS.values(), ids=FILTERS)
def test_wave_frequency_motion_is_held_back(parameters):
    """What passes of the yaw rate at the encounter frequencies is a small part of it."""
    t, amplitude = STEP * np.arange(600), 0.003
    for w in (12.0, 18.0, 26.0):
        wave = np.stack([np.sin(w * t), 0.0 * t, w * np.cos(w * t)], axis=1) * amplitude
        found = run(parameters, wave, np.zeros(600))[300:]
        assert found[:, 1].std() < 0.5 * wave[300:, 2].std(), w


def test_the_wave_model_holds_back_more_at_its_frequency():
    t = STEP * np.arange(600)
    wave = 0.003 * np.stack([np.sin(18.0 * t), 0.0 * t, 18.0 * np.cos(18.0 * t)], axis=1)
    plain, waves = (run(p, wave, np.zeros(600))[300:, 1].std() for p in (OBSERVER, WAVES))
    assert waves < 0.5 * plain


@pytest.mark.parametrize("parameters", FILTERS.values(), ids=FILTERS)
def test_a_changed_order_is_no_motion(parameters):
    """With the jump named, the estimates are those of the unchanged order, across +-180 deg too."""
    rudder = held_rudder(200)
    x = sailing(SHIP, rudder)
    jump = np.zeros(200)
    jump[100] = math.radians(170.0)
    moved = x.copy()
    moved[100:, 0] = (x[100:, 0] + jump[100] + math.pi) % (2.0 * math.pi) - math.pi
    kept, found = run(parameters, x, rudder), run(parameters, moved, rudder, jump)
    assert found[:, 1:] == pytest.approx(kept[:, 1:], abs=1e-12)
    turned = found[100:, 0] - kept[100:, 0] - jump[100]
    assert np.cos(turned) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("parameters", FILTERS.values(), ids=FILTERS)
def test_batch_is_the_same_as_single_episodes(parameters):
    kind = "low_pass" if isinstance(parameters, LowPass) else "observer"
    gains = Gains(2.0, 1.0, K_v=-2.0, **{kind: parameters})
    pids = [PID(gains) for _ in range(6)]
    for k, pid in enumerate(pids):
        pid.reset(5 if k == 0 else 1, load_ship("kcs"), load_scenario())
    for k in range(20):
        seen = np.random.default_rng(k).uniform(-1.0, 1.0, (5, 9))
        rows = [pid.act(seen[i : i + 1]) for i, pid in enumerate(pids[1:])]
        assert np.array_equal(pids[0].act(seen), np.vstack(rows))


def test_gains_of_each_episode():
    """Arrays of noises, as tuning has them, give each row its own filter."""
    many = dataclasses.replace(OBSERVER, yaw_noise=np.array([0.5, 5.0]))
    both, t = many.start(2, STEP), STEP * np.arange(50)
    single = [dataclasses.replace(OBSERVER, yaw_noise=q).start(1, STEP) for q in (0.5, 5.0)]
    for s in np.sin(3.0 * t):
        seen = [np.full(2, z) for z in (0.1 * s, 0.3 * s, 0.0, 0.0, 0.0)]
        together = np.stack(both(*seen))
        alone = np.hstack([np.stack(f(*(z[:1] for z in seen))) for f in single])
        assert np.array_equal(together, alone)
    assert together[1, 0] != together[1, 1]


def test_low_pass_by_hand():
    """Share 1 - exp(-step / T) of each change; an order that changes is no motion."""
    low = LowPass(T_psi=1.0, T_r=2.0, T_v=4.0).start(1, 0.5)
    first = low(*(np.array([x]) for x in (0.1, 0.2, 0.3)), None, 0.0)
    assert [float(x[0]) for x in first[:3]] == pytest.approx([0.1, 0.2, 0.3]) and first[3] == 0.0
    psi, r, v, _ = low(*(np.array([x]) for x in (0.3, 0.6, -0.5)), None, 0.05)
    assert psi[0] == pytest.approx(0.15 + (1.0 - math.exp(-0.5)) * 0.15)
    assert r[0] == pytest.approx(0.2 + (1.0 - math.exp(-0.25)) * 0.4)
    assert v[0] == pytest.approx(0.3 - (1.0 - math.exp(-0.125)) * 0.8)


def test_wrong_filters_are_refused():
    with pytest.raises(ConfigError, match=r"low_pass.T_r = -1"):
        LowPass(0.0, -1.0, 0.0)
    with pytest.raises(ConfigError, match=r"observer.bias_noise = 0.0: must be positive"):
        dataclasses.replace(OBSERVER, bias_noise=0.0)
    with pytest.raises(ConfigError, match=r"linear_ship.N_delta"):
        dataclasses.replace(SHIP, N_delta=-1.0)
    with pytest.raises(ConfigError, match="one filter"):
        Gains(1.0, 1.0, low_pass=FILTERS["low-pass"], observer=OBSERVER)
    with pytest.raises(ConfigError, match="without an observer"):
        Gains(1.0, 1.0, K_b=1.0)
