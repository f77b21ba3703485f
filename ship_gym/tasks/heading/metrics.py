"""Metrics of a heading that is ordered: J, error, the response to a step of the order.

J has two parts. Most of that of the turn is fixed by rudder and rudder rate; that of the steady
part is what control decides. J_0.1 is the mean of the two, weighted by their intervals.
"""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import wrap_angle
from ship_gym.recording.trajectory import Trajectory
from ship_gym.tasks.base import Metric
from ship_gym.tasks.measures import (
    LAMBDAS,
    TURN,
    control_cost,
    full_scale_time,
    overshoot,
    rms,
    settling_time,
    to_the_end,
    turning,
)

_LAM = 0.1  # lambda of the two parts of J
ORDERS = "order_from"  # meta of a recording: intervals from which its orders were to hold

METRICS: dict[str, Metric] = {
    **{
        f"J_{lam:g}": Metric("deg2", f"mean(psi_e^2) + {lam:g} mean(delta^2)", "lower")
        for lam in LAMBDAS
    },
    "J_steady": Metric(
        "deg2",
        f"J_{_LAM:g} without the first {TURN:g} s after each order, the first one included; none "
        "where nothing is left",
        "lower",
    ),
    "J_turn": Metric("deg2", f"J_{_LAM:g} in the first {TURN:g} s after each order", "lower"),
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
    """Values of `METRICS`; J_steady is nan where no interval is steady."""
    psi_e = wrap_angle(trajectory["psi"][1:] - trajectory["psi_ordered"][:-1])
    limit = math.radians(trajectory.meta["config"]["limits"]["heading_error_deg"])
    psi_e = to_the_end(trajectory, psi_e, limit)
    delta = to_the_end(trajectory, trajectory["delta"][1:], trajectory.meta["ship"]["delta_max"])
    return {
        **{f"J_{lam:g}": float(control_cost(psi_e, delta, lam)) for lam in LAMBDAS},
        **_parts(trajectory, psi_e, delta),
        "rms_error": rms(np.degrees(psi_e)),
        "max_error": float(np.abs(np.degrees(trajectory["psi_error"])).max()),
        **_step_response(trajectory),
    }


def _parts(trajectory: Trajectory, psi_e: np.ndarray, delta: np.ndarray) -> dict[str, float]:
    """J after the turns and in them.

    Orders that failing came before count too: the recording's meta has them, where there are any.
    """
    sailed = np.flatnonzero(np.diff(trajectory["psi_ordered"]) != 0.0) + 1
    orders = {0, *sailed.tolist(), *trajectory.meta.get(ORDERS, ())}
    turn = turning(orders, len(psi_e), trajectory.meta["config"]["control_interval"])
    return {
        name: float(control_cost(psi_e[part], delta[part], _LAM)) if part.any() else math.nan
        for name, part in (("J_steady", ~turn), ("J_turn", turn))
    }


def _step_response(trajectory: Trajectory) -> dict[str, float]:
    """Overshoot and settling, mean over the steps of the ordered heading; of one heading: its own.

    The order that holds at first is a step only if it is the only one.
    """
    config, time = trajectory.meta["config"], full_scale_time(trajectory)
    error = np.degrees(trajectory["psi_error"])
    return step_response(time, error, trajectory["psi_ordered"], config["duration"])


def step_response(
    time: np.ndarray, error: np.ndarray, ordered: np.ndarray, duration: float
) -> dict[str, float]:
    """Overshoot [deg] and settling time [s], mean over the steps of the ordered heading.

    Parameters
    ----------
    time : numpy.ndarray
        Full-scale time [s], shape (n,).
    error : numpy.ndarray
        Heading less ordered heading [deg], shape (n,).
    ordered : numpy.ndarray
        Ordered heading, in any unit, shape (n,).
    duration : float
        What an only heading counts that is not settled at [full-scale s].
    """
    begins = np.flatnonzero(np.diff(ordered) != 0.0) + 1
    parts = np.split(np.arange(len(time)), begins)
    found = []
    for part in parts[1:] or parts:
        settled = settling_time(time[part], error[part])
        planned = duration if len(parts) == 1 else time[part[-1]] - time[part[0]]
        found.append((overshoot(error[part]), planned if settled is None else settled))
    over, settling = np.mean(found, axis=0).tolist()
    return {"overshoot": over, "settling_time": settling}
