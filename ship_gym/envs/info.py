"""The info of a step, built when somebody looks: a dict that computes what is asked for.

A step keeps one copy of the bytes that an info may show; the dict of names and arrays, which costs
more than the copy, is made of it when it is asked for.
"""

from __future__ import annotations

import copy as copies
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

# An entry that nobody can name: json's C code asks for the items only where a dict is not empty.
_WAITING = object()
_LINE = 64  # bytes, to a multiple of which each array begins


class Info(dict):
    """A dict whose first entries are built when they are asked for; each looks as if it were there.

    To Gymnasium and its wrappers it is a dict: it may be written to, copied, compared, joined; a
    copy and what is pickled are plain dicts with everything in them.

    Parameters
    ----------
    names : iterable of str
        In their order; held, not copied.
    build : callable
        ``build(name)`` gives the value of an entry, a new one at each call.
    """

    __slots__ = ("_build", "_names")

    def __init__(self, names: Collection[str], build: Callable[[str], Any]):
        self._names: Collection[str] = names
        self._build: Callable[[str], Any] | None = build
        dict.__setitem__(self, _WAITING, None)

    def __missing__(self, name: Any) -> Any:
        if not self._waits(name):
            raise KeyError(name)
        assert self._build is not None  # as something waits
        value = self._build(name)
        dict.__setitem__(self, name, value)
        return value

    def _waits(self, name: Any) -> bool:
        """Whether an entry is to be built yet."""
        return name in self._names and not dict.__contains__(self, name)

    def _whole(self) -> Info:
        """Itself, with everything built: a dict like others from now on."""
        if self._build is not None:
            there = dict(dict.items(self))
            del there[_WAITING]
            built = {k: there.pop(k) if k in there else self._build(k) for k in self._names}
            dict.clear(self)
            dict.update(self, built | there)
            self._names, self._build = (), None
        return self

    def __contains__(self, name: object) -> bool:
        return dict.__contains__(self, name) or name in self._names

    def get(self, name: Any, default: Any = None) -> Any:
        """As ``dict.get``."""
        return self[name] if name in self else default

    def setdefault(self, name: Any, default: Any = None) -> Any:
        """As ``dict.setdefault``."""
        if name not in self:
            self[name] = default
        return self[name]

    def __iter__(self):  # what makes dict(info), {**info} and other.update(info) ask for the values
        return dict.__iter__(self._whole())

    def __reversed__(self):
        return dict.__reversed__(self._whole())

    def __len__(self) -> int:
        return dict.__len__(self._whole())

    def __eq__(self, other: object) -> bool:
        return dict.__eq__(self._whole(), _plain(other))

    def __ne__(self, other: object) -> bool:
        return dict.__ne__(self._whole(), _plain(other))

    __hash__ = None

    def __or__(self, other):
        return dict.__or__(self.copy(), _plain(other))

    def __ror__(self, other):
        return dict.__or__(_plain(other), self.copy())

    def __ior__(self, other):
        self.update(other)
        return self

    def __delitem__(self, name: Any) -> None:
        dict.__delitem__(self._whole(), name)

    def keys(self):
        """As ``dict.keys``."""
        return dict.keys(self._whole())

    def values(self):
        """As ``dict.values``."""
        return dict.values(self._whole())

    def items(self):
        """As ``dict.items``."""
        return dict.items(self._whole())

    def pop(self, *args: Any) -> Any:
        """As ``dict.pop``."""
        return dict.pop(self._whole(), *args)

    def popitem(self) -> tuple[Any, Any]:
        """As ``dict.popitem``."""
        return dict.popitem(self._whole())

    def clear(self) -> None:
        """As ``dict.clear``."""
        dict.clear(self._whole())

    def copy(self) -> dict[str, Any]:
        """A plain dict."""
        return dict(dict.items(self._whole()))

    __copy__ = copy

    def __deepcopy__(self, memo: dict) -> dict[str, Any]:
        if self._build is None:
            return copies.deepcopy(self.copy(), memo)
        made = Info(self._names, self._build)  # builds new values for itself
        for name, value in dict.items(self):
            if name is not _WAITING:
                dict.__setitem__(made, name, copies.deepcopy(value, memo))
        return made

    def __reduce_ex__(self, protocol: Any):
        return dict, (self.copy(),)

    def __repr__(self) -> str:
        return dict.__repr__(self._whole())


def _plain(other: Any) -> Any:
    return other._whole() if isinstance(other, Info) else other


class _Place(NamedTuple):
    """Where an array lies: in which source, and from which byte on with which shape."""

    source: int
    offset: int
    shape: tuple[int, ...]
    dtype: np.dtype
    strides: tuple[int, ...]


class Layout:
    """Where the values of an info lie in the arrays of a batch.

    Parameters
    ----------
    buffer : numpy.ndarray
        Bytes of `side_by_side`.
    groups : mapping
        Of an entry that is a dict: names, and an array (n, number of names, ...).
    columns : mapping
        Of an entry that is a value: an array (n,).
    """

    def __init__(
        self,
        buffer: np.ndarray,
        groups: Mapping[str, tuple[Sequence[str], np.ndarray]],
        columns: Mapping[str, np.ndarray],
    ):
        self._sources = [buffer]
        self.groups = {key: tuple(names) for key, (names, _) in groups.items()}
        arrays = {key: array for key, (_, array) in groups.items()} | dict(columns)
        self._places = {key: self._place(array) for key, array in arrays.items()}
        self.names = dict.fromkeys(arrays)
        self.masked_names = dict.fromkeys(k for name in arrays for k in (name, f"_{name}"))

    def _place(self, array: np.ndarray) -> _Place:
        buffer = self._sources[0]
        offset = array.ctypes.data - buffer.ctypes.data
        if 0 <= offset < buffer.nbytes:
            return _Place(0, offset, array.shape, array.dtype, array.strides)
        self._sources.append(array)
        return _Place(len(self._sources) - 1, 0, (), array.dtype, ())

    def sources(self, copy: bool = True) -> list[np.ndarray]:
        """What the values are read from: copies, or the arrays of the batch themselves."""
        return [source.copy() for source in self._sources] if copy else self._sources

    def read(self, key: str, sources: list[np.ndarray]) -> np.ndarray:
        """Array of an entry, (n, ...), a view."""
        place = self._places[key]
        if place.source:
            return sources[place.source]
        return np.ndarray(place.shape, place.dtype, sources[0], place.offset, place.strides)


def side_by_side(arrays: Mapping[str, np.ndarray]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Copies of arrays in one buffer.

    Returns
    -------
    buffer : numpy.ndarray
        Bytes.
    views : dict
        The arrays in it, by name.
    """
    sizes = [math.ceil(array.nbytes / _LINE) * _LINE for array in arrays.values()]
    buffer, views, offset = np.zeros(sum(sizes), np.uint8), {}, 0
    for (name, array), size in zip(arrays.items(), sizes, strict=True):
        views[name] = np.ndarray(array.shape, array.dtype, buffer, offset)
        views[name][...] = array
        offset += size
    return buffer, views


def info_of_one(layout: Layout, i: int, copy: bool = True) -> Info:
    """Info of episode i in plain numbers."""
    sources = layout.sources(copy)

    def build(key: str) -> Any:
        array = layout.read(key, sources)
        names = layout.groups.get(key)
        if names is None:
            return array.item(i)
        row = list(array[i].copy()) if array.ndim > 2 else array[i].tolist()
        return dict(zip(names, row, strict=True))

    return Info(layout.names, build)


def info_of_all(
    layout: Layout, mask: np.ndarray, only: Mapping[str, np.ndarray], copy: bool = True
) -> Info:
    """Info of a batch in Gymnasium's form: each key with a ``_key`` mask.

    Parameters
    ----------
    layout : Layout
    mask : numpy.ndarray
        Of whom, bool (n,); rows of the others are zero.
    only : mapping
        Names in groups that not all have, and who has them, bool (n,).
    copy : bool
        Whether the values are those of now, or those of the time when they are looked at.
    """
    sources = layout.sources(copy)

    def masked(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
        if not rows.all():
            values = values.copy()
            values[~rows] = 0
        return values

    def build(key: str) -> Any:
        if key not in layout.names:
            return mask
        array = layout.read(key, sources).copy()
        names = layout.groups.get(key)
        if names is None:
            return masked(array, mask)
        found = {}
        for k, name in enumerate(names):
            rows = mask & only[name] if name in only else mask
            found[name], found[f"_{name}"] = masked(array[:, k], rows), rows
        return found

    return Info(layout.masked_names, build)
