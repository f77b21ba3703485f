"""Canvas: lines, shapes and text on a picture, smooth at the edges; the only place with Pillow.

Coordinates are design units, x to the right and y down, whatever the size of the picture. Shapes
are drawn at twice its size and reduced, which smooths their edges; text is set on the reduced
picture and lies above all shapes.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

try:
    from PIL import Image, ImageDraw, ImageFont
except ModuleNotFoundError as error:
    raise ImportError('pictures need Pillow: pip install "ship-gym[render]"') from error

Color = tuple[int, int, int]
_FINE = 2  # shapes are drawn this many times larger, and reduced
_SMOOTH = 4  # and texts this many, because letters fitted to pixels stand unevenly
_CAP = 0.36  # from the middle of a capital letter to its foot, by the size of the font
DEGREE = "\N{DEGREE SIGN}"

# Colours that stay apart with every kind of colour vision: Okabe and Ito (2008), "Color universal
# design", jfly.uni-koeln.de/color. Greys and paler tones are ours.
INK, MUTED, LINE, PAPER = (33, 43, 54), (92, 105, 118), (216, 223, 229), (255, 255, 255)
PALE = (238, 241, 244)
SEA, CREST, GRID, WAKE = (224, 234, 241), (237, 243, 248), (204, 217, 226), (150, 172, 188)
BLUE, SKY, GREEN = (0, 114, 178), (86, 180, 233), (0, 158, 115)
ORANGE, RED = (230, 159, 0), (213, 94, 0)


class Canvas:
    """An empty picture.

    Parameters
    ----------
    width, height : int
        Size [pixel].
    unit : float
        Pixels of one design unit.
    color : Color
        Of the ground.
    """

    def __init__(self, width: int, height: int, unit: float, color: Color):
        self.width, self.height = width / unit, height / unit
        self._unit, self._fine = unit, unit * _FINE
        self._image = Image.new("RGB", (width * _FINE, height * _FINE), color)
        self._draw = ImageDraw.Draw(self._image)
        self._texts: list[tuple] = []

    def line(self, points, color: Color, width: float = 1.0, joint: bool = False) -> None:
        """Line through points, shape (k, 2); `joint` rounds the corners of a wide one."""
        thick = max(1, round(width * self._fine))
        self._draw.line(self._flat(points), color, thick, "curve" if joint else None)

    def dashed(self, start, end, color: Color, width: float = 1.0, dash: float = 6.0) -> None:
        """Dashed straight line between two points, dashes and gaps of length `dash`."""
        start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
        length = math.dist(start, end)
        if length == 0.0:
            return
        begin = np.arange(0.0, length, 2.0 * dash)
        for a, b in zip(begin, np.minimum(begin + dash, length), strict=True):
            self.line([start + a / length * (end - start), start + b / length * (end - start)],
                      color, width)  # fmt: skip

    def polygon(self, points, fill: Color, outline: Color | None = None, width: float = 1.0):
        """Filled polygon, points of shape (k, 2)."""
        self._draw.polygon(self._flat(points), fill)
        if outline is not None:
            self.line([*points, points[0]], outline, width, joint=True)

    def box(self, x: float, y: float, width: float, height: float, fill: Color, radius: float = 0):
        """Filled rectangle with rounded corners."""
        low = self._flat([(x, y), (x + width, y + height)])
        if low[2] - low[0] < 1.0 or low[3] - low[1] < 1.0:
            return
        self._draw.rounded_rectangle(low, min(radius, 0.5 * width, 0.5 * height) * self._fine, fill)

    def cover(self, x: float, y: float, width: float, height: float, radius: float = 0.0) -> None:
        """White rectangle that also takes away the texts below it, even those it only touches."""
        self.box(x, y, width, height, PAPER, radius)
        self._texts = [
            text
            for text in self._texts
            if not _overlap((x, y, x + width, y + height), self._extent(text))
        ]

    def circle(self, centre, radius: float, fill=None, outline=None, width: float = 1.0) -> None:
        """Circle, filled, outlined or both."""
        thick = max(1, round(width * self._fine))
        self._draw.ellipse(self._square(centre, radius), fill, outline, thick)

    def arc(self, centre, radius: float, start: float, end: float, color: Color, width: float):
        """Arc clockwise from one direction to another, both from up [rad]."""
        angles = [math.degrees(a) - 90.0 for a in (start, end)]
        thick = max(1, round(width * self._fine))
        self._draw.arc(self._square(centre, radius), *angles, color, thick)

    def arrow(self, start, end, color: Color, width: float = 1.5, head: float = 6.0) -> None:
        """Arrow between two points with a filled head of length `head`."""
        start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
        length = math.dist(start, end)
        if length == 0.0:
            return
        ahead = (end - start) / length
        neck = end - min(head, length) * ahead
        side = 0.5 * head * np.array([-ahead[1], ahead[0]])
        self.line([start, neck], color, width)
        self.polygon([end, neck + side, neck - side], color)

    def text(
        self, place, text: str, size: float, color: Color = INK, anchor: str = "ls", halo=None
    ) -> None:
        """Text above all shapes.

        Parameters
        ----------
        place : (x, y)
            Where its anchor lies.
        size : float
            Of the font [design units].
        anchor : str
            "l", "m" or "r" (left, middle, right), then "s" (foot of the letters) or "m" (middle).
        halo : Color, optional
            Of a rim that keeps it legible on lines.
        """
        self._texts.append((place, text, size, color, anchor, halo))

    def fitted(self, text: str, size: float, width: float) -> str:
        """`text`, or as much of it as fits into `width` with three dots."""
        if self.text_width(text, size) <= width:
            return text
        while text and self.text_width(text + "...", size) > width:
            text = text[:-1]
        return text.rstrip() + "..."

    def text_width(self, text: str, size: float) -> float:
        """Width of a text [design units]."""
        return _length(text, self._pixels(size)) / self._unit

    def pixels(self) -> np.ndarray:
        """The picture, uint8, shape (height, width, 3)."""
        image = self._image.reduce(_FINE)
        for place, text, size, color, anchor, halo in self._texts:
            pixels = self._pixels(size)
            shift = {"l": 0.0, "m": -0.5, "r": -1.0}[anchor[0]] * _length(text, pixels)
            x = round(place[0] * self._unit + shift)
            y = round(place[1] * self._unit + (_CAP * pixels if anchor[1] == "m" else 0.0))
            for rim, ink in ((max(1, round(1.6 * self._unit)), halo), (0, color)):
                if ink is not None:
                    mask, (left, top) = _mask(text, pixels, rim)
                    image.paste(ink, (x + left, y + top), mask)
        return np.array(image)

    def _extent(self, text: tuple) -> tuple[float, float, float, float]:
        """Left, top, right, bottom of a text [design units]."""
        (x, y), words, size, _, anchor, _ = text
        width = self.text_width(words, size)
        left = x + {"l": 0.0, "m": -0.5, "r": -1.0}[anchor[0]] * width
        foot = y + (_CAP * size if anchor[1] == "m" else 0.0)
        return left, foot - size, left + width, foot

    def _flat(self, points: Sequence) -> list[float]:
        return (np.asarray(points, dtype=float) * self._fine).ravel().tolist()

    def _square(self, centre, radius: float) -> list[float]:
        x, y = centre
        return self._flat([(x - radius, y - radius), (x + radius, y + radius)])

    def _pixels(self, size: float) -> int:
        return round(size * self._unit)


def _overlap(one: tuple, two: tuple) -> bool:
    """Whether two rectangles of left, top, right, bottom have a common part."""
    return one[0] < two[2] and two[0] < one[2] and one[1] < two[3] and two[1] < one[3]


def toward(angle: float) -> np.ndarray:
    """Step on the picture in a direction from north [rad]."""
    return np.array([math.sin(angle), -math.cos(angle)])


def bearing(angle: float) -> str:
    """Direction from north as three digits, 000 to 359 deg."""
    return f"{round(math.degrees(angle)) % 360:03d}{DEGREE}"


@functools.lru_cache(maxsize=32)
def _font(size: int):
    return ImageFont.load_default(size)


@functools.lru_cache(maxsize=4096)
def _length(text: str, size: int) -> float:
    return _font(_SMOOTH * size).getlength(text) / _SMOOTH


@functools.lru_cache(maxsize=4096)  # most texts come back in the next picture
def _mask(text: str, size: int, rim: int):
    """Text as a grey mask, and where its corner lies from the left end of its foot."""
    font = _font(_SMOOTH * size)
    edges = font.getbbox(text, stroke_width=_SMOOTH * rim, anchor="ls")
    # whole pixels of the picture, so that the reduced mask stands where the large one did
    left, top = (_SMOOTH * math.floor(v / _SMOOTH) for v in edges[:2])
    right, bottom = (_SMOOTH * math.ceil(v / _SMOOTH) for v in edges[2:])
    mask = Image.new("L", (max(right - left, _SMOOTH), max(bottom - top, _SMOOTH)))
    width = _SMOOTH * rim
    ImageDraw.Draw(mask).text(
        (-left, -top), text, 255, font, "ls", stroke_width=width, stroke_fill=255
    )
    return mask.reduce(_SMOOTH), (left // _SMOOTH, top // _SMOOTH)
