"""What a critic sees of sea and forces, written out for a ship on a known heading."""

import math

import gymnasium as gym
import numpy as np
import pytest

from ship_gym.conventions import FORCE_COMPONENTS, PSI
from ship_gym.tasks import observations_of

ID = "ShipGym/HeadingKeeping-v0"
SEA = {
    "sea.states": [],
    "sensors.noise": False,
    "sea.gusts": False,
    "sea.wave_height": 4.0,
    "sea.wave_height_min": 4.0,
    "sea.peak_period": 9.7,
    "sea.wind_speed": 12.0,
    "sea.wind_speed_min": 12.0,
    "sea.current_speed": 0.8,
    "sea.current_speed_min": 0.8,
}
ROWS = observations_of("heading_keeping", True)


def sailed(psi, current_to, wind_to, waves_to, **changes):
    """Columns by symbol of a ship that heads `psi` while the weather goes as said [rad]."""
    env = gym.make(ID, privileged=True, overrides=SEA | changes)
    env.reset(seed=4)
    episodes = env.unwrapped.episodes
    seas = episodes.sim.seas
    for name, size, towards in (("V", 0.8, current_to), ("wind", 12.0, wind_to)):
        seas[f"{name}_north"], seas[f"{name}_east"] = (
            size * math.cos(towards),
            size * math.sin(towards),
        )
    episodes.tasks["wave_to"] = waves_to
    episodes.sim.state[0, PSI] = psi
    episodes.observe()
    seen = episodes.observations[0].tolist()
    return dict(zip([row.symbol for row in ROWS], seen, strict=True)), episodes


@pytest.mark.parametrize(
    ("psi", "towards", "along", "across"),
    [
        (0.0, 0.0, 1, 0),
        (0.0, 0.5 * math.pi, 0, 1),  # from port to starboard
        (0.5 * math.pi, 0.5 * math.pi, 1, 0),
        (0.5 * math.pi, 0.0, 0, -1),  # heads east, flows north: to port
        (math.pi, 0.0, -1, 0),
    ],
)
def test_current_and_wind_in_the_axes_of_the_ship(psi, towards, along, across):
    """0.8 and 12 m/s over the nominal speed of 7.46 m/s."""
    seen, episodes = sailed(psi, towards, towards, 0.0)
    U0 = episodes.ship.speed
    for symbol, size in (("u_c / U0", 0.8 * along), ("v_c / U0", 0.8 * across)):
        assert seen[symbol] == pytest.approx(size / U0, abs=1e-6)
    for symbol, size in (("u_w / U0", 12.0 * along), ("v_w / U0", 12.0 * across)):
        assert seen[symbol] == pytest.approx(size / U0, abs=1e-6)


@pytest.mark.parametrize(
    ("psi", "waves_to", "sin", "cos"),
    [(0.0, math.pi, 0, -1), (1.0, 1.0, 0, 1), (0.0, -0.5 * math.pi, 1, 0), (0.5, 1.0, None, None)],
)
def test_waves_by_height_period_and_encounter_angle(psi, waves_to, sin, cos):
    """Head sea: cos mu = -1; from starboard, going to port: sin mu = 1. 4 m over the draught."""
    seen, episodes = sailed(psi, 0.0, 0.0, waves_to)
    hull = episodes.ship.hull
    assert seen["H_s / d"] == pytest.approx(4.0 / hull.d, rel=1e-6)
    period = 9.7 * math.sqrt(9.80665 / hull.L) / (2.0 * math.pi)
    assert seen["T_p sqrt(g/L) / 2 pi"] == pytest.approx(period, rel=1e-6)
    mu = psi - waves_to
    expected = (math.sin(mu), math.cos(mu)) if sin is None else (sin, cos)
    assert (seen["sin(mu)"], seen["cos(mu)"]) == pytest.approx(expected, abs=1e-6)


def test_without_waves_there_is_no_encounter_angle():
    calm = {"sea.wave_height": 0.0, "sea.wave_height_min": 0.0}
    seen, _ = sailed(0.3, 0.0, 0.0, 1.0, **calm)
    assert seen["H_s / d"] == seen["sin(mu)"] == seen["cos(mu)"] == 0.0


def test_forces_by_half_rho_L_d_U_squared_and_moments_by_L_more():
    """Components 1, 2, 3 and so on of this unit come back as themselves; limited to 5."""
    _, episodes = sailed(0.0, 0.0, 0.0, 0.0)
    ship = episodes.ship
    unit = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
    size = 0.25 * np.arange(1.0, 19.0).reshape(6, 3)
    size[0, 0], size[5, 2] = 7.0, -9.0
    episodes.sim.forces[0] = size * [unit, unit, unit * ship.hull.L]
    episodes.observe()
    seen = dict(zip([row.symbol for row in ROWS], episodes.observations[0].tolist(), strict=True))
    for k, name in enumerate(FORCE_COMPONENTS):
        for axis, letter in enumerate("XYN"):
            expected = min(max(size[k, axis], -5.0), 5.0)
            assert seen[f"{letter}_{name}'"] == pytest.approx(expected, rel=1e-6)
