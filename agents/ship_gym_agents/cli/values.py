"""Types of option values: numbers, files and names, refused in one line before any work."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem


class Number(click.ParamType):
    """A finite number within [low, high]; outside, one line that names option, value and range.

    Parameters
    ----------
    low, high : float
        Allowed range, ends included.
    unit : str
        For the message.
    kind : type
        float or int.
    """

    def __init__(
        self, low: float = -math.inf, high: float = math.inf, unit: str = "-", kind: type = float
    ):
        self.low, self.high, self.unit, self.kind = low, high, unit, kind
        self.name = "integer" if kind is int else "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number of a text."""
        option = param.opts[0] if param else "value"
        told = f"{option} = {_short(str(value))}"
        try:
            number = self.kind(value)
        except ValueError:
            raise click.UsageError(f"{told}: must be a {self._what()}", ctx) from None
        finite = self.kind is int or math.isfinite(number)  # 10**400 is no float
        if not (finite and self.low <= number <= self.high):
            raise click.UsageError(f"{told}: allowed is {self._range()}", ctx)
        return number

    def _what(self) -> str:
        return "whole number" if self.kind is int else f"number [{self.unit}]"

    def _range(self) -> str:
        if self.low == -math.inf and self.high == math.inf:
            return f"a finite number [{self.unit}]"
        unit = "" if self.unit == "-" else f" [{self.unit}]"
        return f"{self.low:.10g} to {self.high:.10g}{unit}"


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:40]} ... {text[-10:]}"


def whole(low: int, high: int) -> Number:
    """A whole number within [low, high]."""
    return Number(low, high, kind=int)


class OwnNumber(Number):
    """A whole number within [low, high], or the word "own"."""

    def __init__(self, low: int, high: int):
        super().__init__(low, high, kind=int)
        self.name = "own|integer"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number of a text, or the word."""
        return value if value == "own" else super().convert(value, param, ctx)

    def _what(self) -> str:
        return "whole number, or own"


class OutFile(click.ParamType):
    """A file to write: its extension, and that it can be written, are checked before any work.

    Parameters
    ----------
    suffixes : str
        Extensions with their dot, one or several.
    """

    name = "file"

    def __init__(self, *suffixes: str):
        self.suffix, self.suffixes = suffixes[0], suffixes

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path of a text."""
        path, option = Path(value), param.opts[0] if param else "file"
        if isinstance(value, Path) or _alone(value, param, ctx):  # Path: a default
            return path
        if path.suffix.lower() not in self.suffixes:
            known = " or ".join(self.suffixes)
            raise click.UsageError(f"{option} {path}: allowed is a {known} file", ctx)
        return _tried(path, option, ctx)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """How the help shows it."""
        return f"FILE{'|'.join(self.suffixes)}"

    def shell_complete(self, ctx, param, incomplete: str) -> list[CompletionItem]:
        """Files of the shell."""
        return [CompletionItem(incomplete, type="file")]


class OutFolder(click.ParamType):
    """A folder to write into."""

    name = "folder"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """The path of a text."""
        path, option = Path(value), param.opts[0] if param else "folder"
        return path if _alone(value, param, ctx) else _tried(path, option, ctx, folder=True)

    def shell_complete(self, ctx, param, incomplete: str) -> list[CompletionItem]:
        """Folders of the shell."""
        return [CompletionItem(incomplete, type="dir")]


def _alone(value: Any, param: click.Parameter | None, ctx: click.Context | None) -> bool:
    """Whether an option stands without its value; refused where it needs one."""
    if value == "" and param is not None and not getattr(param, "alone", False):
        raise click.UsageError(f"{param.opts[0]}: needs a name", ctx)
    return value == ""


def _tried(path: Path, option: str, ctx: click.Context | None, folder: bool = False) -> Path:
    """The path, refused if it could not be written; a shell that completes does not try it."""
    if ctx is not None and ctx.resilient_parsing:
        return path
    from ship_gym.writing import check_place

    return check_place(path, option, folder)


class Name(click.ParamType):
    """A name or a file, checked by the verb; a shell completes the names and, without one, files.

    Parameters
    ----------
    kind : str
        Key of ``names.NAMES``.
    """

    def __init__(self, kind: str):
        self.kind, self.name = kind, "name"

    def shell_complete(self, ctx, param, incomplete: str) -> list[CompletionItem]:
        """Names that begin so."""
        from ship_gym_agents.cli.names import NAMES

        found = [name for name in NAMES[self.kind]() if name.startswith(incomplete)]
        return [CompletionItem(name) for name in found] or [CompletionItem(incomplete, type="file")]
