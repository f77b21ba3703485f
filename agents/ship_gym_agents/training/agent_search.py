"""Search for hyperparameters: each trial is a training run, judged on seeds kept for tuning.

Optuna proposes and prunes; its journal in the folder of the search keeps every finished trial,
whatever ends the search. A trial is one unit of an engine (``ship_gym.evaluation.engines``), which
asks the journal for its values itself, so that processes and machines need to share the folder
only. Every trial is judged on the same seas, so that two of them differ by what was learned.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.engines import Work, engine_of
from ship_gym.evaluation.splits import tuning_seeds
from ship_gym.keys import Keys, read_keys
from ship_gym.provenance import provenance
from ship_gym.reading import read_as
from ship_gym.writing import atomic_path
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training.run import Report
from ship_gym_agents.training.score import score_of, validate
from ship_gym_agents.training.search_plan import Plan, Trial, held, mean_of, trained
from ship_gym_agents.training.search_space import start_of, with_settings
from ship_gym_agents.training.train import need_libraries
from ship_gym_agents.tuning.search import need_optuna

PLAN_FILE, JOURNAL = "search.json", "trials.log"
_NAME = "agents"
_STARTUP = 8  # trials by chance before the sampler and the median pruner begin to judge


class _Job(NamedTuple):
    """A trial; its number makes the seed of the sampler."""

    plan: Plan
    out: Path
    number: int


def _lost(job: _Job, what: str) -> None:
    """Nothing: the trial that took the process with it is proposed again when resumed."""


def search(
    plan: Plan,
    out: str | Path,
    *,
    resume: bool = False,
    jobs: int = 1,
    engine: str = "local",
    address: str | None = None,
    told: Callable[[Trial], Any] = lambda trial: None,
) -> list[Trial]:
    """Run the trials that are missing; all that have ended, by number.

    Parameters
    ----------
    plan : Plan
    out : path
        Folder of the search; must not hold one unless `resume`.
    resume : bool
        Go on; the plan must be that of before, but for the number of trials.
    jobs, engine, address
        As in ``engines.engine_of``.
    told : callable
        Called with each trial that has ended.

    Raises
    ------
    ConfigError
        Another search in the folder, or a plan that cannot be used.
    ImportError
        Optuna, Ray or a library for training is not installed.
    """
    need_optuna()
    need_libraries(run_config(**plan.given).algorithm)
    out = Path(out).resolve()
    run = engine_of(engine, jobs, address, Work(_do_trial, _lost))
    with held(out):
        _check_score(plan)
        _check_earlier(plan, out, resume)
        _mend_journal(out / JOURNAL)
        study = _study(plan, out, 0)
        _clean(study, plan)
        ended = len(trials_of(plan, out))
        units = {k: _Job(plan, out, k) for k in range(ended, plan.trials)}
        for _, trial in run(units):
            if trial is not None:
                told(trial)
    return trials_of(plan, out)


def _check_score(plan: Plan) -> None:
    """Refuse episodes without a value of the score, as those too short for a steady part."""
    scenario = run_config(**plan.given).scenario
    name = score_of(scenario).name
    if validate(ConstantController(), scenario, tuning_seeds(2)).means[name] is None:
        raise ConfigError(
            f"duration = {scenario.duration:g} s: an episode has no {name}, by which trials are "
            "judged; allowed is a longer one"
        )


def _check_earlier(plan: Plan, out: Path, resume: bool) -> None:
    file = out / PLAN_FILE
    if file.is_file():
        if not resume:
            raise ConfigError(f"{out} holds a search; resume it or choose another folder")
        before = read_keys(file).table("plan").values
        different = sorted(key for key in plan.plain if plan.plain[key] != before.get(key))
        if different:
            raise ConfigError(
                f"{out}: cannot resume with other {', '.join(different)} than in {PLAN_FILE}"
            )
    with atomic_path(file) as temporary:
        told = {"plan": plan.plain, **provenance()}
        temporary.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def _mend_journal(file: Path) -> None:
    """Take what a killed search left in Optuna's journal: half a line, and its lock.

    Nobody else writes it: the folder of the search is held.
    """
    for lock in file.parent.glob(f"{file.name}.lock*"):
        lock.unlink(missing_ok=True)
    if file.is_file() and not (data := file.read_bytes()).endswith(b"\n"):
        with file.open("r+b") as journal:
            journal.truncate(data.rfind(b"\n") + 1)


def _study(plan: Plan, out: Path, number: int) -> Any:
    """The study in the journal, with a sampler for the trial of this number."""
    import optuna  # late: it takes a second

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    journal = optuna.storages.journal.JournalFileBackend(str(out / JOURNAL))
    config = run_config(**plan.given)
    validations = config.hyperparameters.training.validations
    pruner = {
        "median": optuna.pruners.MedianPruner(_STARTUP, n_warmup_steps=validations // 3),
        "hyperband": optuna.pruners.HyperbandPruner(1, validations, 3),
        "none": optuna.pruners.NopPruner(),
    }[plan.pruner]
    sampler = optuna.samplers.TPESampler(
        n_startup_trials=_STARTUP, seed=(1 + config.seed) * 100_003 + number
    )
    direction = "maximize" if score_of(config.scenario).better == "higher" else "minimize"
    with read_as(out / JOURNAL, "the journal of a search"):
        return optuna.create_study(
            study_name=_NAME,
            storage=optuna.storages.JournalStorage(journal),
            sampler=sampler,
            pruner=pruner,
            direction=direction,
            load_if_exists=True,
        )


def _clean(study: Any, plan: Plan) -> None:
    """Begin with the config as it is; propose again what a kill left without an end."""
    from optuna.trial import TrialState

    if not study.get_trials(deepcopy=False):
        study.enqueue_trial(start_of(plan.ranges, plan.given))
    for trial in study.get_trials(deepcopy=False, states=(TrialState.RUNNING,)):
        study.tell(trial.number, state=TrialState.FAIL)
        study.enqueue_trial(trial.params)


def trials_of(plan: Plan, out: Path) -> list[Trial]:
    """Trials of a search that have ended, by number."""
    return _ended(_study(plan, out, 0))


def _ended(study: Any, numbers: slice = slice(None)) -> list[Trial]:
    """Trials of a study that have ended, of those in `numbers`."""
    from optuna.trial import TrialState

    states = {TrialState.COMPLETE: "complete", TrialState.PRUNED: "pruned"}
    found = []
    for trial in study.get_trials(deepcopy=False)[numbers]:
        own = Keys(trial.user_attrs, JOURNAL, f"trial {trial.number}")
        if trial.state in states:
            shown = list(trial.intermediate_values.values())
            score = trial.value if trial.state is TrialState.COMPLETE else (shown or [None])[-1]
            each, means = own.items("each", []), dict(own.table("means", {}).values)
            settings = dict(own.table("settings").values)
            found.append(Trial(trial.number, states[trial.state], settings, score, each, means))
        elif note := own.text("refused", ""):
            settings = dict(own.table("settings").values)
            found.append(Trial(trial.number, "refused", settings, None, [], {}, note))
    return found


def _do_trial(job: _Job) -> Trial:
    """Ask for values, train with them, judge, tell."""
    import optuna

    plan, study = job.plan, _study(job.plan, job.out, job.number)
    trial = study.ask()
    settings = {name: one.suggest(trial, name) for name, one in plan.ranges.items()}
    trial.set_user_attr("settings", settings)
    try:
        each, means = _sailed_trial(plan, job.out, trial, settings)
    except optuna.TrialPruned:
        study.tell(trial, state=optuna.trial.TrialState.PRUNED)
    except ConfigError as error:
        trial.set_user_attr("refused", str(error))
        study.tell(trial, state=optuna.trial.TrialState.FAIL)
    else:
        trial.set_user_attr("each", each)
        trial.set_user_attr("means", means)
        study.tell(trial, mean_of(each))
    return _ended(study, slice(trial.number, trial.number + 1))[0]


def _sailed_trial(plan: Plan, out: Path, trial: Any, settings: Mapping[str, Any]):
    """Train once for each seed; scores of all judging episodes, means of the metrics."""
    given = with_settings(plan.given, settings)
    config = run_config(**given)
    judging, validations = tuning_seeds(plan.episodes), config.hyperparameters.training.validations
    folder, parts = out / "trials" / f"{trial.number:04d}", []
    for k in range(plan.seeds):
        given["seed"] = config.seed + k
        report = _reporter(trial, k, validations)
        parts.append(trained(plan, given, folder / f"seed_{k}", judging, report))
    name = score_of(config.scenario).name
    each = [value for part in parts for value in part.each[name]]
    return each, {name: mean_of([p.means[name] for p in parts]) for name in parts[0].means}


def _reporter(trial: Any, place: int, validations: int) -> Report:
    """What a run calls after each validation: it tells the pruner, which may end the run."""
    import optuna

    seen = set()

    def report(used: float, score: float | None) -> None:
        step = place * (validations + 1) + round(used * validations)
        if score is None or step in seen:
            return
        seen.add(step)
        trial.report(score, step)
        if used < 1.0 and trial.should_prune():
            raise optuna.TrialPruned

    return report
