"""Write a data set: sail what a plan says, in batches, into a set that appears when it is whole."""

from __future__ import annotations

import copy
import dataclasses
import json
import os
from collections.abc import Iterable, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

import gymnasium as gym

import ship_gym  # noqa: F401  knows the environment ids
from ship_gym_agents.datasets import card as cards
from ship_gym_agents.datasets.minari_set import VERSION, NewSet, check_free, put_whole, usual_folder
from ship_gym_agents.datasets.plan import Plan, Prepared, prepared, usual_id
from ship_gym_agents.datasets.sail import Progress, batches, sail
from ship_gym_agents.datasets.scores import reference_scores

AUTHOR = "Ship Gym"  # of a set that nobody signs


@dataclasses.dataclass(frozen=True)
class Written:
    """A data set that was written.

    Attributes
    ----------
    name : str
        Its id.
    folder : Path
        Of all data sets.
    card : dict
    """

    name: str
    folder: Path
    card: dict[str, Any]

    @property
    def path(self) -> Path:
        """Of the set: ``data``, ``card.json`` and ``README.md`` are in it."""
        return self.folder / self.name


def _plain(iterable: Iterable, description: str = "") -> Iterable:
    return iterable


def write_set(
    plan: Plan,
    folder: str | os.PathLike | None = None,
    name: str | None = None,
    *,
    author: str = AUTHOR,
    email: str | None = None,
    license: str = cards.LICENSE,
    force: bool = False,
    progress: Progress = _plain,
) -> Written:
    """Sail a plan and write its episodes as a data set of Minari.

    Parameters
    ----------
    plan : Plan
    folder : path-like, optional
        Of all data sets; ``usual_folder()`` if omitted.
    name : str, optional
        Id of the set; one that says what is in it if omitted.
    author, email, license : str
        For card and metadata.
    force : bool
        Replace a set of that id.
    progress : callable
        ``progress(iterable, description)`` of control intervals.

    Raises
    ------
    ConfigError
        What `prepared` refuses, a set that is there, a place that cannot be written; before the
        first episode. And ``ControllerFailed`` while they sail: then nothing is written.
    """
    folder = usual_folder() if folder is None else Path(folder)
    ready = prepared(plan)
    name = name or usual_id(ready)
    path = check_free(folder, name, force)
    spec = env_spec(ready)
    about = {"author": author, "license": license}
    with put_whole(path, folder) as place:
        scores = reference_scores(ready, progress)
        new, rows = NewSet(place, spec), []
        for entry in ready.entries:
            rows.append(_add(new, entry, ready, progress))
        card = cards.made_card(ready, name, rows, scores, spec, VERSION, about)
        card = json.loads(json.dumps(card, default=str))
        new.describe(_metadata(card, ready, author, email))
        (place / "card.json").write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")
        (place / "README.md").write_text(cards.markdown(card), encoding="utf-8")
    return Written(name, folder, card)


def _add(new: NewSet, entry: Any, ready: Prepared, progress: Progress) -> dict[str, Any]:
    """Sail the episodes of one controller with one noise into the set; the row of the card."""
    told: list[dict[str, Any]] = []
    steps: list[int] = []
    for seeds in batches(entry.seeds, ready.scenario.steps):
        bar = lambda intervals: progress(intervals, entry.label)  # noqa: E731
        noise = (entry.noise, ready.memory)
        episodes = sail(entry.controller, seeds, ready.env, *noise, ready.plan.infos, bar)
        some = cards.episodes_of_entry(entry, episodes, ready)
        new.add(episodes, some)
        told += some
        steps += map(len, episodes)
    return cards.row_of(entry, told, steps)


def env_spec(ready: Prepared) -> Any:
    """Spec of the environment of a set: the task's id, and arguments that JSON can keep.

    A scenario of the package stays a name; one of a file or a mapping, or that names files itself,
    is there in full, its files as absolute paths.
    """
    spec = copy.deepcopy(gym.spec(ready.task.env_id))
    scenario, values = ready.env.get("scenario", ready.task.name), ready.scenario.to_dict()
    whole = _with_whole_paths(values)
    if isinstance(scenario, str) and not scenario.endswith(".toml") and whole == values:
        kwargs = {k: v for k, v in ready.env.items() if v not in (None, {}) and k != "scenario"}
        spec.kwargs = {"scenario": scenario, **json.loads(json.dumps(kwargs))}
    else:
        spec.kwargs = {"scenario": whole}
    spec.kwargs["info"] = "flat"
    spec.max_episode_steps = ready.scenario.steps  # the episode's own; readers of sets ask for it
    return spec


def _with_whole_paths(value: Any) -> Any:
    """Nested values whose texts that name files, by their extension, are absolute paths."""
    if isinstance(value, Mapping):
        return {key: _with_whole_paths(one) for key, one in value.items()}
    if isinstance(value, str) and Path(value).suffix and os.path.isfile(value):
        return os.path.abspath(value)
    return value


def _metadata(
    card: Mapping[str, Any], ready: Prepared, author: str, email: str | None
) -> dict[str, Any]:
    """What Minari wants to know of a set."""
    scores, seeds = card["reference_scores"], card["seeds"]
    names = ", ".join(card["controllers"])
    noise = ", ".join(f"{std:g}" for std in ready.plan.noise)
    found = {
        "dataset_id": card["dataset_id"],
        "algorithm_name": names if not any(ready.plan.noise) else f"{names}; action noise {noise}",
        "author": {author},
        "description": f"{names} sail {card['ship']} in {card['environment']['id']}, scenario "
        f"{ready.scenario.source}, action noise {noise}; {card['episodes']} episodes, seeds "
        f"{seeds['first']} to {seeds['last']} ({seeds['split']}).",
        "requirements": _requirements(),
        "num_episodes_average_score": scores["episodes"],
        "license": card["license"],
        "ship_gym": dict(card),
    }
    if scores["expert"] > scores["random"]:  # else a normalised score would mean nothing
        found |= {"ref_min_score": scores["random"], "ref_max_score": scores["expert"]}
    return found | ({"author_email": {email}} if email else {})


def _requirements() -> list[str]:
    try:
        return [f"ship-gym=={metadata.version('ship-gym')}"]
    except metadata.PackageNotFoundError:
        return []
