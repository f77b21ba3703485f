"""Controllers that compete on Ship Gym: classical autopilots and learned policies.

``import ship_gym_agents`` is light; what is below loads on first use. The console command
``ship-gym`` is the package `cli`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # what `__getattr__` loads, for type checkers and editors (py.typed)
    from ship_gym_agents.controllers import CONTROLLERS as CONTROLLERS
    from ship_gym_agents.controllers import PRETRAINED as PRETRAINED
    from ship_gym_agents.controllers import make_controller as make_controller
    from ship_gym_agents.controllers import pretrained as pretrained
    from ship_gym_agents.controllers import trained_for as trained_for

_PUBLIC = (
    "CONTROLLERS",
    "PRETRAINED",
    "make_controller",
    "pretrained",
    "trained_for",
)

__all__ = [*_PUBLIC]


def __getattr__(name: str) -> Any:
    """Load a public name on first use (PEP 562)."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'ship_gym_agents' has no attribute {name!r}")
    return getattr(importlib.import_module("ship_gym_agents.controllers"), name)


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(_PUBLIC))
