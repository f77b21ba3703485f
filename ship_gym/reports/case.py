"""A manoeuvre given in degrees, sailed beside the trial it belongs to."""

from __future__ import annotations

import dataclasses
import math

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.manoeuvres import TurningCircle, ZigZag, turning_circle, zigzag
from ship_gym.sea.state import CALM, RegularWave, Sea, load_sea, regular_sea
from ship_gym.ships.particulars import Ship
from ship_gym.ships.trials import Trial
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
        What the sea is: its name, and the regular wave or direction that was asked for.
    trial : Trial or None
        Measured manoeuvre with the same rudder, heading, speed and waves.
    water : Sea
        The sea at the ship's scale.
    calm : TurningCircle, ZigZag or None
        The same manoeuvre in calm water, where the sea has waves.
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
    water: Sea = CALM
    calm: TurningCircle | ZigZag | None = None


def sail(
    ship: Ship,
    manoeuvre: str = "turning",
    *,
    delta_deg: float | None = None,
    psi_deg: float | None = None,
    speed: float | None = None,
    n: float | None = None,
    sea: str = "calm",
    wave_height: float | None = None,
    wavelength: float | None = None,
    wave_from_deg: float | None = None,
) -> Case:
    """Sail a manoeuvre given in degrees, beside its trial, or beside calm water if in waves.

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
    wave_height, wavelength : float, optional
        A regular wave on top of a sea without waves: its height, twice the amplitude, at the
        ship's own scale [m], and its length [L]. Both or none.
    wave_from_deg : float, optional
        Where the waves of the sea come from, and with them its wind, from north [deg]; for a
        regular wave 0, a head sea at first, if omitted.

    Raises
    ------
    ConfigError
        Unknown manoeuvre or sea, a value out of range, or half a wave.
    """
    kind = MANOEUVRES[check_known("manoeuvre", manoeuvre, MANOEUVRES)]
    delta, psi = _angles(ship, kind, delta_deg, psi_deg)
    speed = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    water, label = sea_of(ship, sea, wave_height, wavelength, wave_from_deg)
    waves = (wave_height or 0.0, wavelength or 0.0, (wave_from_deg or 0.0) % 360.0)
    trial = None
    if sea == "calm":
        trial = _matching_trial(ship, kind, delta, psi, speed, n, waves)
    if n is None:
        n = self_propulsion(ship, speed) if trial is None or trial.n is None else trial.n

    def sailed(around: Sea) -> TurningCircle | ZigZag:
        if kind == "turning_circle":
            return turning_circle(ship, delta, speed, n, around)
        return zigzag(ship, delta, psi, speed, n, around)

    result, calm = sailed(water), sailed(CALM) if has_waves(water) else None
    return Case(ship, kind, delta, psi, speed, n, label, result, trial, water, calm)


def has_waves(sea: Sea) -> bool:
    """Whether a sea has waves."""
    return sea.has_waves


def sea_of(
    ship: Ship,
    name: str,
    wave_height: float | None = None,
    wavelength: float | None = None,
    wave_from_deg: float | None = None,
) -> tuple[Sea, str]:
    """Sea at the scale of a ship, and what it is in words; arguments as in `sail`."""
    sea, label = load_sea(name).scaled(ship.scale), name
    if (wave_height is None) != (wavelength is None):
        missing = "wave_height" if wave_height is None else "wavelength"
        raise ConfigError(f"{missing}: a regular wave needs its height [m] and its length [L]")
    if wave_from_deg is not None:
        check_number("wave_from", wave_from_deg, -360.0, 360.0, "deg")
    if wave_height is not None and wavelength is not None:
        if has_waves(sea):
            raise ConfigError(f"wave_height: sea {name!r} has waves already; leave one of them out")
        wave = _regular_wave(ship, wave_height, wavelength)
        wave_from_deg = wave_from_deg or 0.0
        label = "" if name == "calm" else f"{name}, "
        label += f"regular waves {wave_height:.4g} m high and {wavelength:.4g} L long"
        sea = dataclasses.replace(sea, regular=wave)
    if wave_from_deg is None:
        return sea, label
    if not has_waves(sea):
        raise ConfigError(f"wave_from: sea {name!r} has no waves; give wave_height and wavelength")
    come = math.radians(wave_from_deg) % (2.0 * math.pi)
    go = (come + math.pi) % (2.0 * math.pi)
    sea = dataclasses.replace(sea, wave_direction_to=go, wind_direction_from=come)
    return sea, f"{label} from {wave_from_deg:.4g} deg"


def _regular_wave(ship: Ship, height: float, wavelength: float) -> RegularWave | None:
    """A wave of a height [m] and a length [L]; one that breaks is a ConfigError."""
    check_number("wave_height", height, 1e-6, 40.0, "m")
    check_number("wavelength", wavelength, 0.05, 20.0, "L")
    try:
        return regular_sea(0.5 * height, wavelength=wavelength * ship.hull.L).regular
    except ConfigError as error:
        raise ConfigError(
            f"wave_height = {height} m, wavelength = {wavelength} L: {error}"
        ) from None


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
        wave_height=trial.wave_height if trial.waves else None,
        wavelength=trial.wavelength if trial.waves else None,
        wave_from_deg=trial.wave_from_deg if trial.waves else None,
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
    if kind == "turning_circle" and delta_deg == 0.0:
        raise ConfigError("delta = 0 deg: a turning circle needs a rudder angle")
    if kind == "zigzag" and delta_deg * psi_deg <= 0.0:
        raise ConfigError(
            f"delta = {delta_deg:.6g} deg, psi = {psi_deg:.6g} deg: must have one sign, not zero"
        )
    # degrees of the limit itself must not fail on the last bit
    delta = min(max(math.radians(delta_deg), -ship.gear.delta_max), ship.gear.delta_max)
    return delta, math.radians(psi_deg)


def _matching_trial(
    ship: Ship,
    kind: str,
    delta: float,
    psi: float,
    speed: float,
    n: float | None,
    waves: tuple[float, float, float],
) -> Trial | None:
    """First trial with this manoeuvre, these angles, speed, propeller speed and waves.

    ``waves``: height [m], length [L] and where they come from [deg], within 0 to 360.
    """
    for t in ship.trials:
        same = t.manoeuvre == kind and abs(t.delta_deg - math.degrees(delta)) < 0.01
        same = same and abs(t.psi_deg - math.degrees(psi)) < 0.01
        same = same and abs(t.speed - speed) <= _SAME * t.speed
        its = (t.wave_height, t.wavelength, t.wave_from_deg % 360.0)
        pairs = zip(its, waves, strict=True)
        same = same and all(abs(a - b) <= _SAME * max(abs(a), 1e-9) for a, b in pairs)
        if same and (n is None or t.n is None or abs(t.n - n) <= _SAME * t.n):
            return t
    return None
