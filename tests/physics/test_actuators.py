import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ship_gym.physics.actuators import engine_after, governed_command, rudder_after
from ship_gym.ships import load_ship
from tests.conftest import tables_of

RECORD = tables_of(load_ship("kcs"))[0]
GEAR, ENGINE = RECORD.gear, RECORD.engine
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
    assert engine_after(1.0, command, 60.0, ENGINE) == pytest.approx(n, abs=1e-4)


@settings(deadline=None)  # the first example may compile the kernel
@given(st.floats(0.0, 2.3), st.floats(-1.0, 4.0), st.floats(0.0, 50.0), st.floats(0.0, 50.0))
def test_two_intervals_are_one(n, command, a, b):
    """Exact in time: the step length does not matter."""
    once = engine_after(n, command, a + b, ENGINE)
    twice = engine_after(engine_after(n, command, a, ENGINE), command, b, ENGINE)
    assert once == pytest.approx(twice, abs=1e-9)
    assert 0.0 <= once <= float(ENGINE.n_max)


def test_governor_lowers_the_command_at_the_torque_limit():
    limit = float(ENGINE.torque_max)
    assert governed_command(1.0, 2.0, 0.5 * limit, ENGINE) == 2.0
    assert governed_command(2.0, 2.0, 4.0 * limit, ENGINE) == pytest.approx(1.0)
