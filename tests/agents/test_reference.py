import math

import numpy as np
import pytest
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.reference import JUMP, Guidance, OrderWatch, Reference, ReferenceModel
from ship_gym_agents.wave_filter import LinearShip, LowPass, Observer

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError

STEP = 1.0 / 30.0
NOTHING = np.zeros(1)


def lead(parameters, psi, target, T=900, step=STEP):
    model = ReferenceModel(parameters, step)
    found = [model(np.array([target]), np.array([psi]), NOTHING) for _ in range(T)]
    return np.array(found)[:, :2, 0]  # columns: psi, r


@pytest.mark.parametrize("limit", [0.2, 10.0])
def test_reference_reaches_the_target_without_overshoot(limit):
    psi, r = lead(Reference(4.0, limit, 5.0), math.radians(30.0), 0.0).T
    assert abs(psi[-1]) < 1e-3 and abs(r[-1]) < 1e-3
    assert psi.min() > -1e-3 and r.max() < 1e-3
    assert np.abs(r).max() <= limit


def test_unlimited_reference_is_the_triple_pole():
    """The error of a triple pole -w decays as (1 + w t + (w t)^2 / 2) exp(-w t)."""
    w, t = 4.0, STEP * np.arange(1, 121)
    psi, _ = lead(Reference(w, 100.0, 100.0), 0.5, 0.0, 120).T
    exact = 0.5 * (1.0 + w * t + 0.5 * (w * t) ** 2) * np.exp(-w * t)
    assert psi == pytest.approx(exact, abs=0.03 * 0.5)


def test_limited_reference_turns_at_the_limit():
    psi, r = lead(Reference(8.0, 0.3, 0.5), 2.0, 0.0, 200).T
    assert np.median(r) == pytest.approx(-0.3)
    assert np.abs(np.diff(r)).max() <= 0.5 * STEP * (1.0 + 1e-9)
    assert psi[150] - psi[50] == pytest.approx(-0.3 * 100 * STEP, rel=1e-6)


def test_reference_takes_the_shorter_way():
    psi, r = lead(Reference(4.0, 0.5), math.radians(170.0), math.radians(-170.0), 300).T
    assert r.min() > -1e-3 and psi[-1] == pytest.approx(math.radians(-170.0), abs=1e-3)


def test_long_intervals_give_the_same_reference():
    fine = lead(Reference(4.0, 0.4), 0.6, 0.0, 300)[9::10]
    coarse = lead(Reference(4.0, 0.4), 0.6, 0.0, 30, step=10 * STEP)
    assert coarse == pytest.approx(fine, abs=0.01)


def test_watch_sees_orders_and_no_motion():
    """A turn at r' = 1 with gyro noise and the heading crossing 180 deg is no new order."""
    rng, watch, order = np.random.default_rng(0), OrderWatch(STEP), 0.0
    for k in range(400):
        changed = math.radians(20.0) if k == 200 else 0.0
        order += changed
        noise = math.radians(0.1) * rng.standard_normal(8)
        psi = k * STEP + 2.0 + noise - order
        psi = (psi + math.pi) % (2.0 * math.pi) - math.pi
        jump = watch(psi, np.ones(8))
        assert jump == pytest.approx(-changed, abs=math.radians(1.0))
        assert changed or not jump.any()


def test_watch_takes_a_small_change_for_motion():
    watch = OrderWatch(STEP)
    watch(NOTHING, NOTHING)
    assert watch(NOTHING + 0.9 * JUMP, NOTHING) == 0.0


def steer(gains, order_deg, T=400, ship=None):
    """Headings [deg] of a linear ship under the PID with orders [deg] by interval."""
    ship = ship or LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
    pid, kcs = PID(gains), load_ship("kcs")
    pid.reset(1, kcs, load_scenario())
    step, psi, v, r, delta, rows = kcs.speed / kcs.hull.L, 0.0, 0.0, 0.0, 0.0, []
    limit = kcs.gear.delta_max
    for k in range(T):
        e = psi - math.radians(order_deg(k))
        seen = np.array([[math.sin(e), math.cos(e), r, 1.0, v, delta / limit, 0.5, 0.0, 0.5]])
        wanted = limit * float(pid.act(seen)[0, 0])
        for _ in range(10):
            delta += np.clip(wanted - delta, -0.1 * kcs.gear.rate, 0.1 * kcs.gear.rate)
            h = 0.1 * step
            dv = ship.Y_v * v + ship.Y_r * r + ship.Y_delta * delta
            dr = ship.N_v * v + ship.N_r * r + ship.N_delta * delta
            v, r, psi = v + h * dv, r + h * dr, psi + h * r
        rows.append((math.degrees(psi), math.degrees(delta), r))
    return np.array(rows)


def test_pid_with_reference_turns_at_the_rate_and_does_not_overshoot():
    """A 60 deg change of order: no overshoot, settled, the ship's rate within a fifth of the limit.

    The rudder takes its time, which the reference does not know.
    """
    linear = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)
    observer = Observer(linear, 0.5, 2.0, 0.8, 0.05, 0.25)
    gains = Gains(2.0, 1.5, K_v=-2.0, observer=observer, reference=Reference(1.5, 0.2, 0.1))
    psi, delta, r = steer(gains, lambda k: 60.0 * (k >= 50), 600).T
    assert np.abs(psi[:50]).max() < 0.1
    assert psi.max() < 61.0 and psi[-1] == pytest.approx(60.0, abs=0.5)
    assert 0.2 < r.max() < 0.24
    step = steer(Gains(2.0, 1.5, K_v=-2.0), lambda k: 60.0 * (k >= 50))
    assert np.abs(delta).max() < 0.7 * np.abs(step[:, 1]).max()


def test_wrong_references_are_refused():
    with pytest.raises(ConfigError, match=r"reference.frequency = 0.0: must be positive"):
        Reference(0.0, 0.3)
    with pytest.raises(ConfigError, match=r"reference.rate_limit = nan"):
        Reference(1.0, math.nan)
    with pytest.raises(ConfigError, match=r"guidance.look_ahead = 0.0"):
        Guidance(look_ahead=0.0)


def changed_orders(pid):
    """Rudder actions of two episodes whose order changes by +-30 deg after 20 intervals."""
    pid.reset(2, load_ship("kcs"), load_scenario())
    rows = []
    for k in range(60):
        e = np.radians([2.0, -1.0]) if k < 20 else np.radians([-28.0, 29.0])
        seen = np.zeros((2, 9))
        seen[:, 0], seen[:, 1], seen[:, 3] = np.sin(e), np.cos(e), 1.0
        seen[:, 2] = 0.01 * k, -0.005 * k
        rows.append(pid.act(seen)[:, 0])
    return np.array(rows)


LINEAR = LinearShip(Y_v=-0.75, Y_r=-0.36, Y_delta=-0.14, N_v=-4.8, N_r=-2.6, N_delta=1.1)


@pytest.mark.parametrize(
    "parts",
    [
        {"reference": Reference(3.0, 0.4)},
        {"reference": Reference(3.0, 0.4), "K_i": 0.2},
        {"reference": Reference(3.0, 0.4), "low_pass": LowPass(0.1, 0.1, 0.1)},
        {"reference": Reference(3.0, 0.4), "observer": Observer(LINEAR, 0.5, 2.0, 0.8, 0.05, 0.25)},
        {},
    ],
    ids=["reference", "integral", "low pass", "observer", "plain"],
)
def test_a_controller_used_twice_gives_the_same_actions(parts):
    """Reference, watch of the orders, integral and filter begin anew with every reset."""
    pid = PID(Gains(1.5, 1.0, **parts))
    first = changed_orders(pid)
    assert np.array_equal(changed_orders(pid), first)
    assert np.array_equal(changed_orders(PID(Gains(1.5, 1.0, **parts))), first)
    assert np.ptp(first) > 0.1


@pytest.mark.parametrize("error_deg", [30.0, -30.0])
def test_the_reference_begins_at_the_heading_of_the_ship(error_deg):
    """So the first rudder is that of one interval's turn, not of the whole error: K_p = 1.

    After the first part dt' = step / n of an interval the reference has turned by less than
    w^3 error step^2, here 27 * 0.5 * (1/31)^2 / 2 = 0.4 deg in heading; without it 30 deg.
    """
    pid = PID(Gains(1.0, 0.0, reference=Reference(3.0, 0.4)))
    ship = load_ship("kcs")
    pid.reset(1, ship, load_scenario())
    e = math.radians(error_deg)
    seen = np.zeros((1, 9))
    seen[0, :2] = math.sin(e), math.cos(e)
    first = math.degrees(ship.gear.delta_max * pid.act(seen)[0, 0])
    assert -0.5 < first * math.copysign(1.0, error_deg) <= 0.0
    plain = PID(Gains(1.0, 0.0))
    plain.reset(1, ship, load_scenario())
    full = math.degrees(ship.gear.delta_max * plain.act(seen)[0, 0])
    assert full == pytest.approx(-error_deg, rel=1e-9)
