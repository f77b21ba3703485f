"""Manoeuvres that no fit has seen: the trials of the ship file, sailed before and after."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.reports.case import sail_trial, trials
from ship_gym.reports.trials import Comparison, comparisons, summary
from ship_gym.ships.particulars import Ship
from ship_gym.text import percent, table


@dataclasses.dataclass(frozen=True)
class Unseen:
    """Measures of trials, each with what was computed before."""

    found: tuple[Comparison, ...]

    def table(self, markdown: bool = False) -> str:
        """Measured, before and fitted values with their differences from the measured ones."""
        return _table(self.found, markdown)

    def as_dict(self) -> dict[str, Any]:
        """The table as plain data, and its means."""
        rows = [
            {
                "trial": each.trial,
                "measure": each.row.name,
                "unit": each.row.unit,
                "measured": each.row.measured,
                "before": each.before and each.before.computed,
                "fitted": each.row.computed,
            }
            for each in self.found
        ]
        return {"trials": rows, "summary": summary(self.found)}

    def sentence(self) -> str:
        """How near the trials are, before and after."""
        counts = summary(self.found)
        return (
            f"Mean difference from the {counts['values']} measured values: before "
            f"{counts['mean_before_percent']:.1f} %, fitted {counts['mean_now_percent']:.1f} %; "
            f"{counts['closer']} are nearer, {counts['further']} further off."
        )


def sail_trials(ship: Ship, fitted: Ship, each: Callable[[Iterable], Iterable] = iter) -> Unseen:
    """Every measure of every trial: measured, of the ship before (``row.before``), and after.

    Raises
    ------
    ConfigError
        The ship file has no trials, or the fitted ship does not do one of the manoeuvres.
    """
    found: list[Comparison] = []
    if not trials(ship):
        raise ConfigError(f"{ship.name}: its file has no trials to sail")
    for trial in each(trials(ship)):
        old = {c.key: c.row.computed for c in comparisons(sail_trial(ship, trial))}
        new = sail_trial(fitted, trial)
        found += comparisons(new, {(fitted.name, *key[1:]): value for key, value in old.items()})
    return Unseen(tuple(found))


def _table(found: Sequence[Comparison], markdown: bool) -> str:
    rows, last = [], ""
    for each in found:
        row, before = each.row, each.before
        assert before is not None
        name, last = "" if each.trial == last else each.trial, each.trial
        values = [row.shown(row.measured), row.shown(before.computed), row.shown(row.computed)]
        gaps = [percent(before.difference), percent(row.difference)]
        rows.append([name, row.label.strip(), row.unit, *values, *gaps])
    header = ["trial (not fitted to)", "measure", "unit", "measured", "before", "fitted"]
    return table([*header, "before", "fitted"], rows, left=3, markdown=markdown)
