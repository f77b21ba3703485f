"""Values that no file should hold, and the TOML text of any value."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np


class Raw(str):
    """A text that stands in a file as it is, without quotes."""


def _nested(depth: int) -> list:
    made: list = []
    for _ in range(depth):
        made = [made]
    return made


# Each is put in place of a value of a file, of whatever type that one is.
ODD: tuple[Any, ...] = (
    0, -0.0, 1, -1, 2, 1.0, -1.0, 0.5, 1e-3, 1e3, 1e6, -1e6, 1e-12, 1e-300, 5e-324, -1e-300, 1e30,
    1e300, -1e300, 1.7976931348623157e308, 2**31, 2**53 + 1, 2**63, -(2**63) - 1, 2**64, 10**18,
    10**400, -(10**400), Raw("9" * 5000), math.nan, math.inf, -math.inf, True, False, "", " ", "0",
    "1.0", "nan", "none", "kcs", "deg", "-", "a" * 1000, "\u00e9\u4e2d\U0001f6a2", "\x00", "a\nb",
    "\u202e", "../../etc/passwd", "/dev/zero", "/dev/null", "/", ".", "ship.toml", "C:\\con",
    "%s{}", [], {}, [[]], [{}], [0.0], [1.0, 0.0], [math.nan], ["a", 1], [1.0] * 200,
    {"value": 1.0},
    {"value": {}, "unit": {}}, {"": ""}, {"value": 1.0, "unit": "furlong"}, {"a": {"a": {"a": 1}}},
    _nested(60), Raw("[" * 50_000), Raw("2026-01-01"), Raw("00:00:00"), Raw("0x1F"), Raw("1_0"),
)  # fmt: skip
SCALES = (0.0, -1.0, 1e-3, 1e-2, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 100.0, 1e3, 1e6, 1e9, 1e-9, 1e20)


def odd(rng: np.random.Generator) -> Any:
    """A value that should not be there."""
    return ODD[rng.integers(len(ODD))]


def scaled(rng: np.random.Generator, value: int | float) -> int | float:
    """A number another size of which may be too large, too small or of the wrong sign."""
    if rng.random() < 0.2:
        return value + (1 if isinstance(value, int) else rng.normal())
    try:
        made = value * SCALES[rng.integers(len(SCALES))]
    except OverflowError:
        return value
    return int(made) if isinstance(value, int) and rng.random() < 0.7 else made


def toml(data: dict[str, Any]) -> str:
    """TOML of nested mappings: one inline value for each key of the top, which every reader takes.

    Tables stand inline, so that an odd value may stand anywhere.
    """
    return "".join(f"{_key(key)} = {_literal(value)}\n" for key, value in data.items())


def _key(name: str) -> str:
    plain = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if plain else _quoted(name)


def _quoted(text: str) -> str:
    return json.dumps(text).replace("\x7f", "\\u007f")


def _literal(value: Any) -> str:
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(str(k))} = {_literal(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_literal, value)) + "]"
    return repr(value) if isinstance(value, int | float) else str(value)  # str: of a date


def json_text(value: Any) -> str:
    """JSON of any value, raw texts as they are."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, dict):
        inner = ", ".join(f"{json.dumps(str(k))}: {json_text(v)}" for k, v in value.items())
        return "{" + inner + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(json_text, value)) + "]"
    return json.dumps(value)
