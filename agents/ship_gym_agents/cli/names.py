"""What can be named, kind by kind, for ``ship-gym list`` and for the completion of a shell."""

from __future__ import annotations

from collections.abc import Callable


def ships() -> list[str]:
    """Ships of the package."""
    from ship_gym.ships.files import available_ships

    return available_ships()


def scenarios() -> list[str]:
    """Scenarios of the package."""
    from ship_gym.scenarios.scenario import available_scenarios

    return available_scenarios()


def tasks() -> list[str]:
    """Tasks that are registered."""
    from ship_gym.tasks import TASKS

    return list(TASKS)


def controllers() -> list[str]:
    """Autopilots and trained policies of the package."""
    from ship_gym_agents.controllers import CONTROLLERS, pretrained

    return [*CONTROLLERS, *pretrained()]


def controls() -> list[str]:
    """What a controller can command."""
    from ship_gym.tasks.columns import ACTIONS

    return list(ACTIONS)


def seas() -> list[str]:
    """Named seas."""
    from ship_gym.sea.state import available_seas

    return available_seas()


def algorithms() -> list[str]:
    """Algorithms of training."""
    from ship_gym_agents.sb3.config import OPTIONS

    return list(OPTIONS)


def recipes() -> list[str]:
    """Plans of training that come with the package."""
    from ship_gym_agents.sb3.config import available_recipes

    return available_recipes()


def suites() -> list[str]:
    """Suites of benchmarks."""
    from ship_gym.evaluation.suite import ALL, available_suites

    return [*available_suites(), ALL]


def engines() -> list[str]:
    """What sails a benchmark."""
    from ship_gym.evaluation.engines import ENGINES

    return list(ENGINES)


def episodes() -> list[str]:
    """Which episodes of an evaluation can be recorded."""
    from ship_gym.evaluation.choice import WHICH

    return list(WHICH)


NAMES: dict[str, Callable[[], list[str]]] = {
    "ships": ships,
    "scenarios": scenarios,
    "tasks": tasks,
    "controllers": controllers,
    "seas": seas,
    "algorithms": algorithms,
    "controls": controls,
    "recipes": recipes,
    "suites": suites,
    "engines": engines,
    "episodes": episodes,
}
