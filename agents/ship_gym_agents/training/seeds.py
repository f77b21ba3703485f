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
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_number
from ship_gym.provenance import atomic_path, provenance
from ship_gym_agents.policies.policy_file import POLICY_FILE
from ship_gym_agents.sb3.config import CARD_FILE, RunConfig, plain
from ship_gym_agents.training.budget import Budget
from ship_gym_agents.training.curves import draw_curves
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
        Runs at a time, each in a process of its own if more than one.
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
    """
    check_number("seeds", count, 2, 1000)
    check_number("jobs", jobs, 1, 1000)
    Budget(minutes, steps)
    need_libraries(config.algorithm)
    folder = TrainingFolder(out)
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
        except ConfigError:
            if not any(folder.path.glob(f"seed_*/{CARD_FILE}")):
                folder.free()
            raise
        except KeyboardInterrupt:
            folder.write_card(card | {"status": "interrupted"})
            raise
        finally:
            draw_curves(folder.path, sorted(folder.path.glob("seed_*")))
        card |= {"status": "complete", **summarised(cards, _score(config))}
        with atomic_path(folder.path / SUMMARY_FILE) as temporary:
            temporary.write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")
        best = folder.path / f"seed_{card['median']['place']}" / POLICY_FILE
        with atomic_path(folder.path / POLICY_FILE) as temporary:
            shutil.copyfile(best, temporary)
        folder.write_card(card)
        return card


def _check_earlier(folder: TrainingFolder, config: RunConfig, count: int, resume: bool) -> None:
    card = folder.card()
    if card is None:
        return
    if not resume:
        raise ConfigError(f"{folder.path} holds a run; resume it or choose another folder")
    if card["config"] != plain(config) or card.get("seeds") != count:
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
    if jobs == 1:
        return [
            _one(config, out, options, None if bar is None else _PartOfBar(bar, k, len(parts)))
            for k, (config, out) in enumerate(parts)
        ]
    spawn = multiprocessing.get_context("spawn")  # a forked torch may hang
    with concurrent.futures.ProcessPoolExecutor(jobs, mp_context=spawn) as pool:
        try:
            waiting = [pool.submit(_one, config, out, options, None) for config, out in parts]
            left = set(waiting)
            while left:
                done, left = concurrent.futures.wait(
                    left, _POLL, concurrent.futures.FIRST_EXCEPTION
                )
                for one in done:
                    one.result()  # raises what ended it
                _show(bar, [out for _, out in parts])
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [one.result() for one in waiting]


def _one(config: RunConfig, out: Path, options: dict[str, Any], bar: Any) -> dict[str, Any]:
    """Train one seed, or go on with it; what is complete stays as it is."""
    card = TrainingFolder(out).card()
    same = {key: options[key] for key in ("minutes", "steps")}
    if card is not None and card["status"] == "complete" and card["budget"] == same:
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


def _score(config: RunConfig) -> Score:
    return score_of(config.scenario)._replace(wear=config.hyperparameters.training.wear)


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
    known = [run[score.name] for run in runs if run[score.name] is not None]
    return {
        "score": score.text,
        "runs": runs,
        "median": ranked[len(ranked) // 2],
        "spread": [min(known), max(known)] if known else None,
    }
