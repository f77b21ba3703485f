"""The record in a rerun file: exact columns and meta, written sealed and read back verified.

Entity ``/record/meta`` holds the head as JSON: names of the columns, checksums, the meta, and those
columns that stay the same; ``/record`` holds rows of the others, float64 in the order of their
names. The rest of the file is what the viewer shows, drawn from them (``picture``). The record
comes first and in pieces, so that a file that was cut still gives its first rows.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from rerun.chunk import Chunk, RrdReader
from rerun.error_utils import RerunWarning

from ship_gym.recording.card import run_name
from ship_gym.recording.rerun_export.log import (
    TIMELINE,
    Output,
    application_id,
    clock,
    new_stream,
)
from ship_gym.recording.rerun_export.picture import send_picture
from ship_gym.recording.sealed import DamagedRecording, damage_told, seal, verify
from ship_gym.recording.trajectory import Trajectory
from ship_gym.writing import DiskFull, atomic_path

_FORMAT = 2  # of /record; a reader refuses what it does not know
COMPARISON = "/comparison"  # entity of a file that has no record, see `compare`
_PIECE = 200  # rows that go together; each piece costs some 3 kB
# Prefixes keep our names apart from rerun's own, and from each other: within one process rerun
# remembers the type of every component name.
_HEAD, _ROWS = "ShipGymHead", "ShipGymRecord"


def write_rrd(trajectory: Trajectory, path: str | os.PathLike, *, picture: bool = True) -> None:
    """Write `trajectory` to a sealed ``.rrd`` file with its blueprint, without a viewer.

    Parameters
    ----------
    trajectory : Trajectory
        What to write; views whose columns are missing are left out.
    path : path-like
        File to write; it is replaced only by a complete file that was read back and compared.
    picture : bool
        Whether to write what the viewer shows, too.

    Raises
    ------
    OSError
        If it cannot be written, such as on a full disk; names the file.
    """
    try:
        record, shown = _streams(trajectory, picture)
        with atomic_path(path) as temporary:
            temporary.write_bytes(record)
            _check_record(temporary, trajectory)
            data = seal(record, shown)
            temporary.write_bytes(data)
            if temporary.read_bytes() != data:
                raise OSError("the file does not hold what was written")
    except DiskFull:  # names the file already
        raise
    except OSError as error:
        why = error.strerror or str(error)
        raise OSError(f"{path}: the recording could not be written: {why}") from error


def _streams(trajectory: Trajectory, picture: bool) -> tuple[bytes, bytes]:
    """Record and picture as rerun encodes them."""
    stream = new_stream(application_id(run_name(trajectory.meta)))
    try:
        source = stream.binary_stream()
        out = Output(stream)
        log_record(out, trajectory)
        record, shown = source.read() or b"", b""
        if picture:
            send_picture(out, trajectory)
            shown = source.read() or b""
    finally:
        stream.disconnect()
    return record, shown


def log_record(out: Output, trajectory: Trajectory) -> None:
    """Send the head and all rows of a run that is over."""
    fixed = {name: float(v[0]) for name, v in trajectory.columns.items() if _stays(name, v)}
    head = {
        "format": _FORMAT,
        "rows": len(trajectory),
        "columns": trajectory.names,
        "fixed": fixed,
        "checksums": {name: _checksum(v) for name, v in trajectory.columns.items()},
        "meta": trajectory.meta,
    }
    text = json.dumps(head | {"meta_checksum": _head_checksum(head)})
    # Sent as columns, which keep the order; ``log`` hands on to a thread that waits for more.
    column = rr.DynamicArchetype.columns(archetype=_HEAD, components={"json": [text]})
    rr.send_columns("record/meta", [], column, recording=out.stream, strict=True)
    moving = [values for name, values in trajectory.columns.items() if name not in fixed]
    table, what = np.stack(moving, axis=1), rr.ComponentDescriptor(f"{_ROWS}:rows", archetype=_ROWS)
    for start in range(0, len(table), _PIECE):
        rows = table[start : start + _PIECE]
        values = rr.components.ScalarBatch(rows.ravel())
        column = rr.ComponentColumn(what, values, lengths=np.full(len(rows), rows.shape[1]))
        times = clock(rows[:, 0])
        rr.send_columns("record", [times], [column], recording=out.stream, strict=True)


def read_rrd(
    path: str | os.PathLike, *, sealed: bool = True
) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """Read the columns, each float64 of shape (T,), and the meta from a file of `write_rrd`.

    Parameters
    ----------
    path : path-like
        A ``.rrd`` file.
    sealed : bool
        Whether to verify every byte before rerun sees it; False: a file that rerun has rewritten.

    Returns
    -------
    columns : dict of str to numpy.ndarray
        In their original order.
    meta : dict
        As it was given to the Trajectory; ``complete`` is false if the file was cut.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    DamagedRecording
        If the file is not as it was written, or is not a recording of Ship Gym.
    """
    path = Path(path)
    with damage_told(path):
        return _read(path, sealed)


def _read(path: Path, sealed: bool):
    if not path.is_file():
        partial = path.with_name(path.name + ".partial")
        more = f"; a run that was broken off left {partial}" if partial.is_file() else ""
        raise FileNotFoundError(f"no recording {path}{more}")
    if not sealed:
        return _decoded(_chunks(path, path), path, complete=True)
    found = verify(path)
    return _decoded(_verified_chunks(found.data[: found.record], path), path, found.complete)


def read_chunks(path: str | os.PathLike) -> list[Chunk]:
    """Read all of a sealed file, record and picture, up to where it was cut.

    Raises
    ------
    DamagedRecording
        If the file is not as it was written.
    """
    return _verified_chunks(verify(path).data, path)


def _decoded(chunks: list[Chunk], path: str | os.PathLike, complete: bool):
    """Columns and meta of the record, compared with their checksums."""
    head = _head(chunks, path)
    moving = [name for name in head["columns"] if name not in head["fixed"]]
    read = dict(zip(moving, _rows(chunks, len(moving), path).T.copy(), strict=True))
    count = len(read["t"])
    read |= {name: np.full(count, value) for name, value in head["fixed"].items()}
    columns = {name: read[name] for name in head["columns"]}
    for name, values in columns.items():
        if complete and _checksum(values) != head["checksums"][name]:
            raise DamagedRecording(f"{path}: column {name!r} is not the one that was written")
    return columns, head["meta"] if complete else head["meta"] | {"complete": False}


def _head(chunks: list[Chunk], path: str | os.PathLike) -> dict:
    heads = [chunk for chunk in chunks if chunk.entity_path == "/record/meta"]
    if not heads and any(chunk.entity_path == COMPARISON for chunk in chunks):
        raise DamagedRecording(f"{path} is a comparison of runs, which has no record of its own")
    if not heads:
        raise DamagedRecording(f"{path} is a rerun file, but not a recording of Ship Gym")
    head = json.loads(heads[0].to_record_batch().column(f"{_HEAD}:json")[0][0].as_py())
    if head["format"] != _FORMAT:
        raise DamagedRecording(f"{path} has recording format {head['format']}, not {_FORMAT}")
    if head.pop("meta_checksum") != _head_checksum(head):
        raise DamagedRecording(f"{path}: the meta is not the one that was written")
    return head


def _rows(chunks: list[Chunk], width: int, path: str | os.PathLike) -> np.ndarray:
    """Rows of the record in order; rerun's tools may have split and reordered the file."""
    batches = [chunk.to_record_batch() for chunk in chunks if chunk.entity_path == "/record"]
    if not batches:
        raise DamagedRecording(f"{path} was cut off before its first rows")
    times = [batch.column(TIMELINE).cast("int64").to_numpy() for batch in batches]
    values = [batch.column(f"{_ROWS}:rows").flatten().to_numpy() for batch in batches]
    order = np.argsort(np.concatenate(times), kind="stable")
    table = np.concatenate(values)
    if len(table) != width * len(order):
        raise DamagedRecording(f"{path}: its rows do not have {width} columns each")
    return table.reshape(-1, width)[order]


def _stays(name: str, values: np.ndarray) -> bool:
    """Whether a column is one value in every bit; the time is stored in any case."""
    bits = values.view(np.int64)
    return name != "t" and bool((bits == bits[0]).all())


def _checksum(data: Any) -> str:
    return hashlib.blake2b(data, digest_size=8).hexdigest()


def _head_checksum(head: Mapping) -> str:
    return _checksum(json.dumps(head, sort_keys=True).encode())


def _check_record(file: Path, trajectory: Trajectory) -> None:
    """Look whether rerun has put everything into the record that it was given."""
    try:
        columns, meta = _decoded(_chunks(file, "the record"), "the record", complete=True)
    except (DamagedRecording, KeyError) as error:
        raise OSError(f"rerun did not make a whole record: {error}") from error
    same = list(columns) == trajectory.names and meta == trajectory.meta
    if not same or any(columns[k].tobytes() != trajectory[k].tobytes() for k in columns):
        raise OSError("rerun did not make a whole record")


def _verified_chunks(data: bytes, path: str | os.PathLike) -> list[Chunk]:
    """Chunks of these bytes, by a file that holds nothing else: rerun's reader takes only files."""
    handle, name = tempfile.mkstemp(prefix="ship-gym-", suffix=".rrd")
    try:
        try:
            with open(handle, "wb") as copy:
                copy.write(data)
        except OSError as error:
            raise OSError(f"{path} cannot be read: no copy in {name}: {error.strerror}") from error
        return _chunks(name, path)
    finally:
        os.unlink(name)


def _chunks(file: str | os.PathLike, path: str | os.PathLike) -> list[Chunk]:
    """Chunks of a file; rerun warns of one without a manifest, as ours are."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RerunWarning)
        try:
            return RrdReader(file).stream().to_chunks()
        except (RuntimeError, ValueError, OSError) as error:
            raise DamagedRecording(f"{path} is not a readable .rrd file: {error}") from error
