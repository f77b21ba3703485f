"""Manoeuvres of course stability: pull-out and direct spiral, at a constant propeller order.

Does a ship whose rudder is put back go straight, and over which rudder angles has she two steady
yaw rates?
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_angle
from ship_gym.conventions import R
from ship_gym.manoeuvres import Run, approach
from ship_gym.recording.trajectory import Trajectory
from ship_gym.sea.state import Sea
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import through_water
from ship_gym.stopping import neutral_angle, water_motion

_SAMPLE = 1.0 / 28.0  # output step [L / U0]
_TURN = 12.0  # L / U0 with the rudder over in a pull-out
_PULL = (40.0, 160.0)  # shortest and longest time with it neutral [L / U0]
_STEADY = 2e-5  # change of r' within one L / U0 that counts as none
_HOLD = (4.0, 80.0)  # shortest and longest hold of a spiral's rudder angle [L / U0]
_FINE = math.radians(3.0)  # within it a spiral goes in quarter steps
_BRANCHES_MEET = 1e-3  # r' by which the branches differ where there is no loop


@dataclasses.dataclass(frozen=True)
class PullOut:
    """Measures of a pull-out to both sides; r' = r L / U, to starboard positive.

    Attributes
    ----------
    turning_rate_starboard, turning_rate_port : float
        r' at the end of the turns.
    residual_starboard, residual_port : float
        r' that is left with the rudder at its neutral angle after each turn.
    residual_difference : float
        Of the two: 0 for a ship that is stable on a straight course.
    half_time : float
        Time after the first order of the neutral angle until r' has halved [s].
    """

    turning_rate_starboard: float
    turning_rate_port: float
    residual_starboard: float
    residual_port: float
    residual_difference: float
    half_time: float
    trajectory: Trajectory

    def measures(self) -> dict[str, float]:
        """All measures by name, without the trajectory."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)[:-1]}


@dataclasses.dataclass(frozen=True)
class Spiral:
    """Measures of a direct spiral; r' = r L / U, to starboard positive.

    Attributes
    ----------
    loop_width : float
        Rudder angles between the jumps of the two branches [rad]; 0 without a loop. Known to a
        quarter of the step.
    loop_height : float
        Difference of r' between the branches at the neutral angle.
    neutral_angle : float
        Rudder angle of a straight course [rad]: middle of the loop, or where r' crosses zero.
    slope : float
        d r' / d delta of the whole curve from end to end [1/rad].
    delta, yaw_rate : tuple of float
        Rudder angles [rad] in the order sailed, and the steady r' of each.
    """

    loop_width: float
    loop_height: float
    neutral_angle: float
    slope: float
    delta: tuple[float, ...]
    yaw_rate: tuple[float, ...]
    trajectory: Trajectory

    def measures(self) -> dict[str, Any]:
        """All measures by name, without the trajectory."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)[:-1]}


def pull_out(
    ship: Named | Ship,
    delta: float = math.radians(20.0),
    speed: float | None = None,
    n: float | None = None,
    sea: Sea | None = None,
) -> PullOut:
    """Pull-out: turn steadily to starboard, rudder to neutral until steady; the same to port.

    Parameters
    ----------
    ship : str, path or Ship
    delta : float
        Rudder angle of the turns [rad]; its sign is not used.
    speed, n : float, optional
        Approach speed through the water [m/s], the ship's nominal one if omitted, and constant
        propeller speed [rev/s], self-propulsion if omitted.
    sea : Sea, optional
        Calm water if omitted.

    Raises
    ------
    ConfigError
        Rudder beyond the gear's limit, zero or in degrees.
    """
    ship = load_ship(ship)
    U0, n = approach(ship, delta, speed, n)
    if delta == 0.0:
        raise ConfigError("delta = 0: a pull-out needs a rudder angle")
    run, unit = Run(ship, U0, n, sea, _SAMPLE), ship.hull.L / U0
    ends = []
    largest, neutral = abs(delta), neutral_angle(ship)
    for angle in (largest, -largest):
        run.until(lambda sim, t: False, angle, _TURN * unit)
        ends += [_yaw_rate(run), _held(run, neutral, U0, _PULL)]
    c = run.columns()
    U = np.hypot(*through_water(c))
    released = c["t"] >= _TURN * unit
    halved = c["t"][released][(c["r"] * ship.hull.L / U)[released] <= 0.5 * ends[0]]
    config = {"manoeuvre": "pull_out", "delta": abs(delta), "speed": U0, "n": n}
    return PullOut(
        turning_rate_starboard=ends[0],
        turning_rate_port=ends[2],
        residual_starboard=ends[1],
        residual_port=ends[3],
        residual_difference=ends[1] - ends[3],
        half_time=float(halved[0]) - _TURN * unit if len(halved) else math.nan,
        trajectory=run.trajectory(c, config),
    )


def spiral(
    ship: Named | Ship,
    delta: float = math.radians(15.0),
    step: float = math.radians(1.0),
    speed: float | None = None,
    n: float | None = None,
    sea: Sea | None = None,
) -> Spiral:
    """Direct spiral (Dieudonne): from starboard to port and back, each angle held until steady.

    Parameters
    ----------
    ship, speed, n, sea
        As in `pull_out`.
    delta : float
        Largest rudder angle [rad]; its sign is not used.
    step : float
        Between the angles [rad]; a quarter of it within 3 deg of amidships.

    Raises
    ------
    ConfigError
        Rudder beyond the gear's limit or in degrees, or a step that is not between zero and it.
    """
    ship = load_ship(ship)
    U0, n = approach(ship, delta, speed, n)
    largest = abs(delta)
    if largest == 0.0:
        raise ConfigError("delta = 0: a spiral needs a rudder angle")
    check_angle("step", step, largest)
    if not step > 0.0:
        raise ConfigError(f"step = {step:.4g} rad: must be between 0 and delta = {largest:.4g} rad")
    down = _angles(largest, step)
    run = Run(ship, U0, n, sea, _SAMPLE)
    rates = [_held(run, angle, U0) for angle in (*down, *down[::-1])]
    first, second = np.array(rates[: len(down)]), np.array(rates[len(down) :][::-1])
    low, high = _crossing(down, first), _crossing(down, second)
    neutral = 0.5 * (low + high)
    height = float(np.interp(neutral, down[::-1], first[::-1]))
    height -= float(np.interp(neutral, down[::-1], second[::-1]))
    config = {"manoeuvre": "spiral", "delta": largest, "step": step, "speed": U0, "n": n}
    looping = height > _BRANCHES_MEET
    return Spiral(
        loop_width=max(high - low, 0.0) if looping else 0.0,
        loop_height=height if looping else 0.0,
        neutral_angle=neutral,
        slope=float((first[0] - first[-1]) / (down[0] - down[-1])),
        delta=(*down.tolist(), *down[::-1].tolist()),
        yaw_rate=tuple(rates),
        trajectory=run.trajectory(run.columns(), config),
    )


def _angles(largest: float, step: float) -> np.ndarray:
    """Rudder angles from `largest` down to its opposite, closer within `_FINE` [rad]."""
    coarse = np.linspace(-largest, largest, 2 * math.ceil(largest / step - 1e-9) + 1)
    inner = min(_FINE, largest)
    fine = np.linspace(-inner, inner, 8 * math.ceil(inner / step - 1e-9) + 1)
    return np.sort(np.concatenate([coarse[np.abs(coarse) > inner + 1e-9], fine]))[::-1]


def _held(run: Run, angle: float, U0: float, hold: tuple[float, float] = _HOLD) -> float:
    """Steady r' at a rudder angle [rad], or that after the longest hold [L / U0]."""
    unit, (shortest, longest) = run.ship.hull.L / U0, hold
    rates: list[float] = []
    per_unit = round(1.0 / _SAMPLE)

    def steady(sim, t) -> bool:
        rates.append(_yaw_rate(run))
        if len(rates) <= shortest * per_unit:
            return False
        return abs(rates[-1] - rates[-1 - per_unit]) < _STEADY

    run.until(steady, angle, longest * unit)
    return _yaw_rate(run)


def _yaw_rate(run: Run) -> float:
    """Yaw rate r' = r L / U through the water now."""
    U = math.hypot(*water_motion(run.sim))
    return float(run.sim.state[0, R]) * run.ship.hull.L / U


def _crossing(down: np.ndarray, rates: np.ndarray) -> float:
    """Rudder angle [rad] at which a branch over falling angles changes the sign of r'."""
    return float(np.interp(0.0, rates[::-1], down[::-1]))
