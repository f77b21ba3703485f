"""Sections of every scenario but the sea (``sea_range``): sensors, randomisation, failure.

Start, limits, rewards and orders belong to the task (``ship_gym.tasks``).
"""

from __future__ import annotations

import dataclasses

from ship_gym.config import ConfigError, check_fields


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
    dropout_rate, dropout_time : float
        How often an hour, by chance, and for how long [s] the gyro is lost: heading and yaw rate
        then stay what was last shown, and nothing says so, as of a repeater without a signal. In
        whole control intervals; also without `noise`.
    """

    noise: bool = True
    heading_deg: float = 0.1
    yaw_rate_deg_s: float = 0.02
    speed: float = 0.05
    position: float = 1.0
    dropout_rate: float = 0.0
    dropout_time: float = 0.0

    def __post_init__(self) -> None:
        ranges = {
            "heading_deg": (0.0, 45.0, "deg"),
            "yaw_rate_deg_s": (0.0, 10.0, "deg/s"),
            "speed": (0.0, 10.0, "m/s"),
            "position": (0.0, 1000.0, "m"),
            "dropout_rate": (0.0, 3600.0, "1/h"),
            "dropout_time": (0.0, 1e6, "s"),
        }
        check_fields("sensors", self, ranges)
        if (self.dropout_rate > 0.0) != (self.dropout_time > 0.0):
            raise ConfigError(
                f"sensors.dropout_rate = {self.dropout_rate} with dropout_time = "
                f"{self.dropout_time}: allowed is both above 0, or neither"
            )


# Largest keys of `Randomisation`: beyond them draws are no ships. Of 300 draws at these sizes, each
# for itself, at most 5 % fail the runs of ``ship_gym.behaviour``; a third or a half more, and up to
# 30 % do, or end in no numbers at all.
LARGEST = {
    "surrogate_std": 3.0,
    "hull_std": 0.2,
    "interaction_std": 0.3,
    "loading": 0.4,
    "gear": 0.9,
    "sensors": 1.0,
}


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

    def __post_init__(self) -> None:
        check_fields("randomisation", self, {k: (0.0, most, "-") for k, most in LARGEST.items()})


@dataclasses.dataclass(frozen=True)
class Failure:
    """A fault that begins during the episode and stays, but a dropout; nothing by default.

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
    dropout : float
        How long the gyro is lost from then on [full-scale s], as with ``sensors.dropout_time``.
    """

    time: float = 0.0
    rudder_rate: float = 1.0
    propeller_speed: float | None = None
    heading_bias_deg: float = 0.0
    dropout: float = 0.0

    def __post_init__(self) -> None:
        ranges = {
            "time": (0.0, 1e6, "s"),
            "rudder_rate": (0.0, 1.0, "-"),
            "propeller_speed": (0.0, 1.0, "-"),
            "heading_bias_deg": (-180.0, 180.0, "deg"),
            "dropout": (0.0, 1e6, "s"),
        }
        check_fields("failure", self, ranges)
        if self.time > 0.0 and not self.any:
            raise ConfigError(f"failure.time = {self.time}: nothing fails then; say what does")

    @property
    def any(self) -> bool:
        """Whether anything fails."""
        sizes = (self.rudder_rate, self.propeller_speed, self.heading_bias_deg, self.dropout)
        return sizes != (1.0, None, 0.0, 0.0)
