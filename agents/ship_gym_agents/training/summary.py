"""What a training run prints before and after."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.evaluation import metrics_of
from ship_gym.tasks import TASKS
from ship_gym_agents.sb3.config import RunConfig


def plan(
    config: RunConfig, out: str | Path, minutes: float | None = None, steps: int | None = None
) -> str:
    """One line: what is trained, for how long, into which folder."""
    limits = [f"{minutes:g} min" if minutes else "", f"{steps} samples" if steps else ""]
    scenario, training = config.scenario, config.hyperparameters.training
    return (
        f"{config.algorithm}: {scenario.task} with {scenario.ship}, control {scenario.control}, "
        f"seed {config.seed}, {training.envs} environments, at most "
        f"{' or '.join(filter(None, limits))} -> {out}"
    )


def summary(card: Mapping[str, Any], out: str | Path) -> str:
    """How training went and where the policy is."""
    best, seconds = card["best"], card["seconds"]
    rate = card["samples"] / seconds
    task = card["config"]["scenario"]["task"]
    name = TASKS[task].headline
    unit = metrics_of(task)[name].unit
    history = "  ".join(_shown(found, name) for found in card["validations"])
    return (
        f"{card['samples']} samples in {seconds:.0f} s, {rate:.0f} per second\n"
        f"validation {name} [{unit}]: {history}\n"
        f"best: {name} {_shown(best, name)} {unit}, return {best['return']:.2f}, success "
        f"{best['success']:.0%}, after {best['samples']} samples\n"
        f"wrote {Path(out) / 'policy.zip'}, card.json and checkpoint"
    )


def _shown(found: Mapping[str, float | None], name: str) -> str:
    """A mean of the validation; short episodes, or runs begun under another headline, have none."""
    value = found.get(name)
    return "-" if value is None else f"{value:.4g}"
