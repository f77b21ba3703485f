"""The section ``sea`` of a scenario: from which seas an episode draws its own."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any, ClassVar, NamedTuple

from ship_gym.config import ConfigError, check_fields, check_known, check_number, shown, told_of
from ship_gym.sea.components import omega_of_length
from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.sea_states import SeaState, sea_state
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.spectrum_files import read_again
from ship_gym.sea.state import RegularWave, Sea

STATES = tuple(f"ss{k}" for k in range(2, 9))
REGULAR = "regular"
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
    swell_min : float
        As `height_min`, of the swell.
    """

    sea: Sea
    height_min: float
    wind_min: float
    wind_max: float
    swell_min: float = 1.0


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
        Significant height, uniform between them [m]. Of a regular wave its height from trough to
        crest. Of `spectrum_file` what it is scaled to; 0: as in the file.
    peak_period : float
        T_p of the waves, or the period of a regular wave [s].
    wind_speed, wind_speed_min : float
        Uniform between them [m/s], at 10 m.
    wave_encounter_deg : float or None
        Of the waves, and of the wind unless it has its own.
    wind_encounter_deg : float or None
        None: from where the waves come.
    spectrum : str
        ``"bretschneider"``, ``"jonswap"``, or ``"regular"``: one regular wave.
    spreading, wave_count, drift, surge_model
        As in ``sea.Sea`` and ``sea.spectra.WaveSystem``.
    gusts : bool
        Along the mean wind, with the turbulence intensity of the wind drawn.
    wavelength : float
        Of a regular wave in deep water, instead of its period [m]; 0: `peak_period` says it.
    swell_height, swell_height_min : float
        Significant height of a swell beside the other waves, uniform between them, whatever theirs
        is [m]; 0: none.
    swell_period : float
        T_p of the swell [s].
    swell_encounter_deg : float or None
        Of the swell. None: any direction, whatever that of the other waves.
    swell_spectrum : str
        ``"jonswap"`` or ``"bretschneider"``.
    swell_spreading : float
        Of the swell, as `spreading`.
    current_variation : float
        The current's speed varies slowly by this fraction of it, 0 to 1.
    current_period : float
        Period of that variation [s].
    spectrum_file : str
        Measured or hindcast spectrum, csv or netCDF (``sea.spectrum_files``), instead of a
        spectrum's name and period; from the folder of the scenario file.
    spectrum_pick : str
        Which of several spectra of a netCDF file, as ``"time=2020-02-01T06:00, station=#0"``.
    spectrum_directions : str
        ``"from"`` or ``"to"``: what the directions of a netCDF file are, where it does not say.
    spectrum_north : bool
        Whether waves of `spectrum_file` go where the file says, from north; else their mean
        direction has the encounter angle.
    """

    PATHS: ClassVar = ("spectrum_file",)  # keys that a scenario file gives from its own folder

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
    wavelength: float = 0.0
    swell_height: float = 0.0
    swell_height_min: float = 0.0
    swell_period: float = 14.0
    swell_encounter_deg: float | None = None
    swell_spectrum: str = "jonswap"
    swell_spreading: float = 0.0
    current_variation: float = 0.0
    current_period: float = 1800.0
    spectrum_file: str = ""
    spectrum_pick: str = ""
    spectrum_directions: str = ""
    spectrum_north: bool = False

    def __post_init__(self) -> None:
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
            "wavelength": (0.0, 1e4, "m"),
            "swell_height": (0.0, math.inf, "m"),
            "swell_height_min": (0.0, self.swell_height, "m"),
            "swell_encounter_deg": angle,
        }
        check_fields("sea", self, ranges)
        object.__setattr__(self, "states", tuple(self.states))  # a list has no hash
        for state in self.states:
            check_known("sea state", state, STATES)
        self._check_together()
        self.weathers()  # refuses what no sea has

    def _check_together(self) -> None:
        """Refuse keys that exclude each other."""
        if self.states and (self.wave_height > 0.0 or self.wind_speed > 0.0):
            raise ConfigError(
                f"sea.states = {list(self.states)} together with wave_height = {self.wave_height}, "
                f"wind_speed = {self.wind_speed}: allowed is either the states or the numbers"
            )
        given: set[str] = set()
        of = ""
        if self.states:
            of = f"sea.states = {list(self.states)}: the states bring their own"
            given = {"peak_period", "wavelength", "spectrum_file"}
        elif self.spectrum_file:
            of = f"sea.spectrum_file = {shown(self.spectrum_file)}: the file brings its own"
            given = {"peak_period", "wavelength", "spectrum", "swell_height"}
        elif self.wavelength > 0.0 and self.spectrum == REGULAR:
            of, given = f"sea.wavelength = {self.wavelength}", {"peak_period"}
        if self.spectrum == REGULAR:
            of = of or "sea.spectrum = 'regular'"
            given = {*given, "spreading", "swell_height"}
            given = {*given, "spectrum"} if self.states else given
        elif self.wavelength > 0.0:
            raise ConfigError(
                f"sea.wavelength = {self.wavelength} with spectrum = {shown(self.spectrum)}: "
                f"allowed with {REGULAR!r}; a spectrum has a peak_period"
            )
        if not self.spectrum_file:
            of = of or "sea.spectrum_file = ''"
            given = {*given, "spectrum_pick", "spectrum_directions", "spectrum_north"}
        for name in sorted(given):
            if getattr(self, name) != getattr(SeaRange, name):
                raise ConfigError(
                    f"sea.{name} = {shown(getattr(self, name))} together with {of}; allowed is "
                    "either"
                )

    def weathers(self) -> tuple[Weather, ...]:
        """The seas that an episode may draw, without current; at least one, calm or not."""
        return _made(self) if self.spectrum_file else _weathers(self)  # the file may change

    def _of_state(self, state: SeaState) -> Weather:
        aloft = state.wind_speed() / state.wind  # from the height of the table to 10 m
        sea = self._sea(state.height_max, state.peak_period, state.wind_max * aloft)
        share = state.height_min / state.height_max
        return Weather(sea, share, state.wind_min * aloft, state.wind_max * aloft, self._swell_min)

    @property
    def _swell_min(self) -> float:
        return self.swell_height_min / self.swell_height if self.swell_height > 0.0 else 1.0

    def _sea(self, height: float, peak_period: float, wind_speed: float) -> Sea:
        varies = self.current_variation > 0.0
        return Sea(
            current_speed=self.current_speed if varies else 0.0,  # an episode draws its own
            current_variation=self.current_variation,
            current_period=self.current_period,
            sway_disturbance=self.sway_disturbance,
            yaw_disturbance=self.yaw_disturbance,
            correlation_time=self.correlation_time,
            wave_count=self.wave_count,
            drift=self.drift,
            surge_model=self.surge_model,
            wind_speed=wind_speed,
            gusts=self.gusts,
            **self._waves(height, peak_period),
        )

    def _waves(self, height: float, peak_period: float) -> dict[str, Any]:
        """Waves of a sea, as ``Sea`` takes them; a swell is its second system."""
        if self.spectrum_file:
            return {"spectrum": self._measured()}
        if self.spectrum == REGULAR:
            omega = 2.0 * math.pi / check_number("sea.peak_period", peak_period, 0.1, 40.0, "s")
            if self.wavelength > 0.0:
                omega = omega_of_length(self.wavelength)
            return {"regular": RegularWave(0.5 * height, omega) if height > 0.0 else None}
        waves = WaveSystem(self.spectrum, height, peak_period, spreading=self.spreading)
        if not self.swell_height > 0.0:
            return {"waves": (waves,) if height > 0.0 else ()}
        with told_of("sea.swell_..."):  # what is wrong with it is said of "waves", as of all
            swell = WaveSystem(
                self.swell_spectrum,
                self.swell_height,
                self.swell_period,
                spreading=self.swell_spreading,
            )
        return {"waves": (waves, swell)}

    def _measured(self) -> MeasuredSpectrum:
        """The spectrum of the file, of the largest height."""
        found = read_again(self.spectrum_file, self.spectrum_pick, self.spectrum_directions)
        if self.spectrum_north and not found.direction:
            raise ConfigError(
                f"sea.spectrum_north = true: {self.spectrum_file} has no directions; allowed is "
                "false, with wave_encounter_deg"
            )
        if self.spreading and found.direction:
            raise ConfigError(
                f"sea.spreading = {self.spreading}: {self.spectrum_file} has its own; allowed is 0"
            )
        found = dataclasses.replace(found, spreading=self.spreading)
        return found.with_height(self.wave_height) if self.wave_height > 0.0 else found


def _made(sea: SeaRange) -> tuple[Weather, ...]:
    if sea.states:
        return tuple(sea._of_state(sea_state(int(name[2:]))) for name in sea.states)
    share = sea.wave_height_min / sea.wave_height if sea.wave_height > 0.0 else 1.0
    only = sea._sea(sea.wave_height, sea.peak_period, sea.wind_speed)
    return (Weather(only, share, sea.wind_speed_min, sea.wind_speed, sea._swell_min),)


@functools.lru_cache(maxsize=64)
def _weathers(sea: SeaRange) -> tuple[Weather, ...]:
    """`SeaRange.weathers`, made once for equal ranges: one ``make`` asks for them several times."""
    return _made(sea)
