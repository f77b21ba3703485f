"""Options that say which moment of a run is shown, and how large."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory

WORST, STRIP = "worst", "strip"


class At(click.ParamType):
    """A word of `words`, or a time [s]."""

    name = "moment"

    def __init__(self, *words: str):
        self.words = words

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The word or the time of a text."""
        if value in self.words:
            return value
        try:
            time = float(value)
        except ValueError:
            time = math.nan
        if not math.isfinite(time):
            allowed = ", ".join(self.words)
            raise click.UsageError(f"--at {value}: allowed are {allowed}, or a time [s]", ctx)
        return time

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """How the help shows it."""
        return "|".join((*self.words, "TIME"))

    def shell_complete(self, ctx, param, incomplete: str) -> list:
        """The words."""
        from click.shell_completion import CompletionItem

        return [CompletionItem(word) for word in self.words if word.startswith(incomplete)]


class Size(click.ParamType):
    """Width and height in pixels, as in 1920x1080."""

    name = "size"
    _SMALLEST, _LARGEST = 320, 7680

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Both numbers of a text."""
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"(\d+)x(\d+)", value)
        size = tuple(map(int, found.groups())) if found else (0, 0)
        if not all(self._SMALLEST <= length <= self._LARGEST for length in size):
            raise click.UsageError(
                f"--size {value}: must be WIDTHxHEIGHT [pixels], each {self._SMALLEST} to "
                f"{self._LARGEST}, as in 1920x1080",
                ctx,
            )
        return size

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """How the help shows it."""
        return "WIDTHxHEIGHT"


def time_of(run: Trajectory, at: str | float) -> float:
    """The time that is asked for [s]; one outside the run is refused."""
    from ship_gym.config import check_number
    from ship_gym.recording.marks import worst_moment

    if at == WORST:
        return worst_moment(run)
    t = run["t"]
    return check_number("--at", at, float(t[0]), float(t[-1]), "s")


def said(run: Trajectory, time: float) -> str:
    """The time, and the marks there are at it."""
    from ship_gym.recording.marks import marks

    there = [mark.text for mark in marks(run) if mark.time == time]
    return f"{time:.6g} s" + (f": {'; '.join(there)}" if there else "")
