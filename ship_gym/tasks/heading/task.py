"""Keep an ordered heading."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_fields
from ship_gym.conventions import wrap_angle
from ship_gym.tasks.base import ErrorColumn, Moment, Outcome, Start, Task
from ship_gym.tasks.bridge import observe_bridge
from ship_gym.tasks.heading import NAME, VERSION, kernels
from ship_gym.tasks.heading.metrics import METRICS, measure


@dataclasses.dataclass(frozen=True)
class Limits:
    """What ends an episode as failed.

    Attributes
    ----------
    heading_error_deg : float
        Heading error; 180: nothing.
    """

    heading_error_deg: float = 180.0

    def __post_init__(self):
        check_fields("limits", self, {"heading_error_deg": (1.0, 180.0, "deg")})


def fill(scenario, tasks) -> None:
    """Write the limit of the heading error."""
    tasks["heading_limit"] = math.radians(scenario.limits.heading_error_deg)


def check(scenario) -> None:
    """Refuse a start beyond the limit."""
    start, limit = scenario.start.heading_error_deg, scenario.limits.heading_error_deg
    if start >= limit and limit != 180.0:
        raise ConfigError(
            f"start.heading_error_deg = {start}: must be below limits.heading_error_deg = {limit}"
        )


def columns(recorded, history, plan) -> dict[str, np.ndarray]:
    """Order and error [rad] of a recording."""
    error = wrap_angle(recorded["psi"] - history["psi_ordered"])
    return {"psi_ordered": history["psi_ordered"], "psi_error": error}


def scene(episodes, i) -> dict:
    """Order and limit for a picture."""
    task = episodes.tasks[i]
    return {
        "psi_ordered": float(task["psi_ordered"]),
        "heading_limit": float(task["heading_limit"]),
    }


def limits(scenario, ship) -> dict[str, float]:
    """The limit of the heading error, where there is one."""
    del ship
    largest = scenario.limits.heading_error_deg
    return {"heading_error_deg": largest} if largest < 180.0 else {}


def fails(scenario) -> str:
    """What ends an episode as failed."""
    return f"heading error beyond {scenario.limits.heading_error_deg:g} deg"


TASK = Task(
    name=NAME,
    version=VERSION,
    title="Hold an ordered heading in a seaway.",
    sections={"start": Start, "limits": Limits},
    terms=kernels.TERMS,
    outcomes=(Outcome("heading limit", failed=True),),
    fields=kernels.FIELDS,
    fill=fill,
    observe=observe_bridge,
    judge=kernels.judge,
    error=kernels.error,
    check=check,
    history=("psi_ordered",),
    columns=columns,
    error_column=ErrorColumn("psi_error", "heading error", "rad"),
    limits=limits,
    metrics=METRICS,
    measure=measure,
    headline="J_steady",
    controllers=("pid", "constant"),
    scene=scene,
    fails=fails,
    page=Path(__file__).with_name("page.md").read_text(encoding="utf-8"),
    example={"sea.states": ["ss5"], "duration": 900.0},
    moment=Moment("pid", 2, 120),
)
