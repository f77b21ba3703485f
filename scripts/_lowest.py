"""Lowest versions that pyproject.toml allows, as ``name==version`` for pip, one a line.

python scripts/_lowest.py                # of what every installation needs
python scripts/_lowest.py rl plot        # and of these extras
python scripts/_lowest.py --only rl      # of the extra alone, where it asks for more

A requirement may hold from a Python on: ``"numpy>=2.1; python_version >= '3.13'"``; the Python that
runs this counts.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"
MARKER = re.compile(r"python_version *(>=|<) *'(\d+\.\d+)'")
FLOOR = re.compile(r"([A-Za-z0-9._-]+)(\[[a-z0-9,]+\])?>=([0-9][0-9a-z.]*)")


def lowest(project: dict, extras: list[str], base: bool = True) -> dict[str, str]:
    """Lowest version of each requirement: of several floors of a name the highest.

    Raises
    ------
    SystemExit
        An extra that is not there, or a requirement without a floor.
    """
    found: dict[str, str] = {}
    for requirement in [*(project["dependencies"] if base else ()), *_of(project, extras)]:
        requirement, _, marker = requirement.partition(";")
        if marker and not _holds(marker.strip()):
            continue
        floor = FLOOR.match(requirement)
        if floor is None:
            sys.exit(f"{PROJECT.name}: {requirement!r} has no lower bound (name>=version)")
        name, parts, version = floor.groups()
        name += parts or ""
        found[name] = max(found.get(name, version), version, key=_order)
    return found


def _of(project: dict, extras: list[str]) -> Iterator[str]:
    """Requirements of extras, and of the extras that these name."""
    for extra in extras:
        if extra not in project["optional-dependencies"]:
            sys.exit(f"{PROJECT.name}: no extra {extra!r}")
        for requirement in project["optional-dependencies"][extra]:
            own = re.fullmatch(rf"{project['name']}\[(.+)\]", requirement)
            yield from _of(project, own[1].split(",")) if own else (requirement,)


def _holds(marker: str) -> bool:
    """Whether a marker is true of this Python; only a bound of ``python_version`` is known."""
    bound = MARKER.fullmatch(marker)
    if bound is None:
        sys.exit(f"{PROJECT.name}: marker {marker!r}: only python_version >= or < is known here")
    new_enough = sys.version_info[:2] >= _order(bound[2])
    return new_enough == (bound[1] == ">=")


def _order(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"\d+", version))


if __name__ == "__main__":
    words = sys.argv[1:]
    only = "--only" in words
    read = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    wanted = lowest(read, [word for word in words if word != "--only"], base=not only)
    print(*(f"{name}=={version}" for name, version in wanted.items()), sep="\n")
