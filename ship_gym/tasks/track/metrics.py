"""Metrics of a track: cross-track error and time."""

from __future__ import annotations

import numpy as np

from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks.base import Metric
from ship_gym.tasks.measures import rms, sailed_time, to_the_end
from ship_gym.tasks.track.kernels import OUTCOMES
from ship_gym.tracks.guidance import cross_track

METRICS: dict[str, Metric] = {
    "rms_cross_track": Metric("L", "root mean square of the cross-track error", "lower"),
    "max_cross_track": Metric("L", "largest absolute cross-track error, start included", "lower"),
    "voyage_time": Metric("s", "until arrival; if there is none, the planned duration", "lower"),
}


def measure(trajectory: Trajectory) -> dict[str, float]:
    """Values of `METRICS`."""
    meta = trajectory.meta
    L = meta["ship"]["L"]
    legs = trajectory["leg"][:-1].astype(int)
    ends = cross_track(np.array(meta["waypoints"]), legs, trajectory["x"][1:], trajectory["y"][1:])
    arrived = meta["outcome"] == OUTCOMES[-1].name
    judged = to_the_end(trajectory, ends / L, meta["config"]["limits"]["cross_track"])
    return {
        "rms_cross_track": rms(judged),
        "max_cross_track": float(
            max(np.abs(ends).max(), abs(trajectory["cross_track_error"][0])) / L
        ),
        "voyage_time": float(sailed_time(trajectory) if arrived else meta["config"]["duration"]),
    }
