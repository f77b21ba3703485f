"""Reference scores: the mean returns that Minari calls 0 and 1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.splits import seeds_of
from ship_gym_agents.datasets.plan import Prepared, UniformActions
from ship_gym_agents.datasets.sail import Episode, Progress, batches, sail

EPISODES = 100  # of which the means are, as by default in Minari


def returns_of(episodes: list[Episode]) -> np.ndarray:
    """Sum of the rewards of each episode, undiscounted."""
    return np.array([one.rewards.sum() for one in episodes])


def reference_scores(ready: Prepared, progress: Progress) -> dict[str, Any]:
    """Mean returns of random actions and of the expert on seeds kept for validation.

    Returns
    -------
    dict
        ``random`` and ``expert`` (mean return), ``expert_name``, ``episodes``, ``seeds`` (first,
        last).
    """
    seeds = seeds_of("validation", EPISODES)
    random = _mean(UniformActions(), seeds, ready, progress)
    expert = _mean(ready.expert, seeds, ready, progress)
    return {
        "random": random,
        "expert": expert,
        "expert_name": ready.expert.name,
        "episodes": EPISODES,
        "seeds": [seeds[0], seeds[-1]],
    }


def _mean(who: Controller, seeds: list[int], ready: Prepared, progress: Progress) -> float:
    returns = []
    for some in batches(seeds, ready.scenario.steps):
        bar = lambda steps: progress(steps, f"reference score, {who.name}")  # noqa: E731
        returns.append(returns_of(sail(who, some, ready.env, infos=False, progress=bar)))
    return float(np.concatenate(returns).mean())


def normalised(value: float, scores: Mapping[str, Any]) -> float | None:
    """A return as Minari normalises it; None where the expert is no better than chance."""
    span = scores["expert"] - scores["random"]
    return (value - scores["random"]) / span if span > 0.0 else None
