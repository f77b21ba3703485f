"""Ship Gym: environments, simulator and benchmark for ship autopilots.

``import ship_gym`` registers the Gymnasium ids and is light; everything below loads on first use.
So does every module: ``ship_gym.manoeuvres`` needs no import of its own.
"""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from typing import Any

from ship_gym.envs.registration import ENVIRONMENTS, load_task, register_all, register_task
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import class_name

__version__ = "0.1.0"

# public name -> module that defines it
_PUBLIC = {
    "Chart": "ship_gym.charts.chart",
    "DiscreteRudder": "ship_gym.envs.discrete",
    "RecordRerun": "ship_gym.envs.record_rerun",
    "RecordRerunVector": "ship_gym.envs.record_rerun_vector",
    "Route": "ship_gym.tracks.route",
    "Sea": "ship_gym.sea.state",
    "Ship": "ship_gym.ships.particulars",
    "ShipEnv": "ship_gym.envs.env",
    "ShipSim": "ship_gym.simulation",
    "ShipTorchEnv": "ship_gym.gpu.torch_env",
    "ShipVectorEnv": "ship_gym.envs.vector_env",
    "Track": "ship_gym.tracks.track",
    "Trajectory": "ship_gym.recording.trajectory",
    "action_columns": "ship_gym.tasks.columns",
    "available_scenarios": "ship_gym.scenarios.scenario",
    "available_seas": "ship_gym.sea.state",
    "available_ships": "ship_gym.ships.files",
    "available_surrogates": "ship_gym.ships.loader",
    "linearise": "ship_gym.linear",
    "load_route": "ship_gym.tracks.files",
    "load_scenario": "ship_gym.scenarios.scenario",
    "load_sea": "ship_gym.sea.state",
    "load_ship": "ship_gym.ships.loader",
    "load_track": "ship_gym.tracks.files",
    "load_wave_table": "ship_gym.sea.wave_response",
    "measured_sea": "ship_gym.sea.state",
    "observation_columns": "ship_gym.tasks.columns",
    "scaled": "ship_gym.ships.scaling",
    **{class_name(task): "ship_gym.envs.classes" for task in TASKS},
    "self_propulsion": "ship_gym.simulation",
}

__all__ = [*sorted(_PUBLIC), "ENVIRONMENTS", "load_task", "register_task", "__version__"]

register_all()


def __getattr__(name: str) -> Any:
    """Load a public name or module on first use (PEP 562)."""
    if name in _PUBLIC:
        value = getattr(importlib.import_module(_PUBLIC[name]), name)
        globals()[name] = value
        return value
    if name in {class_name(task) for task in TASKS}:  # of one's own
        return getattr(importlib.import_module("ship_gym.envs.classes"), name)
    path = f"{__name__}.{name}"
    if name.startswith("_") or not name.isidentifier() or importlib.util.find_spec(path) is None:
        raise AttributeError(f"module 'ship_gym' has no attribute {name!r}")
    return importlib.import_module(path)


def __dir__() -> list[str]:
    modules = {found.name for found in pkgutil.iter_modules(__path__)}
    return sorted({*globals(), *_PUBLIC, *(name for name in modules if name[0] != "_")})
