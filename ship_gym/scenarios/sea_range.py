"""The section ``sea`` of a scenario: from which seas an episode draws its own."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import NamedTuple

from ship_gym.config import ConfigError, check_fields, check_known
from ship_gym.sea.sea_states import SeaState, sea_state
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea

STATES = tuple(f"ss{k}" for k in range(2, 9))
_FULL_TURN_DEG = 360.0


class Weather(NamedTuple):
    """One sea that an episode may draw, at full scale.

    Attributes
    ----------
    sea : Sea
        With the largest waves and wind.
    height_min : float
        Smallest significant height as a share of the largest.
    wind_min, wind_max : float
        Range of the wind speed [m/s].
    """

    sea: Sea
    height_min: float
    wind_min: float
    wind_max: float


@dataclasses.dataclass(frozen=True)
class SeaRange:
    """Distribution of the sea, everything at full scale; a model gets it Froude-scaled.

    Encounter angles are ``psi - direction_to`` of the ship on its ordered heading or first leg,
    as ``conventions`` has it: 180 from ahead, 0 from astern, 90 from starboard. None: any
    direction, uniform.

    Attributes
    ----------
    current_speed, current_speed_min : float
        Uniform between them [m/s].
    current_encounter_deg : float or None
        Of the current.
    sway_disturbance, yaw_disturbance, correlation_time : float
        As in ``sea.Sea``.
    states : tuple of str
        Sea states by name, ``ss2`` to ``ss8``: each episode draws one of them, its significant
        height and wind uniform in their ranges in the table, its peak period the most probable.
        Empty: the next five keys.
    wave_height, wave_height_min : float
        Significant height, uniform between them [m].
    peak_period : float
        T_p of the waves [s].
    wind_speed, wind_speed_min : float
        Uniform between them [m/s], at 10 m.
    wave_encounter_deg : float or None
        Of the waves, and of the wind unless it has its own.
    wind_encounter_deg : float or None
        None: from where the waves come.
    spectrum, spreading, wave_count, drift, surge_model
        As in ``sea.Sea`` and ``sea.spectra.WaveSystem``.
    gusts : bool
        Along the mean wind, with the turbulence intensity of the wind drawn.
    """

    current_speed: float
    current_speed_min: float = 0.0
    current_encounter_deg: float | None = None
    sway_disturbance: float = 0.0
    yaw_disturbance: float = 0.0
    correlation_time: float = 2.0
    states: tuple[str, ...] = ()
    wave_height: float = 0.0
    wave_height_min: float = 0.0
    peak_period: float = 8.8
    wind_speed: float = 0.0
    wind_speed_min: float = 0.0
    wave_encounter_deg: float | None = None
    wind_encounter_deg: float | None = None
    spectrum: str = "bretschneider"
    spreading: float = 0.0
    wave_count: int = 60
    drift: str = "slow"
    surge_model: str = "blend"
    gusts: bool = False

    def __post_init__(self):
        angle = (-_FULL_TURN_DEG, _FULL_TURN_DEG, "deg")
        ranges = {
            "current_speed": (0.0, 10.0, "m/s"),
            "current_speed_min": (0.0, self.current_speed, "m/s"),
            "current_encounter_deg": angle,
            "wave_encounter_deg": angle,
            "wind_encounter_deg": angle,
            "wave_height": (0.0, math.inf, "m"),
            "wave_height_min": (0.0, self.wave_height, "m"),
            "wind_speed": (0.0, math.inf, "m/s"),
            "wind_speed_min": (0.0, self.wind_speed, "m/s"),
        }
        check_fields("sea", self, ranges)
        object.__setattr__(self, "states", tuple(self.states))  # a list has no hash
        for state in self.states:
            check_known("sea state", state, STATES)
        if self.states and (self.wave_height > 0.0 or self.wind_speed > 0.0):
            raise ConfigError(
                f"sea.states = {list(self.states)} together with wave_height = {self.wave_height}, "
                f"wind_speed = {self.wind_speed}: allowed is either the states or the numbers"
            )
        if self.states and self.peak_period != SeaRange.peak_period:
            raise ConfigError(
                f"sea.peak_period = {self.peak_period} together with sea.states = "
                f"{list(self.states)}: the states bring their own; allowed is either"
            )
        self.weathers()  # refuses what no sea has

    def weathers(self) -> tuple[Weather, ...]:
        """The seas that an episode may draw, without current; at least one, calm or not."""
        return _weathers(self)

    def _of_state(self, state: SeaState) -> Weather:
        aloft = state.wind_speed() / state.wind  # from the height of the table to 10 m
        sea = self._sea(state.height_max, state.peak_period, state.wind_max * aloft)
        share = state.height_min / state.height_max
        return Weather(sea, share, state.wind_min * aloft, state.wind_max * aloft)

    def _sea(self, height: float, peak_period: float, wind_speed: float) -> Sea:
        waves = WaveSystem(self.spectrum, height, peak_period, spreading=self.spreading)
        return Sea(
            sway_disturbance=self.sway_disturbance,
            yaw_disturbance=self.yaw_disturbance,
            correlation_time=self.correlation_time,
            waves=(waves,) if height > 0.0 else (),
            wave_count=self.wave_count,
            drift=self.drift,
            surge_model=self.surge_model,
            wind_speed=wind_speed,
            gusts=self.gusts,
        )


@functools.lru_cache(maxsize=64)
def _weathers(sea: SeaRange) -> tuple[Weather, ...]:
    """`SeaRange.weathers`, made once for equal ranges: one ``make`` asks for them several times."""
    if not sea.states:
        share = sea.wave_height_min / sea.wave_height if sea.wave_height > 0.0 else 1.0
        only = sea._sea(sea.wave_height, sea.peak_period, sea.wind_speed)
        return (Weather(only, share, sea.wind_speed_min, sea.wind_speed),)
    return tuple(sea._of_state(sea_state(int(name[2:]))) for name in sea.states)
