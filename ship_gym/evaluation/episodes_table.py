"""The table of a benchmark: one row an episode, a parquet file that says how it was made.

Rows are sorted by suite, scenario, ship, controller and seed. All columns but `RUN_TIMES` are the
same in every run, for any number of jobs and either engine.
"""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ship_gym.config import ConfigError, check_known, shown
from ship_gym.evaluation.about import check_about
from ship_gym.evaluation.metrics import all_metrics
from ship_gym.keys import Keys
from ship_gym.reading import MOST, parsed_json, read_as, read_bytes
from ship_gym.writing import atomic_path

if TYPE_CHECKING:
    import pyarrow

SORTED_BY = ("suite", "scenario", "ship", "controller", "seed")
RUN_TIMES = ("decision_ms",)
_ABOUT = b"ship_gym"  # key of the schema's metadata
_TEXT, _WHOLE, _TRUTH, _NUMBER = "string", "int64", "bool", "float64"
_TYPES = {_TEXT: str, _WHOLE: int, _TRUTH: bool, _NUMBER: int | float}
_MOST = {_WHOLE: 2**63, _NUMBER: 10**308}

# Columns before and after those of the metrics, with their types. Encounter angles: 0 from astern,
# 180 from ahead, of the first ordered heading or leg, positive from starboard; null where there is
# no sea, wind or current.
BEFORE: dict[str, str] = {
    "suite": _TEXT,
    "version": _TEXT,
    "scenario": _TEXT,
    "tier": _TEXT,
    "task": _TEXT,
    "ship": _TEXT,
    "controller": _TEXT,
    "kind": _TEXT,
    "seed": _WHOLE,
    "measure": _TEXT,
    "value": _NUMBER,
    "wave_height": _NUMBER,
    "wave_period": _NUMBER,
    "wave_encounter_deg": _NUMBER,
    "wind_speed": _NUMBER,
    "wind_encounter_deg": _NUMBER,
    "current_speed": _NUMBER,
    "current_encounter_deg": _NUMBER,
}
AFTER: dict[str, str] = {
    "outcome": _TEXT,
    "failed": _TRUTH,
    "length": _WHOLE,
    "error": _TEXT,
    "decision_ms": _NUMBER,
}


@dataclasses.dataclass(frozen=True, eq=False)
class Results:
    """Episodes of a benchmark.

    Attributes
    ----------
    table : pyarrow.Table
        One row an episode, columns `BEFORE`, metrics, `AFTER`.
    about : dict
        Suites with their SHA, seeds, ships, controllers, versions, machine and so on.
    """

    table: pyarrow.Table
    about: dict[str, Any]

    def rows(self) -> list[dict[str, Any]]:
        """The episodes as plain values."""
        return self.table.to_pylist()


def arrow() -> Any:
    """The modules pyarrow and pyarrow.parquet; says how to install them where they are absent."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise ImportError(
            'tables of benchmarks need pyarrow: pip install "ship-gym[benchmark]"'
        ) from None
    return pyarrow, pyarrow.parquet


def columns() -> dict[str, str]:
    """Names and types of the columns."""
    return BEFORE | dict.fromkeys(all_metrics(), _NUMBER) | AFTER


def schema() -> pyarrow.Schema:
    """Names and types of the columns, as pyarrow has them."""
    pa, _ = arrow()
    return pa.schema([(name, pa.type_for_alias(kind)) for name, kind in columns().items()])


def check_row(row: Any, where: str) -> dict[str, Any]:
    """A row of plain values, refused if one is not what its column holds.

    Parameters
    ----------
    where : str
        The file, for the message.
    """
    values, kinds = Keys(row, where, "rows"), columns()
    for name, value in values.values.items():
        kind = kinds[check_known(f"column of {where}:", name, kinds)]
        right = value is None or isinstance(value, _TYPES[kind])
        if not right or (isinstance(value, bool) != (kind == _TRUTH) and value is not None):
            raise ConfigError(f"{values.label(name)} = {shown(value)}: must be of type {kind}")
        if kind in (_WHOLE, _NUMBER) and value is not None and abs(value) >= _MOST[kind]:
            raise ConfigError(f"{values.label(name)} = {shown(value)}: too large for {kind}")
    return dict(values.values)


def table_of(rows: Iterable[Mapping[str, Any]]) -> pyarrow.Table:
    """Rows as a sorted table; what a row lacks is null, and so is what is not finite."""
    pa, _ = arrow()
    fields = schema()
    plain = [{name: finite(row.get(name)) for name in fields.names} for row in rows]
    unknown = {key for row in rows for key in row} - set(fields.names)
    if unknown:
        raise ConfigError(f"an episode has no column {sorted(unknown)[0]!r}")
    made = pa.Table.from_pylist(plain, schema=fields)
    return made.sort_by([(name, "ascending") for name in SORTED_BY])


def finite(value: Any) -> Any:
    """The value, None for a number that is not finite."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_results(path: str | Path, results: Results) -> None:
    """Write results as one file, whole or not at all."""
    _, parquet = arrow()
    about = json.dumps(results.about, allow_nan=False).encode()
    table = results.table.replace_schema_metadata({_ABOUT: about})
    with atomic_path(path) as temporary:
        parquet.write_table(table, temporary, compression="zstd")


def read_results(path: str | Path) -> Results:
    """Read the results of a benchmark.

    Parameters
    ----------
    path : path-like
        A file of `write_results`, or the folder of a run that has one.

    Raises
    ------
    ConfigError
        No such file, not a parquet file, damaged, or not of a benchmark.
    """
    path = Path(path)
    path = path / "episodes.parquet" if os.path.isdir(path) else path
    if not os.path.isfile(path):
        raise ConfigError(f"{path}: no such file; results are made by: ship-gym benchmark")
    table, about = read_parquet(path, _ABOUT, "a benchmark")
    _check(path, table)
    return Results(table.replace_schema_metadata(None), check_about(about, str(path)))


def read_parquet(path: str | Path, key: bytes, what: str) -> tuple[pyarrow.Table, dict[str, Any]]:
    """The table of a parquet file, its numbers finite or null, and the mapping beside it.

    Parameters
    ----------
    path : path-like
    key : bytes
        Of the mapping, as JSON, in the schema's metadata.
    what : str
        Whose table it should be, for the message.

    Raises
    ------
    ConfigError
        Not a parquet file, damaged, or of something else.
    """
    pa, parquet = arrow()
    data = read_bytes(path)
    with read_as(path, "a parquet file"):
        file = parquet.ParquetFile(pa.BufferReader(data))
        rows, size = file.metadata.num_rows, sum(
            file.metadata.row_group(k).total_byte_size for k in range(file.metadata.num_row_groups)
        )  # fmt: skip
        if max(size, 8 * rows * file.metadata.num_columns) > MOST:
            raise ValueError(f"{rows} rows of {size} bytes: allowed are {MOST} bytes in all")
        table = file.read()
        table.validate(full=True)
    text = (table.schema.metadata or {}).get(key)
    if text is None:
        raise ConfigError(f"{path}: a parquet file, but not of {what}: it does not say so")
    about = parsed_json(text, path)
    if not isinstance(about, dict):
        raise ConfigError(f"{path}: says of itself {shown(about)}: allowed is a mapping")
    for name in table.column_names:
        values = table.column(name)
        if pa.types.is_floating(values.type) and not _all_finite(values):
            raise ConfigError(f"{path}: column {shown(name)} holds a number that is not finite")
    return table, about


def _all_finite(values: pyarrow.ChunkedArray) -> bool:
    return all(math.isfinite(value) for value in values.to_pylist() if value is not None)


def _check(path: Path, table: pyarrow.Table) -> None:
    for name, kind in (BEFORE | AFTER).items():
        if name not in table.column_names:
            raise ConfigError(f"{path}: not of this version's benchmark: no column {name!r}")
        found = str(table.schema.field(name).type)
        if found.replace("double", _NUMBER) != kind:
            raise ConfigError(f"{path}: column {name!r} is of type {found}, must be {kind}")
        if name in SORTED_BY and table.column(name).null_count:
            raise ConfigError(f"{path}: column {name!r} has a row without a value")
