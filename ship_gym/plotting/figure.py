"""What all pictures share: style, colours, and writing a file whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image  # comes with matplotlib

from ship_gym.reports.page import Picture
from ship_gym.writing import atomic_path

INK, FAINT, GRID = "#22303c", "#8795a1", "#e3e8ec"
BLUE, TEAL, AMBER, RED = "#1f5a94", "#2a8f82", "#d98324", "#b8402f"
VIOLET, SKY = "#7d4fa6", "#57a5d1"
DASHED = (0, (4, 2))
MEASURED = AMBER  # whatever comes from a trial, in every picture

_DPI = 110
_STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": FAINT,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "contour.negative_linestyle": "solid",
    "font.size": 9,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
}


@contextlib.contextmanager
def picture(path: str | os.PathLike, width: float, height: float) -> Iterator[Figure]:
    """Give an empty figure of `width` by `height` inches; write it as PNG when the block ends.

    The caller's own matplotlib settings and backend are neither used nor changed. An exception in
    the block leaves an existing file as it was.
    """
    with matplotlib.style.context(["default", _STYLE]):
        figure = Figure(figsize=(width, height), dpi=_DPI, layout="constrained")
        yield figure
        with atomic_path(path) as temporary:
            _write(figure, temporary)


def _write(figure: Figure, path: Path) -> None:
    """Write a PNG of 256 colours, a third of the size of one with all."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    image = image.quantize(256, dither=Image.Dither.NONE)
    image.save(path, format="PNG", optimize=True, dpi=(_DPI, _DPI))


def for_page(caption: str, draw: Callable[[Path], object], name: str = "") -> Picture:
    """What a drawing function writes, as a picture of a page."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        draw(path)
        return Picture(caption, path.read_bytes(), name)


def headline(figure: Figure, title: str, details: str) -> None:
    """Title and a fainter line of details under it, at the upper left of the figure."""
    room = 0.62 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, 1.0 - room))
    style = {"x": 0.012, "ha": "left", "va": "top"}
    figure.text(y=1.0 - 0.12 * room, s=title, fontsize=13, fontweight="bold", **style)
    figure.text(y=1.0 - 0.55 * room, s=details, color=FAINT, **style)


def level(axes: Axes, value: float, deviation: float = 0.0, **kwargs) -> None:
    """Measured value of a trial as a dashed horizontal line, its standard deviation as a band."""
    if deviation > 0.0:
        band = {"color": MEASURED, "alpha": 0.2, "linewidth": 0.0}
        axes.axhspan(value - deviation, value + deviation, **band, **kwargs)
    axes.axhline(value, color=MEASURED, linestyle=DASHED, linewidth=1.2, **kwargs)
