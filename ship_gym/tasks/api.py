"""Everything that a task of your own is made of, in one import.

See ``docs/extending.md`` for a whole one, and `Task` for what each part means.
"""

from ship_gym.conventions import COMMAND_NAMES, DELTA, PSI, STATE_NAMES, N, R, U, V, X, Y
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import wrapped
from ship_gym.physics.dynamics import water_velocity
from ship_gym.tasks import measures
from ship_gym.tasks.base import (
    DIVERGED,
    RUNNING,
    ErrorColumn,
    Metric,
    Moment,
    NoLimits,
    OneOrder,
    Outcome,
    Plot,
    Row,
    Start,
    Task,
    Term,
)
from ship_gym.tasks.bridge import N_BRIDGE, clipped, observe_bridge, settle
from ship_gym.tasks.rewards import costs

__all__ = [
    "COMMAND_NAMES",
    "DELTA",
    "DIVERGED",
    "N",
    "N_BRIDGE",
    "PSI",
    "R",
    "RUNNING",
    "STATE_NAMES",
    "U",
    "V",
    "X",
    "Y",
    "ErrorColumn",
    "Metric",
    "Moment",
    "NoLimits",
    "OneOrder",
    "Outcome",
    "Plot",
    "Row",
    "Start",
    "Task",
    "Term",
    "clipped",
    "costs",
    "kernel",
    "measures",
    "observe_bridge",
    "settle",
    "water_velocity",
    "wrapped",
]
