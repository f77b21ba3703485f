"""What a training run prints before and after."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym_agents.policies.policy_file import POLICY_FILE
from ship_gym_agents.sb3.config import RunConfig
from ship_gym_agents.training.score import score_of


def plan(
    config: RunConfig,
    out: str | Path,
    minutes: float | None = None,
    steps: int | None = None,
    seeds: int = 1,
) -> str:
    """One line: what is trained, for how long, into which folder."""
    limits = [f"{minutes:g} min" if minutes else "", f"{steps} samples" if steps else ""]
    scenario, training = config.scenario, config.hyperparameters.training
    seed = f"seed {config.seed}"
    if seeds > 1:
        seed = f"seeds {config.seed} to {config.seed + seeds - 1}"
    return (
        f"{config.algorithm}: {scenario.task} with {scenario.ship}, control {scenario.control}, "
        f"{seed}, {training.envs} environments, at most {' or '.join(filter(None, limits))} of "
        f"training{' each' if seeds > 1 else ''} -> {out}"
    )


def summary(config: RunConfig, card: Mapping[str, Any], out: str | Path) -> str:
    """How training went and where the policy is."""
    if "runs" in card:
        return _of_seeds(config, card, out)
    score, best = score_of(config.scenario), card["best"]
    first, last = card["validation_seeds"]
    history = "  ".join(shown(found[score.name]) for found in card["validations"])
    lines = [
        _how_long(card),
        f"validation on {last - first + 1} seas, {score.name} [{score.unit}]: {history}",
        f"best ({card['score']}): {score.name} {shown(best[score.name])} {score.unit}, return "
        f"{best['return']:.2f}, success {best['success']:.0%}, after {best['samples']} samples",
    ]
    if "final" in card:
        lines.append(card["final"]["text"])
    return "\n".join([*lines, _wrote(out)])


def _how_long(card: Mapping[str, Any]) -> str:
    """Samples and seconds; a plain word where nothing was learned."""
    samples, seconds = card["samples"], card["seconds"]
    line = f"{samples} samples in {seconds:.0f} s of training"
    if card["validations"][-1].get("iteration") == 0.0:
        return f"{line}: ended before the first iteration was complete, so nothing was learned"
    return line if seconds < 1.0 else f"{line}, {samples / seconds:.0f} per second"


def _of_seeds(config: RunConfig, card: Mapping[str, Any], out: str | Path) -> str:
    """A line for each seed, and which one is kept."""
    score = score_of(config.scenario)
    lines = []
    for run in card["runs"]:
        against = "".join(f", {verdict} {name}" for name, verdict in run["against"].items())
        lines.append(
            f"seed {run['seed']}: {score.name} {shown(run[score.name])} {score.unit}, success "
            f"{run['success']:.0%}, rudder travel {run['rudder_travel']:.4g} deg/h{against}"
        )
    median = card["median"]
    low, high = card["spread"] or (None, None)
    lines.append(
        f"kept: the median, seed {median['seed']} ({card['score']}); {score.name} of the seeds "
        f"from {shown(low)} to {shown(high)} {score.unit}"
    )
    return "\n".join([*lines, f"wrote {Path(out) / POLICY_FILE}, summary.json, curve.png"])


def _wrote(out: str | Path) -> str:
    return f"wrote {Path(out) / POLICY_FILE}, card.json, curve.csv, curve.png and checkpoint"


def shown(value: float | None) -> str:
    """A value of a validation; short episodes have none."""
    return "-" if value is None else f"{value:.4g}"
