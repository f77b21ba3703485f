"""Follow steps of the ordered heading: kernels and metrics of ``tasks.heading``, more orders."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import check_fields
from ship_gym.physics.angles import wrapped
from ship_gym.tasks.base import Moment, Outcome
from ship_gym.tasks.course import NAME, VERSION, kernels
from ship_gym.tasks.heading.kernels import FROM, ORDER
from ship_gym.tasks.heading.metrics import ORDERS
from ship_gym.tasks.heading.task import TASK as HEADING
from ship_gym.tasks.heading.task import Limits as HeadingLimits
from ship_gym.tasks.heading.task import fails as heading_fails


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
class Limits(HeadingLimits):
    """What ends an episode as failed.

    Attributes
    ----------
    heading_error_deg : float
        Heading error; 180: nothing.
    overshoot_deg : float or None
        Heading beyond the order on the first swing past it after a step (task
        ``course_changing``); None: any.
    """

    overshoot_deg: float | None = None

    def __post_init__(self):
        super().__post_init__()
        check_fields("limits", self, {"overshoot_deg": (0.1, 180.0, "deg")})


def fill(scenario, tasks) -> None:
    """Write the limits of error and overshoot."""
    HEADING.fill(scenario, tasks)
    largest = scenario.limits.overshoot_deg
    tasks["overshoot_limit"] = math.inf if largest is None else math.radians(largest)


def limits(scenario, ship) -> dict[str, float]:
    """The limits of error and overshoot, where there are any."""
    largest = scenario.limits.overshoot_deg
    past = {} if largest is None else {"overshoot_deg": largest}
    return HEADING.limits(scenario, ship) | past


def fails(scenario) -> str:
    """What ends an episode as failed."""
    largest = scenario.limits.overshoot_deg
    past = "" if largest is None else f", or beyond {largest:g} deg on the swing past a new order"
    return heading_fails(scenario) + past


class Orders:
    """One ordered heading, then steps of it.

    Each step has a size uniform between the two of the section ``course``, a side by chance and a
    time uniform between the two after the one before, in whole control intervals.
    """

    def __init__(self, scenario, ships):
        del ships
        self._course, self._interval = scenario.course, scenario.control_interval
        self._steps = scenario.course.changes
        self.shape, self.n_draws = (1 + self._steps, 2), 3 * self._steps

    def make(self, which, uniform, order, plans, tasks):
        """See ``tasks.base.Plan``."""
        course = self._course
        tasks["count"][which] = self.shape[0]
        psi, time = order.copy(), np.full(len(which), course.first)
        plans[which, 0, FROM], plans[which, 0, ORDER] = 0.0, psi
        for k in range(self._steps):
            size, side, gap = uniform[:, 3 * k : 3 * k + 3].T
            degrees = course.step_min_deg + (course.step_max_deg - course.step_min_deg) * size
            step = np.where(side < 0.5, -1.0, 1.0) * degrees * (math.pi / 180.0)
            psi = np.array([wrapped(a) for a in (psi + step).tolist()])
            plans[which, k + 1, FROM] = np.maximum(np.rint(time / self._interval), 1.0)
            plans[which, k + 1, ORDER] = psi
            time = time + course.interval_min + (course.interval_max - course.interval_min) * gap
        return np.zeros(len(which)), np.zeros(len(which))


def meta(plan) -> dict:
    """Intervals from which the orders were to hold, as an episode that failed may not reach all."""
    return {ORDERS: [int(begins) for begins in plan[:, FROM]]}


TASK = dataclasses.replace(
    HEADING,
    name=NAME,
    version=VERSION,
    title="Follow steps of the ordered heading in a seaway.",
    sections={**HEADING.sections, "limits": Limits, "course": Course},
    outcomes=(*HEADING.outcomes, Outcome("overshoot limit", failed=True)),
    fields=kernels.FIELDS,
    fill=fill,
    judge=kernels.judge,
    plan=Orders,
    begin=kernels.begin,
    fails=fails,
    limits=limits,
    meta=meta,
    headline="settling_time",
    page=Path(__file__).with_name("page.md").read_text(encoding="utf-8"),
    example={"sea.states": ["ss5"], "duration": 1200.0},
    moment=Moment("pid", 1, 330),
)
