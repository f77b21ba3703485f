"""Judgements on events: scores, paired differences from the best classical controller, profiles."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ship_gym.evaluation.report.events import NOTHING, Event
from ship_gym.evaluation.score import Reference, References, mean_score
from ship_gym.evaluation.statistics import Estimate, Paired, holm, paired
from ship_gym.tasks import TASKS

SIGNIFICANT = 0.05  # of a p-value after Holm's correction


@dataclasses.dataclass(frozen=True)
class Scale:
    """What the scores of an event are counted between.

    Attributes
    ----------
    cell : Reference or None
        Values of the measure at score 0 and 100; None without a scale.
    source : str
        ``"ShipBench-1"`` or ``"these episodes"``.
    why : str
        Why there is no score; empty if there is one.
    """

    cell: Reference | None
    source: str
    why: str = ""

    @property
    def optimum(self) -> float | None:
        """Score of the reference optimum."""
        return None if self.cell is None or self.why else self.cell.optimum_score

    def score(self, value: float | None) -> float | None:
        """Score of a value of the measure."""
        if self.cell is None or self.why or value is None or value <= 0.0:
            return None
        return self.cell.score(value)

    def estimate(self, values: np.ndarray) -> Estimate | None:
        """Score of the values of an event with its interval; the scale is taken as given."""
        if self.cell is None or self.why or not (values > 0.0).all():
            return None
        return mean_score([(values, self.cell)])


def scale(event: Event, references: References | None) -> Scale:
    """The scale of an event: of the frozen references, else of the episodes themselves."""
    if event.metric.better != "lower":
        return Scale(None, "", f"more {event.measure} is better: the score is made for errors")
    cell = references.of(event.scenario, event.ship) if references else None
    source = references.version if references else ""
    if cell is None or cell.measure != event.measure:
        made, source = _of_these(event), "these episodes"
        if isinstance(made, str):
            return Scale(None, "", made)
        cell = made
    if cell.scored:
        return Scale(cell, source)
    why = (
        f"doing nothing ({cell.nothing:.3g}) is hardly worse than the reference "
        f"{cell.reference_controller} ({cell.reference:.3g}): less than 5 %"
    )
    return Scale(cell, source, why)


def _of_these(event: Event) -> Reference | str:
    """A scale from the episodes of an event, or why there is none."""
    by = TASKS[event.task].controllers[0] if event.task in TASKS else "pid"
    missing = [name for name in (NOTHING, by) if name not in event.runs]
    if missing:
        lacks = " and no ".join(missing)
        return f"no reference value is stored, and the results have no {lacks}"
    nothing, best = (event.runs[name].middle("value") for name in (NOTHING, by))
    if nothing is None or best is None or min(nothing, best) <= 0.0:
        return "no reference value is stored, and the measure of these episodes gives none"
    return Reference(event.scenario, event.ship, event.measure, nothing, best, by)


@dataclasses.dataclass(frozen=True, eq=False)
class Difference:
    """Paired difference of the measure, controller minus the event's best classical one.

    Attributes
    ----------
    event : Event
    controller, against : str
    n : int
        Seeds that both finished.
    found : Paired
        Mean of the differences, in the unit of the measure.
    share : float
        It by the mean of the opponent on the same seeds.
    p : float
        After Holm's correction for all differences of the report.
    """

    event: Event
    controller: str
    against: str
    n: int
    found: Paired
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
    pairs = [
        (event, name, against, seeds)
        for event in found
        if (against := event.best_classical)
        for name in event.runs
        if name not in (against, NOTHING) and len(seeds := event.finished([name, against])) > 1
    ]
    values = [
        (event.runs[name].at(seeds), event.runs[against].at(seeds))
        for event, name, against, seeds in pairs
    ]
    judged = [paired(own, best) for own, best in values]
    family = [
        min(each.p, tail(own - best)) for each, (own, best) in zip(judged, values, strict=True)
    ]
    return [
        Difference(event, name, against, len(seeds), each, each.value / best.mean(), float(p))
        for (event, name, against, seeds), each, (_, best), p in zip(
            pairs, judged, values, holm(family), strict=True
        )
    ]


def tail(differences: np.ndarray) -> float:
    """Upper bound of the p-value of the sign-flip test, 2 exp(-(sum d)^2 / (2 sum d^2)).

    Hoeffding's inequality for a sum with random signs (1963, Theorem 2). A test with random flips
    cannot give a p-value below about one by their number, which Holm's factor for hundreds of
    comparisons would lift above any level, however large the difference.
    """
    square = float(differences @ differences)
    return min(1.0, 2.0 * float(np.exp(-0.5 * differences.sum() ** 2 / square))) if square else 1.0
