"""A task of one file: hold a yaw rate, as for a turning trial or a search pattern."""

import dataclasses
import math

import numpy as np

import ship_gym
from ship_gym.config import check_fields
from ship_gym.tasks.api import (
    N_BRIDGE,
    RUNNING,
    Metric,
    Outcome,
    Plot,
    R,
    Row,
    Task,
    Term,
    clipped,
    costs,
    kernel,
    measures,
    observe_bridge,
    settle,
)

TOO_FAST = 2  # first outcome of its own


@dataclasses.dataclass(frozen=True)
class YawRate:
    """The ordered yaw rate.

    Attributes
    ----------
    order_deg_s : float
        Of the ship that sails, positive to starboard.
    """

    order_deg_s: float = 0.3

    def __post_init__(self):
        check_fields("yaw_rate", self, {"order_deg_s": (-5.0, 5.0, "deg/s")})


@dataclasses.dataclass(frozen=True)
class Limits:
    """What ends an episode as failed.

    Attributes
    ----------
    error_deg_s : float
        Error of the yaw rate.
    """

    error_deg_s: float = 2.0


def fill(scenario, tasks):
    """Order and limit [rad/s] of each ship."""
    tasks["order"] = math.radians(scenario.yaw_rate.order_deg_s)
    tasks["limit"] = math.radians(scenario.limits.error_deg_s)


@kernel
def observe(state, waves, command, ship, sea, task, interval, row):
    """The bridge, then the error of the yaw rate as measured."""
    seen = observe_bridge(state, waves, command, ship, sea, task, interval, row)
    error = (seen.r - task.order) * task.L / task.speed
    row[N_BRIDGE] = clipped(error, -5.0, 5.0)


@kernel
def judge(state, before, sea, task, plan, terms, result):
    """The error squared; too large an error ends the episode."""
    error = state[R] - task.order
    outcome = TOO_FAST if abs(error) > task.limit else RUNNING
    own = (-task.interval * task.rate_error * error * error,)
    paid = costs(state, before, sea, task, outcome != RUNNING)
    settle(result, terms, error, own, paid, outcome, task)


def measure(trajectory):
    """Root mean square of the error over the ends of the intervals."""
    order = math.radians(trajectory.meta["config"]["yaw_rate"]["order_deg_s"])
    return {"rms_rate_error": math.degrees(measures.rms(trajectory["r"][1:] - order))}


def columns(recorded, history, plan):
    """The ordered rate [rad/s] in a recording."""
    return {"rate_ordered": history["order"]}


TASK = Task(
    name="hold_yaw_rate",
    title="Hold an ordered yaw rate in a seaway.",
    sections={"yaw_rate": YawRate, "limits": Limits},
    terms=(
        Term("rate_error", "(r - r_ordered)^2 [rad2/s2]", "Of (r - r_ordered)^2 [s2/rad2].", 1e4),
    ),
    observations=(Row("rate_error", "(r - r_o) L / U0", "-", -5.0, 5.0, "error of the yaw rate"),),
    outcomes=(Outcome("yaw rate limit", failed=True),),
    fields=(("order", np.float64), ("limit", np.float64)),
    fill=fill,
    history=("order",),
    columns=columns,
    plots=(Plot("rate", "Yaw rate [rad/s]", ("r", "rate_ordered")),),
    observe=observe,
    judge=judge,
    metrics={"rms_rate_error": Metric("deg/s", "root mean square of the error", "lower")},
    measure=measure,
    headline="rms_rate_error",
    fails=lambda scenario: f"error of the yaw rate beyond {scenario.limits.error_deg_s:g} deg/s",
    scenario={"base": "heading_keeping", "duration": 300.0, "start": {"heading_error_deg": 0.0}},
)
ship_gym.register_task(TASK)
