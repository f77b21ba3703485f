"""Equations of motion, integrator, step: by substitution, by order, bit by bit."""

import dataclasses

import numpy as np
import pytest

from ship_gym.physics.dynamics import accelerations
from ship_gym.sea import Sea
from ship_gym.ships import available_ships, load_ship
from ship_gym.simulation import ShipSim, longest_step
from tests.conftest import symmetric, tables_of

SEA = Sea(0.3, 1.0, 0.01, 0.001)


def test_accelerations_satisfy_the_equations_of_motion(ship):
    b = tables_of(ship)[0].inertia
    u, v, r = ship.speed, -0.2 * ship.speed, 0.6 * ship.speed / ship.hull.L
    X, Y, N = 1e-3 * b.m_u, 2e-3 * b.m_v, 3e-5 * b.I_r
    du, dv, dr = accelerations((u, v, r), X, Y, N, b)
    assert b.m_u * du - b.m_v * v * r - b.m_xG * r**2 == pytest.approx(X)
    assert b.m_v * dv + b.m_u * u * r + b.m_xG * dr == pytest.approx(Y)
    assert b.I_r * dr + b.m_xG * (dv + u * r) == pytest.approx(N)


def test_inertia_of_kcs_by_hand(kcs_model):
    b, rho = kcs_model.inertia, 999.103
    m, half = rho * 0.122, 0.5 * rho * 3.057**2 * 0.144
    assert b.m_u == pytest.approx(m + 0.0061 * half)
    assert b.m_v == pytest.approx(m + 0.1521 * half)
    assert b.m_xG == pytest.approx(-0.045 * m)
    assert b.I_r == pytest.approx(m * (0.764**2 + 0.045**2) + 0.0089 * half * 3.057**2)


def sail(ship, n=3, steps=40, sea=SEA, dt=None, seed=5, parallel=False, command=None):
    sim = ShipSim(ship, n, sea, parallel)
    sim.reset(seed)
    rng = np.random.default_rng(seed)
    dt = longest_step(ship) if dt is None else dt
    rudder = ship.gear.delta_max * rng.uniform(-1, 1, (steps, n))
    rpm = ship.engine.n_max * rng.uniform(0, 1, (steps, n))
    for k in range(steps):
        sim.step(np.stack([rudder[k], rpm[k]], axis=1) if command is None else command, dt)
    return sim


@pytest.mark.compiled
def test_third_order_in_time():
    """Kutta: errors fall by 8 when the step is halved, where the right-hand side is smooth.

    The tables of the ships are piecewise linear, whose kinks would hide the order at this accuracy;
    so the propeller here has a constant thrust coefficient, and the engine no torque limit (the
    torque is that of the start of the step). The next test is of the real ships.
    """
    tanker = load_ship("kvlcc2_model")
    constant = dataclasses.replace(
        tanker.open_water, values=np.full_like(tanker.open_water.values, 0.3)
    )
    engine = dataclasses.replace(tanker.engine, torque_max=np.inf)
    ship = dataclasses.replace(tanker, open_water=constant, engine=engine)
    command = np.array([[0.6, 10.0]])
    begin = ShipSim(ship, 1)
    begin.reset(0, n=10.0)
    for _ in range(40):
        begin.step(command, 0.2)

    def end(steps):
        sim = ShipSim(ship, 1)
        sim.state[:] = begin.state
        sim.longest[:] = np.inf  # let the step be as long as asked
        for _ in range(steps):
            sim.step(command, 24.0 / steps)
        return sim.state[0, :6]

    exact = end(4096)
    errors = [np.abs(end(steps) - exact).max() for steps in (64, 128, 256, 512)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert (orders > 2.9).all() and (orders < 3.3).all(), (errors, orders)


@pytest.mark.compiled
@pytest.mark.parametrize("name", available_ships())
def test_longest_step_is_converged(name):
    """Rudder thrown between the stops: the default step against one 16 times finer."""
    ship = load_ship(name)
    seconds = 24 * longest_step(ship)

    def heading(parts):
        sim = ShipSim(ship, 1)
        sim.reset(0)
        for k in range(24 * parts):
            side = 1.0 if (k // (8 * parts)) % 2 == 0 else -1.0
            command = np.array([[side * ship.gear.delta_max, sim.state[0, 7]]])
            sim.step(command, seconds / (24 * parts))
        return sim.state[0]

    coarse, fine = heading(1), heading(16)
    assert abs(coarse[5] - fine[5]) < 1e-4
    assert np.hypot(*(coarse[3:5] - fine[3:5])) < 1e-3 * ship.hull.L


@pytest.mark.compiled
@pytest.mark.parametrize("name", available_ships())
def test_serial_parallel_and_batch_of_one_are_the_same_bits(name):
    ship = load_ship(name)
    serial, parallel = sail(ship, 7), sail(ship, 7, parallel=True)
    assert (serial.state == parallel.state).all()
    assert (serial.forces == parallel.forces).all() and (serial.flow == parallel.flow).all()
    rng = np.random.default_rng(5)
    rudder = ship.gear.delta_max * rng.uniform(-1, 1, (40, 7))
    rpm = ship.engine.n_max * rng.uniform(0, 1, (40, 7))
    for i in (0, 6):
        one = ShipSim(ship, 1, SEA)
        one.reset(5 + i)
        for k in range(40):
            one.step(np.array([[rudder[k, i], rpm[k, i]]]), longest_step(ship))
        assert (one.state[0] == serial.state[i]).all()


@pytest.mark.parametrize("name", available_ships())
def test_mirror_symmetry_of_the_ship(name):
    ship = symmetric(load_ship(name))
    one, other = ShipSim(ship, 1), ShipSim(ship, 1)
    one.reset(0)
    other.reset(0)
    for k in range(200):
        delta = ship.gear.delta_max * np.sin(0.1 * k)
        n = one.state[0, 7]
        one.step(np.array([[delta, n]]), longest_step(ship))
        other.step(np.array([[-delta, n]]), longest_step(ship))
    sign = np.array([1, -1, -1, 1, -1, -1, -1, 1])
    np.testing.assert_allclose(one.state[0], sign * other.state[0], rtol=1e-9, atol=1e-9)


def test_a_uniform_current_only_carries_the_ship_along(kcs_model):
    """Galileo: the track in a current is the track in calm water plus current times time."""
    current = Sea(0.3, 2.0)
    calm, carried = ShipSim(kcs_model, 1), ShipSim(kcs_model, 1, current)
    calm.reset(0, n=10.2)
    carried.reset(0, n=10.2)
    for _ in range(300):
        command = np.array([[0.5, 10.2]])
        calm.step(command, 0.1)
        carried.step(command, 0.1)
    drift = 0.3 * 30.0 * np.array([np.cos(2.0), np.sin(2.0)])
    np.testing.assert_allclose(carried.state[0, 3:5] - calm.state[0, 3:5], drift, atol=1e-5)
    np.testing.assert_allclose(carried.state[0, [2, 5]], calm.state[0, [2, 5]], atol=1e-6)


@pytest.mark.compiled
@pytest.mark.parametrize("name", available_ships())
def test_a_ship_left_alone_comes_to_rest(name):
    """From any motion, propeller stopped: the energy falls in every step."""
    ship = load_ship(name)
    sim = ShipSim(ship, 64)
    sim.reset(0)
    rng = np.random.default_rng(2)
    U = ship.speed
    sim.state[:, 0] = U * rng.uniform(-1, 1, 64)
    sim.state[:, 1] = U * rng.uniform(-1, 1, 64)
    sim.state[:, 2] = U / ship.hull.L * rng.uniform(-3, 3, 64)
    sim.state[:, 7] = 0.0
    b = ship.inertia

    def energy():
        u, v, r = sim.state[:, :3].T
        return 0.5 * (b.m_u * u**2 + b.m_v * v**2 + b.I_r * r**2) + b.m_xG * v * r

    before = start = energy()
    for k in range(600):
        sim.step(np.zeros((64, 2)), longest_step(ship))
        now = energy()
        assert (now < before).all(), k
        before = now
    # 600 steps are 20 ship lengths at the nominal speed; coasting decays as slowly as 1 / t
    assert (before < 0.5 * start).all()
