"""What the instruments of a ship show: heading, rate of turn, log, position, rudder, wind."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ship_gym.conventions import DELTA, PSI, U, V, X, Y
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.physics.scratch import GUST_COLUMNS
from ship_gym.physics.waves import WAVE_SWAY, WAVE_SWAY_VELOCITY
from ship_gym.physics.wind import gust_factor
from ship_gym.tasks.columns import Columns

_TURN = 2.0 * math.pi


class Seen(NamedTuple):
    """One instant.

    Attributes
    ----------
    time : float
        Since the start [s].
    heading, rate : float
        Of the gyro, in [0, 2 pi) [rad]; positive to starboard [rad/s].
    surge, sway : float
        Of the log, through the water, forward and to starboard [m/s].
    ground_surge, ground_sway : float
        Over ground [m/s].
    north, east : float
        Position in the plane [m].
    course, speed : float
        Over ground, in [0, 2 pi) [rad] and [m/s].
    rudder : float
        Achieved, positive turns to starboard [rad].
    rudders : int
        How many of them there are.
    wind : tuple of float or None
        Velocity of the air now, north and east [m/s]; None: no wind.
    """

    time: float
    heading: float
    rate: float
    surge: float
    sway: float
    ground_surge: float
    ground_sway: float
    north: float
    east: float
    course: float
    speed: float
    rudder: float
    rudders: int
    wind: tuple[float, float] | None


def seen(batch: EpisodeBatch, columns: Columns) -> Seen:
    """What the instruments of the one ship of a batch show now.

    Gyro and log are those of the observation, with the wave-frequency motion, noise and failures of
    the scenario's sensors; position and speed over ground have the wave-frequency motion only.
    """
    sim, task, shown = batch.sim, batch.tasks[0], columns.view(batch.observations)
    state, waves, U0 = sim.state[0], sim.waves[0], float(task["speed"])
    error = math.atan2(shown.sin_error.item(), shown.cos_error.item())
    psi, v = float(state[PSI]), float(state[V] + waves[WAVE_SWAY_VELOCITY])
    cos, sin, aside = math.cos(psi), math.sin(psi), float(waves[WAVE_SWAY])
    u = float(state[U])
    north, east = u * cos - v * sin, u * sin + v * cos
    return Seen(
        time=float(sim.time[0]),
        heading=(float(task["psi_ordered"]) + error) % _TURN,
        rate=shown.yaw_rate.item() * U0 / float(task["L"]),
        surge=shown.surge.item() * U0,
        sway=shown.sway.item() * U0,
        ground_surge=u,
        ground_sway=v,
        north=float(state[X]) - aside * sin,
        east=float(state[Y]) + aside * cos,
        course=math.atan2(east, north) % _TURN,
        speed=math.hypot(north, east),
        rudder=float(state[DELTA]),
        rudders=batch.ships[0].propellers,
        wind=_wind(batch),
    )


def _wind(batch: EpisodeBatch) -> tuple[float, float] | None:
    """Mean wind and its gust now."""
    sea, water = batch.sim.seas[0], batch.sim.water
    if not sea["windy"]:
        return None
    time, scale = float(batch.sim.time[0]), float(sea["gust_scale"])
    gusts, work = water.gusts[int(sea["wind_table"])], np.zeros(GUST_COLUMNS)
    factor = float(gust_factor(time, scale, gusts, water.gust_phases[0], work))
    return float(sea["wind_north"]) * factor, float(sea["wind_east"]) * factor


def relative(now: Seen, moving: bool) -> tuple[float, float]:
    """Where the wind comes from, by the bow in [0, 2 pi) [rad], and its speed [m/s].

    Parameters
    ----------
    now : Seen
        With wind.
    moving : bool
        As it is felt on the moving ship; else as if she lay still over the ground.
    """
    assert now.wind is not None
    north, east = now.wind
    cos, sin = math.cos(now.heading), math.sin(now.heading)
    ahead, aside = north * cos + east * sin, east * cos - north * sin
    if moving:
        ahead, aside = ahead - now.ground_surge, aside - now.ground_sway
    return math.atan2(-aside, -ahead) % _TURN, math.hypot(ahead, aside)


def plain(now: Seen) -> dict[str, Any]:
    """For JSON, in degrees and knots as people say them."""
    return {
        "time": round(now.time, 6),
        "heading_deg": round(math.degrees(now.heading), 3),
        "course_deg": round(math.degrees(now.course), 3),
        "speed": round(now.speed, 4),
        "rudder_deg": round(math.degrees(now.rudder), 3),
        "north": round(now.north, 2),
        "east": round(now.east, 2),
    }
