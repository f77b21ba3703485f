"""Several seeds of one config: a run folder for each, the median policy, the spread.

The folder holds ``seed_0/``, ``seed_1/`` ..., each a run as of one seed, and of all of them
``card.json``, ``summary.json``, ``curve.png`` and the policy of the median seed.
"""

from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import multiprocessing
import shutil
import signal
from collections.abc import Callable, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_number
from ship_gym.evaluation.engines import begin_worker
from ship_gym.provenance import provenance
from ship_gym.writing import atomic_path
from ship_gym_agents.policies.policy_file import POLICY_FILE
from ship_gym_agents.sb3.config import CARD_FILE, RunConfig, check_free, is_config_of, plain
from ship_gym_agents.training.budget import Budget
from ship_gym_agents.training.curves import draw_curves, is_stale
from ship_gym_agents.training.run import status_of
from ship_gym_agents.training.run_folder import TrainingFolder
from ship_gym_agents.training.score import Score, score_of
from ship_gym_agents.training.train import beginning, need_libraries, train

SUMMARY_FILE = "summary.json"
_POLL = 2.0  # seconds between two looks at the cards of runs in other processes


def train_seeds(
    config: RunConfig,
    out: str | Path,
    count: int,
    *,
    jobs: int = 1,
    minutes: float | None = None,
    steps: int | None = None,
    resume: bool = False,
    init: str | Path | None = None,
    bar: Any = None,
    final: bool = True,
    command: str = "",
) -> dict[str, Any]:
    """Train `count` policies that differ by their seed only, the first with the config's own.

    Parameters
    ----------
    count : int
    jobs : int
        Runs at a time, each in a process of its own if more than one. Ctrl-C and `SIGTERM` let
        each write a checkpoint.
    config, out, minutes, steps, resume, init, bar, final, command
        As in `train`; the budget is that of each seed.

    Returns
    -------
    dict
        The card: with ``seeds``, what each reached, and ``median``, the one whose policy is kept.

    Raises
    ------
    ConfigError
        As `train`, or a run of another number of seeds to resume.
    ChildProcessError
        The process of a seed was killed.
    """
    check_number("seeds", count, 2, 1000)
    check_number("jobs", jobs, 1, 1000)
    Budget(minutes, steps)
    need_libraries(config.algorithm)
    folder = TrainingFolder(out)
    score = score_of(config.scenario, config.hyperparameters.training.wear)
    with folder.locked():
        _check_earlier(folder, config, count, resume)
        init = beginning(folder, init, resume)
        card = {
            "name": f"{config.algorithm}-{folder.name}",
            "status": "running",
            "config": plain(config),
            "budget": {"minutes": minutes, "steps": steps},
            "seeds": count,
            "command": command,
            "init": init,
            **provenance(),
        }
        folder.write_card(card)
        options = {"minutes": minutes, "steps": steps, "init": init}
        options |= {"final": final, "command": command}
        try:
            cards = _all(_parts(config, folder.path, count), options, jobs, bar)
        except BaseException as stop:
            folder.write_card(card | {"status": status_of(stop)})
            if isinstance(stop, ConfigError) and not any(folder.path.glob(f"seed_*/{CARD_FILE}")):
                folder.free()
            raise
        finally:
            draw_curves(folder.path, sorted(folder.path.glob("seed_*")))
        card |= {"status": "complete", **summarised(cards, score)}
        with atomic_path(folder.path / SUMMARY_FILE) as temporary:
            temporary.write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")
        best = folder.path / f"seed_{card['median']['place']}" / POLICY_FILE
        with atomic_path(folder.path / POLICY_FILE) as temporary:
            shutil.copyfile(best, temporary)
        folder.write_card(card)
        return card


def _check_earlier(folder: TrainingFolder, config: RunConfig, count: int, resume: bool) -> None:
    if not resume:
        check_free(folder.path)
    card = folder.card()
    if card is None:
        return
    if card.get("seeds") != count or not is_config_of(folder.path, config):
        raise ConfigError(
            f"{folder.path}: cannot resume with another config or number of seeds than in "
            f"{CARD_FILE}"
        )


def _parts(config: RunConfig, out: Path, count: int) -> list[tuple[RunConfig, Path]]:
    """Config and folder of each seed."""
    return [
        (dataclasses.replace(config, seed=config.seed + k), out / f"seed_{k}") for k in range(count)
    ]


def _all(
    parts: Sequence[tuple[RunConfig, Path]], options: dict[str, Any], jobs: int, bar: Any
) -> list[dict[str, Any]]:
    """Train all, in turn or several at a time; their cards in order."""
    if jobs > 1:
        return _side_by_side(parts, options, jobs, bar)
    return [
        _one(config, out, options, None if bar is None else _PartOfBar(bar, k, len(parts)))
        for k, (config, out) in enumerate(parts)
    ]


def _side_by_side(
    parts: Sequence[tuple[RunConfig, Path]], options: dict[str, Any], jobs: int, bar: Any
) -> list[dict[str, Any]]:
    """Train `jobs` at a time, each in a process of its own, which ends with this one.

    No more are handed out than are trained: what a pool has been given it does to the end.
    """
    spawn, before = multiprocessing.get_context("spawn"), set(multiprocessing.active_children())
    todo = iter(enumerate(parts))
    under_way: dict[concurrent.futures.Future, int] = {}  # a forked torch may hang: spawn
    made: dict[int, dict[str, Any]] = {}
    pool = concurrent.futures.ProcessPoolExecutor(jobs, spawn, begin_worker)
    try:
        while len(made) < len(parts):
            while len(under_way) < jobs and (item := next(todo, None)) is not None:
                under_way[pool.submit(_one_there, *item[1], options)] = item[0]
            done, _ = concurrent.futures.wait(under_way, _POLL, concurrent.futures.FIRST_COMPLETED)
            for one in done:
                made[under_way.pop(one)] = one.result()  # raises what ended it
            _show(bar, [out for _, out in parts])
    except BrokenProcessPool:
        raise ChildProcessError(
            "the process of a seed was ended from outside; --resume goes on"
        ) from None
    finally:
        if len(made) < len(parts):
            for process in set(multiprocessing.active_children()) - before:
                process.terminate()
        pool.shutdown(cancel_futures=True)
    return [made[k] for k in range(len(parts))]


def _one_there(config: RunConfig, out: Path, options: dict[str, Any]) -> dict[str, Any]:
    """`_one` in a process of a pool; being terminated breaks it off, with a checkpoint."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return _one(config, out, options, None)
    finally:
        signal.signal(signal.SIGTERM, before)


def _one(config: RunConfig, out: Path, options: dict[str, Any], bar: Any) -> dict[str, Any]:
    """Train one seed, or go on with it; what is complete stays as it is."""
    folder = TrainingFolder(out)
    with folder.locked():  # mended, if a kill left its card behind
        card = folder.card()
    same = {key: options[key] for key in ("minutes", "steps")}
    if card is not None and card["status"] == "complete" and card["budget"] == same:
        if is_stale(out):  # killed while its picture was drawn
            draw_curves(out)
        return card
    return train(config, out, resume=True, bar=bar, **options)


class _PartOfBar:
    """The share of a bar that belongs to one of several runs in turn."""

    def __init__(self, bar: Any, place: int, count: int):
        self._bar, self._place, self._count = bar, place, count
        self.n, self.total = 0, bar.total
        self.update(0)

    def update(self, increment: int) -> None:
        """Move."""
        self.n += increment
        wanted = int((self._place * self.total + self.n) / self._count)
        self._bar.update(wanted - self._bar.n)

    def set_postfix_str(self, text: str) -> None:
        """Show a text."""
        if hasattr(self._bar, "set_postfix_str"):
            self._bar.set_postfix_str(f"seed {self._place + 1} of {self._count}, {text}")


def _show(bar: Any, folders: Sequence[Path]) -> None:
    """Move a bar by what the cards of runs in other processes say."""
    if bar is not None:
        cards = [TrainingFolder(folder).card() or {} for folder in folders]
        share = sum(card.get("used", 0.0) for card in cards) / len(cards)
        bar.update(int(share * bar.total) - bar.n)


def summarised(cards: Sequence[dict[str, Any]], score: Score) -> dict[str, Any]:
    """What the seeds reached, and the median one.

    By the final evaluation, without one by the best validation. Of an even number the worse one of
    the two in the middle is taken.

    Returns
    -------
    dict
        ``runs`` (seed, means, verdicts), ``median`` (place, seed, means), ``spread`` of the score.
    """
    runs = [
        {
            "place": k,
            "seed": card["config"]["seed"],
            **card.get("final", {}).get("policy", card["best"]),
            "against": {
                name: each["difference"]["verdict"]
                for name, each in card.get("final", {}).get("references", {}).items()
            },
        }
        for k, card in enumerate(cards)
    ]
    order: Callable[[dict[str, Any]], Any] = score.key
    ranked = sorted(runs, key=order)
    known = [value for run in runs if (value := run.get(score.name)) is not None]
    return {
        "score": score.text,
        "runs": runs,
        "median": ranked[len(ranked) // 2],
        "spread": [min(known), max(known)] if known else None,
    }
