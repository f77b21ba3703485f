"""Measured manoeuvres of a ship file: conditions, values, scatter of the facilities."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from ship_gym.config import ConfigError, check_known, check_number, shown
from ship_gym.ships.ranges import TRIAL

KINDS = ("turning_circle", "zigzag")
_LARGEST = 1000.0  # of a measure in L, deg, s or a ratio
# measures in N or N m -> power of the length ratio by Froude's law; the others are in L, deg, s or
# ratios, and a model keeps those when it becomes a ship
_POWERS = {
    "steady_thrust": 3.0,
    "rudder_normal_force": 3.0,
    "movable_rudder_force": 3.0,
    "steady_torque": 4.0,
}


@dataclasses.dataclass(frozen=True)
class Trial:
    """A measured manoeuvre to compare with, at the scale of its ship.

    Attributes
    ----------
    manoeuvre : str
        ``"turning_circle"`` or ``"zigzag"``.
    source : str
        Where the numbers are printed, and what must be known to compare with them.
    delta_deg : float
        Rudder angle [deg], positive to starboard.
    speed : float
        Approach speed [m/s].
    measures : dict
        Name as in the result of the manoeuvre to printed value, SI; a name that ends in ``_deg`` is
        in degrees. ``movable_rudder_force`` [N] is on the movable part of the rudder.
    facility : str
        Who measured.
    psi_deg : float
        Heading of the reversals of a zig-zag [deg]; sign as `delta_deg`.
    n : float, optional
        Propeller speed [rev/s]; self-propulsion at `speed` if None.
    length : float, optional
        Length of the model that was tested [m], at whose scale the file states the trial; None:
        this ship's own. The loader scales such a trial to the ship.
    wave_height, wavelength : float
        Regular wave: height, twice the amplitude [m], and length [L]; 0: calm water.
    wave_from_deg : float
        Where it comes from at rudder execution, from the approach course [deg]; 0 is a head sea,
        positive from starboard.
    facilities : int
        How many facilities the values are the mean of.
    deviation : dict
        Measure to standard deviation of the facilities, as a share of their mean; of a single test
        its printed standard error.
    movable_factor : float, optional
        Normal force on the movable part of the rudder over that on the whole rudder. The computed
        force of the whole rudder times this is compared with ``movable_rudder_force``.
    others : dict
        Who else computed this trial to measures, named as in `measures`.
    """

    manoeuvre: str
    source: str
    delta_deg: float
    speed: float
    measures: dict[str, Any] = dataclasses.field(hash=False)
    facility: str = ""
    psi_deg: float = 0.0
    n: float | None = None
    length: float | None = None
    wave_height: float = 0.0
    wavelength: float = 0.0
    wave_from_deg: float = 0.0
    facilities: int = 1
    deviation: dict[str, float] = dataclasses.field(default_factory=dict, hash=False)
    movable_factor: float | None = None
    others: dict[str, dict] = dataclasses.field(default_factory=dict, hash=False)

    def __post_init__(self):
        check_known("manoeuvre of a trial", self.manoeuvre, KINDS)
        for name, allowed in TRIAL.items():
            value = getattr(self, name)
            if not allowed.by and value is not None:  # the others are by the ship
                check_number(f"trial.{name}", value, allowed.low, allowed.high)
        for name in ("wave_height", "speed"):
            check_number(f"trial.{name}", getattr(self, name), 0.0, unit="m or m/s")
        if (self.wave_height > 0.0) != (self.wavelength > 0.0):
            raise ConfigError(
                f"trial.wave_height = {self.wave_height} m, trial.wavelength = {self.wavelength} "
                "L: a wave needs both, calm water neither"
            )
        _check_measures("trial.measures", self.measures)
        for who, measures in self.others.items():
            _check_measures(f"trial.others.{shown(who)}", measures)
        for name, value in self.deviation.items():
            check_number(f"trial.deviation.{name}", value, 0.0, 1.0)
            if name not in self.measures:
                raise ConfigError(f"trial.deviation.{name} = {value}: trial.measures has no {name}")
        if self.movable_factor is None and "movable_rudder_force" in self.measures:
            raise ConfigError("trial.movable_factor: missing, needed for movable_rudder_force")

    @property
    def waves(self) -> bool:
        """Whether it was measured in waves."""
        return self.wave_height > 0.0


def _check_measures(where: str, measures: Any) -> None:
    """Refuse measures that are no numbers, or a list of them where one is a list."""
    if not isinstance(measures, Mapping):
        raise ConfigError(f"{where} = {shown(measures)}: must be a table of numbers")
    for name, value in measures.items():
        many = isinstance(value, list | tuple)
        if many != (name == "overshoots_deg"):
            kind = "a number" if many else "a list of numbers"
            raise ConfigError(f"{where}.{shown(name)} = {shown(value)}: must be {kind}")
        high = math.inf if name in _POWERS else _LARGEST
        for number in value if many else [value]:
            check_number(f"{where}.{name}", number, -high, high)


def scaled_trial(trial: Trial, ratio: float, density_ratio: float = 1.0, model: str = "") -> Trial:
    """A trial at another scale by Froude's law.

    Parameters
    ----------
    trial : Trial
    ratio, density_ratio : float
        New length and density over the old ones.
    model : str
        Whose model trial it is, where friction was corrected: then no propeller speed and no
        force is left, and the source says so.
    """
    root = math.sqrt(ratio)

    def scaled(measures: dict[str, Any]) -> dict[str, Any]:
        kept = {k: v for k, v in measures.items() if not (model and k in _POWERS)}
        return {
            k: v * ratio ** _POWERS[k] * density_ratio if k in _POWERS else v
            for k, v in kept.items()
        }

    measures = scaled(trial.measures)
    return dataclasses.replace(
        trial,
        speed=trial.speed * root,
        n=None if trial.n is None or model else trial.n / root,
        measures=measures,
        wave_height=trial.wave_height * ratio,
        deviation={k: v for k, v in trial.deviation.items() if k in measures},
        others={who: scaled(values) for who, values in trial.others.items()},
        source=f"{model}: {trial.source}" if model else trial.source,
    )
