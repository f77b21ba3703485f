"""A window of rerun's viewer in its light theme, on a screen that nobody sees.

Without a window the viewer is always dark, and no argument sets the theme of one: it comes from the
settings of the last session, so a window gets a folder of settings of its own.
"""

from __future__ import annotations

import contextlib
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import rerun as rr

from ship_gym.recording.rerun_export.program import NoViewer, end

_XVFB = "Xvfb"
_SETTINGS = """{
"rerun.version": "%s",
"egui": "(options:(theme_preference:Light))"
}
"""


@contextlib.contextmanager
def light_window(size: tuple[int, int]) -> Iterator[tuple[list[str], dict[str, str]]]:
    """Give the arguments and the environment of a viewer in the light theme.

    Raises
    ------
    NoViewer
        This is not Linux, or Xvfb is not installed.
    """
    program = shutil.which(_XVFB)
    if not sys.platform.startswith("linux") or program is None:
        raise NoViewer("a light picture needs Xvfb on Linux (Debian, Ubuntu: xvfb)")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        settings = Path(folder) / "rerun" / "app.ron"
        settings.parent.mkdir()
        settings.write_text(_SETTINGS % rr.__version__)
        with _screen(program, size) as display:
            environment = {"DISPLAY": display, "WAYLAND_DISPLAY": "", "XDG_DATA_HOME": folder}
            yield ["--persist-state"], environment


@contextlib.contextmanager
def _screen(program: str, size: tuple[int, int]) -> Iterator[str]:
    """Give the name of a screen in memory."""
    width, height = size
    screen = ["-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp"]
    process = subprocess.Popen(
        [program, "-displayfd", "1", *screen],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        number = process.stdout.readline().strip()  # once it is ready
        if not number:
            raise NoViewer(f"{_XVFB} did not start")
        yield f":{number}"
    finally:
        process.stdout.close()
        end(process)
