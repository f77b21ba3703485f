"""Tuning of controllers: search on tuning seeds, all candidates of a generation in one batch.

What a controller needs to be tuned: `KIND`, `TUNED`, ``first_gains(ship)`` and, if it has several,
``structures(ship)``; see `ship_gym_agents.tuning.tune`.
"""

from ship_gym_agents.tuning.record import gains_file, is_tuned, settings
from ship_gym_agents.tuning.tune import Size, Tuned, Tuning, tune

__all__ = ["Size", "Tuned", "Tuning", "gains_file", "is_tuned", "settings", "tune"]
