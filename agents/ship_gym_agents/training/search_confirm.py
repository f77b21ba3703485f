"""Confirm the winner of a search: train it and the config of before again, with fresh seeds.

The best of many trials was partly lucky; what its hyperparameters are worth shows in runs that did
not choose them, on seas that did not either.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ship_gym.config import check_number
from ship_gym.evaluation.engines import Work, engine_of
from ship_gym.evaluation.splits import tuning_seeds
from ship_gym.keys import read_keys
from ship_gym.writing import atomic_path
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training.score import score_of
from ship_gym_agents.training.search_plan import Plan, held, trained
from ship_gym_agents.training.search_space import with_settings

_FRESH = 1000  # added to the seed of training


class _Job(NamedTuple):
    """One training run with the settings of `who`."""

    plan: Plan
    out: Path
    number: int
    who: str
    settings: Mapping[str, Any]


def _lost(job: _Job, what: str) -> None:
    """Nothing: the comparison goes without this run."""


def is_before(plan: Plan, settings: Mapping[str, Any]) -> bool:
    """Whether settings leave the config as it is."""
    return run_config(**with_settings(plan.given, settings)) == run_config(**plan.given)


def confirm(
    plan: Plan,
    out: str | Path,
    settings: Mapping[str, Any],
    *,
    jobs: int = 1,
    engine: str = "local",
    address: str | None = None,
) -> Iterator[tuple[str, int, list[float | None]]]:
    """Train the winner and the config of before again, with seeds that no trial had.

    Nothing where the two are the same.

    Parameters
    ----------
    settings : mapping
        Of the winner.
    plan, out, jobs, engine, address
        As in `search`.

    Yields
    ------
    who : str
        ``"best"`` or ``"before"``.
    place : int
        Which of the training seeds.
    each : list
        Score of each judging episode, on tuning seeds behind those of the trials.
    """
    if is_before(plan, settings):
        return
    out = Path(out).resolve()
    run = engine_of(engine, jobs, address, Work(_do_confirm, _lost))
    both = [("best", settings), ("before", {})]
    units = {
        number: _Job(plan, out, number // 2, *both[number % 2])
        for number in range(2 * plan.confirm)
    }
    with held(out):
        for number, each in run(units):
            if each is not None:
                yield both[number % 2][0], number // 2, each


def _do_confirm(job: _Job) -> list[float | None]:
    """Train and judge, or read what an earlier part of the search found for these settings."""
    plan, folder = job.plan, job.out / "confirm" / f"{job.who}_{job.number}"
    file = folder / "each.json"
    key = json.loads(json.dumps(dict(job.settings)))
    if file.is_file():
        found = read_keys(file)
        if found.table("settings").values == key:
            return [None if v is None else check_number(str(file), v) for v in found.items("each")]
    given = with_settings(plan.given, job.settings)
    config = run_config(**given)
    given["seed"] = config.seed + _FRESH + job.number
    judging = tuning_seeds(2 * plan.episodes)[plan.episodes :]
    each = trained(plan, given, folder, judging).each[score_of(config.scenario).name]
    with atomic_path(file) as temporary:
        temporary.write_text(json.dumps({"settings": key, "each": each}) + "\n", encoding="utf-8")
    return each
