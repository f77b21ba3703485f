"""A recording as a parquet file, for pandas, Polars, DuckDB and the like."""

from __future__ import annotations

import json
import os
from typing import Any

from ship_gym.evaluation.episodes_table import arrow
from ship_gym.recording.trajectory import Trajectory
from ship_gym.writing import atomic_path

META = b"ship_gym"  # key of the schema's metadata


def write_parquet(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Write all columns, float64, and the meta as JSON in the metadata of the schema.

    Parameters
    ----------
    trajectory : Trajectory
    path : path-like
        File to write, whole or not at all.

    Raises
    ------
    ImportError
        If pyarrow is not installed.
    """
    pa, parquet = arrow()
    table = pa.table(dict(trajectory.columns), metadata={META: json.dumps(trajectory.meta)})
    with atomic_path(path) as temporary:
        parquet.write_table(table, temporary, compression="zstd")


def read_meta(path: str | os.PathLike) -> dict[str, Any]:
    """The meta of a recording that `write_parquet` wrote.

    Raises
    ------
    ImportError
        If pyarrow is not installed.
    KeyError, ValueError
        No parquet file, or one without meta.
    """
    _, parquet = arrow()
    return json.loads((parquet.read_schema(path).metadata or {})[META])
