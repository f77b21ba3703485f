"""One plot of a recording: its lines, colours and place among the tabs of a viewer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Columns = Mapping[str, np.ndarray]

# Readable on black and on white: the viewer has a dark and a light theme.
BLUE, ORANGE, GREEN, RED = (40, 130, 220), (214, 112, 16), (46, 150, 76), (218, 66, 66)
GREY, PURPLE, TEAL, PINK = (128, 128, 128), (150, 96, 214), (16, 146, 152), (206, 76, 150)
PALETTE = (BLUE, ORANGE, GREEN, PURPLE, TEAL, PINK, RED, GREY)
DEG = 180.0 / np.pi
# Topics: each is a tab of the viewer; the first holds what is seen at once.
STEERING, COURSE, FORCE, LOADS, FLOW = "Steering", "Course", "Forces", "Loads", "Flow"


@dataclass(frozen=True)
class Series:
    """One line of a plot: legend text, values of shape (T,) in the panel's unit, RGB colour.

    A `limit` need not be on the axis as long as the other lines are far from it.
    """

    label: str
    values: np.ndarray
    color: tuple[int, int, int]
    limit: bool = False


@dataclass(frozen=True)
class Panel:
    """One plot: the path of its data, a title with the unit, its lines, and its tab."""

    path: str
    title: str
    series: list[Series]
    topic: str = COURSE
    robust: bool = False  # the axis leaves out the largest tenth of the rows

    @property
    def name(self) -> str:
        """Last part of the path."""
        return self.path.rpartition("/")[2]
