"""Metrics of a heading that is ordered: J, error, the response to a step of the order."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import wrap_angle
from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks.base import Metric
from ship_gym.tasks.measures import (
    LAMBDAS,
    control_cost,
    full_scale_time,
    overshoot,
    rms,
    settling_time,
    to_the_end,
)

METRICS: dict[str, Metric] = {
    **{
        f"J_{lam:g}": Metric("deg2", f"mean(psi_e^2) + {lam:g} mean(delta^2)", "lower")
        for lam in LAMBDAS
    },
    "rms_error": Metric("deg", "root mean square of the heading error", "lower"),
    "max_error": Metric("deg", "largest absolute heading error, start included", "lower"),
    "overshoot": Metric(
        "deg", "first swing past the ordered heading; 0 if not crossed; mean over steps", "lower"
    ),
    "settling_time": Metric(
        "s",
        "until the first stay of 60 s within 2 deg begins; if there is none, the time that was "
        "planned; mean over steps",
        "lower",
    ),
}


def measure(trajectory: Trajectory) -> dict[str, float]:
    """Values of `METRICS`."""
    psi_e = wrap_angle(trajectory["psi"][1:] - trajectory["psi_ordered"][:-1])
    limit = math.radians(trajectory.meta["config"]["limits"]["heading_error_deg"])
    psi_e = to_the_end(trajectory, psi_e, limit)
    delta = to_the_end(trajectory, trajectory["delta"][1:], trajectory.meta["ship"]["delta_max"])
    return {
        **{f"J_{lam:g}": float(control_cost(psi_e, delta, lam)) for lam in LAMBDAS},
        "rms_error": rms(np.degrees(psi_e)),
        "max_error": float(np.abs(np.degrees(trajectory["psi_error"])).max()),
        **_step_response(trajectory),
    }


def _step_response(trajectory: Trajectory) -> dict[str, float]:
    """Overshoot and settling, mean over the steps of the ordered heading; of one heading: its own.

    The order that holds at first is a step only if it is the only one.
    """
    config = trajectory.meta["config"]
    time = full_scale_time(trajectory)
    error = np.degrees(trajectory["psi_error"])
    begins = np.flatnonzero(np.diff(trajectory["psi_ordered"]) != 0.0) + 1
    parts = np.split(np.arange(len(time)), begins)
    found = []
    for part in parts[1:] or parts:
        settled = settling_time(time[part], error[part])
        planned = config["duration"] if len(parts) == 1 else time[part[-1]] - time[part[0]]
        found.append((overshoot(error[part]), planned if settled is None else settled))
    over, settling = np.mean(found, axis=0).tolist()
    return {"overshoot": over, "settling_time": settling}
