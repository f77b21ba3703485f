"""The best, the median and the worst episode of an evaluation: named, and recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

Episodes = Mapping[str, Mapping[str, Sequence[float | None]]]


def check_which(which: Sequence[str], folder: Path | None) -> None:
    """Refuse ``--which`` without a folder to record into, unknown words, and a missing library."""
    from ship_gym.config import check_known
    from ship_gym.evaluation.choice import WHICH
    from ship_gym_agents.cli.output import need

    if which and folder is None:
        raise click.UsageError("--which: needs --record FOLDER")
    for word in which:
        check_known("--which", word, WHICH)
    if folder is not None:
        need("rerun")


def extremes_of(rollouts: Sequence[Any], episodes: Episodes) -> dict[str, Any]:
    """Seeds and values of these episodes of each controller, by the headline of the task.

    Where no episode has a value of it, since all are too short, the return decides.

    Parameters
    ----------
    rollouts : sequence of Rollout
    episodes : mapping
        Controller -> metric -> values, as ``compare`` gives them.

    Returns
    -------
    dict
        ``by`` (metric), ``of`` (controller -> best, median, worst -> seed, value).
    """
    from ship_gym.evaluation import choice

    by, better = _decides(rollouts[0], episodes)
    found = {
        one.controller: choice.extremes(
            one.seeds, episodes[one.controller][by], better, one.failed.tolist()
        )
        for one in rollouts
    }
    return {"by": by, "of": found}


def extremes_table(found: Mapping[str, Any], markdown: bool = False) -> str:
    """The extremes of an evaluation as text, seed: value."""
    from ship_gym.evaluation.choice import EXTREMES
    from ship_gym.text import table

    by, rows = found["extremes"]["by"], []
    for name, extremes in found["extremes"]["of"].items():
        rows.append([name, *(_cell(extremes.get(which)) for which in EXTREMES)])
    unit = found["metrics"][by]["unit"]
    title = f"episode, seed: {by}" if unit == "-" else f"episode, seed: {by} [{unit}]"
    return table([title, *EXTREMES], rows, None, markdown=markdown)


def recorded(
    rollouts: Sequence[Any], episodes: Episodes, which: Sequence[str], folder: Path
) -> list[Path]:
    """Write episodes of each controller into a folder; gives the files.

    Parameters
    ----------
    rollouts, episodes
        As in `extremes_of`.
    which : sequence of str
        Of ``choice.WHICH``.
    folder : path
    """
    from ship_gym.evaluation import choice
    from ship_gym.evaluation.recordings import file_name, keep
    from ship_gym_agents.cli.output import progress

    by, better = _decides(rollouts[0], episodes)
    wanted = []
    for sailed in rollouts:
        values, failed = episodes[sailed.controller][by], sailed.failed.tolist()
        each = [i for word in which for i in choice.chosen(word, values, better, failed)]
        wanted += [(sailed, i) for i in dict.fromkeys(each)]
    files = []
    for sailed, i in progress(wanted, "recording"):
        file = folder / file_name(sailed.controller, sailed.seeds[i])
        files.append(keep(sailed.trajectory(i), file).file)
    return files


def _decides(sailed: Any, episodes: Episodes) -> tuple[str, str]:
    """The metric that decides, and which values of it are better."""
    from ship_gym.evaluation import metrics_of
    from ship_gym.evaluation.choice import deciding

    name = sailed.task.headline
    name = deciding(name, {name: [value for one in episodes.values() for value in one[name]]})
    return name, metrics_of(sailed.task.name)[name].better


def _cell(episode: Mapping[str, Any] | None) -> str:
    if not episode:
        return "-"
    value = episode["value"]
    return f"{episode['seed']}: {'-' if value is None else f'{value:.4g}'}"
