"""What of a controller is tuned for a task, in which scenario, and where its gains belong."""

from __future__ import annotations

from typing import Any

from ship_gym.config import ConfigError
from ship_gym.ships.particulars import Ship
from ship_gym_agents.tuning.objective import objective_of


def structures_of(
    controller: type[Any], ship: Ship, task: str | None = None
) -> dict[str, tuple[Any, tuple[str, ...]]]:
    """Structure -> gains to begin at and names of those that are free; of a task or in general.

    Raises
    ------
    ConfigError
        The class cannot be tuned: it lacks a part of the protocol.
    """
    missing = [key for key in ("KIND", "TUNED", "first_gains") if not hasattr(controller, key)]
    if missing:
        raise ConfigError(
            f"controller {controller.__name__} cannot be tuned: it has no {', no '.join(missing)}"
        )
    on_course = task is not None and objective_of(task).name == "settling_time"
    if on_course and hasattr(controller, "course_structures"):
        return controller.course_structures(ship)
    if hasattr(controller, "structures"):
        return controller.structures(ship)
    return {"": (controller.first_gains(ship), tuple(controller.TUNED))}


def scenario_for(controller: type[Any]) -> str:
    """The scenario that a controller is tuned in if none is named."""
    on_track = "cross_track" in getattr(controller, "needs", ())
    return "track_following" if on_track else "heading_keeping"


def own_task_of(controller: type[Any], task: str) -> str | None:
    """The task that tuned gains are for and no other; None: they are the ship's in general.

    General are those of the task of `scenario_for`, or of the tasks that a controller names by a
    class attribute `GENERAL`.
    """
    general = getattr(controller, "GENERAL", (scenario_for(controller),))
    return None if task in general else task
