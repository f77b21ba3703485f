import dataclasses
import itertools
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import PSI, R
from ship_gym.evaluation.minimum_turn import minimum_turn_time
from ship_gym.ships import load_ship
from ship_gym.ships.plausible import checked
from ship_gym.simulation import ShipSim, self_propulsion

BAND = math.radians(2.0)


def with_rudder(ship, **changes):
    return dataclasses.replace(ship, gear=dataclasses.replace(ship.gear, **changes))


def brute_force(ship, step, dt=0.25):
    """Shortest of many turns with one switch: its time and the two rudder angles are searched."""
    shares = [(a, b) for a in (1.0, 0.9, 0.7) for b in (1.0, 0.9, 0.7, 0.0)]
    switches = np.arange(0.0, 40.0, dt)
    tried = np.array([(s, a, b) for s, (a, b) in itertools.product(switches, shares)])
    sim = ShipSim(ship, len(tried))
    sim.reset(0)
    n = np.full(len(tried), self_propulsion(ship, ship.speed))
    entered, peak, turned = (np.full(len(tried), x) for x in (np.inf, 0.0, False))
    for k in range(round(150.0 / dt)):
        first = k * dt < tried[:, 0]
        rudder = ship.gear.delta_max * np.where(first, tried[:, 1], -tried[:, 2])
        before = sim.state[:, PSI].copy()
        state = sim.step(np.column_stack([rudder, n]), dt)
        rising, psi = ~turned, state[:, PSI]
        now = rising & np.isinf(entered) & (psi >= step - BAND)
        part = (step - BAND - before[now]) / (psi[now] - before[now])
        entered[now] = (k + part) * dt
        peak = np.where(rising, np.maximum(peak, psi), peak)
        turned |= ~first & (state[:, R] <= 0.0)
    allowed = turned & (peak <= step + BAND)
    best = np.argmin(np.where(allowed, entered, np.inf))
    return entered[best], tried[best]


def test_the_minimum_is_that_of_a_search_by_brute_force():
    """Full rudder both ways is best; the search's switches, 0.25 s apart, cost it a little."""
    ship, step = load_ship("s175"), math.radians(20.0)
    found, (_, over, counter) = brute_force(ship, step)
    assert (over, counter) == (1.0, 1.0)
    least = minimum_turn_time(ship, step)
    assert least <= found + 1e-3
    assert least == pytest.approx(found, abs=0.1)


def test_more_rudder_and_a_faster_gear_turn_sooner():
    ship, step = load_ship("s175"), math.radians(30.0)
    times = [
        minimum_turn_time(with_rudder(ship, delta_max=math.radians(d)), step) for d in (15, 25, 35)
    ]
    assert times[0] > times[1] + 1.0 > times[2] + 2.0
    slow = with_rudder(ship, rate=0.5 * ship.gear.rate)
    assert minimum_turn_time(slow, step) > times[2] + 1.0


def test_larger_steps_take_longer_and_steps_within_the_band_nothing():
    degrees = (0.0, 2.0, 2.1, 5.0, 20.0, 60.0, 120.0, 180.0)
    times = [minimum_turn_time("s175", math.radians(d)) for d in degrees]
    assert times[:2] == [0.0, 0.0]
    assert all(a < b for a, b in itertools.pairwise(times[1:]))
    assert times[2] < 5.0


@pytest.mark.parametrize("degrees", [10.0, 90.0])
def test_a_symmetric_ship_turns_alike_to_both_sides(degrees):
    step = math.radians(degrees)
    assert minimum_turn_time("s175", -step) == pytest.approx(minimum_turn_time("s175", step))
    kcs = [minimum_turn_time("kcs", sign * step) for sign in (1.0, -1.0)]
    assert kcs[0] != pytest.approx(kcs[1], rel=1e-3)  # her single propeller is not symmetric


def test_a_slower_ship_takes_longer():
    ship, step = load_ship("s175"), math.radians(20.0)
    assert minimum_turn_time(ship, step, 0.6 * ship.speed) > 1.2 * minimum_turn_time(ship, step)


def test_what_cannot_be_turned_is_refused(monkeypatch):
    with pytest.raises(ConfigError, match="looks like degrees"):
        minimum_turn_time("s175", 20.0)
    with pytest.raises(ConfigError, match="allowed is"):
        minimum_turn_time("s175", 3.3)
    stiff = with_rudder(load_ship("s175"), delta_max=math.radians(0.05))
    stiff = checked(dataclasses.replace(stiff, strict=False))
    with pytest.raises(ConfigError, match=r"s175: no ship does this: .* she has turned 0 deg"):
        minimum_turn_time(stiff, 1.0)
    monkeypatch.setattr(ShipSim, "_check_ships", lambda self: None)
    with pytest.raises(ConfigError, match=r"s175: no turn of 180 deg within 3600 s"):
        minimum_turn_time(stiff, 1.0)
