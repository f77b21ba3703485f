"""What is written beside the picture of a recording: its card, and its marks on the time line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.recording.card import card_text
from ship_gym.recording.marks import Mark, marks
from ship_gym.recording.panel import Panel
from ship_gym.recording.rerun_export.log import Output, clock, log, log_style
from ship_gym.recording.trajectory import Trajectory

CARD, MARKS = "about", "marks"  # entities of both
# Level, which gives a log entry its colour, and colour on the plots, by kind of mark
_LEVELS = {
    "error": (rr.TextLogLevel.WARN, (224, 90, 90)),
    "saturation": (rr.TextLogLevel.WARN, (240, 160, 60)),
    "limit": (rr.TextLogLevel.WARN, (240, 160, 60)),
    "failure": (rr.TextLogLevel.ERROR, (224, 60, 60)),
    "leg": (rr.TextLogLevel.INFO, (130, 170, 210)),
    "end": (rr.TextLogLevel.INFO, (160, 160, 160)),
}


def send_card(out: Output, trajectory: Trajectory) -> None:
    """Send the card of a run as a page."""
    log(out, CARD, rr.TextDocument(card_text(trajectory), media_type="text/markdown"))


def send_marks(out: Output, trajectory: Trajectory) -> None:
    """Send the marks of a run as entries of a text log, each at its time."""
    found = marks(trajectory)
    entries = rr.TextLog.columns(
        text=[mark.text for mark in found],
        level=[_level(mark, trajectory) for mark in found],
        color=[_LEVELS[mark.kind][1] for mark in found],
    )
    times = clock([mark.time for mark in found])
    rr.send_columns(MARKS, [times], entries, recording=out.stream, strict=True)


def send_points(
    out: Output, t: np.ndarray, panel: Panel, found: Sequence[Mark], line: int = 0
) -> None:
    """Send marks as points on one line of a plot.

    Parameters
    ----------
    out : Output
    t : numpy.ndarray
        Times of the rows [s], shape (T,).
    panel : Panel
    found : sequence of Mark
        Of the run, as `marks` gives them; the end is left out.
    line : int
        Which series of the panel.
    """
    found = [mark for mark in found if mark.kind != "end"]
    if not found:
        return
    path, series = f"{panel.path}/{MARKS}", panel.series[line]
    log_style(out, path, rr.SeriesPoints, names=["marks"], markers=["circle"], marker_sizes=[4.0])
    values = np.interp([mark.time for mark in found], t, series.values)
    colors = [_LEVELS[mark.kind][1] for mark in found]
    points = [*rr.Scalars.columns(scalars=values), *rr.SeriesPoints.columns(colors=colors)]
    times = clock([mark.time for mark in found])
    rr.send_columns(path, [times], points, recording=out.stream, strict=True)


def marks_view(name: str = "Marks") -> rrb.TextLogView:
    """The list of marks: time, level and text, without the path that all share."""
    kinds = (("LogLevel", True), ("Body", True), ("EntityPath", False))
    shown = [rrb.encodings.TextLogColumn(kind, visible=visible) for kind, visible in kinds]
    columns = rrb.TextLogColumns(text_log_columns=shown)
    return rrb.TextLogView(origin=f"/{MARKS}", name=name, columns=columns)


def _level(mark: Mark, trajectory: Trajectory) -> str:
    """Level of an entry; the end of a run that failed is an error."""
    if mark.kind == "end" and trajectory.meta.get("failed"):
        return str(rr.TextLogLevel.ERROR)
    return str(_LEVELS[mark.kind][0])
