"""Controllers by name: classical autopilots, learned policies, gains, a user's own.

A controller has a `name`, `reset` and `act`, see ``ship_gym.evaluation.controller``. `CONTROLLERS`
names those without training; `make_controller` also loads the others.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known, shown, told_of
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym.ships import load_ship
from ship_gym_agents.adaptive import Adaptive
from ship_gym_agents.autopilot import Autopilot
from ship_gym_agents.bang_bang import BangBang
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.gains_files import kind_of, load_gains, tuned_file
from ship_gym_agents.los import ILOS, LOSPID
from ship_gym_agents.lqg import LQG
from ship_gym_agents.mpc import MPC
from ship_gym_agents.pid import PID
from ship_gym_agents.plugins import file_of, is_own, load_object, own_controller
from ship_gym_agents.speed_keeping import JustInTime

CONTROLLERS: dict[str, Callable[[], Controller]] = {
    "constant": ConstantController,
    "pid": PID,
    "los_pid": LOSPID,
    "ilos": ILOS,
    "drift_los": DriftLOS,
    "adaptive": Adaptive,
    "bang_bang": BangBang,
    "just_in_time": JustInTime,
    "lqg": LQG,
    "mpc": MPC,
}
OWN_MODEL = "+model"  # behind name@ship
PRETRAINED = Path(__file__).parent / "pretrained"


def pretrained() -> list[str]:
    """Names of the policies that come with the package."""
    return sorted(path.stem for path in PRETRAINED.glob("*.safetensors"))


def shipped_file(name: str) -> Path | None:
    """File of a policy that comes with the package; None if there is none of that name."""
    return PRETRAINED / f"{name}.safetensors" if name in pretrained() else None


def make_controller(name_or_path: str | Path) -> Controller:
    """A controller or shipped policy by name; a policy, gains or a user's own by its file.

    Parameters
    ----------
    name_or_path : str or path
        A key of `CONTROLLERS`; ``"name@ship"``: that controller with the gains of this ship,
        whatever ship sails, and ``"name@ship+model"``: on the linear model of the ship that sails,
        as its designers know it; one of `pretrained()`; the path of a ``.toml`` file of gains,
        which names its controller; the ``.safetensors`` file of a policy or the folder of a run of
        ``ship-gym train``, for several seeds the median one; or ``"file.py:Name"``: a controller
        of one's own, its class or what makes it.

    Raises
    ------
    ConfigError
        Unknown name (with the nearest one), no such file, or a file that is none of these.
    """
    name, path = str(name_or_path), Path(name_or_path)
    if is_own(name):
        return _of_file(own_controller(name), file_of(name))
    if path.suffix == ".toml":
        with told_of(path):
            kind = controller_class(kind_of(path))
        return _of_file(kind(load_gains(path, kind).gains, name=path.stem), path)
    if "@" in name and not os.path.exists(path):
        return _with_gains_of(*name.rsplit("@", 1))
    if (file := shipped_file(name)) or (name not in CONTROLLERS and os.path.exists(path)):
        # Late: the import of this package is light, and an autopilot needs no policies.
        from ship_gym_agents.policies.policy_file import load_policy

        policy = load_policy(file or path)
        policy.name = name if file else policy.name
        return policy
    if path.suffix or len(path.parts) > 1:
        raise ConfigError(f"{shown(name, 150)}: no such policy; train one with: ship-gym train")
    return CONTROLLERS[check_known("controller", name, [*CONTROLLERS, *pretrained()])]()


def _of_file(controller: Any, file: Path) -> Controller:
    """A controller that says which file decides what it does, as a policy does (`file`)."""
    if not hasattr(controller, "file"):
        with contextlib.suppress(AttributeError):  # one of slots has no room for it
            controller.file = file
    return controller


def controller_class(name: str) -> type[Any]:
    """The class of a controller with gains: a key of `CONTROLLERS` or one's own ``file.py:Class``.

    Raises
    ------
    ConfigError
        There is none, or it has no gains that differ from ship to ship.
    """
    if is_own(name):
        found = load_object(name)
    else:
        check_known("controller", name, [*CONTROLLERS, *pretrained()])
        found = CONTROLLERS.get(name)
    if not hasattr(found, "KIND"):
        able = [key for key, one in CONTROLLERS.items() if hasattr(one, "KIND")]
        raise ConfigError(f"controller {shown(name)} has no gains; allowed are {', '.join(able)}")
    return found


def _with_gains_of(name: str, ship: str) -> Controller:
    """A controller with the gains of a ship, whatever ship sails; of the `OWN_MODEL` of that."""
    found = controller_class(name)
    whole, ship = ship, ship.removesuffix(OWN_MODEL)
    foreign = load_ship(ship)
    gains_for = getattr(found, "gains_for", None)  # a controller of one's own may have none
    gains = gains_for(foreign) if gains_for else tuned_file(foreign, found).gains
    made = found(gains, name=f"{name}@{whole}")
    if isinstance(made, Autopilot):
        made.lent_by = foreign  # those of the task that is sailed, as for a ship of its own
        made.own_model = whole != ship
    elif whole != ship:
        raise ConfigError(f"controller {name}@{whole}: has no linear model to replace")
    return made


def trained_for(controller: Controller) -> dict[str, Any]:
    """Scenario, ship, control and privileges of a policy's training; empty for other controllers.

    Keyword arguments of ``rollout``; each may be replaced by another.
    """
    scenario = getattr(controller, "card", {}).get("config", {}).get("scenario", {})
    found = {key: scenario[key] for key in ("ship", "control", "privileged") if key in scenario}
    return found | ({"scenario": scenario} if scenario else {})
