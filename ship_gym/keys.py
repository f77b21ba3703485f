"""Keys of a mapping that was read from a file, each checked as it is taken.

For files that hold more than their reader wants to know, such as the card of a run; what is known
in full becomes a dataclass by ``config.build``.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

from ship_gym.config import ConfigError, build, check_number, nearest, shown
from ship_gym.reading import read_json

T = TypeVar("T")
_NEEDED: Any = object()  # no value to take instead


@dataclasses.dataclass(frozen=True)
class Keys:
    """A mapping, and where it stands, for messages.

    Every method that takes a key has a last argument `instead`, the value of a key that is missing
    or null; without it such a key is refused.

    Parameters
    ----------
    values : mapping
        What a parser gave; refused if it is something else.
    where : str
        The file.
    name : str
        Keys that lead to the mapping in the file, apart by dots.

    Examples
    --------
    >>> card = Keys({"budget": {"steps": 1000}}, "card.json")
    >>> card.table("budget").whole("steps", low=1)
    1000
    >>> card.table("budget").text("steps")
    Traceback (most recent call last):
        ...
    ship_gym.config.ConfigError: card.json: budget.steps = 1000: must be a text
    """

    values: Mapping[str, Any]
    where: str
    name: str = ""

    def __post_init__(self):
        if not isinstance(self.values, Mapping):
            what = f": {self.name}" if self.name else ""
            raise ConfigError(f"{self.where}{what} = {shown(self.values)}: must be a table of keys")

    def label(self, key: str) -> str:
        """File and key, for a message."""
        return f"{self.where}: {self.name}{'.' if self.name else ''}{shown(key, 80).strip(chr(39))}"

    def value(self, key: str, instead: Any = _NEEDED) -> Any:
        """Whatever stands there."""
        found = self.values.get(key)
        if found is not None:
            return found
        if instead is not _NEEDED:
            return instead
        if key in self.values:
            raise ConfigError(f"{self.label(key)} = null: must have a value")
        within = f" in {self.name}" if self.name else ""
        raise ConfigError(f"{self.where}: missing key {key!r}{within};{nearest(key, self.values)}")

    def _of_type(self, key: str, kinds: type, what: str, instead: Any) -> Any:
        found = self.value(key, instead)
        if found is not instead and not isinstance(found, kinds):
            raise ConfigError(f"{self.label(key)} = {shown(found)}: must be {what}")
        return found

    def table(self, key: str, instead: Any = _NEEDED) -> Keys:
        """A table of keys."""
        inner = f"{self.name}{'.' if self.name else ''}{key}"
        return Keys(self.value(key, instead), self.where, inner)

    def tables(self, instead: Any = _NEEDED) -> Iterator[tuple[str, Keys]]:
        """Every key with the table that stands there."""
        return ((str(key), self.table(key, instead)) for key in self.values)

    def text(self, key: str, instead: Any = _NEEDED) -> str:
        """A text."""
        return self._of_type(key, str, "a text", instead)

    def known(self, key: str, known: Iterable[str], instead: Any = _NEEDED) -> str:
        """One of the texts of `known`."""
        found = self.text(key, instead)
        if found is not instead and found not in (known := list(known)):
            raise ConfigError(f"{self.label(key)} = {shown(found)}:{nearest(found, known)}")
        return found

    def items(self, key: str, instead: Any = _NEEDED) -> list[Any]:
        """A list of whatever."""
        return self._of_type(key, list, "a list", instead)

    def number(
        self,
        key: str,
        low: float = -math.inf,
        high: float = math.inf,
        unit: str = "-",
        instead: Any = _NEEDED,
    ) -> float:
        """A finite number within [low, high]."""
        found = self.value(key, instead)
        return found if found is instead else _number(self.label(key), found, low, high, unit)

    def whole(
        self, key: str, low: float = -math.inf, high: float = math.inf, instead: Any = _NEEDED
    ) -> int:
        """A whole number within [low, high]."""
        found = self.number(key, low, high, instead=instead)
        if found is instead:
            return found
        if not isinstance(self.values[key], int):
            raise ConfigError(f"{self.label(key)} = {shown(found)}: must be a whole number")
        return self.values[key]

    def numbers(
        self, key: str, low: float = -math.inf, high: float = math.inf, instead: Any = _NEEDED
    ) -> list[float]:
        """A list of finite numbers within [low, high]."""
        found = self.items(key, instead)
        if found is instead:
            return found
        return [_number(f"{self.label(key)}[{k}]", v, low, high) for k, v in enumerate(found)]

    def build(self, cls: type[T]) -> T:
        """A dataclass by ``config.build``; keys that are no fields of it are passed over."""
        kind: Any = cls
        known = {field.name for field in dataclasses.fields(kind)}
        where = f"{self.where}: {self.name}" if self.name else self.where
        return build(cls, {key: v for key, v in self.values.items() if key in known}, where)


# results, which may be the rounding of a zero
_number = functools.partial(check_number, tiny=True)


def read_keys(path: str | os.PathLike) -> Keys:
    """Keys of a JSON file that holds an object."""
    return Keys(read_json(path), str(path))
