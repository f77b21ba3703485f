"""The card of a data set: what is in it and where it comes from, as values and as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.evaluation.splits import split_of
from ship_gym.provenance import provenance
from ship_gym.tasks import TASKS
from ship_gym.text import table
from ship_gym_agents.datasets.plan import RANDOM, Entry, Prepared
from ship_gym_agents.datasets.sail import CLEAN, Episode
from ship_gym_agents.datasets.scores import normalised, returns_of
from ship_gym_agents.entrants import entrant

LICENSE = "Apache-2.0"  # that of the package
HEADER = (
    *("Controller", "Noise", "Episodes", "Seeds", "Steps"),
    *("Return, mean ± std", "5 % to 95 %", "Normalised", "Failed"),
)
_SHARES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)


def episodes_of_entry(entry: Entry, episodes: Sequence[Episode], ready: Prepared) -> list[dict]:
    """What Minari keeps beside each episode: who sailed, with which noise, how it ended."""
    outcomes = ready.task.all_outcomes
    return [
        {
            "controller": entry.controller.name,
            "noise": entry.noise,
            "return": float(value),
            "outcome": outcomes[one.outcome].name if one.outcome else "truncated",
            "failed": bool(outcomes[one.outcome].failed),
        }
        for one, value in zip(episodes, returns_of(list(episodes)), strict=True)
    ]


def row_of(entry: Entry, told: Sequence[Mapping[str, Any]], steps: Sequence[int]) -> dict[str, Any]:
    """What the card says of the episodes of one controller with one noise."""
    ends = [one["outcome"] for one in told]
    return {
        "controller": entry.controller.name,
        "noise": entry.noise,
        "episodes": len(told),
        "seeds": [entry.seeds[0], entry.seeds[-1]],
        "steps": int(sum(steps)),
        "returns": distribution([one["return"] for one in told]),
        "failed": float(np.mean([one["failed"] for one in told])),
        "outcomes": {name: ends.count(name) for name in dict.fromkeys(ends)},
    }


def distribution(values: Sequence[float]) -> dict[str, float]:
    """Mean, standard deviation and quantiles."""
    quantiles = np.quantile(values, _SHARES).tolist()
    names = ("min", "5 %", "25 %", "median", "75 %", "95 %", "max")
    spread = {"mean": float(np.mean(values)), "std": float(np.std(values))}
    return spread | dict(zip(names, quantiles, strict=True))


def made_card(
    ready: Prepared,
    name: str,
    rows: Sequence[Mapping[str, Any]],
    scores: Mapping[str, Any],
    spec: Any,
    minari_version: str,
    written: Mapping[str, Any],
) -> dict[str, Any]:
    """The card as plain values, as JSON keeps them.

    Parameters
    ----------
    ready : Prepared
    name : str
        Id of the data set.
    rows : sequence of mapping
        As `row_of` gives them.
    scores : mapping
        As ``scores.reference_scores`` gives them.
    spec : gymnasium.envs.registration.EnvSpec
    minari_version : str
    written : mapping
        ``author``, ``license``.
    """
    plan, scenario = ready.plan, ready.scenario
    made = provenance()
    first, last = ready.entries[0].seeds[0], ready.entries[-1].seeds[-1]
    return {
        "dataset_id": name,
        **written,
        "environment": {"id": spec.id, "kwargs": spec.kwargs},
        "task_file": TASKS.files.get(ready.task.name),
        "task": ready.task.name,
        "ship": ready.ship.name,
        "scenario": scenario.to_dict(),
        "controllers": {one.controller.name: _about(one.named) for one in ready.entries},
        "noise": {
            "std": list(plan.noise),
            "time": plan.noise_time,
            "kind": "Ornstein-Uhlenbeck process"
            if plan.noise_time > 0.0
            else "independent numbers",
        },
        "seeds": {"first": first, "last": last, "split": split_of(first)},
        "episodes": sum(row["episodes"] for row in rows),
        "steps": sum(row["steps"] for row in rows),
        "infos": plan.infos,
        "reference_scores": dict(scores),
        "entries": [
            {**row, "normalised_mean": normalised(row["returns"]["mean"], scores)} for row in rows
        ],
        "versions": {**made["versions"], "minari": minari_version},
        "git_commit": made["git_commit"],
    }


def _about(named: str) -> dict[str, Any]:
    if named == RANDOM:
        return {"named": named, "kind": "uniform in [-1, 1]"}
    found = entrant(named)
    return {"named": named, "kind": found.kind, **found.about}


def markdown(card: Mapping[str, Any]) -> str:
    """The card for people."""
    seeds, env = card["seeds"], card["environment"]
    made = ", ".join(f"{key} {value}" for key, value in card["versions"].items())
    text = [
        f"Author: {card['author']}. License: {card['license']}.",
        f'Environment: `gym.make("{env["id"]}", **{env["kwargs"]})`.',
        f"Seeds {seeds['first']} to {seeds['last']}, split {seeds['split']}. With these versions "
        "`env.reset(seed=seed)` and an episode's actions give that episode again, bit for bit.",
        f"Actions are float32 in [-1, 1], as the environment got them. {_noise_in_words(card)}",
        scores_in_words(card),
        "Failed: ended at a limit of the scenario, or the ship is none any more.",
        f"Made by commit {card['git_commit']} with {made}.",
    ]
    return (
        "\n\n".join(
            [
                f"# {card['dataset_id']}",
                f"{card['steps']} steps of {card['episodes']} episodes of `{env['id']}`, ship "
                f"{card['ship']}.",
                table(HEADER, [cells(row) for row in card["entries"]], markdown=True),
                "\n".join(f"- {one}" for one in text),
            ]
        )
        + "\n"
    )


def scores_in_words(card: Mapping[str, Any]) -> str:
    """What the normalised scores 0 and 1 are."""
    scores = card["reference_scores"]
    first, last = scores["seeds"]
    random, expert = f"random actions ({scores['random']:.5g})", scores["expert_name"]
    expert = f"{expert} ({scores['expert']:.5g}), {scores['episodes']} episodes"
    if scores["expert"] <= scores["random"]:
        return f"No normalised scores: {random} earn as much as {expert}."
    return (
        f"Normalised scores: 0 is the mean return of {random}, 1 that of {expert} each, seeds "
        f"{first} to {last}."
    )


def _noise_in_words(card: Mapping[str, Any]) -> str:
    noise = card["noise"]
    if not any(noise["std"]):
        return "Nothing is added to what the controllers ask for."
    time = f"correlation time {noise['time']:g} s" if noise["time"] else "white"
    text = f"Noise on them: {noise['kind']}, {time}, standard deviation as in the table."
    clean = f" `{CLEAN}` among the infos is what the controller asked for before it."
    return text + clean * card["infos"]


def cells(row: Mapping[str, Any]) -> list[str]:
    """A row of the card as text, below `HEADER`."""
    returns, score = row["returns"], row["normalised_mean"]
    return [
        row["controller"],
        f"{row['noise']:g}",
        str(row["episodes"]),
        f"{row['seeds'][0]} to {row['seeds'][1]}",
        str(row["steps"]),
        f"{returns['mean']:.4g} ± {returns['std']:.3g}",
        f"{returns['5 %']:.4g} to {returns['95 %']:.4g}",
        "-" if score is None else f"{score:.3f}",
        f"{100.0 * row['failed']:.3g} %",
    ]
