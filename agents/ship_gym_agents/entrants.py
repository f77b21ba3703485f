"""Controllers as a benchmark takes them: by name, with what they are and where they come from."""

from __future__ import annotations

import functools
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.unit import Entrant
from ship_gym.own_files import split
from ship_gym.provenance import sha256
from ship_gym_agents.autopilot import Autopilot
from ship_gym_agents.controllers import CONTROLLERS, make_controller, shipped_file
from ship_gym_agents.gains_files import tuned_files


def entrant(named: str | Path, shown: str | None = None) -> Entrant:
    """The controller of a name or file, as `make_controller` takes it, ready to travel.

    Parameters
    ----------
    named : str or path
    shown : str, optional
        Its name in tables, instead of its own; see `distinct`.

    Raises
    ------
    ConfigError
        As `make_controller`.
    """
    text = _absolute(str(named))
    made: Any = make_controller(text)
    file = _file(text)
    about: dict[str, Any] = {} if file is None else {"file": file.name, "sha256": sha256(file)}
    about |= _gains(made)
    kind = "policy" if hasattr(made, "card") else "own" if split(text) else "classical"
    if kind == "policy":
        about |= {"trained": trained(made.card)}
        about |= _gains(make_controller(made.form.base)) if made.form.base else {}
    make = functools.partial(make_controller, text)
    return Entrant(str(named), shown or made.name, make, kind, about | _told(made))


def distinct(named: Sequence[str]) -> dict[str, str]:
    """How policies of one name are told apart, such as the seeds of a run: by their paths.

    Parameters
    ----------
    named : sequence of str
        As `make_controller` takes them; those that are no files of policies are passed over.

    Returns
    -------
    dict
        Name or path to the name to show, of policies that would share one.
    """
    from ship_gym_agents.policies.policy_file import read_card

    files = [text for text in dict.fromkeys(named) if _is_policy(text)]
    names = {text: str(read_card(text).get("name")) for text in files}
    own = list(names.values())
    return {text: text.rstrip("/") for text, name in names.items() if own.count(name) > 1}


def controllers_of(named: Sequence[str]) -> list[Controller]:
    """Controllers to sail side by side, as `make_controller` makes them, each with its own name.

    Raises
    ------
    ConfigError
        As `make_controller`; none, or two of one name.
    """
    shown = distinct(named)
    made = [make_controller(text) for text in named]
    for text, controller in zip(named, made, strict=True):
        controller.name = shown.get(text, controller.name)
    names = [controller.name for controller in made]
    if not names:
        raise ConfigError("--controller: nothing to sail; name at least one")
    if double := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(f"two controllers are named {double[0]!r}; give one another name")
    return made


def _is_policy(text: str) -> bool:
    """Whether `make_controller` would read a policy from this path."""
    path = Path(text)
    usual = text in CONTROLLERS or shipped_file(text) or path.suffix == ".toml" or split(text)
    return not usual and os.path.exists(path)


def _absolute(named: str) -> str:
    """The name, files as absolute paths: another process may stand in another folder."""
    file, name = split(named) or (Path(named), "")
    if not os.path.exists(file):
        return named
    return f"{file.resolve()}{f':{name}' if name else ''}"


def _file(text: str) -> Path | None:
    """The file that decides what a controller does; None for one of the package's own code."""
    if _is_policy(text):
        from ship_gym_agents.policies.policy_file import policy_path

        return policy_path(text)
    file = Path((split(text) or (text, ""))[0])
    found = [path for path in (shipped_file(text), file) if path and os.path.isfile(path)]
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
    found |= {"algorithm": config.get("algorithm")}
    found |= {key: card.get(key) for key in ("samples", "seconds", "validation_seeds")}
    return {key: value for key, value in found.items() if value is not None}
