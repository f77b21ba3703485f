"""Metrics of a track: distance to the route, cross-track error, corridor and time."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.recording.trajectory import Trajectory
from ship_gym.simulation import through_water
from ship_gym.tasks.base import Metric
from ship_gym.tasks.measures import delivered_energy, rms, sailed_time, to_the_end
from ship_gym.tasks.track.kernels import AT_THE_END
from ship_gym.tracks.guidance import cross_track, nearest_leg, off_route, share_left

METRICS: dict[str, Metric] = {
    "rms_route": Metric(
        "L",
        "root mean square of the distance to the route, the nearest of the previous, the active "
        "and the next leg; of one whose time is up before the end: the share of the route that is "
        "left counts with the distance that ends an episode, the largest of the legs', so that "
        "loitering never pays",
        "lower",
    ),
    "max_route": Metric("L", "largest distance to the route, start included", "lower"),
    "corridor": Metric(
        "-",
        "share of the intervals within the corridor, of the leg and side where the ship is, from "
        "the first within it on; of what a failure left unsailed: outside",
        "higher",
    ),
    "rms_cross_track": Metric(
        "L", "root mean square of the cross-track error from the active leg", "lower"
    ),
    "max_cross_track": Metric("L", "largest absolute cross-track error, start included", "lower"),
    "voyage_time": Metric(
        "s", "until the end is passed in the corridor; if never, the planned duration", "lower"
    ),
    "voyage_energy": Metric(
        "kWh",
        "delivered until the end is passed in the corridor, with what the speed lost on the way "
        "takes to make again; if never, what the engine gives at most over the planned duration; "
        "of a model: by Froude's law",
        "lower",
    ),
}


def measure(trajectory: Trajectory) -> dict[str, float]:
    """Values of `METRICS`."""
    meta = trajectory.meta
    L, limits = meta["ship"]["L"], meta["config"]["limits"]
    voyage = (
        np.array(meta["waypoints"]),
        trajectory["leg"][:-1].astype(int),
        trajectory["x"][1:],
        trajectory["y"][1:],
    )
    off, cross = off_route(*voyage) / L, cross_track(*voyage) / L
    limit = limits["cross_track"] * _widest(trajectory)
    start = abs(trajectory["cross_track_error"][0]) / L  # on the first leg that is both
    at_end = meta["outcome"] in AT_THE_END
    left = 0.0 if at_end or meta["failed"] else share_left(voyage[0], *(z[-1] for z in voyage[1:]))
    within = np.abs(off) <= _corridor(trajectory, voyage, off)
    judged = rms(to_the_end(trajectory, off, limit))
    return {
        "rms_route": math.hypot(math.sqrt(1.0 - left) * judged, math.sqrt(left) * limit),
        "max_route": float(max(np.abs(off).max(), start)),
        "corridor": _kept(to_the_end(trajectory, within, 0.0)),
        "rms_cross_track": rms(to_the_end(trajectory, cross, limit)),
        "max_cross_track": float(max(np.abs(cross).max(), start)),
        "voyage_time": float(sailed_time(trajectory) if at_end else meta["config"]["duration"]),
        "voyage_energy": _voyage_energy(trajectory, at_end),
    }


def _voyage_energy(trajectory: Trajectory, arrived: bool) -> float:
    """Energy of a voyage at full scale [kWh], see `METRICS`.

    The way is given and so is the time for it: to go slowly pays only as long as she arrives. Nor
    does it pay to arrive slowly: the energy in a tanker's speed takes her for kilometres.
    """
    ship = trajectory.meta["ship"]
    if arrived:
        u, _ = through_water(trajectory)
        lost = 0.5 * ship["m_u"] * max(u[0] ** 2 - u[-1] ** 2, 0.0) / ship["efficiency"]
        work = (delivered_energy(trajectory) + lost) * ship["scale"] ** 4
    else:
        work = ship["power_max"] * ship["scale"] ** 3.5 * trajectory.meta["config"]["duration"]
    return work / 3.6e6


def _kept(within: np.ndarray) -> float:
    """Share of the intervals within the corridor, from the first of them on; 0 if none is."""
    within = within.astype(bool)
    first = int(np.argmax(within))
    return float(within[first:].mean()) if within[first] else 0.0


def _corridor(
    trajectory: Trajectory, voyage: tuple[np.ndarray, ...], off: np.ndarray
) -> float | np.ndarray:
    """Corridor [L] at the end of each interval: of the nearest leg, on the side of the ship."""
    meta = trajectory.meta
    if "leg_limits" not in meta:
        return meta["config"]["limits"]["corridor"]
    beside = np.array(meta["leg_limits"])[nearest_leg(*voyage).astype(int)]
    side = (off > 0.0).astype(int)  # port, starboard
    return beside[np.arange(len(side)), side] / meta["ship"]["L"]


def _widest(trajectory: Trajectory) -> float:
    """Widest corridor of the legs by that of the scenario; 1 where legs have none of their own."""
    meta = trajectory.meta
    if "leg_limits" not in meta:
        return 1.0
    return float(np.max(meta["leg_limits"])) / (
        meta["config"]["limits"]["corridor"] * meta["ship"]["L"]
    )
