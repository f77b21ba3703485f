"""From the options of what is sailed to the arguments of a rollout, own tasks included."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any


def own_task(task: str | None) -> str | None:
    """Load the task of ``--task``, a name or FILE.py[:NAME]; its name, None without the option."""
    if task is None:
        return None
    from ship_gym import load_task

    return load_task(task).name


def wanted(
    options: Mapping[str, Any], task: str | None = None, known: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Arguments of ``rollout`` and ``run_config`` from options.

    Parameters
    ----------
    options : mapping
        ``scenario``, ``ship``, ``control``, ``overrides``, as ``options.environment`` gives them;
        those left out are None or empty.
    task : str, optional
        Name of the task of ``--task``: its scenario is taken unless another one is asked for.
    known : mapping, optional
        What a policy was trained for; each may be replaced.
    """
    found = dict(known or {})
    given = {key: value for key, value in options.items() if value not in (None, {})}
    if task is not None and "scenario" not in given and _task_of(found) != task:
        found["scenario"] = task
    return found | given


def _task_of(known: Mapping[str, Any]) -> str | None:
    return known.get("scenario", {}).get("task")


def check_task(sailed: str, task: str | None, scenario: Any) -> None:
    """Refuse a scenario of another task than ``--task`` asks for."""
    from ship_gym.config import ConfigError, shown

    if task is not None and sailed != task:
        raise ConfigError(f"--task {task}: scenario {scenario} is of task {shown(sailed)}")


def resolved(env: Mapping[str, Any], task: str | None) -> Any:
    """The scenario of the arguments of a rollout, refused if it is not of the task asked for."""
    from ship_gym.envs.env import resolved_scenario

    names = ("ship", "control", "surrogate", "privileged", "overrides")
    given = {key: env.get(key) for key in names}
    scenario, _ = resolved_scenario(env.get("scenario", "heading_keeping"), **given)
    check_task(scenario.task, task, env.get("scenario"))
    return scenario


def known_to(named: Sequence[str]) -> tuple[str | None, dict[str, Any]]:
    """The first of these controllers that was trained, and what for; None and nothing if none."""
    from ship_gym_agents.controllers import make_controller, trained_for

    for name in named:
        if found := trained_for(make_controller(name)):
            return name, found
    return None, {}


def ready(controllers: Sequence[Any], start: Any, seeds: Sequence[int]) -> None:
    """Refuse, before the first one sails, controllers that cannot steer episodes that begin so."""
    from ship_gym.evaluation.guard import Guarded

    for controller in controllers:
        Guarded(controller, seeds[:1]).reset(1, start.ship, start.scenario)


def again(options: Mapping[str, Any], task: str | None) -> dict[str, Any]:
    """The options of what is sailed, as ``output.next_command`` takes them."""
    overrides = [f"{key}={_shown(value)}" for key, value in options["overrides"].items()]
    kept = {key: options[key] for key in ("scenario", "ship", "control")}
    return {**kept, "task": task, "set": overrides}


def _shown(value: Any) -> str:
    """A value as ``--set`` takes it: TOML, a text bare where it would be read as one."""
    from ship_gym_agents.cli.options import toml_value

    if isinstance(value, str) and toml_value(value) == value:
        return value
    return _toml(value)


def _toml(value: Any) -> str:
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{json.dumps(key)} = {_toml(own)}' for key, own in value.items())}}}"
    return str(value)
