"""Sections of a scenario: where an episode starts, in which sea, what it costs, what ends it."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

from ship_gym.config import ConfigError, check_known, check_number
from ship_gym.sea.sea_states import SeaState, sea_state
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea
from ship_gym.tracks.shapes import SHAPES

STATES = tuple(f"ss{k}" for k in range(2, 9))
_FULL_TURN_DEG = 360.0


def _check_fields(section: str, item: object, ranges: dict[str, tuple[float, float, str]]) -> None:
    """Refuse a field of a section outside its range; None is allowed where it is the default."""
    for name, (low, high, unit) in ranges.items():
        value = getattr(item, name)
        if value is not None:
            check_number(f"{section}.{name}", value, low, high, unit)


@dataclasses.dataclass(frozen=True)
class Start:
    """Distribution of the start.

    Attributes
    ----------
    heading_error_deg : float
        Uniform within plus and minus this, of the ordered heading or the first leg.
    cross_track : float
        Distance from the first leg, uniform within plus and minus this [L]; only for tracks.
    """

    heading_error_deg: float
    cross_track: float = 0.0

    def __post_init__(self):
        ranges = {"heading_error_deg": (0.0, 180.0, "deg"), "cross_track": (0.0, 100.0, "L")}
        _check_fields("start", self, ranges)


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
            "wave_height_min": (0.0, self.wave_height, "m"),
            "wind_speed_min": (0.0, self.wind_speed, "m/s"),
        }
        _check_fields("sea", self, ranges)
        for state in self.states:
            check_known("sea state", state, STATES)
        if self.states and (self.wave_height > 0.0 or self.wind_speed > 0.0):
            raise ConfigError(
                f"sea.states = {list(self.states)} together with wave_height = {self.wave_height}, "
                f"wind_speed = {self.wind_speed}: allowed is either the states or the numbers"
            )
        self.weathers()  # refuses what no sea has

    def weathers(self) -> tuple[Weather, ...]:
        """The seas that an episode may draw, without current; at least one, calm or not."""
        if not self.states:
            share = self.wave_height_min / self.wave_height if self.wave_height > 0.0 else 1.0
            sea = self._sea(self.wave_height, self.peak_period, self.wind_speed)
            return (Weather(sea, share, self.wind_speed_min, self.wind_speed),)
        return tuple(self._of_state(sea_state(int(name[2:]))) for name in self.states)

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


@dataclasses.dataclass(frozen=True)
class Course:
    """Steps of the ordered heading (task ``course_changing``), times at full scale.

    Attributes
    ----------
    changes : int
        Number of steps; those whose time comes after the end of the episode are not ordered.
    step_min_deg, step_max_deg : float
        Size of each, uniform between them, to either side with equal chance.
    first : float
        Time of the first [s].
    interval_min, interval_max : float
        Time from one to the next, uniform between them [s].
    """

    changes: int = 4
    step_min_deg: float = 5.0
    step_max_deg: float = 60.0
    first: float = 30.0
    interval_min: float = 180.0
    interval_max: float = 240.0

    def __post_init__(self):
        ranges = {
            "changes": (1, 50, "-"),
            "step_max_deg": (0.0, 180.0, "deg"),
            "step_min_deg": (0.0, self.step_max_deg, "deg"),
            "first": (0.0, 1e6, "s"),
            "interval_max": (1.0, 1e6, "s"),
            "interval_min": (1.0, self.interval_max, "s"),
        }
        _check_fields("course", self, ranges)


@dataclasses.dataclass(frozen=True)
class TrackRange:
    """The track to sail (task ``track_following``), lengths in ship lengths L.

    Attributes
    ----------
    kind : str
        ``random``, the name of a shape (``ship_gym.tracks.shapes.SHAPES``) or ``points``.
    legs : int
        Number of legs of a random track.
    leg_min, leg_max : float
        Length of a leg [L], uniform between them.
    turn_max_deg : float
        Largest course change.
    turn_radius : float
        Radius of a turn that the ship can follow [L]; course changes are limited so that a turn
        fits between its neighbours.
    acceptance : float
        Radius of the circle about a way-point in which the next leg begins [L].
    look_ahead : float
        Distance of the point on the leg that the look-ahead error aims at [L].
    points : tuple of tuples of float
        North and east of the way-points [m], for ``kind = "points"``; in metres of the ship that
        sails, model or not.
    file : str
        Or a GeoJSON file with them.
    """

    kind: str = "random"
    legs: int = 5
    leg_min: float = 3.0
    leg_max: float = 15.0
    turn_max_deg: float = 90.0
    turn_radius: float = 3.0
    acceptance: float = 2.0
    look_ahead: float = 3.0
    points: tuple[tuple[float, ...], ...] = ()
    file: str = ""

    def __post_init__(self):
        check_known("kind of track", self.kind, ("random", "points", *SHAPES))
        ranges = {
            "legs": (1, 100, "-"),
            "leg_max": (0.1, 1000.0, "L"),
            "leg_min": (0.1, self.leg_max, "L"),
            "turn_max_deg": (0.0, 150.0, "deg"),
            "turn_radius": (0.0, 100.0, "L"),
            "acceptance": (0.1, 20.0, "L"),
            "look_ahead": (0.1, 100.0, "L"),
        }
        _check_fields("track", self, ranges)
        given = bool(self.points) + bool(self.file)
        if given != (self.kind == "points"):
            raise ConfigError(
                f"track.kind = {self.kind!r} with {len(self.points)} points and file = "
                f"{self.file!r}: kind = 'points' needs either points or a file, others neither"
            )


@dataclasses.dataclass(frozen=True)
class Limits:
    """What ends an episode as failed.

    Attributes
    ----------
    heading_error_deg : float
        Heading error; not used on a track.
    cross_track : float
        Distance from the active leg [L]; only on a track.
    """

    heading_error_deg: float = 180.0
    cross_track: float = 5.0

    def __post_init__(self):
        ranges = {"heading_error_deg": (1.0, 180.0, "deg"), "cross_track": (0.1, 100.0, "L")}
        _check_fields("limits", self, ranges)


@dataclasses.dataclass(frozen=True)
class Reward:
    """Weights of the reward terms, per full-scale second.

    Attributes
    ----------
    rudder : float
        Of delta^2 [1/rad^2].
    rudder_rate : float
        Of (rudder change / largest change in one interval)^2.
    speed_loss : float
        Of (1 - u / U0)^2 where u < U0.
    termination : float
        Once, where a limit ends the episode.
    heading : float
        Of psi_e^2 [1/rad^2]; tracks: 0.
    cross_track : float
        Of (e / L)^2; headings: 0.
    """

    rudder: float
    rudder_rate: float
    speed_loss: float
    termination: float
    heading: float = 0.0
    cross_track: float = 0.0

    def __post_init__(self):
        names = [field.name for field in dataclasses.fields(self)]
        _check_fields("reward", self, dict.fromkeys(names, (0.0, math.inf, "-")))


@dataclasses.dataclass(frozen=True)
class Sensors:
    """White noise of the measurements, standard deviations at full scale, one draw an interval.

    The sizes are estimates of good equipment. For comparison: the performance standard of gyro
    compasses allows an rms of 0.25 deg x secant of the latitude between readings of a settled
    compass (IMO A.821(19), 4.1.2, read at puc.overheid.nl, PUC_2513_14). Real errors are also
    slow: a constant one is ``failure.heading_bias_deg``.

    Attributes
    ----------
    noise : bool
        Off: exact measurements (the wave-frequency motion stays in them).
    heading_deg, yaw_rate_deg_s : float
        Gyro compass and rate gyro.
    speed : float
        Log, surge and sway [m/s].
    position : float
        Satellite receiver [m], north and east; only tracks see it.
    """

    noise: bool = True
    heading_deg: float = 0.1
    yaw_rate_deg_s: float = 0.02
    speed: float = 0.05
    position: float = 1.0

    def __post_init__(self):
        ranges = {
            "heading_deg": (0.0, 45.0, "deg"),
            "yaw_rate_deg_s": (0.0, 10.0, "deg/s"),
            "speed": (0.0, 10.0, "m/s"),
            "position": (0.0, 1000.0, "m"),
        }
        _check_fields("sensors", self, ranges)


@dataclasses.dataclass(frozen=True)
class Randomisation:
    """What of the ship differs between episodes; everything is off by default.

    Normal draws are cut at three standard deviations. What was drawn is in
    ``info["randomisation"]`` and in recordings, as factors of the ship file's value (surrogate: in
    standard deviations).

    Attributes
    ----------
    surrogate_std : float
        Thrust with torque, propeller side force and the rudder's two forces are moved by this many
        standard deviations of the surrogate: 1 takes the surrogate at its word.
    hull_std : float
        Relative standard deviation of the resistance and of each hull derivative, each for itself.
    interaction_std : float
        The same of wake fraction, thrust deduction, a_H and flow straightening.
    loading : float
        Draught, uniform within 1 plus and minus this; mass, inertia, added mass and hull forces go
        with it at constant coefficients. Waves and wind stay those of the design draught.
    gear : float
        Rudder rate, uniform within 1 plus and minus this.
    sensors : float
        Size of the sensors' noise, uniform within 1 plus and minus this.
    """

    surrogate_std: float = 0.0
    hull_std: float = 0.0
    interaction_std: float = 0.0
    loading: float = 0.0
    gear: float = 0.0
    sensors: float = 0.0

    def __post_init__(self):
        ranges = {
            "surrogate_std": (0.0, 10.0, "-"),
            "hull_std": (0.0, 0.3, "-"),
            "interaction_std": (0.0, 0.3, "-"),
            "loading": (0.0, 0.5, "-"),
            "gear": (0.0, 0.9, "-"),
            "sensors": (0.0, 1.0, "-"),
        }
        _check_fields("randomisation", self, ranges)


@dataclasses.dataclass(frozen=True)
class Failure:
    """A fault that begins during the episode and stays; nothing by default.

    Attributes
    ----------
    time : float
        When it begins [full-scale s].
    rudder_rate : float
        Share of the rudder rate that is left; 0: the rudder is stuck.
    propeller_speed : float
        Share of the self-propulsion speed that the engine can still turn (thrust loss).
    heading_bias_deg : float
        Error of the gyro compass, positive to starboard.
    """

    time: float = 0.0
    rudder_rate: float = 1.0
    propeller_speed: float | None = None
    heading_bias_deg: float = 0.0

    def __post_init__(self):
        ranges = {
            "time": (0.0, 1e6, "s"),
            "rudder_rate": (0.0, 1.0, "-"),
            "propeller_speed": (0.0, 1.0, "-"),
            "heading_bias_deg": (-180.0, 180.0, "deg"),
        }
        _check_fields("failure", self, ranges)

    @property
    def any(self) -> bool:
        """Whether anything fails."""
        return self != Failure(time=self.time)
