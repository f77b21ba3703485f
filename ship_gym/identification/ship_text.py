"""Ship file of a fitted ship: the file that it began with, its fitted numbers in their places."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.identification.numbers import unit_of, values_of
from ship_gym.reading import read_text
from ship_gym.ships.files import file_of
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim
from ship_gym.text import WIDTH
from ship_gym.writing import atomic_path

MARK = "# Fitted by `ship-gym fit-hull`"
STATUS = "numbers fitted to tests, see the head of this file and their sources; not validated"
_DIGITS = 6
_SECTION = re.compile(r"\s*\[([^\[\]]+)\]\s*(#.*)?$")
_SAME = 1e-4  # of a number; the file holds `_DIGITS` digits


def write_ship(
    path: Path,
    base: os.PathLike | str,
    fitted: Ship,
    sources: Mapping[str, str],
    told: Sequence[str],
) -> None:
    """Write the ship file of a fitted ship; it is read again before it is put in its place.

    Parameters
    ----------
    path : pathlib.Path
    base : str or path
        Name or file of the ship before the fit.
    fitted : Ship
    sources : mapping
        Full name of every fitted number to its source: what was fitted to what.
    told : sequence of str
        Lines for the head of the file.

    Raises
    ------
    ConfigError
        The file of the base writes a number in a way that cannot be replaced, or a fitted number
        is one that no ship has; or the ship does what no ship does (``behaviour``).
    """
    origin = file_of(base)
    text = ship_text(read_text(origin), fitted, sources)
    text = _with_base_path(text, origin, path)
    head = [f"{MARK} from {_words(base)}; the other numbers are that ship's.", *_wrapped(told)]
    whole = "\n".join([head[0], *(f"# {line}".rstrip() for line in head[1:]), "#", text])
    with atomic_path(path) as temporary:
        temporary.write_text(whole, encoding="utf-8")
        _check(temporary, fitted, tuple(sources))


def ship_text(text: str, fitted: Ship, sources: Mapping[str, str]) -> str:
    """Text of a ship file with some numbers replaced, or put at the head of their sections."""
    names = tuple(sources)
    values = dict(zip(names, values_of(fitted, names), strict=True))
    lines, open_names = text.splitlines(), list(names)
    made: list[str] = []
    section, heads = "", {}
    for line in lines:
        if found := _SECTION.match(line):
            section = found[1].strip()
            heads[section] = len(made) + 1
        name = f"{section}.{line.partition('=')[0].strip()}"
        if name in values and "=" in line:
            line = _entry(fitted, name, values[name], sources[name])
            open_names.remove(name)
        elif name == ".status" and "=" in line:
            line = f'status = "{STATUS}"'
        made.append(line)
    for name in reversed(open_names):
        section = name.partition(".")[0]
        if section not in heads:
            made += ["", f"[{section}]"]
            heads[section] = len(made)
        made.insert(heads[section], _entry(fitted, name, values[name], sources[name]))
        heads = {s: at + (at > heads[section]) for s, at in heads.items()}
    return "\n".join(made) + "\n"


def _entry(ship: Ship, name: str, value: float, source: str) -> str:
    short, unit = name.partition(".")[2], unit_of(ship, name)
    plain = source.replace("\\", "/").replace('"', "'")
    return f'{short} = {{ value = {value:.{_DIGITS}g}, unit = "{unit}", source = "{plain}" }}'


def _with_base_path(text: str, origin: Path, path: Path) -> str:
    """``scaled_from`` with a path that counts from the new file's folder."""

    def moved(found: re.Match) -> str:
        there = (origin.parent / found[2]).resolve()
        relative = Path(os.path.relpath(there, path.resolve().parent)).as_posix()
        return f"{found[1]}{relative}{found[3]}"

    return re.sub(r'(?m)^(\s*scaled_from\s*=\s*")([^"]*\.toml)(")', moved, text)


def _check(path: Path, fitted: Ship, names: tuple[str, ...]) -> None:
    """Load what was written, see that she sails as ships do; her numbers are those found."""
    ship = load_ship(path)
    ShipSim(ship, 1)
    there, meant = values_of(ship, names), values_of(fitted, names)
    wrong = np.abs(there - meant) > _SAME * np.maximum(np.abs(meant), 1e-6)
    if wrong.any():
        name = names[int(wrong.argmax())]
        raise ConfigError(f"{name} does not come back from the ship file: write it as 'key = ...'")


def _words(base: os.PathLike | str) -> str:
    return load_ship(base).name


def _wrapped(told: Sequence[str]) -> list[str]:
    import textwrap

    return [line for text in told for line in textwrap.wrap(text, WIDTH - 2)]
