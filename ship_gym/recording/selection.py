"""Runs chosen and ordered by their columns and metrics, as ``review list`` asks for them."""

from __future__ import annotations

import operator
import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from ship_gym.config import ConfigError, check_known, shown
from ship_gym.recording.library import COLUMNS, NUMBERS, Run, metric_names

_OPERATORS = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_FOR_TEXT = ("==", "!=")
_CONDITION = re.compile(r"\s*([^<>=!\s]+)\s*(<=|>=|==|!=|<|>)\s*(.*?)\s*")


class Condition(NamedTuple):
    """A column or metric, an operator of text, and what it is compared with."""

    field: str
    operator: str
    value: str | float

    def holds(self, run: Run) -> bool:
        """Whether a run meets it; one that has no such value does not."""
        found = run.value(self.field)
        return found is not None and bool(_OPERATORS[self.operator](found, self.value))


def condition(text: str, metrics: Sequence[str] | None = None) -> Condition:
    """The condition that a text such as ``J_1>100`` or ``outcome!=end of time`` states.

    Parameters
    ----------
    text : str
        A column of ``library.COLUMNS`` or a metric, one of < <= > >= == !=, and a number or, of a
        column of text, == or != and a text.
    metrics : sequence of str, optional
        Metrics that there are; if omitted, every field that is no column may be one.

    Raises
    ------
    ConfigError
        What is no such condition; says what is allowed.
    """
    found = _CONDITION.fullmatch(text)
    if found is None:
        raise ConfigError(
            f"condition {shown(text)}: must be FIELD OPERATOR VALUE, such as J_1>100 or ship==kcs; "
            f"operators: {' '.join(_OPERATORS)}"
        )
    name, sign, value = found.groups()
    if metrics is not None:
        check_known("field", name, [*COLUMNS, *metrics])
    if name not in COLUMNS or name in NUMBERS:
        return Condition(name, sign, _number(text, value))
    if sign not in _FOR_TEXT:
        raise ConfigError(f"condition {shown(text)}: {name} is text: allowed are == and !=")
    return Condition(name, sign, value.strip("'\""))


def _number(text: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise ConfigError(f"condition {shown(text)}: {shown(value)} is not a number") from None


def chosen(runs: Sequence[Run], conditions: Sequence[str]) -> list[Run]:
    """The runs that meet all conditions; without conditions all of them, bad files included."""
    made = [condition(text, metric_names(runs)) for text in conditions]
    return [run for run in runs if all(one.holds(run) for one in made)]


def ordered(runs: Sequence[Run], by: str, reverse: bool = False) -> list[Run]:
    """The runs by a column or metric, small ones first; those that lack it are last."""
    check_known("field to sort by", by, [*COLUMNS, *metric_names(runs)])
    values: list[Any] = [run.value(by) for run in runs]
    having = [i for i, value in enumerate(values) if value is not None]
    lacking = [run for run, value in zip(runs, values, strict=True) if value is None]
    ranked = sorted(having, key=lambda i: values[i], reverse=reverse)
    return [*(runs[i] for i in ranked), *lacking]
