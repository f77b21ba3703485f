"""What is written beside the picture of a recording: its card, and its marks on the time line."""

from __future__ import annotations

import numpy as np
import rerun as rr

from ship_gym.recording.card import card_text
from ship_gym.recording.marks import Mark, marks
from ship_gym.recording.rerun_export.log import TIMELINE, Output, log
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
    times = np.round(np.array([mark.time for mark in found]) * 1e9).astype("timedelta64[ns]")
    entries = rr.TextLog.columns(
        text=[mark.text for mark in found],
        level=[_level(mark, trajectory) for mark in found],
        color=[_LEVELS[mark.kind][1] for mark in found],
    )
    clock = rr.TimeColumn(TIMELINE, duration=times)
    rr.send_columns(MARKS, [clock], entries, recording=out.stream, strict=True)


def _level(mark: Mark, trajectory: Trajectory) -> str:
    """Level of an entry; the end of a run that failed is an error."""
    if mark.kind == "end" and trajectory.meta.get("failed"):
        return str(rr.TextLogLevel.ERROR)
    return str(_LEVELS[mark.kind][0])
