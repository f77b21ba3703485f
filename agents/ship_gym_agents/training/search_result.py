"""What a search found: the best trial, a file of hyperparameters, a table, a picture."""

from __future__ import annotations

import csv
import dataclasses
import json
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.statistics import paired
from ship_gym.text import signed_interval, table
from ship_gym.writing import atomic_path
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.sb3.sections import load_hyperparameters
from ship_gym_agents.training.score import Score, score_of
from ship_gym_agents.training.search_confirm import is_before
from ship_gym_agents.training.search_plan import Plan, Trial, mean_of
from ship_gym_agents.training.search_space import with_settings

BEST_FILE, TABLE_FILE, PICTURE_FILE = "best.toml", "trials.csv", "trials.png"
_SHOWN = 10  # trials of the printed table


def report(
    plan: Plan,
    trials: Sequence[Trial],
    out: str | Path,
    runs: Sequence[tuple[str, int, list[float | None]]] = (),
) -> dict[str, Any]:
    """Write ``best.toml``, ``trials.csv`` and ``trials.png``.

    Parameters
    ----------
    plan : Plan
    trials : sequence of Trial
    out : path
        Folder of the search.
    runs : sequence
        What ``search_confirm.confirm`` yielded.

    Returns
    -------
    dict
        For ``--json``: ``best`` (trial, settings, score), ``score`` (name, unit, better),
        ``trials``, ``confirmed`` (see `confirmed`, or None), ``best_file``, and the ``text``.

    Raises
    ------
    ConfigError
        No trial is complete.
    """
    out, config = Path(out), run_config(**plan.given)
    score = score_of(config.scenario)
    write_table(trials, out / TABLE_FILE)
    best = ranked(trials, score)
    write_best(plan, best[0], len(trials), out / BEST_FILE)
    scenario = config.scenario
    title = f"{config.algorithm}, {scenario.task}, {scenario.ship}: {len(trials)} trials"
    picture = draw_trials(trials, score, title, out / PICTURE_FILE)
    proved = confirmed(runs, score)
    written = [out / BEST_FILE, TABLE_FILE, *([PICTURE_FILE] if picture else [])]
    lines = [in_words(best, trials, score), *([proved["text"]] if proved else [])]
    if is_before(plan, best[0].settings):
        lines.append("the best are the hyperparameters of before: nothing was gained")
    return {
        "best": best[0]._asdict(),
        "score": score._asdict(),
        "trials": [trial._asdict() for trial in trials],
        "confirmed": proved,
        "best_file": str(out / BEST_FILE),
        "text": "\n".join([*lines, f"wrote {', '.join(map(str, written))}"]),
    }


def ranked(trials: Sequence[Trial], score: Score) -> list[Trial]:
    """Complete trials, the best first.

    Raises
    ------
    ConfigError
        None is complete; with the reason of the last that was refused.
    """
    sign = 1.0 if score.better == "lower" else -1.0
    complete = [trial for trial in trials if trial.state == "complete"]
    if not complete:
        why = [trial.note for trial in trials if trial.note][-1:]
        raise ConfigError(f"no trial is complete{': ' if why else ''}{' '.join(why)}")
    scores: list[Any] = [trial.score for trial in complete]
    order = sorted(range(len(complete)), key=lambda k: sign * scores[k])
    return [complete[k] for k in order]


def difference(each: Sequence[float | None], other: Sequence[float | None]):
    """Mean of each - other over the episodes that both have, with its 95 % interval; or None."""
    pairs = [(a, b) for a, b in zip(each, other, strict=False) if a is not None and b is not None]
    return paired([a for a, _ in pairs], [b for _, b in pairs]) if len(pairs) > 1 else None


def write_best(plan: Plan, trial: Trial, trials: int, path: Path) -> None:
    """Hyperparameters of a trial, as far as they are not the package's own, for ``train``."""
    config = run_config(**with_settings(plan.given, trial.settings))
    own = load_hyperparameters(config.algorithm, task=config.scenario.task)
    new, old = (
        json.loads(json.dumps(dataclasses.asdict(h))) for h in (config.hyperparameters, own)
    )
    score = score_of(config.scenario)
    lines = [
        f"# Best of {trials} trials of ship-gym tune-agent: {config.algorithm} for "
        f"{config.scenario.task} with {config.scenario.ship}.",
        f"# Mean {score.name} {trial.score:.4g} {score.unit} on {plan.episodes} tuning seeds, "
        f"{plan.seeds} training run(s). For ship-gym train --hyperparameters.",
    ]
    for section, values in new.items():
        changed = {key: value for key, value in values.items() if value != old[section].get(key)}
        if changed:
            lines += [
                "",
                f"[{section}]",
                *(f"{key} = {toml_value(v)}" for key, v in changed.items()),
            ]
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def toml_value(value: Any) -> str:
    """A value as TOML writes it: as JSON does, but for tables."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f'"{key}" = {toml_value(v)}' for key, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    return json.dumps(value)


def write_table(trials: Sequence[Trial], path: Path) -> None:
    """One row for each trial, what it was trained with behind what it reached."""
    names = list(dict.fromkeys(name for trial in trials for name in trial.settings))
    means = list(dict.fromkeys(name for trial in trials for name in trial.means))
    with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["trial", "state", "score", *means, *names, "note"])
        for trial in trials:
            own = [trial.means.get(name) for name in means]
            values = [trial.settings.get(name) for name in names]
            rows.writerow([trial.number, trial.state, trial.score, *own, *values, trial.note])


def draw_trials(trials: Sequence[Trial], score: Score, title: str, path: Path) -> Path | None:
    """The picture; None without matplotlib."""
    if find_spec("matplotlib") is None:
        return None
    from ship_gym.plotting.trials_of_search import plot_search  # late: it takes a second

    rows = [(t.number, t.score, t.state == "complete", t.settings) for t in trials]
    plot_search(rows, f"{score.name} [{score.unit}]", score.better == "lower", path, title)
    return path


def in_words(best: Sequence[Trial], trials: Sequence[Trial], score: Score) -> str:
    """The best trials as a table, each with its paired difference from the first."""
    counts = {state: sum(t.state == state for t in trials) for state in ("pruned", "refused")}
    names = list(best[0].settings)
    header = ["trial", f"{score.name} [{score.unit}]", "from the best", "travel [deg/h]", *names]
    rows = [
        [
            str(trial.number),
            f"{trial.score:.4g}",
            "" if trial is best[0] else _interval(difference(trial.each, best[0].each)),
            f"{trial.means['rudder_travel']:.0f}",
            *(_short(trial.settings.get(name)) for name in names),
        ]
        for trial in best[:_SHOWN]
    ]
    shown = f"the best {len(rows)} of {len(best)} complete trials"
    told = ", ".join(f"{count} {state}" for state, count in counts.items() if count)
    return f"{shown}{f' ({told})' if told else ''}:\n{table(header, rows, None)}"


def _short(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def _interval(found: Any) -> str:
    return "-" if found is None else signed_interval(found.value, found.low, found.high)


def confirmed(
    runs: Sequence[tuple[str, int, list[float | None]]], score: Score
) -> dict[str, Any] | None:
    """Winner against the config of before, over the seas, each the mean of its training runs.

    Returns
    -------
    dict or None
        ``best`` and ``before`` (mean of each training run), ``difference`` (value, low, high) and
        ``text``; None without runs of both.
    """
    by_who = {who: [each for name, _, each in runs if name == who] for who in ("best", "before")}
    if not all(by_who.values()):
        return None
    seas = [[mean_of(column) for column in zip(*by_who[who], strict=True)] for who in by_who]
    found = difference(*seas)
    means = {who: [mean_of(each) for each in parts] for who, parts in by_who.items()}
    verdict = "no difference shown"
    if found is not None and not found.low <= 0.0 <= found.high:
        verdict = "better" if (found.high < 0.0) == (score.better == "lower") else "WORSE"
    shown = {who: " ".join(_short(value) for value in values) for who, values in means.items()}
    text = (
        f"confirmed with fresh seeds of training and seas: {score.name} {shown['best']} against "
        f"{shown['before']} {score.unit} of the hyperparameters of before, difference "
        f"{_interval(found)}: {verdict} (the interval is over seas; the runs show what seeds of "
        "training do)"
    )
    kept = None if found is None else dataclasses.asdict(found)
    return {**means, "difference": kept, "verdict": verdict, "text": text}
