"""Controllers as a benchmark takes them: by name, with what they are and where they come from."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.unit import Entrant
from ship_gym.own_files import split
from ship_gym.provenance import sha256
from ship_gym_agents.autopilot import Autopilot
from ship_gym_agents.controllers import PRETRAINED, make_controller
from ship_gym_agents.gains_files import tuned_files


def entrant(named: str | Path) -> Entrant:
    """The controller of a name or file, as `make_controller` takes it, ready to travel.

    Raises
    ------
    ConfigError
        As `make_controller`.
    """
    text = _absolute(str(named))
    made = make_controller(text)
    file = _file(text)
    about = {} if file is None else {"file": file.name, "sha256": sha256(file)}
    about |= _gains(made)
    kind = "policy" if hasattr(made, "card") else "own" if split(text) else "classical"
    if kind == "policy":
        about |= {"trained": trained(made.card)}
    make = functools.partial(make_controller, text)
    return Entrant(str(named), made.name, make, kind, about | _told(made))


def _absolute(named: str) -> str:
    """The name, files as absolute paths: another process may stand in another folder."""
    file, name = split(named) or (Path(named), "")
    if not file.exists():
        return named
    return f"{file.resolve()}{f':{name}' if name else ''}"


def _file(text: str) -> Path | None:
    """The file that decides what a controller does; None for one of the package's own code."""
    from ship_gym_agents.sb3.policy import POLICY_FILE

    file = Path((split(text) or (text, ""))[0])
    shipped = PRETRAINED / f"{text}.zip"
    found = [path for path in (shipped, file / POLICY_FILE, file) if path.is_file()]
    return found[0] if found else None


def _gains(controller: Controller) -> dict[str, Any]:
    """Files of tuned gains that ship and task choose from, with the beginning of their SHA-256."""
    if not isinstance(controller, Autopilot) or controller.gains_given:
        return {}
    lent, kind = controller.lent_by, controller.KIND
    files = {path.name: path for path in reversed(tuned_files(kind))}
    if lent is not None:
        own = f"{kind}_{lent.name}."
        files = {name: path for name, path in files.items() if name.startswith(own)}
    return {"gains_files": {name: sha256(files[name])[:12] for name in sorted(files)}}


def _told(controller: Controller) -> dict[str, Any]:
    """What a controller says of itself, by an optional method ``about``."""
    about = getattr(controller, "about", None)
    return dict(about()) if callable(about) else {}


def trained(card: Mapping[str, Any]) -> dict[str, Any]:
    """What a policy was trained on: scenario's task, ship, seed, samples, as its card says."""
    config = card.get("config", {})
    scenario = config.get("scenario", {})
    found = {key: scenario.get(key) for key in ("task", "ship", "control")}
    found["sea"] = scenario.get("sea", {}).get("states")
    found |= {"algorithm": config.get("algorithm"), "seed": config.get("seed")}
    found |= {key: card.get(key) for key in ("samples", "seconds", "validation_seeds")}
    return {key: value for key, value in found.items() if value is not None}
