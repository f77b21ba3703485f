"""What every part of a recording is sent through: a stream and what it has already."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr

from ship_gym.recording.rerun_export.program import HOST, NoViewer, Program, listens

TIMELINE = "sim_time"
PORT = 9876  # of a viewer for live views, which is rerun's own
_VIEWERS: list[Program] = []  # that were opened here; they stay open when this process ends


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


def application_id(name: str) -> str:
    """Application id of a run with a name.

    A viewer shares layout, ranges of axes and place of the eye between recordings of one id.
    """
    return "ship_gym_" + re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")


def new_stream(name: str) -> rr.RecordingStream:
    """Open a stream with an application id; it goes nowhere yet.

    What earlier ones have left is freed first. Rerun itself does that in ``rr.init`` only: each
    stream would keep two threads and its memory for as long as the process lives.

    Raises
    ------
    OSError
        If rerun is switched off.
    """
    rr.bindings.flush_and_cleanup_orphaned_recordings()
    stream = rr.RecordingStream(name)
    if not rr.is_enabled(stream):
        raise OSError("rerun records nothing: the environment has RERUN=off")
    return stream


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
    stream.connect_grpc(open_viewer() if sink is None else sink)
    return stream


def open_viewer() -> str:
    """Address of a viewer that is open on this machine, or else is opened, on loopback only."""
    if not listens(PORT):
        try:
            program = Program(["--expect-data-soon"], PORT, detached=True)
            program.until(lambda: listens(PORT))
        except NoViewer as error:
            raise RuntimeError(str(error)) from error
        _VIEWERS.append(program)
    return f"rerun+http://{HOST}:{PORT}/proxy"


def clock(times: np.ndarray | Sequence[float]) -> rr.TimeColumn:
    """Times [s], shape (T,), on the time line of the viewer."""
    nanoseconds = np.round(np.asarray(times) * 1e9).astype("timedelta64[ns]")
    return rr.TimeColumn(TIMELINE, duration=nanoseconds)


def log(out: Output, path: str, archetype) -> None:
    """Log what does not change in time."""
    out.stream.log(path, archetype, static=True, strict=True)


def log_style(out: Output, path: str, archetype: Any, **style) -> None:
    """Log what stays the same of an entity whose geometry changes in time."""
    log(out, path, archetype.from_fields(**style))
