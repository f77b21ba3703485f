"""The table of episodes as events: one scenario with one ship, sailed by several controllers."""

from __future__ import annotations

import dataclasses
import functools
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from ship_gym.evaluation.metrics import all_metrics
from ship_gym.evaluation.statistics import Estimate, estimate, interquartile_mean, rate
from ship_gym.tasks.base import Metric

_KEYS = ("suite", "scenario", "ship")
NOTHING = "constant"  # the controller that does nothing
_RATES = ("success",)  # 0 or 1 per episode


@dataclasses.dataclass(frozen=True, eq=False)
class Run:
    """The episodes of one controller in one event, sorted by seed.

    Attributes
    ----------
    controller, kind : str
        Kind: ``classical``, ``policy`` or ``own``.
    columns : dict
        Every column of the table by name, shapes (n,).
    """

    controller: str
    kind: str
    columns: dict[str, np.ndarray]

    @property
    def seeds(self) -> np.ndarray:
        """Of the episodes, shape (n,)."""
        return self.columns["seed"]

    @property
    def values(self) -> np.ndarray:
        """Of the event's measure, shape (n,); NaN for an episode that broke off with an error."""
        return self.columns["value"]

    @property
    def broken(self) -> np.ndarray:
        """Whether the controller broke each episode off with an error, shape (n,)."""
        return self.columns["error"] != ""

    @functools.cached_property
    def estimate(self) -> Estimate | None:
        """Interquartile mean of the measure with its interval; None if episodes are broken."""
        return self.of(None)

    def of(self, name: str | None) -> Estimate | None:
        """Interquartile mean (of `success`, the rate) of a column with its 95 % interval.

        None where the column has no number for an episode: a mean over the others would favour a
        controller that breaks.
        """
        values = self.values if name is None else self.columns.get(name)
        if values is None or not np.isfinite(values).all():
            return None
        return rate(values) if name in _RATES else estimate(values)

    def at(self, seeds: np.ndarray, name: str = "value") -> np.ndarray:
        """A column at some of the seeds, in their order in the table."""
        return self.columns[name][np.isin(self.seeds, seeds)]

    def middle(self, name: str) -> float | None:
        """`of` without the interval, which takes long to compute."""
        values = self.columns.get(name)
        if values is None or not np.isfinite(values).all():
            return None
        return float(values.mean() if name in _RATES else interquartile_mean(values))


@dataclasses.dataclass(frozen=True, eq=False)
class Event:
    """One scenario with one ship.

    Attributes
    ----------
    suite, scenario, ship, tier, task : str
    measure : str
        Name of what is scored.
    runs : dict
        Controller to its `Run`, the best by the measure first, those without a middle last.
    """

    suite: str
    scenario: str
    ship: str
    tier: str
    task: str
    measure: str
    runs: dict[str, Run]

    @property
    def cell(self) -> str:
        """The key of ``shipbench_1.json``."""
        return f"{self.scenario}/{self.ship}"

    @property
    def anchor(self) -> str:
        """Where the page tells about it."""
        return slug(f"{self.suite}-{self.scenario}-{self.ship}")

    @property
    def metric(self) -> Metric:
        """Unit, meaning and sense of the measure; of an unknown one: lower is better."""
        return all_metrics().get(self.measure, Metric("", self.measure, "lower"))

    @functools.cached_property
    def best_classical(self) -> str | None:
        """The classical controller with the best middle of the measure; it never broke.

        The one that does nothing is no opponent. None if there is no other.
        """
        for name, run in self.runs.items():  # the best first
            if run.kind == "classical" and name != NOTHING and run.middle("value") is not None:
                return name
        return None

    def rank(self, item: tuple[str, Run]) -> tuple[bool, float]:
        """Key that sorts (controller, run) from the best to the worst."""
        middle = item[1].middle("value")
        if middle is None:
            return True, 0.0
        return False, middle if self.metric.better == "lower" else -middle

    def finished(self, names: Sequence[str]) -> np.ndarray:
        """Seeds for which all of these controllers have a value of the measure, sorted."""
        every = [run.seeds[np.isfinite(run.values)] for name in names for run in [self.runs[name]]]
        return functools.reduce(np.intersect1d, every)


def slug(text: str) -> str:
    """The text as an anchor or a file name: names of scenarios may be paths."""
    return re.sub(r"[^\w.-]+", "-", text).strip("-")


def events(table: Any) -> list[Event]:
    """Events of a table of results, in its order.

    Parameters
    ----------
    table : pyarrow.Table
        As ``evaluation.episodes_table`` lays it out.
    """
    columns = {name: _array(table.column(name)) for name in table.column_names}
    groups: dict[tuple[str, ...], dict[str, list[int]]] = {}
    for i, key in enumerate(zip(*(columns[name] for name in _KEYS), strict=True)):
        groups.setdefault(key, {}).setdefault(columns["controller"][i], []).append(i)
    return [_event(columns, runs) for runs in groups.values()]


def _array(column: Any) -> np.ndarray:
    """A column as an array; null is NaN, or the empty text."""
    text = str(column.type) in ("string", "large_string") or "dictionary" in str(column.type)
    if text:
        return np.array([value or "" for value in column.to_pylist()], dtype=object)
    return column.to_numpy()


def _event(columns: dict[str, np.ndarray], rows: dict[str, list[int]]) -> Event:
    first = next(iter(rows.values()))[0]
    said = {key: str(columns[key][first]) for key in (*_KEYS, "tier", "task", "measure")}
    runs = {}
    for name, indices in rows.items():
        order = np.array(indices)[np.argsort(columns["seed"][indices], kind="stable")]
        taken = {key: values[order] for key, values in columns.items()}
        runs[name] = Run(name, str(taken["kind"][0]), taken)
    event = Event(**said, runs=runs)
    return dataclasses.replace(event, runs=dict(sorted(runs.items(), key=event.rank)))
