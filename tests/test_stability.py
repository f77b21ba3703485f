"""Pull-out and spiral: a ship made symmetric and stable has no loop, an unstable one its own."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.ships import load_ship
from ship_gym.stability import pull_out, spiral
from tests.conftest import symmetric


@pytest.fixture(scope="module")
def unstable():
    """KVLCC2 without difference of sides and with less yaw damping: unstable for certain."""
    ship = symmetric(load_ship("kvlcc2_model"))
    return dataclasses.replace(ship, hull=dataclasses.replace(ship.hull, N_r=0.5 * ship.hull.N_r))


def test_stable_ship_goes_straight_and_has_no_loop():
    ship = load_ship("onrt_model")
    pulled, found = pull_out(ship), spiral(ship)
    assert abs(pulled.residual_difference) < 1e-6 and abs(pulled.residual_starboard) < 1e-6
    assert pulled.turning_rate_starboard == pytest.approx(-pulled.turning_rate_port, rel=1e-3)
    assert 0.0 < pulled.half_time < 5.0 * ship.hull.L / ship.speed
    assert found.loop_width == found.loop_height == 0.0
    assert found.neutral_angle == pytest.approx(0.0, abs=1e-4)


def test_a_pull_out_waits_for_a_slow_decay():
    """KCS at full scale needs over 40 L / U0 after a turn to port; her spiral has no loop."""
    assert abs(pull_out("kcs").residual_difference) < 1e-3


@pytest.mark.slow
def test_unstable_ship_keeps_turning_at_the_rate_of_its_loop(unstable):
    pulled, found = pull_out(unstable), spiral(unstable)
    assert pulled.residual_starboard == pytest.approx(-pulled.residual_port, rel=1e-2)
    assert pulled.residual_starboard > 0.1
    assert found.loop_height == pytest.approx(pulled.residual_difference, rel=0.05)
    assert found.loop_width > math.radians(1.0)
    assert found.neutral_angle == pytest.approx(0.0, abs=math.radians(0.3))


def test_branches_of_the_loop(unstable):
    """Rudder to port and back: outside the loop one curve, inside two, mirrored."""
    found = spiral(unstable)
    half = len(found.delta) // 2
    delta = np.array(found.delta)
    down, up = np.array(found.yaw_rate[:half]), np.array(found.yaw_rate[half:])[::-1]
    np.testing.assert_allclose(delta[:half], delta[half:][::-1], atol=1e-12)
    outside = np.abs(delta[:half]) > 0.6 * found.loop_width + math.radians(0.5)
    np.testing.assert_allclose(down[outside], up[outside], atol=5e-3)
    np.testing.assert_allclose(down, -up[::-1], atol=1e-2)
    assert (np.diff(down[outside]) < 0.0).all()


def test_spiral_is_steady_turning(kcs_model):
    """At the ends the yaw rate is that of a steady turn at that angle, from another manoeuvre."""
    found = spiral(kcs_model, math.radians(10.0), math.radians(5.0))
    turn = pull_out(kcs_model, math.radians(10.0))
    assert found.yaw_rate[0] == pytest.approx(turn.turning_rate_starboard, rel=0.01)
    slope = (found.yaw_rate[0] - found.yaw_rate[len(found.delta) // 2 - 1]) / math.radians(20.0)
    assert found.slope == pytest.approx(slope, rel=1e-6)


@pytest.mark.slow
def test_finer_step_moves_the_loop_by_less_than_a_quarter_of_the_coarse_one(unstable):
    coarse, fine = (spiral(unstable, step=math.radians(step)) for step in (1.0, 0.5))
    assert abs(coarse.loop_width - fine.loop_width) < 2.0 * 0.25 * math.radians(1.0)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda s: pull_out(s, 0.0), "needs a rudder angle"),
        (lambda s: pull_out(s, 20.0), "looks like degrees"),
        (lambda s: spiral(s, 0.9), "delta = 0.9"),
        (lambda s: spiral(s, 0.2, 0.0), "step = 0"),
        (lambda s: spiral(s, 0.2, 0.3), "step = 0.3"),
        (lambda s: spiral(s, 0.2, -0.1), "step = -0.1"),
    ],
)
def test_bad_input(kcs_model, call, word):
    with pytest.raises(ConfigError) as error:
        call(kcs_model)
    assert word in str(error.value)
