"""Recordings as rerun files and in rerun's viewer; the only package that imports rerun."""

from __future__ import annotations

from ship_gym.recording.rerun_export.log import Output, open_stream
from ship_gym.recording.rerun_export.picture import send_about, send_picture
from ship_gym.recording.rerun_export.rrd_file import read_chunks, read_rrd, write_rrd

__all__ = [
    "Output",
    "open_stream",
    "read_chunks",
    "read_rrd",
    "send_about",
    "send_picture",
    "write_rrd",
]
