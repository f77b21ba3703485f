"""Controllers that compete on Ship Gym: classical autopilots and learned policies.

A controller has a `name`, `reset` and `act`, see ``ship_gym.evaluation.controller``. `CONTROLLERS`
names those without training; `make_controller` also loads trained policies and files of gains.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known
from ship_gym.evaluation.controller import ConstantController, Controller
from ship_gym_agents.los import ILOS, LOSPID
from ship_gym_agents.pid import PID, load_gains

CONTROLLERS: dict[str, Callable[[], Controller]] = {
    "constant": ConstantController,
    "pid": PID,
    "los_pid": LOSPID,
    "ilos": ILOS,
}
PRETRAINED = Path(__file__).parent / "pretrained"


def pretrained() -> list[str]:
    """Names of the policies that come with the checkout; their card is in the file."""
    return sorted(path.stem for path in PRETRAINED.glob("*.zip"))


def make_controller(name_or_path: str | Path) -> Controller:
    """A controller or shipped policy by name, a trained policy by path, or a PID by its gains.

    Parameters
    ----------
    name_or_path : str or path
        A key of `CONTROLLERS`; one of `pretrained()`; the path of a ``.toml`` file of PID gains;
        or the folder or ``.zip`` file of a policy trained by ``scripts/train.py``.

    Raises
    ------
    ConfigError
        Unknown name (with the nearest one), no such file, or a file that is none of these.
    """
    name, path = str(name_or_path), Path(name_or_path)
    if path.suffix == ".toml":
        return PID(load_gains(path).gains, name=path.stem)
    shipped = name in pretrained()
    if shipped or (name not in CONTROLLERS and path.exists()):
        # Late: the import of this package is light, and an autopilot needs nothing of sb3.
        from ship_gym_agents.sb3.policy import load_policy

        policy = load_policy(PRETRAINED / f"{name}.zip" if shipped else path)
        policy.name = name if shipped else policy.name
        return policy
    if path.suffix or len(path.parts) > 1:
        raise ConfigError(f"{name}: no such policy; train one with: python scripts/train.py")
    return CONTROLLERS[check_known("controller", name, [*CONTROLLERS, *pretrained()])]()


def trained_for(controller: Controller) -> dict[str, Any]:
    """Scenario, ship, control and privileges of a policy's training; empty for other controllers.

    Keyword arguments of ``rollout``; each may be replaced by another.
    """
    scenario = getattr(controller, "card", {}).get("config", {}).get("scenario", {})
    found = {key: scenario[key] for key in ("ship", "control", "privileged") if key in scenario}
    return found | ({"scenario": scenario} if scenario else {})
