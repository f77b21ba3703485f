"""Judgements on events: scores, paired differences from the best classical controller, profiles."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.evaluation.report.events import NOTHING, Event
from ship_gym.evaluation.report.numbers import holm, normalised, resampled_middles, sign_flip
from ship_gym.evaluation.statistics import Estimate, estimate
from ship_gym.tasks import TASKS

SIGNIFICANT = 0.05  # of a p-value after Holm's correction


@dataclasses.dataclass(frozen=True)
class Scale:
    """What the scores of an event are counted between.

    Attributes
    ----------
    nothing, reference : float or None
        Values of the measure at score 0 and 100; None without a scale.
    by : str
        The reference controller.
    source : str
        ``"ShipBench-1"`` or ``"these episodes"``.
    optimum : float or None
        Score of the reference optimum.
    why : str
        Why there is no score; empty if there is one.
    """

    nothing: float | None
    reference: float | None
    by: str
    source: str
    optimum: float | None
    why: str = ""

    def score(self, value: float | None) -> float | None:
        """Score of a value of the measure."""
        if self.why or value is None:
            return None
        return normalised(value, self.nothing, self.reference)

    def estimate(self, middle: Estimate | None) -> Estimate | None:
        """Score of an estimate of the measure; its ends change places, the scale is fixed."""
        if middle is None or (value := self.score(middle.value)) is None:
            return None
        return Estimate(value, self.score(middle.high), self.score(middle.low))


def scale(event: Event, references: Mapping[str, Mapping[str, Any]]) -> Scale:
    """The scale of an event: of the frozen references, else of the episodes themselves.

    Parameters
    ----------
    event : Event
    references : mapping
        Cells of the reference values by ``scenario/ship``.
    """
    known = references.get(event.cell)
    if event.metric.better != "lower":
        return _without(f"more {event.measure} is better: the score is made for errors")
    if known and known["measure"] == event.measure:
        made = (known["nothing"], known["reference"], known["reference_controller"])
        optimum, source = known.get("optimum"), "ShipBench-1"
    else:
        runs = event.runs
        by = _usual(event.task)
        missing = [name for name in (NOTHING, by) if name not in runs]
        if missing:
            lacks = " and no ".join(missing)
            return _without(f"no reference value is stored, and the results have no {lacks}")
        middles = [runs[name].middle("value") for name in (NOTHING, by)]
        if None in middles:
            return _without("no reference value is stored, and an episode of it broke off")
        made, optimum, source = (*middles, by), None, "these episodes"
    nothing, reference, by = made
    if normalised(reference, nothing, reference) is None:
        return _without(
            f"doing nothing ({nothing:.3g}) is hardly worse than the reference {by} "
            f"({reference:.3g}): less than 5 %"
        )
    best = None if optimum is None else normalised(optimum, nothing, reference)
    return Scale(nothing, reference, by, source, best)


def _usual(task: str) -> str:
    """The reference of a task where no stored value names one: its first default controller."""
    return TASKS[task].controllers[0] if task in TASKS else "pid"


def _without(why: str) -> Scale:
    return Scale(None, None, "", "", None, why)


def mean_score(cells: Sequence[tuple[Event, Scale]], controller: str) -> Estimate | None:
    """Mean score of a controller over events, with a 95 % interval.

    Seeds are drawn anew within each event; the events themselves are given.
    """
    if not cells:
        return None
    value = np.mean([s.score(e.runs[controller].middle("value")) for e, s in cells])
    drawn = np.zeros(1)
    for k, (event, scaled) in enumerate(cells):
        middles = resampled_middles(event.runs[controller].values, k)
        ratio = np.log(scaled.nothing / scaled.reference)
        drawn = drawn + 100.0 * np.log(scaled.nothing / middles) / ratio / len(cells)
    low, high = np.quantile(drawn, (0.025, 0.975))
    return Estimate(float(value), float(low), float(high))


@dataclasses.dataclass(frozen=True, eq=False)
class Difference:
    """Paired difference of the measure, controller minus the event's best classical one.

    Attributes
    ----------
    event : Event
    controller, against : str
    n : int
        Seeds that both finished.
    found : Estimate
        Interquartile mean of the differences, in the unit of the measure.
    share : float
        It by the middle of the opponent.
    p : float
        After Holm's correction for all differences of the report.
    """

    event: Event
    controller: str
    against: str
    n: int
    found: Estimate
    share: float
    p: float

    @property
    def verdict(self) -> str:
        """``"better"``, ``"worse"`` or nothing if the difference may be chance."""
        if self.p >= SIGNIFICANT or self.found.value == 0.0:
            return ""
        lower = self.found.value < 0.0
        return "better" if lower == (self.event.metric.better == "lower") else "worse"


def differences(found: Sequence[Event]) -> list[Difference]:
    """Differences of all controllers in all events; one family of comparisons for Holm.

    The opponent is chosen by the same episodes, which is in its favour. The controller that does
    nothing is left out: nobody asks, and a larger family hides what is asked.
    """
    pairs, minus = [], []
    for event in found:
        for name in event.runs if event.best_classical else ():
            seeds = event.finished([name, event.best_classical])
            if name not in (event.best_classical, NOTHING) and len(seeds) > 1:
                own, best = event.runs[name], event.runs[event.best_classical]
                pairs.append((event, name))
                minus.append(own.at(seeds) - best.at(seeds))
    corrected = holm([sign_flip(each) for each in minus]) if minus else []
    made = []
    for (event, name), each, p in zip(pairs, minus, corrected, strict=True):
        middle = estimate(each)
        of = event.runs[event.best_classical].middle("value")
        share = middle.value / of if of else float("nan")
        made.append(Difference(event, name, event.best_classical, len(each), middle, share, p))
    return made
