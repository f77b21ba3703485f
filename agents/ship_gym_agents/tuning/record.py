"""What a file of gains tells of its tuning, and whether a tuning is done already."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

from ship_gym.evaluation.rollout import tuning_seeds
from ship_gym.evaluation.statistics import Estimate
from ship_gym.provenance import versions
from ship_gym.ships import load_ship
from ship_gym_agents.gains_files import GainsFile, load_gains, place_for_gains
from ship_gym_agents.tuning.objective import objective_of
from ship_gym_agents.tuning.search import Size
from ship_gym_agents.tuning.tune import VALIDATION, Tuning

_PACKAGES = ("ship-gym", "python", "numpy", "scipy")
_SEARCH = ("optuna", "cmaes")


def settings(
    size: Size, scenario: str, task: str, structures: Sequence[str], **more: Any
) -> dict[str, Any]:
    """What a tuning depends on, as a file of gains tells it; `more`: control, overrides."""
    first, n = tuning_seeds(1)[0], size.episodes
    method = f"CMA-ES, {size.generations} generations of {size.candidates}, seed {size.seed}"
    if size.polish:
        method += f"; then Nelder-Mead, {size.polish} evaluations"
    return {
        "objective": objective_of(task).text,
        "method": method,
        "scenario": str(scenario),
        "structures": list(structures),
        "seeds_tuning": [first, first + n - 1],
        "seeds_validation": [first + n, first + (1 + VALIDATION) * n - 1],
        **more,
    }


def is_tuned(
    controller: type[Any], ship: str, how: Mapping[str, Any], path: Path | None = None
) -> bool:
    """Whether a file of gains of this ship by these `settings` and these versions is there."""
    name = load_ship(ship).name
    path = place_for_gains(name, controller.KIND) if path is None else Path(path)
    if not path.is_file():
        return False
    found = load_gains(path, controller)
    same = all(found.tuning.get(key) == value for key, value in how.items())
    mine = found.controller == controller.KIND
    return same and mine and found.ship == name and found.versions == _versions()


def gains_file(found: Tuning, how: Mapping[str, Any]) -> GainsFile:
    """The winner of a tuning with what reproduces it.

    Parameters
    ----------
    found : Tuning
    how : mapping
        `settings` of the tuning.
    """
    best = found.best
    tuning = {
        "structure": best.structure,
        **how,
        "cost_tuning": _short(best.cost_tuning),
        "cost_validation": _short(best.cost),
        "begun_at": found.begun,
        "before": found.before,
        "cost_before": _short(found.cost_before),
        "gained": _interval(found.gained),
        "changed": {key: _interval(one) for key, one in found.changed.items()},
        "at_bounds": sorted(best.at_bounds),
        "validation_of": {
            tuned.structure or found.controller: {k: _short(v) for k, v in tuned.validation.items()}
            for tuned in found.ranking
        },
    }
    return GainsFile(found.ship, best.gains, tuning, _versions(), found.controller, found.task)


def _interval(found: Estimate) -> list[float | None]:
    return [_short(x) for x in (found.value, found.low, found.high)]


def _short(value: float | None) -> float | None:
    return None if value is None else round(value, 4)


def _versions() -> dict[str, str]:
    found = {k: v for k, v in versions().items() if k in _PACKAGES}
    return found | {name: metadata.version(name) for name in _SEARCH}
