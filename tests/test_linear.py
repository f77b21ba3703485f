import dataclasses
import json
import math

import numpy as np
import pytest
from scipy.linalg import expm
from ship_gym_agents.wave_filter import identify

from ship_gym import available_ships, linearise, load_ship, self_propulsion
from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, N, R, U, V
from ship_gym.linear import LinearShip
from ship_gym.simulation import ShipSim
from ship_gym.stability import pull_out

SHIP = LinearShip(Y_v=-0.8, Y_r=-0.4, Y_delta=-0.15, N_v=-3.0, N_r=-2.5, N_delta=1.2)


def turned(m, delta, lengths):
    """Beside each other: v', r' of the simulated and of the linear ship after some L / U0.

    The rudder is `delta` from its neutral angle; half the difference of the turns to both sides.
    """
    made = load_ship(m.ship)
    sim, angles = ShipSim(made, 2, parallel=False), m.delta0 + np.array([delta, -delta])
    sim.state[:, U], sim.state[:, N], sim.state[:, DELTA] = m.speed, m.n0, angles
    sim.commands[:, 0], sim.commands[:, 1] = angles, m.n0
    sim.set_interval(1.0 / made.time_unit)
    intervals = round(lengths * m.time * made.time_unit)
    for _ in range(intervals):
        sim.advance()
    v, r = 0.5 * (sim.state[0, [V, R]] - sim.state[1, [V, R]])
    pushed = np.zeros((3, 3))
    pushed[:2, :2], pushed[:2, 2] = m.steering.A, m.steering.B * delta
    linear = expm(pushed * intervals / made.time_unit / m.time)[:2, 2]
    return np.array([v / m.speed, r * m.L / m.speed]), linear


@pytest.mark.parametrize("ship", available_ships())
def test_a_small_turn_is_that_of_the_simulated_ship(ship):
    """Rudder 0.05 deg for 1.5 L / U0; measured: within 4e-4."""
    simulated, linear = turned(linearise(ship), math.radians(0.05), 1.5)
    assert linear == pytest.approx(simulated, rel=1e-3)


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2"])
def test_at_another_speed(ship):
    speed = 0.7 * load_ship(ship).speed
    model = linearise(ship, speed)
    assert model.speed == speed and model.n0 == self_propulsion(ship, speed)
    simulated, linear = turned(model, math.radians(0.05), 1.0)
    assert linear == pytest.approx(simulated, rel=1e-3)


def test_with_another_propeller_speed():
    """Half the race over the rudder: she turns less, and slows down, which `left` tells."""
    full = linearise("kcs")
    half = linearise("kcs", n=0.5 * full.n0)
    assert half.steering.N_delta < 0.7 * full.steering.N_delta
    assert half.left[0] < -1e-3 and half.n0 == 0.5 * full.n0


def test_primes_and_their_units():
    """A and B by hand from A', B': of r' by v', say, a' = a L / U0 times L / U0 ..."""
    m = linearise("kcs")
    L, U0 = m.L, m.speed
    assert m.A[2, 1] == pytest.approx(m.A_prime[2, 1] * U0 / L**2 * 1.0, rel=1e-12)
    assert m.A[1, 2] == pytest.approx(m.A_prime[1, 2] * U0, rel=1e-12)
    assert m.A[1, 1] == pytest.approx(m.A_prime[1, 1] * U0 / L, rel=1e-12)
    assert m.B[2, 0] == pytest.approx(m.B_prime[2, 0] * U0**2 / L**2, rel=1e-12)
    assert m.B[0, 1] == pytest.approx(m.B_prime[0, 1] * U0**2 / L / m.n0, rel=1e-12)
    s = m.steering
    assert (s.Y_r, s.N_delta) == (m.A_prime[1, 2], m.B_prime[2, 0])


def test_what_symmetry_forbids_is_zero():
    """Surge does not answer small sway, yaw or rudder to first order, nor sway and yaw surge."""
    m = linearise("kcs")
    largest = np.abs(m.A_prime).max()
    assert np.abs(m.A_prime[0, 1:]).max() < 1e-6 * largest
    assert np.abs(m.A_prime[1:, 0]).max() < 1e-6 * largest
    assert np.abs(m.left).max() < 1e-12
    assert m.A_prime[0, 0] < 0.0 < m.B_prime[0, 1]  # resistance holds back, the propeller pushes


def test_nomoto_in_numbers():
    """The transfer function of r' by delta at some frequencies, by A, B and by Nomoto's form."""
    k = SHIP.nomoto
    for w in (0.0, 0.3, 2.0, 20.0):
        s = 1j * w
        state = np.linalg.solve(s * np.eye(2) - SHIP.A, SHIP.B)[1]
        nomoto = k.K * (1.0 + k.T3 * s) / ((1.0 + k.T1 * s) * (1.0 + k.T2 * s))
        assert nomoto == pytest.approx(state, rel=1e-10)
    assert k.T == pytest.approx(k.T1 + k.T2 - k.T3, rel=1e-12)
    # by hand: N_r Y_v - N_v Y_r = 0.8, N_v Y_delta - Y_v N_delta = 1.41
    assert k.K == pytest.approx(1.41 / 0.8) and k.T3 == pytest.approx(1.2 / 1.41)
    assert k.T1 * k.T2 == pytest.approx(1.0 / 0.8) and k.T1 + k.T2 == pytest.approx(3.3 / 0.8)


def test_units_of_nomoto():
    m = linearise("kcs")
    assert m.nomoto.K == pytest.approx(m.steering.nomoto.K * m.speed / m.L)
    assert m.nomoto.T == pytest.approx(m.steering.nomoto.T * m.L / m.speed)
    slow, fast = m.eigenvalues
    assert (m.nomoto.T1, m.nomoto.T2) == pytest.approx((-1.0 / slow.real, -1.0 / fast.real))


def test_a_ship_that_swings_has_no_two_time_constants():
    swinging = dataclasses.replace(SHIP, Y_v=-2.5, Y_r=0.5)
    k = swinging.nomoto
    assert (
        math.isnan(k.T1) and math.isnan(k.T2) and k.T == pytest.approx(5.0 / 7.75 - k.T3, rel=1e-12)
    )


@pytest.mark.parametrize(("ship", "stable"), [("kcs", True), ("s175", True), ("kvlcc2", False)])
def test_course_stability_is_that_of_a_pull_out(ship, stable):
    """An unstable ship keeps turning when her rudder is back at neutral; Nomoto's K and T tell."""
    m = linearise(ship)
    assert m.stable is stable
    assert (m.nomoto.K > 0.0) is stable and (m.nomoto.T > 0.0) is stable
    assert (pull_out(ship).residual_difference < 0.01) is stable


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2", "onrt", "dtc", "s175"])
def test_the_trial_of_commissioning_finds_nearly_the_same(ship):
    """Rudder up to 6 deg is no small motion: derivatives within some per cent of the larger ones.

    Measured worst of each ship, by the largest of its row: kvlcc2 15 %, the others below 8 %.
    """
    m, found = linearise(ship).steering, identify(load_ship(ship))
    tolerance = 0.15 if ship == "kvlcc2" else 0.08
    for row in (("Y_v", "Y_r", "Y_delta"), ("N_v", "N_r", "N_delta")):
        exact, tried = (np.array([getattr(s, name) for name in row]) for s in (m, found))
        assert np.abs(tried - exact).max() < tolerance * np.abs(exact).max(), (row, exact, tried)


def test_range_is_where_ten_per_cent_are_reached():
    """At the range of r' the linear model is still good, one step of 0.03 beyond it no longer."""
    from ship_gym.linear import _acceleration

    m, feels = linearise("s175"), _acceleration(load_ship("s175"))
    unit, axes = m.speed / m.L, np.array([1.0, m.L])

    def wrong(share):
        worst = 0.0
        for r in (share * unit, -share * unit):
            there = feels(np.array([m.speed, 0.0, r, m.delta0, m.n0]))[1:]
            line = m.A[1:, 2] * r
            worst = max(worst, np.hypot(*((there - line) * axes)) / np.hypot(*(line * axes)))
        return worst

    assert wrong(m.valid["r"]) <= 0.1 < wrong(m.valid["r"] + 0.03)


def test_model_and_ship_have_nearly_the_same_primes():
    """By Froude's law; the loading of the propeller differs by friction, so the rudder does."""
    full, model = (linearise(name).steering for name in ("kcs", "kcs_model"))
    assert model.A == pytest.approx(full.A, rel=0.03)
    assert 1.0 < model.N_delta / full.N_delta < 1.25


def test_json():
    data = json.loads(json.dumps(linearise("onrt").as_dict(), allow_nan=False))
    assert data["ship"] == "onrt" and data["course_stable"] is True
    assert len(data["A"]) == 3 and len(data["B"][0]) == 2


def test_wrong_input_is_refused():
    with pytest.raises(ConfigError, match="speed = 0"):
        linearise("kcs", 0.0)
    with pytest.raises(ConfigError, match="cannot hold"):
        linearise("kcs", 60.0)
    with pytest.raises(ConfigError, match="n = "):
        linearise("kcs", n=1e3)
