"""Ship Gym: environments, simulator and benchmark for ship autopilots.

``import ship_gym`` registers the Gymnasium ids and is light; everything below loads on first use.
So does every module: ``ship_gym.manoeuvres`` needs no import of its own.
"""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from typing import TYPE_CHECKING, Any

from ship_gym.envs.registration import ENVIRONMENTS, load_task, register_all, register_task
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import class_name

if TYPE_CHECKING:  # what `__getattr__` loads, for type checkers and editors (py.typed)
    from ship_gym.charts.chart import Chart as Chart
    from ship_gym.envs.discrete import DiscreteRudder as DiscreteRudder
    from ship_gym.envs.env import ShipEnv as ShipEnv
    from ship_gym.envs.record_rerun import RecordRerun as RecordRerun
    from ship_gym.envs.record_rerun_vector import RecordRerunVector as RecordRerunVector
    from ship_gym.envs.vector_env import ShipVectorEnv as ShipVectorEnv
    from ship_gym.gpu.torch_env import ShipTorchEnv as ShipTorchEnv
    from ship_gym.linear import linearise as linearise
    from ship_gym.recording.trajectory import Trajectory as Trajectory
    from ship_gym.scenarios.scenario import available_scenarios as available_scenarios
    from ship_gym.scenarios.scenario import load_scenario as load_scenario
    from ship_gym.sea.state import Sea as Sea
    from ship_gym.sea.state import available_seas as available_seas
    from ship_gym.sea.state import load_sea as load_sea
    from ship_gym.sea.state import measured_sea as measured_sea
    from ship_gym.sea.wave_response import load_wave_table as load_wave_table
    from ship_gym.ships.files import available_ships as available_ships
    from ship_gym.ships.loader import available_surrogates as available_surrogates
    from ship_gym.ships.loader import load_ship as load_ship
    from ship_gym.ships.particulars import Ship as Ship
    from ship_gym.ships.scaling import scaled as scaled
    from ship_gym.simulation import ShipSim as ShipSim
    from ship_gym.simulation import self_propulsion as self_propulsion
    from ship_gym.tasks.columns import action_columns as action_columns
    from ship_gym.tasks.columns import observation_columns as observation_columns
    from ship_gym.tracks.files import load_route as load_route
    from ship_gym.tracks.files import load_track as load_track
    from ship_gym.tracks.route import Route as Route
    from ship_gym.tracks.track import Track as Track

    CourseChanging: type[ShipEnv]
    HeadingKeeping: type[ShipEnv]
    TrackFollowing: type[ShipEnv]

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
