"""What every part of a recording is sent through: a stream and what it has already."""

from __future__ import annotations

import math
import shutil
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr

TIMELINE = "sim_time"


@dataclass
class Output:
    """A stream and what of a run it has already.

    Attributes
    ----------
    stream : rr.RecordingStream
    sent : float
        Time of the last row that was sent [s].
    fixed : bool
        Whether to send what does not change in time, such as shapes, names and the blueprint.
    area : numpy.ndarray or None
        Corners of the sea of a live view [m], shape (k, 3); None: the run is known to its end.
    largest : dict or None
        Forces of a live view that set the units of its plots, as for ``panels.motion_panels``.
    """

    stream: rr.RecordingStream
    sent: float = -math.inf
    fixed: bool = True
    area: np.ndarray | None = None
    largest: dict[str, float] | None = None


def open_stream(name: str, sink: str | None) -> rr.RecordingStream:
    """Open a stream of a live view in a viewer.

    Parameters
    ----------
    name : str
        Application id.
    sink : str or None
        Address ``rerun+http://...`` of a viewer, or None: open one here, or use the one that is
        open.

    Raises
    ------
    RuntimeError
        If no viewer can be opened.
    """
    stream = rr.RecordingStream(name)
    if sink is None:
        program = shutil.which("rerun") or shutil.which("rerun", path=Path(sys.executable).parent)
        rr.spawn(recording=stream, executable_path=program)
    else:
        stream.connect_grpc(sink)
    return stream


def log(out: Output, path: str, archetype) -> None:
    """Log what does not change in time."""
    out.stream.log(path, archetype, static=True, strict=True)


def log_style(out: Output, path: str, archetype: type, **style) -> None:
    """Log what stays the same of an entity whose geometry changes in time."""
    log(out, path, archetype.from_fields(**style))


def send_rows(
    out: Output, path: str, t: np.ndarray, rows: Callable[[np.ndarray], Iterable]
) -> None:
    """Send `rows` of the times that are new, a mask of shape (T,)."""
    new = t > out.sent
    if new.any():
        times = np.round(t[new] * 1e9).astype("timedelta64[ns]")
        clock = rr.TimeColumn(TIMELINE, duration=times)
        rr.send_columns(path, [clock], rows(new), recording=out.stream, strict=True)


def send_pose(out: Output, path: str, t: np.ndarray, places, turns) -> None:
    """Send places (T, 3) [m] and turns (T, 4) of an entity."""

    def rows(new):
        return rr.Transform3D.columns(translation=places[new], quaternion=turns[new])

    send_rows(out, path, t, rows)
