"""Data sets for offline learning and imitation: who sailed, what was seen, ordered and earned.

`Plan` says what is sailed, `write_set` sails it in batches into a data set of Minari, `load_set`
reads one without network; docs/datasets.md has the conventions.
"""

from __future__ import annotations

try:
    import minari  # noqa: F401  late enough: only who wants data sets comes here
except ImportError as error:
    raise ImportError('data sets need minari: pip install "ship-gym[minari]"') from error

from ship_gym_agents.datasets.plan import RANDOM, Plan
from ship_gym_agents.datasets.read import load_set, read_set, select
from ship_gym_agents.datasets.write import Written, write_set

__all__ = ["RANDOM", "Plan", "Written", "load_set", "read_set", "select", "write_set"]
