"""Plan of a search for hyperparameters, what a trial leaves, and one training run of a trial."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import shutil
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import check_known, check_number
from ship_gym.locks import check_own, locked
from ship_gym.writing import sweep
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training.budget import Budget
from ship_gym_agents.training.run import Report
from ship_gym_agents.training.score import Validation, validate
from ship_gym_agents.training.search_space import Range
from ship_gym_agents.training.train import train

PRUNERS = ("median", "hyperband", "none")


@dataclasses.dataclass(frozen=True)
class Plan:
    """What is searched, and how.

    Attributes
    ----------
    given : dict
        Arguments of ``run_config`` that all trials share; plain values.
    ranges : dict of str to Range
    trials : int
        Those that end, pruned ones included.
    minutes, steps : optional
        Budget of each training run.
    seeds : int
        Training runs of one trial, which differ by their seed.
    episodes : int
        Tuning seeds that judge a trial.
    confirm : int
        Training runs with seeds of their own, of the winner and of the hyperparameters of before,
        both judged on further tuning seeds; 0: none.
    pruner : str
        One of `PRUNERS`.
    """

    given: dict[str, Any]
    ranges: dict[str, Range]
    trials: int = 20
    minutes: float | None = None
    steps: int | None = None
    seeds: int = 1
    episodes: int = 64
    confirm: int = 3
    pruner: str = "median"

    def __post_init__(self):
        check_number("trials", self.trials, 1, 100_000)
        check_number("seeds", self.seeds, 1, 1000)
        check_number("episodes", self.episodes, 2, 10_000)
        check_number("confirm", self.confirm, 0, 1000)
        check_known("pruner", self.pruner, PRUNERS)
        Budget(self.minutes, self.steps)

    @property
    def plain(self) -> dict[str, Any]:
        """As JSON gives it back; what a resumed search may change is left out."""
        made = dataclasses.asdict(self)
        made = {key: made[key] for key in made if key not in ("trials", "confirm")}
        return json.loads(json.dumps(made, default=str))


class Trial(NamedTuple):
    """A trial that has ended.

    Attributes
    ----------
    number : int
    state : str
        ``"complete"``, ``"pruned"`` or ``"refused"`` (values that cannot be combined).
    settings : dict
        Values by dotted name.
    score : float or None
        Mean of the headline metric; of a pruned one what it showed last.
    each : list
        Score of each judging episode, one training seed after the other.
    means : dict
        Success, rudder travel and others.
    note : str
    """

    number: int
    state: str
    settings: dict[str, Any]
    score: float | None
    each: list[float | None]
    means: dict[str, float | None]
    note: str = ""


def trained(
    plan: Plan,
    given: Mapping[str, Any],
    folder: Path,
    judging: Sequence[int],
    report: Report | None = None,
) -> Validation:
    """One training run, its best policy on the judging seeds; no checkpoint stays.

    Parameters
    ----------
    plan : Plan
        With the budget.
    given : mapping
        Arguments of ``run_config``.
    folder : path
        Of the run; what is in it is removed.
    judging : sequence of int
    report : callable, optional
        As in ``train``.
    """
    config = run_config(**given)
    shutil.rmtree(folder, ignore_errors=True)  # of a search that was killed
    budget: dict[str, Any] = {"minutes": plan.minutes, "steps": plan.steps}
    try:
        with warnings.catch_warnings():
            # n_steps and batch_size are drawn each by itself; a last short batch is no harm
            warnings.filterwarnings("ignore", "You have specified a mini-batch size")
            train(config, folder, **budget, report=report, final=False, command="tune-agent")
        return validate(load_policy(folder), config.scenario, judging)
    finally:
        for part in ("checkpoint", "tensorboard"):
            shutil.rmtree(folder / part, ignore_errors=True)


def mean_of(values: Sequence[float | None]) -> float | None:
    """Mean of those that there are."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


@contextlib.contextmanager
def held(out: Path) -> Iterator[None]:
    """Hold the folder of a search; refused while another process does."""
    names = ("search.json", "trials.log", "best.toml", "trials.csv", "trials.png")
    check_own(out, names)
    with locked(out / "lock", "searches in this folder"):
        sweep(out)
        yield
