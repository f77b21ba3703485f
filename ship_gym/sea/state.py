"""The sea a ship sails in: current, waves, wind, and a random low-frequency disturbance."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, build, check_angle, check_known, check_number
from ship_gym.reading import read_toml
from ship_gym.sea.components import (
    WaveComponents,
    omega_of_length,
    regular_wave,
    wave_components,
    wave_numbers,
)
from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.phases import wave_phases
from ship_gym.sea.sea_states import sea_state
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.spectrum_files import read_spectrum
from ship_gym.sea.surface import sum_of
from ship_gym.sea.wind_coefficients import METHODS

# Standard deviations of a disturbance that ships bear: at these each of five ships of the package
# turns at up to r L/U0 = 1.4, at ten times more she spins.
LARGEST_SWAY, LARGEST_YAW = 0.1, 0.02
DRIFTS = ("slow", "mean", "none")
_STATES = Path(__file__).with_name("states.toml")


@dataclasses.dataclass(frozen=True)
class RegularWave:
    """One regular wave: amplitude [m], half the height, and frequency [rad/s]."""

    amplitude: float
    omega: float

    def scaled(self, scale: float) -> RegularWave:
        """The same wave for a model of a scale, by Froude's law."""
        return RegularWave(self.amplitude / scale, self.omega * math.sqrt(scale))


@dataclasses.dataclass(frozen=True)
class Sea:
    """Current, waves, wind and disturbance; the default is calm water. What is off costs nothing.

    Attributes
    ----------
    current_speed : float
        [m/s]
    current_direction_to : float
        Where the current flows to, from north clockwise [rad].
    current_variation, current_period : float
        The current's speed varies slowly by this fraction of it, with this period [s].
    sway_disturbance, yaw_disturbance : float
        Standard deviations of the random sway force and yaw moment, non-dimensional; at most 0.1
        and 0.02.
    correlation_time : float
        T U0 / L of their spectrum.
    waves : tuple of WaveSystem
        Wind sea and swells of an irregular sea; ``sea.sea_states.sea_state(5).waves()`` is one.
    regular : RegularWave or None
        Instead of them.
    spectrum : MeasuredSpectrum or None
        Instead of them, a measured spectrum (`measured_sea`); its mean direction is where the waves
        go to.
    wave_direction_to : float
        Where the waves go to, from north clockwise [rad]; systems may lie off it.
    wave_count : int
        Number of regular waves that an irregular sea is made of.
    drift : str
        ``slow``: with its slow variation, ``mean``: only the constant part, ``none``.
    surge_model : str
        Surge drift by boundary elements (``bem``), by SNNM's regression (``snnm``) or their
        ``blend``.
    wind_speed : float
        One-hour mean at 10 m [m/s].
    wind_direction_from : float
        Where it comes from, from north clockwise [rad].
    wind_method : str
        Coefficients by ``blendermann`` or ``isherwood``.
    gusts : bool
        With gusts along the mean wind.
    """

    current_speed: float = 0.0
    current_direction_to: float = 0.0
    sway_disturbance: float = 0.0
    yaw_disturbance: float = 0.0
    correlation_time: float = 2.0
    current_variation: float = 0.0
    current_period: float = 1800.0
    waves: tuple[WaveSystem, ...] = ()
    regular: RegularWave | None = None
    wave_direction_to: float = 0.0
    wave_count: int = 60
    drift: str = "slow"
    surge_model: str = "blend"
    wind_speed: float = 0.0
    wind_direction_from: float = 0.0
    wind_method: str = "blendermann"
    gusts: bool = False
    spectrum: MeasuredSpectrum | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "waves", tuple(self.waves))  # a list has no hash
        check_number("sea.current_speed", self.current_speed, 0.0, 10.0, "m/s")
        check_angle("sea.current_direction_to", self.current_direction_to)
        check_number("sea.current_variation", self.current_variation, 0.0, 1.0)
        check_number("sea.current_period", self.current_period, 1.0, 1e6, "s")
        check_number("sea.sway_disturbance", self.sway_disturbance, 0.0, LARGEST_SWAY)
        check_number("sea.yaw_disturbance", self.yaw_disturbance, 0.0, LARGEST_YAW)
        check_number("sea.correlation_time", self.correlation_time, 1e-3, 1e3)
        check_angle("sea.wave_direction_to", self.wave_direction_to)
        check_known("drift", self.drift, DRIFTS)
        check_known("surge model", self.surge_model, ("blend", "bem", "snnm"))
        check_number("sea.wind_speed", self.wind_speed, 0.0, 60.0, "m/s")
        check_angle("sea.wind_direction_from", self.wind_direction_from)
        check_known("wind method", self.wind_method, METHODS)
        if self.regular is not None and self.waves:
            raise ConfigError("sea: either a regular wave or an irregular sea, not both")
        if self.spectrum is not None and (self.waves or self.regular is not None):
            raise ConfigError("sea: either a measured spectrum or other waves, not both")
        if self.gusts and self.wind_speed < 0.5:
            raise ConfigError(
                f"sea.gusts with wind_speed = {self.wind_speed}: allowed is a wind from 0.5 m/s, "
                "or gusts = false"
            )
        self.components()  # refuses what no wave has

    def components(self, apart: bool = False) -> WaveComponents:
        """Its regular waves, sorted by direction; empty without waves.

        With `apart` those of the first system come first, `first_count` of them, then the swells.
        """
        if self.regular is not None:
            return regular_wave(self.regular.amplitude, self.regular.omega)
        if self.spectrum is not None:
            found = self.spectrum.components(self.wave_count)
        else:
            found = wave_components(self.waves, self.wave_count) if self.waves else _NO_WAVES
        swell = np.arange(len(found.omega)) >= self.first_count if apart else False
        order = np.lexsort((found.direction, np.broadcast_to(swell, found.omega.shape)))
        return WaveComponents(*(column[order] for column in found))

    def elevation(
        self, x: Any, y: Any, t: Any, seed: int | None = 0, phases: Any = None
    ) -> np.ndarray:
        """Elevation of the surface above still water at places and times [m], positive up.

        Parameters
        ----------
        x, y, t : array_like
            North and east [m] and time [s], of shapes that go together.
        seed : int, optional
            The phases are those of ``ShipSim.reset(seed)`` for ship 0; of ship i those of seed + i.
        phases : array_like, optional
            Instead of them: of each wave of `components` [turns].

        Returns
        -------
        numpy.ndarray
            Of the shape to which x, y and t broadcast; zero without waves.

        Raises
        ------
        ConfigError
            Another number of phases than of waves.
        """
        waves = self.components()
        count = len(waves.omega)
        turns = wave_phases(seed, count) if phases is None else np.asarray(phases, dtype=float)
        if turns.shape != (count,):
            raise ConfigError(f"phases have shape {turns.shape}: allowed is ({count},)")
        to = self.wave_direction_to + waves.direction
        return sum_of(np.stack([waves.amplitude, waves.omega, waves.k, turns, to]), x, y, t)

    @property
    def first_count(self) -> int:
        """Number of regular waves of the first system."""
        if self.regular is not None:
            return 1
        if self.spectrum is not None:
            return self.wave_count
        return wave_numbers(self.waves, self.wave_count)[0] if self.waves else 0

    @property
    def has_waves(self) -> bool:
        """Whether there are waves."""
        return self.regular is not None or self.spectrum is not None or bool(self.waves)

    @property
    def height(self) -> float:
        """Significant height of all systems together, or height of a regular wave [m]."""
        if self.regular is not None:
            return 2.0 * self.regular.amplitude
        if self.spectrum is not None:
            return self.spectrum.height
        return math.hypot(*(system.height for system in self.waves))

    @property
    def period(self) -> float:
        """Peak period of the highest system, or period of a regular wave [s]; 0 without waves."""
        if self.regular is not None:
            return 2.0 * math.pi / self.regular.omega
        if self.spectrum is not None:
            return self.spectrum.peak_period
        highest = max(self.waves, key=lambda system: system.height, default=None)
        return highest.peak_period if highest else 0.0

    def scaled(self, scale: float) -> Sea:
        """The same sea for a model of a scale, by Froude's law; the disturbance has no scale.

        Gusts are made at full scale: ``sea.records`` scales their time and size.
        """
        root = math.sqrt(scale)
        return dataclasses.replace(
            self,
            current_speed=self.current_speed / root,
            current_period=self.current_period / root,
            waves=tuple(system.scaled(scale) for system in self.waves),
            regular=self.regular.scaled(scale) if self.regular else None,
            spectrum=self.spectrum.scaled(scale) if self.spectrum else None,
            wind_speed=self.wind_speed / root,
        )


_NO_WAVES = WaveComponents(*[np.zeros(0)] * 4)
CALM = Sea()


def regular_sea(
    amplitude: float,
    *,
    wavelength: float | None = None,
    omega: float | None = None,
    direction_from: float = 0.0,
    drift: str = "slow",
) -> Sea:
    """A sea of one regular wave.

    Parameters
    ----------
    amplitude : float
        Half the wave height [m].
    wavelength, omega : float
        Length [m] or frequency [rad/s], one of them.
    direction_from : float
        Where it comes from [rad]: 0, from north, is a head sea for a ship that sails north.
    drift : str
        As in `Sea`.
    """
    if (wavelength is None) == (omega is None):
        raise ConfigError("regular_sea: give wavelength or omega, one of them")
    if wavelength is not None:
        omega = omega_of_length(wavelength)
    assert omega is not None
    wave = RegularWave(amplitude, float(omega))
    return Sea(regular=wave, wave_direction_to=_opposite(direction_from), drift=drift)


def irregular_sea(
    height: float,
    peak_period: float,
    *,
    spectrum: str = "jonswap",
    gamma: float = 3.3,
    spreading: float = 0.0,
    direction_from: float = 0.0,
    drift: str = "slow",
) -> Sea:
    """A sea of one wave system.

    Parameters
    ----------
    height, peak_period : float
        Significant height [m] and T_p [s].
    spectrum, gamma, spreading
        As in ``sea.spectra.WaveSystem``.
    direction_from, drift
        As in `regular_sea`.
    """
    system = WaveSystem(spectrum, height, peak_period, gamma, 0.0, spreading)
    return Sea(waves=(system,), wave_direction_to=_opposite(direction_from), drift=drift)


def measured_sea(
    spectrum: MeasuredSpectrum | str | Path,
    *,
    height: float | None = None,
    direction_from: float | None = None,
    wave_count: int = 60,
    drift: str = "slow",
) -> Sea:
    """A sea of a measured or hindcast spectrum.

    Parameters
    ----------
    spectrum : MeasuredSpectrum or path
        Or a file, as ``sea.spectrum_files.read_spectrum`` reads it.
    height : float, optional
        Significant height to which it is scaled [m]; that of the file if omitted.
    direction_from : float, optional
        Where the waves come from in the mean [rad]; as in the file if omitted, of one without
        directions from north.
    wave_count : int
        Number of regular waves.
    drift
        As in `regular_sea`.
    """
    found = spectrum if isinstance(spectrum, MeasuredSpectrum) else read_spectrum(spectrum)
    found = found if height is None else found.with_height(height)
    to = found.mean_direction if found.direction else math.pi
    if direction_from is not None:
        to = _opposite(direction_from)
    return Sea(spectrum=found, wave_direction_to=to, wave_count=wave_count, drift=drift)


def _opposite(direction: float) -> float:
    return (check_angle("direction_from", direction) + 2.0 * math.pi) % (2.0 * math.pi) - math.pi


def available_seas() -> list[str]:
    """Names of the seas that come with the package: ``states.toml``, and ``ss2`` to ``ss8``."""
    return sorted([*read_toml(_STATES), *(f"ss{k}" for k in range(2, 9))])


def load_sea(name: str) -> Sea:
    """A named sea at full scale (`Sea.scaled` for a model); an unknown name is a ConfigError.

    ``ss4`` and so on are the sea states of ``sea_states.csv``: long-crested waves from north and
    their wind.
    """
    check_known("sea", name, available_seas())
    states = read_toml(_STATES)
    if name in states:
        return build(Sea, states[name], f"sea {name}")
    state = sea_state(int(name.removeprefix("ss")))
    return Sea(waves=(state.waves(),), wave_direction_to=math.pi, wind_speed=state.wind_speed())
