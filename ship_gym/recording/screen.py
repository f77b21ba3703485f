"""Whether there is a screen for a viewer; known without rerun."""

from __future__ import annotations

import os
import sys


def has_screen() -> bool:
    """Whether a window can be opened: on Linux, a display server is named."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
