"""The record in a rerun file: exact columns and meta, written and read back.

Entity ``/record`` holds every column as float64 and ``/record/meta`` the meta as JSON; the rest of
the file is what the viewer shows, drawn from them (``picture``).
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import rerun as rr
from rerun.chunk import Chunk, RrdReader

from ship_gym.provenance import atomic_path
from ship_gym.recording.rerun_export.log import TIMELINE, Output, log, send_rows
from ship_gym.recording.rerun_export.picture import send_picture
from ship_gym.recording.trajectory import Trajectory

_FORMAT = 1  # of /record; a reader refuses what it does not know
# Prefixes keep our names apart from rerun's own, and from each other: within one process rerun
# remembers the type of every component name.
_COLUMN, _HEAD = "ShipGymColumn", "ShipGymHead"


def write_rrd(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Write `trajectory` to a ``.rrd`` file with its blueprint, without a viewer.

    Parameters
    ----------
    trajectory : Trajectory
        What to write; views whose columns are missing are left out.
    path : path-like
        File to write; it is replaced only by a complete file that was read back and compared.

    Raises
    ------
    OSError
        If the file that was written does not hold the trajectory, such as on a full disk.
    """
    with atomic_path(path) as temporary:
        stream = rr.RecordingStream(f"ship_gym_{trajectory.meta.get('task', 'run')}")
        try:
            stream.save(temporary)
            out = Output(stream)
            log_record(out, trajectory)
            send_picture(out, trajectory)
            stream.flush()
        finally:
            stream.disconnect()  # closes the file
        _check_written(temporary, trajectory)


def log_record(out: Output, trajectory: Trajectory) -> None:
    """Send the rows that `out` does not have yet, and first the meta."""
    if out.fixed:
        head = {"format": _FORMAT, "columns": trajectory.names, "meta": trajectory.meta}
        text = {"json": json.dumps(head)}
        log(out, "record/meta", rr.DynamicArchetype(_HEAD, components=text))

    def rows(new):
        columns = {name: values[new] for name, values in trajectory.columns.items()}
        return rr.DynamicArchetype.columns(archetype=_COLUMN, components=columns)

    send_rows(out, "record", trajectory["t"], rows)


def read_rrd(path: str | os.PathLike) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """Read the columns, each float64 of shape (T,), and the meta from a file of `write_rrd`.

    Parameters
    ----------
    path : path-like
        A ``.rrd`` file.

    Returns
    -------
    columns : dict of str to numpy.ndarray
        In their original order.
    meta : dict
        As it was given to the Trajectory.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is not a recording of Ship Gym.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no recording {path}")
    try:
        chunks = RrdReader(path).stream().filter(content=["/record", "/record/meta"]).to_chunks()
    except (RuntimeError, ValueError, OSError) as error:
        raise ValueError(f"{path} is not a readable .rrd file: {error}") from error
    heads = [chunk for chunk in chunks if chunk.entity_path == "/record/meta"]
    if not heads:
        raise ValueError(f"{path} is a rerun file, but not a recording of Ship Gym")
    head = json.loads(heads[0].to_record_batch().column(f"{_HEAD}:json")[0][0].as_py())
    if head["format"] != _FORMAT:
        raise ValueError(f"{path} has recording format {head['format']}, not {_FORMAT}")
    rows = [chunk for chunk in chunks if chunk.entity_path == "/record"]
    return {name: _read_column(rows, name) for name in head["columns"]}, head["meta"]


def _read_column(chunks: list[Chunk], name: str) -> np.ndarray:
    """Join one column over its chunks; rerun's tools may have split and reordered the file."""
    times, values = [], []
    for chunk in chunks:
        batch = chunk.to_record_batch()
        if f"{_COLUMN}:{name}" in batch.schema.names:
            column = batch.column(f"{_COLUMN}:{name}")
            times.append(batch.column(TIMELINE).cast("int64").to_numpy()[column.is_valid()])
            values.append(column.flatten().to_numpy())
    order = np.argsort(np.concatenate(times), kind="stable")
    return np.concatenate(values)[order]


def _check_written(path: Path, trajectory: Trajectory) -> None:
    """Rerun writes in a thread that only warns, so look whether everything has arrived."""
    try:
        columns, meta = read_rrd(path)
    except (ValueError, KeyError) as error:
        raise OSError(f"the recording could not be written: {error}") from error
    same = list(columns) == trajectory.names and meta == trajectory.meta
    if not same or any(columns[k].tobytes() != trajectory[k].tobytes() for k in columns):
        raise OSError("the recording could not be written completely")
