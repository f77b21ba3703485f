"""Final evaluation of a run: its policy against the classical controllers of the task.

On validation seas of their own, which had no part in the choice of the policy, episode by episode.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.rollout import begin
from ship_gym.evaluation.splits import JUDGING_SEED
from ship_gym.evaluation.statistics import paired
from ship_gym.scenarios.scenario import Scenario
from ship_gym.tasks import TASKS
from ship_gym.text import signed_interval
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.training.score import Score, Validation, validate

# beside the usual one of a task, where they can steer
_MORE = {"pid": ("adaptive",), "drift_los": ("just_in_time",)}
_TRAVEL = "rudder_travel"
BETTER, WORSE, OPEN = "better than", "worse than", "no difference shown from"
NO_VALUES = "not comparable with"  # too few episodes have a value of the score


def references(scenario: Scenario, base: str = "") -> list[str]:
    """Names of the classical controllers that a policy is compared with.

    The usual one of the task, the others that can steer the scenario, and the one that the policy
    is built on.
    """
    usual = [name for name in TASKS[scenario.task].controllers if name != "constant"][:1]
    more = [name for one in usual for name in _MORE.get(one, ())]
    names = dict.fromkeys((*usual, *more, *([base] if base else [])))
    return [name for name in names if _can_steer(name, scenario)]


def _can_steer(name: str, scenario: Scenario) -> bool:
    start = begin([JUDGING_SEED], scenario, parallel=False)
    try:
        make_controller(name).reset(1, start.ship, start.scenario)
    except ConfigError:
        return False
    return True


def judge(
    policy: Controller,
    scenario: Scenario,
    score: Score,
    episodes: int,
    base: str = "",
    chosen_on: Sequence[int] = (),
    ships: Sequence[str] = (),
) -> dict[str, Any]:
    """Sail the policy and its references on the same seas.

    Parameters
    ----------
    policy : Controller
    scenario : Scenario
    score : Score
    episodes : int
    base : str
        Name of the controller that the policy is built on, if any.
    chosen_on : sequence of int
        Seeds of the validations, on which the references are sailed too, for the learning curve.
    ships : sequence of str
        Of the training, where it had several; they take turns.

    Returns
    -------
    dict
        For the card: ``seeds`` (first, last), ``policy`` (means), ``references`` (name to means
        and ``difference``: policy less reference with its 95 % interval, p and ``verdict``;
        ``travel_difference`` of the rudder's travel; ``validation``: means on `chosen_on`) and the
        ``text`` that says it all.
    """
    seeds = list(range(JUDGING_SEED, JUDGING_SEED + episodes))
    own = validate(policy, scenario, seeds, score, ships)
    found: dict[str, Any] = {}
    for name in references(scenario, base):
        other = validate(make_controller(name), scenario, seeds, score, ships)
        found[name] = {
            **other.means,
            "difference": compared(own, other, score),
            "travel_difference": difference(own.each[_TRAVEL], other.each[_TRAVEL]),
        }
        if chosen_on:
            controller = make_controller(name)
            chosen = validate(controller, scenario, chosen_on, score, ships)
            found[name]["validation"] = chosen.means
    made = {"seeds": [seeds[0], seeds[-1]], "policy": own.means, "references": found}
    return {**made, "text": final_text(made, score)}


def compared(own: Validation, other: Validation, score: Score) -> dict[str, Any]:
    """Difference of the score, own less other, over the episodes in which both have a value."""
    found = difference(own.each[score.name], other.each[score.name])
    if not found:
        return {"verdict": NO_VALUES}
    if found["low"] <= 0.0 <= found["high"]:
        return {**found, "verdict": OPEN}
    lower = found["high"] < 0.0
    return {**found, "verdict": BETTER if lower == (score.better == "lower") else WORSE}


def difference(own: Sequence[float | None], other: Sequence[float | None]) -> dict[str, float]:
    """Mean of paired differences, own less other, with its interval; empty with fewer than two."""
    pairs = [(a, b) for a, b in zip(own, other, strict=True) if a is not None and b is not None]
    if len(pairs) < 2:
        return {}
    return dataclasses.asdict(paired([a for a, _ in pairs], [b for _, b in pairs]))


def final_text(found: Mapping[str, Any], score: Score) -> str:
    """The result in one line."""
    first, last = found["seeds"]
    own, unit = found["policy"], "" if score.unit == "-" else f" {score.unit}"
    line = (
        f"final, {last - first + 1} seas that chose nothing (seeds {first} to {last}), differences "
        f"with 95 % intervals: {score.name} {_shown(own[score.name])}{unit}, success "
        f"{own['success']:.0%}, rudder travel {own['rudder_travel']:.4g} deg/h"
    )
    return "; ".join(
        [line, *(_against(name, other, score) for name, other in found["references"].items())]
    )


def _against(name: str, other: Mapping[str, Any], score: Score) -> str:
    found, failed = other["difference"], ""
    if other["success"] < 1.0:
        failed = f", success {other['success']:.0%}"
    travel = f"rudder travel {_interval(other['travel_difference'])} deg/h"
    if "value" not in found:
        return f"{found['verdict']} {name}{failed}, {travel}"
    return (
        f"{found['verdict']} {name} ({_shown(other[score.name])}{failed}): {_interval(found)}, "
        f"{travel}"
    )


def _interval(found: Mapping[str, float]) -> str:
    return signed_interval(found["value"], found["low"], found["high"])


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
