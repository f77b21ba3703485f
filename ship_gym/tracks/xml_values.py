"""Names and numbers of XML elements, checked; shared by RTZ and GPX."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ship_gym.config import ConfigError, check_number, shown

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_DIGITS = 17


def parted(tag: object) -> tuple[str, str]:
    """Namespace and name of an element's tag; the tag of a comment is no text."""
    namespace, brace, name = str(tag).rpartition("}")
    return namespace.lstrip("{") if brace else "", name


def children(element: Element | None, name: str) -> Iterator[Element]:
    """Children with a name in the element's own namespace or in none."""
    if element is not None:
        namespace = parted(element.tag)[0]
        for child in element:
            if isinstance(child.tag, str) and parted(child.tag) in ((namespace, name), ("", name)):
                yield child


def child(element: Element | None, name: str) -> Element | None:
    """First child with a name, or None."""
    return next(children(element, name), None)


def number(
    element: Element | None, name: str, where: str, low: float, high: float, unit: str
) -> float | None:
    """Attribute of an element as a number within limits; None if it is not there.

    Raises
    ------
    ConfigError
        Names `where` and the attribute, its text and what is allowed.
    """
    text = None if element is None else element.get(name)
    if text is None:
        return None
    if not _NUMBER.fullmatch(text.strip()):
        raise ConfigError(
            f"{where}: {name} = {shown(text)}: must be a number, {low:g} to {high:g} [{unit}]"
        )
    return check_number(f"{where}: {name}", float(text), low, high, unit, tiny=True)


def needed(
    element: Element | None, name: str, where: str, low: float, high: float, unit: str
) -> float:
    """As `number`, of an attribute that must be there."""
    found = number(element, name, where, low, high, unit)
    if found is None:
        raise ConfigError(f"{where}: no {name}; must be a number, {low:g} to {high:g} [{unit}]")
    return found


def decimal(value: float, unit: float = 1.0) -> str:
    """Shortest text in a unit that is read as the same value, without an exponent."""
    number = value / unit
    near = [round(number, digits) for digits in range(_DIGITS + 1)]
    near += [np.nextafter(number, toward) for toward in (-np.inf, np.inf)]
    same = next((one for one in near if one * unit == value), number)
    return np.format_float_positional(same, trim="-")
