"""Sections of a scenario but the sea (``sea_range``): start, orders, sensors, rewards, limits."""

from __future__ import annotations

import dataclasses
import math

from ship_gym.config import ConfigError, check_fields, check_known
from ship_gym.tracks.generator import MARGIN
from ship_gym.tracks.shapes import SHAPES


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
        check_fields("start", self, ranges)


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
        check_fields("course", self, ranges)


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
            "turn_radius": (1e-3, 100.0, "L"),
            "acceptance": (0.1, 20.0, "L"),
            "look_ahead": (0.1, 100.0, "L"),
        }
        check_fields("track", self, ranges)
        if self.leg_min <= MARGIN:
            raise ConfigError(f"track.leg_min = {self.leg_min}: allowed is above {MARGIN:g} [L]")
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
        check_fields("limits", self, ranges)


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
        check_fields("reward", self, dict.fromkeys(names, (0.0, math.inf, "-")))


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
        check_fields("sensors", self, ranges)


@dataclasses.dataclass(frozen=True)
class Randomisation:
    """What of the ship differs between episodes; everything is off by default.

    Normal draws are limited to three standard deviations. What was drawn is in
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
        check_fields("randomisation", self, ranges)


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
        check_fields("failure", self, ranges)
        if self.time > 0.0 and not self.any:
            raise ConfigError(f"failure.time = {self.time}: nothing fails then; say what does")

    @property
    def any(self) -> bool:
        """Whether anything fails."""
        sizes = (self.rudder_rate, self.propeller_speed, self.heading_bias_deg)
        return sizes != (1.0, None, 0.0)
