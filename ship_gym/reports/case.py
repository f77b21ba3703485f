"""A manoeuvre given in degrees, sailed beside the trial it belongs to."""

from __future__ import annotations

import dataclasses
import math

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.manoeuvres import TurningCircle, ZigZag, turning_circle, zigzag
from ship_gym.sea.state import load_sea
from ship_gym.ships.particulars import Ship, Trial
from ship_gym.simulation import self_propulsion

# what the user types -> the name in ship files
MANOEUVRES = {"turning": "turning_circle", "zigzag": "zigzag"}
_TURNING_DEG, _ZIGZAG_DEG = 35.0, 10.0  # rudder angle if none is given
_SAME = 0.02  # speed and propeller speed of a matching trial agree within this fraction


@dataclasses.dataclass(frozen=True)
class Case:
    """A manoeuvre that has been sailed.

    Attributes
    ----------
    manoeuvre : str
        ``"turning_circle"`` or ``"zigzag"``.
    delta, psi : float
        Rudder angle and heading of the reversals (0 in a turning circle) [rad].
    speed, n : float
        Approach speed [m/s] and propeller speed [rev/s].
    sea : str
        Name of the sea.
    trial : Trial or None
        Measured manoeuvre with the same rudder, heading and speed.
    """

    ship: Ship
    manoeuvre: str
    delta: float
    psi: float
    speed: float
    n: float
    sea: str
    result: TurningCircle | ZigZag
    trial: Trial | None


def sail(
    ship: Ship,
    manoeuvre: str = "turning",
    *,
    delta_deg: float | None = None,
    psi_deg: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    sea: str = "calm",
) -> Case:
    """Sail a manoeuvre given in degrees, beside the trial it belongs to.

    Parameters
    ----------
    ship : Ship
    manoeuvre : str
        ``"turning"`` or ``"zigzag"``.
    delta_deg, psi_deg : float, optional
        Rudder angle and heading of the reversals [deg], positive to starboard. Turning circle:
        35; zig-zag: 10, and each is the other if only one is given.
    speed : float, optional
        Approach speed [m/s]; the ship's nominal speed if omitted.
    n : float, optional
        Propeller speed [rev/s]; that of the matching trial, else self-propulsion, if omitted.
    sea : str
        Named sea, Froude-scaled to the ship.

    Raises
    ------
    ConfigError
        Unknown manoeuvre or sea, or a value out of range.
    """
    kind = MANOEUVRES[check_known("manoeuvre", manoeuvre, MANOEUVRES)]
    delta, psi = _angles(ship, kind, delta_deg, psi_deg)
    speed = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    trial = _matching_trial(ship, kind, delta, psi, speed, n) if sea == "calm" else None
    if n is None:
        n = self_propulsion(ship, speed) if trial is None or trial.n is None else trial.n
    water = load_sea(sea).scaled(ship.scale)
    if kind == "turning_circle":
        result = turning_circle(ship, delta, speed, n, water)
    else:
        result = zigzag(ship, delta, psi, speed, n, water)
    return Case(ship, kind, delta, psi, speed, n, sea, result, trial)


def sail_trial(ship: Ship, trial: Trial) -> Case:
    """Sail a measured manoeuvre of a ship file."""
    names = {kind: name for name, kind in MANOEUVRES.items()}
    check_known(f"manoeuvre in a trial of {ship.name}", trial.manoeuvre, names)
    case = sail(
        ship,
        names[trial.manoeuvre],
        delta_deg=trial.delta_deg,
        psi_deg=trial.psi_deg or None,
        speed=trial.speed,
        n=trial.n,
    )
    return dataclasses.replace(case, trial=trial)


def trials(ship: Ship) -> tuple[Trial, ...]:
    """Trials of a ship; ConfigError if its ship file has none."""
    if not ship.trials:
        raise ConfigError(f"{ship.name}: its ship file has no trial to compare with")
    return ship.trials


def _angles(ship: Ship, kind: str, delta_deg: float | None, psi_deg: float | None):
    """Checked rudder angle and heading [rad] from degrees."""
    limit = math.degrees(ship.gear.delta_max) * (1.0 + 1e-12)
    if kind == "turning_circle":
        if psi_deg is not None:
            raise ConfigError("psi: a turning circle has no heading to reverse at")
        delta_deg, psi_deg = _TURNING_DEG if delta_deg is None else delta_deg, 0.0
    else:
        given = [angle for angle in (delta_deg, psi_deg, _ZIGZAG_DEG) if angle is not None]
        delta_deg = given[0]
        psi_deg = given[0] if psi_deg is None else psi_deg
    check_number("delta", delta_deg, -limit, limit, "deg")
    check_number("psi", psi_deg, -90.0, 90.0, "deg")
    # degrees of the limit itself must not fail on the last bit
    delta = min(max(math.radians(delta_deg), -ship.gear.delta_max), ship.gear.delta_max)
    return delta, math.radians(psi_deg)


def _matching_trial(
    ship: Ship, kind: str, delta: float, psi: float, speed: float, n: float | None
) -> Trial | None:
    """First trial with this manoeuvre, these angles and this speed and propeller speed."""
    for t in ship.trials:
        same = t.manoeuvre == kind and abs(t.delta_deg - math.degrees(delta)) < 0.01
        same = same and abs(t.psi_deg - math.degrees(psi)) < 0.01
        same = same and abs(t.speed - speed) <= _SAME * t.speed
        if same and (n is None or t.n is None or abs(t.n - n) <= _SAME * t.n):
            return t
    return None
