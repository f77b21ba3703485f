"""The table of manoeuvres: one row a measure, a parquet file that says how it was made."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.episodes_table import arrow, read_parquet
from ship_gym.evaluation.manoeuvres.definition import CALM
from ship_gym.evaluation.manoeuvres.sailing import Sailed
from ship_gym.reports.case import Case
from ship_gym.reports.handling import KINDS, Handling, as_dict
from ship_gym.reports.measures import rows
from ship_gym.writing import atomic_path

_ABOUT = b"ship_gym_manoeuvres"  # key of the schema's metadata
_TEXT, _TRUTH, _NUMBER = "string", "bool", "float64"
# A manoeuvre that could not be sailed has one row without a measure that says why. Limits are those
# of IMO MSC.137(76), which are of calm water; `trial` is the mean of the facilities that measured,
# `trial_scatter` their standard deviation. A trial that is no manoeuvre of the suite has no side.
COLUMNS: dict[str, str] = {
    "ship": _TEXT,
    "manoeuvre": _TEXT,
    "side": _TEXT,
    "sea": _TEXT,
    "measure": _TEXT,
    "label": _TEXT,
    "unit": _TEXT,
    "value": _NUMBER,
    "calm": _NUMBER,
    "limit": _NUMBER,
    "passes": _TRUTH,
    "trial": _NUMBER,
    "trial_scatter": _NUMBER,
    "source": _TEXT,
    "error": _TEXT,
}


def rows_of(sailed: Sequence[Sailed]) -> list[dict[str, Any]]:
    """Rows of manoeuvres, with the keys of `COLUMNS`, in the order in which they were sailed."""
    found = []
    for each in sailed:
        first = {
            "ship": each.ship.name,
            "manoeuvre": each.name,
            "side": each.side,
            "sea": each.sea,
        }
        found += [
            dict.fromkeys(COLUMNS) | {"source": "", "error": ""} | first | row
            for row in _measures(each)
        ]
    return found


def _measures(each: Sailed) -> list[dict[str, Any]]:
    if each.case is None:
        return [{"measure": "", "label": "", "unit": "", "error": each.error}]
    made = _of_case(each.case) if isinstance(each.case, Case) else _of_handling(each.case)
    if each.sea != CALM or each.trial is not None:
        made = [row | {"limit": None, "passes": None} for row in made]
    return [{k: _finite(v) for k, v in row.items()} for row in made]


def _of_case(case: Case) -> list[dict[str, Any]]:
    trial = case.trial
    source = f"{trial.facility}: {trial.source}" if trial else ""
    return [
        {
            "measure": row.name,
            "label": row.label.strip(),
            "unit": row.unit,
            "value": row.computed,
            "calm": row.calm,
            "limit": row.limit,
            "passes": None if row.limit is None else row.passes,
            "trial": row.measured,
            "trial_scatter": row.deviation,
            "source": source if row.measured is not None else "",
        }
        for row in rows(case)
    ]


def _of_handling(case: Handling) -> list[dict[str, Any]]:
    plain = as_dict(case)
    labels = KINDS[case.manoeuvre].quantities
    limits = {name: each["limit"] for name, each in plain.get("imo", {}).items()}
    return [
        {
            "measure": name,
            "label": labels[name][0],
            "unit": plain["units"][name],
            "value": value,
            "limit": limits.get(name),
            "passes": plain["imo"][name]["pass"] if name in limits else None,
        }
        for name, value in plain["measures"].items()
    ]


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_manoeuvres(
    path: str | Path, found: Sequence[Mapping[str, Any]], about: Mapping[str, Any]
) -> None:
    """Write rows as a parquet file, whole or not at all.

    Parameters
    ----------
    path : path-like
    found : sequence of mapping
        Of `rows_of`.
    about : mapping
        Suite, versions, machine and so on, plain values.
    """
    pa, parquet = arrow()
    fields = pa.schema([(name, pa.type_for_alias(kind)) for name, kind in COLUMNS.items()])
    table = pa.Table.from_pylist([dict(row) for row in found], schema=fields)
    text = json.dumps(dict(about), allow_nan=False).encode()
    with atomic_path(path) as temporary:
        parquet.write_table(table.replace_schema_metadata({_ABOUT: text}), temporary)


def read_manoeuvres(path: str | Path) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Rows of a file of `write_manoeuvres`, and what it says of how it was made.

    Raises
    ------
    ConfigError
        No such file, not a parquet file, or not of manoeuvres.
    """
    if not Path(path).is_file():
        raise ConfigError(
            f"{path}: no such file; it is made by: ship-gym benchmark --suite manoeuvres"
        )
    table, about = read_parquet(path, _ABOUT, "manoeuvres")
    if table.column_names != list(COLUMNS):
        raise ConfigError(f"{path}: a parquet file, but not of this version's manoeuvres")
    for name, kind in COLUMNS.items():
        found = str(table.schema.field(name).type).replace("double", _NUMBER)
        if found != kind:
            raise ConfigError(f"{path}: column {name!r} is of type {found}, must be {kind}")
    return table.to_pylist(), about
