"""Everything the sections of a report are made from, judged once."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from ship_gym.evaluation.report.events import NOTHING, Event, events
from ship_gym.evaluation.report.judgements import Difference, Scale, differences, scale
from ship_gym.evaluation.score import FILE, References, mean_score, read_references
from ship_gym.evaluation.statistics import Estimate
from ship_gym.plotting.benchmark import Style, styles


class Results(Protocol):
    """A table of episodes and what it says about itself, ``episodes_table.Results``."""

    @property
    def table(self) -> Any:
        """A row for each episode."""

    @property
    def about(self) -> Mapping[str, Any]:
        """How it was sailed."""


@dataclasses.dataclass(frozen=True, eq=False)
class Benchmark:
    """Judged results.

    Attributes
    ----------
    events : list of Event
    scales : dict
        Event to `Scale`.
    differences : list of Difference
    about : mapping
        Of the results.
    look : dict
        Controller to its `Style` in pictures.
    """

    events: list[Event]
    scales: dict[Event, Scale]
    differences: list[Difference]
    about: Mapping[str, Any]
    look: dict[str, Style]

    @functools.cached_property
    def controllers(self) -> dict[str, str]:
        """Controller to its kind: classical ones, policies, others; by name, nothing first."""
        kinds = {name: run.kind for event in self.events for name, run in event.runs.items()}
        return dict(sorted(kinds.items(), key=lambda item: (item[0] != NOTHING, item[1], item[0])))

    @property
    def suites(self) -> list[str]:
        """Names, in the order of the table."""
        return list(dict.fromkeys(event.suite for event in self.events))

    def difference(self, event: Event, controller: str) -> Difference | None:
        """The difference of a controller in an event, if it was judged."""
        return self._by.get((event, controller))

    @functools.cached_property
    def _by(self) -> dict[tuple[Event, str], Difference]:
        return {(each.event, each.controller): each for each in self.differences}

    def score(self, event: Event, controller: str | None) -> float | None:
        """Score of a controller in an event; None also of no controller."""
        run = None if controller is None else event.runs.get(controller)
        return None if run is None else self.scales[event].score(run.middle("value"))

    def scored(self, controller: str, among: Sequence[Event]) -> list[Event]:
        """The events among some in which a controller has a score."""
        return [event for event in among if self.score(event, controller) is not None]

    def mean_score(self, controller: str, among: Sequence[Event]) -> Estimate | None:
        """Mean score of a controller over those events among some in which it has one."""
        cells = self.scored(controller, among)
        scales = [(e.runs[controller].values, self.scales[e].cell) for e in cells]
        return mean_score([(values, cell) for values, cell in scales if cell is not None])


def judge(results: Results, references: References | None = None) -> Benchmark:
    """Judge results.

    Parameters
    ----------
    results : Results
    references : References, optional
        What scores are measured against; default: those of ShipBench-1. An event without one is
        measured against the results' own episodes.
    """
    known = read_references() if references is None and FILE.exists() else references
    found = events(results.table)
    names = sorted({name for event in found for name in event.runs})
    return Benchmark(
        found,
        {event: scale(event, known) for event in found},
        differences(found),
        results.about,
        styles(names),
    )
