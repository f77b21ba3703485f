import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ship_gym.physics.actuators import REVERSAL, engine_after, rudder_after
from ship_gym.ships import load_ship
from tests.conftest import tables_of

RECORD = tables_of(load_ship("kcs"))[0]
GEAR, ENGINE = RECORD.gear, RECORD.engine
FREE = RECORD.engine.copy()  # an engine that no torque holds
FREE.torque_max = math.inf
RATE = math.radians(2.32)


def test_rudder_moves_at_its_rate_and_stops_at_the_command():
    assert rudder_after(0.0, 0.5, 1.0, GEAR) == pytest.approx(RATE)
    assert rudder_after(0.0, 0.5, 1e3, GEAR) == 0.5
    assert rudder_after(0.2, -0.5, 2.0, GEAR) == pytest.approx(0.2 - 2.0 * RATE)
    assert rudder_after(0.0, 9.0, 1e3, GEAR) == pytest.approx(math.radians(35.0))


def test_engine_against_a_fine_integration():
    n, command, dt = 1.0, 2.0, 1e-3
    for _ in range(60_000):
        rate = (command - n) / float(ENGINE.time_constant)
        n += dt * max(-float(ENGINE.rate), min(float(ENGINE.rate), rate))
    assert engine_after(1.0, command, 0.0, 60.0, FREE) == pytest.approx(n, abs=1e-4)


@given(st.floats(-1.38, 2.3), st.floats(-3.0, 4.0), st.floats(0.0, 50.0), st.floats(0.0, 50.0))
def test_two_intervals_are_one(n, command, a, b):
    """Exact in time: the step length does not matter, reversing or not."""
    once = engine_after(n, command, 0.0, a + b, FREE)
    twice = engine_after(engine_after(n, command, 0.0, a, FREE), command, 0.0, b, FREE)
    assert once == pytest.approx(twice, abs=1e-9)
    assert -float(FREE.n_astern) - 1e-12 <= once <= float(FREE.n_max)


def test_a_reversal_takes_its_time():
    """From REVERSAL n_max to standstill, then the governor turns the shaft astern."""
    low = REVERSAL * float(FREE.n_max)
    assert engine_after(low, -1.0, 0.0, 0.5 * 15.0, FREE) == pytest.approx(0.5 * low, rel=1e-3)
    stopped = float(FREE.reversal_time)
    assert engine_after(low, -1.0, 0.0, stopped, FREE) == pytest.approx(0.0, abs=1e-12)
    after = engine_after(low, -1.0, 0.0, stopped + 10.0, FREE)
    assert after == pytest.approx(-10.0 * float(FREE.rate))
    assert engine_after(low, 0.0, 0.0, 60.0, FREE) < 0.05 * low  # stopping is no reversal
    # after 1e4 s: below exp(-30) of the way is left
    last = engine_after(1.0, -9.0, 0.0, 1e4, FREE)
    assert last == pytest.approx(-float(FREE.n_astern), rel=1e-12)
    mirrored = -engine_after(-low, 1.0, 0.0, 0.3 * stopped, FREE)
    assert mirrored == pytest.approx(0.7 * low)


def test_no_reversing_without_astern_speed():
    engine = FREE.copy()
    engine.n_astern = 0.0
    assert engine_after(0.0, -1.0, 0.0, 100.0, engine) == 0.0


def propeller_torque(n):
    """Of a propeller at bollard: 4 times the limit at n_max."""
    return 4.0 * float(ENGINE.torque_max) * n * abs(n) / float(ENGINE.n_max) ** 2


def sailed(n, command, engine, seconds, dt, torque=propeller_torque):
    for _ in range(round(seconds / dt)):
        n = engine_after(n, command, torque(n), dt, engine)
    return n


@pytest.mark.parametrize("dt", [1.1, 0.05])
@pytest.mark.parametrize("command", [3.0, -3.0])
def test_speed_settles_where_the_torque_is_the_limit(command, dt):
    n = sailed(0.0, command, ENGINE, 400.0, dt)
    assert abs(n) == pytest.approx(0.5 * float(ENGINE.n_max), rel=1e-6)
    assert n * command > 0.0


def test_shaft_equation_by_a_fine_integration():
    """2 pi I n' = Q_engine - Q of a linear torque with the slope that the kernel assumes."""
    engine = ENGINE.copy()
    engine.rate, engine.time_constant = 1e3, 0.0
    limit, n_max, inertia = (float(engine[k]) for k in ("torque_max", "n_max", "shaft_inertia"))
    slope, n, dt = 2.0 * limit / n_max, 1.0, 1e-4
    fine = n
    for _ in range(10_000):
        fine += dt * (limit - slope * fine) / (2.0 * math.pi * inertia)
    assert engine_after(n, 2.0, slope * n, 1.0, engine) == pytest.approx(fine, rel=1e-4)


def test_water_turns_a_shaft_that_the_brake_cannot_hold():
    """A braking propeller is driven ahead: the shaft stops only where the brake is stronger."""
    brake = float(ENGINE.torque_brake)

    def driven(torque):
        return sailed(0.8, -1.0, ENGINE, 300.0, 1.0, lambda n: torque * (1.0 - n / 0.6))

    assert driven(-2.0 * brake) == pytest.approx(0.3, rel=1e-3)  # torque is -brake there
    assert driven(-0.5 * brake) == pytest.approx(-1.0, rel=1e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stopped_engine_only_brakes(side):
    """Ahead or with sternway, water that is stronger than the brake turns the shaft."""
    brake = float(ENGINE.torque_brake)
    assert engine_after(0.0, 0.0, side * 0.9 * brake, 1.0, ENGINE) == 0.0
    turned = engine_after(0.0, 0.0, side * 1.5 * brake, 1.0, ENGINE)
    assert turned * side < 0.0
    assert turned == -engine_after(0.0, 0.0, -side * 1.5 * brake, 1.0, ENGINE)


def test_inside_its_limits_the_torque_does_nothing():
    for n, command in ((1.0, 1.0), (1.0, 1.01), (1.3, 0.8)):
        found = engine_after(n, command, 0.1 * float(ENGINE.torque_max), 0.5, ENGINE)
        assert found == engine_after(n, command, 0.0, 0.5, FREE)
