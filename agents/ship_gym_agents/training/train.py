"""train: a policy from a scenario, with everything needed to repeat, resume and judge it.

A run folder holds ``card.json`` (from the first second: config, command, versions, status; later
samples, validations, final evaluation), ``lock``, ``checkpoint/`` (to resume), the best policy so
far, ``curve.csv`` and ``curve.png``. Each file is written whole or not at all.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym_agents.controllers import shipped_file
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.sb3.config import RunConfig
from ship_gym_agents.training.curves import draw_curves, is_stale
from ship_gym_agents.training.final import judge
from ship_gym_agents.training.run import Report, Run
from ship_gym_agents.training.run_folder import TrainingFolder

FEWEST_JUDGING = 64  # episodes of the final evaluation, at least
GAUSS_NEWTON = "gauss_newton"


def train(
    config: RunConfig,
    out: str | Path,
    *,
    minutes: float | None = None,
    steps: int | None = None,
    resume: bool = False,
    init: str | Path | None = None,
    bar: Any = None,
    report: Report | None = None,
    final: bool = True,
    command: str = "",
) -> dict[str, Any]:
    """Train a policy and write its run folder.

    Parameters
    ----------
    config : RunConfig
    out : str or path
        Run folder; must not hold a run unless `resume`.
    minutes : float, optional
        Time of training of the whole run, earlier parts of a resumed one included; validations
        and files are not charged to it.
    steps : int, optional
        Samples of the whole run. At least one of the two limits is needed.
    resume : bool
        Continue the run in `out`, which must have the same config; one that was killed before its
        first checkpoint, or no run at all, begins anew.
    init : str or path, optional
        Policy whose weights the run begins with: one of the package by name, a file or the folder
        of a run. A resumed run keeps its own.
    bar : object, optional
        Progress bar with ``n``, ``total`` and ``update(increment)``.
    report : callable, optional
        Called with the used share of the budget and the score after every validation; what it
        raises ends the run.
    final : bool
        Compare the best policy with classical controllers at the end.
    command : str
        What was typed, for the card.

    Returns
    -------
    dict
        The card.

    Raises
    ------
    ConfigError
        No budget or none left, a folder that holds a run or that another process trains into, a
        policy to begin with that cannot be read or is not that of the resumed run.
    ImportError
        A library for training is not installed.
    """
    need_libraries(config.algorithm)
    folder = TrainingFolder(out)
    with folder.locked():
        init = beginning(folder, init, resume)
        told = {"command": command, "init": init}
        try:
            run = Run(config, folder, minutes, steps, resume, told, report)
        except ConfigError:
            if resume and is_stale(folder.path):  # killed while it was drawn
                draw_curves(folder.path)
            raise
        try:
            learn, own = _learner(config.algorithm), None if init is None else _file(init)
            return learn(run, own, bar, _judge(run) if final else None)
        except ConfigError:
            run.refuse()
            folder.free()
            raise
        except KeyboardInterrupt:
            run.write("interrupted")
            raise
        finally:
            draw_curves(folder.path)


def need_libraries(algorithm: str) -> None:
    """Refuse, before any work, that a library which an algorithm needs is not installed."""
    for library in () if algorithm == GAUSS_NEWTON else ("torch", "stable_baselines3"):
        if find_spec(library) is None:
            raise ImportError(
                f'training needs {library}, which is not installed: pip install "ship-gym[rl]"'
            )


def beginning(folder: TrainingFolder, init: str | Path | None, resume: bool) -> str | None:
    """Policy to begin with, that of the resumed run if there is one; None: from nothing.

    Raises
    ------
    ConfigError
        Another policy than the resumed run began with, or one that cannot be read.
    """
    card, given = (folder.card() if resume else None), None if init is None else str(init)
    if card is not None:
        before = card.get("init")
        if given not in (None, before):
            raise ConfigError(
                f"{folder.path}: init = {given}: a resumed run began with {before or 'no policy'}; "
                "leave it out"
            )
        given = before
    if given is not None and folder.checkpoint() is None:
        load_policy(_file(given))
    return given


def _file(init: str) -> str | Path:
    """Where the policy of a name or path lies."""
    return shipped_file(init) or init


def _learner(algorithm: str) -> Callable[..., dict[str, Any]]:
    """What learns, imported late: torch takes seconds, and the card is to be there before."""
    if algorithm == GAUSS_NEWTON:
        from ship_gym_agents.training.gauss_newton import learn
    else:
        from ship_gym_agents.training.sb3_run import learn
    return learn


def _judge(run: Run) -> Callable[[Any], dict[str, Any]]:
    """The final evaluation of the run's best policy."""
    hyper = run.config.hyperparameters

    def of(policy: Any) -> dict[str, Any]:
        episodes = max(FEWEST_JUDGING, run.episodes)
        base, ships = hyper.form.base, hyper.training.ships
        return judge(policy, run.config.scenario, run.score, episodes, base, run.seeds, ships)

    return of
