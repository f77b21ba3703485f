"""What ``ship-gym record`` prints: metrics side by side of few recordings, a row each of many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

_FEW = 4  # recordings whose metrics stand side by side


def tables(found: Sequence[Any], why: Sequence[Mapping[str, str]]) -> str:
    """Recordings as text.

    Parameters
    ----------
    found : sequence of ship_gym.evaluation.recordings.Recording
    why : sequence of mapping
        Of those that were chosen ``which`` they are and ``by`` what, else nothing.
    """
    return _side_by_side(found, why) if len(found) <= _FEW else _rows(found, why)


def _side_by_side(found: Sequence[Any], why: Sequence[Mapping[str, str]]) -> str:
    from ship_gym.evaluation import all_metrics
    from ship_gym.text import table

    rows = [
        ["seed", "", *(str(one.seed) for one in found)],
        ["outcome", "", *(one.outcome for one in found)],
    ]
    if why[0]:
        rows.append([f"by {why[0]['by']}", "", *(one["which"] for one in why)])
    known = all_metrics()
    for name in found[0].metrics:
        rows.append([name, known[name].unit, *(_number(one.metrics[name]) for one in found)])
    return table(["metric", "unit", *(one.controller for one in found)], rows, None)


def _rows(found: Sequence[Any], why: Sequence[Mapping[str, str]]) -> str:
    from ship_gym.evaluation import all_metrics
    from ship_gym.text import table

    by = why[0].get("by") or next(iter(found[0].metrics), None)
    header, columns = ["controller", "seed", "outcome"], []
    if by is not None:
        unit = all_metrics()[by].unit
        header.append(by if unit == "-" else f"{by} [{unit}]")
        columns = [_number(one.metrics[by]) for one in found]
    rows = [[one.controller, str(one.seed), one.outcome] for one in found]
    rows = [[*row, *columns[i : i + 1]] for i, row in enumerate(rows)]
    if why[0]:
        header.append("which")
        rows = [[*row, more["which"]] for row, more in zip(rows, why, strict=True)]
    return table(header, rows, None)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"
