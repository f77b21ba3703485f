"""``reset(options=...)``: what an episode starts with instead of drawing it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known, check_number

# option -> shape of one value, lowest, highest, unit
_OPTIONS: dict[str, tuple[tuple[int, ...], float, float, str]] = {
    "heading_error_deg": ((), -180.0, 180.0, "deg"),
    "speed": ((), -100.0, 100.0, "m/s"),
    "position": ((2,), -1e7, 1e7, "m"),
    "sea_seed": ((), 0, 2**63 - 1, "-"),
}


def start_options(
    options: Mapping[str, Any] | None, n: int, also: tuple[str, ...] = ()
) -> dict[str, np.ndarray]:
    """Options of a reset as arrays over n environments.

    Parameters
    ----------
    options : mapping or None
        ``heading_error_deg`` of the heading less the ordered one or the bearing of the first leg;
        ``speed`` through the water [m/s]; ``position`` north and east [m]; ``sea_seed``: current,
        waves, wind and their phases are those of the episode of that seed (directions that the
        scenario gives as encounter angles count from this episode's order). One value for all
        environments, or one for each.
    n : int
        Number of environments.
    also : tuple of str
        Options that the caller reads itself.

    Returns
    -------
    dict of str to numpy.ndarray
        Shape (n, ...), of what is given.

    Raises
    ------
    ConfigError
        An unknown option, a wrong number of values, a value that is not allowed.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ConfigError(f"options = {options!r}: must be a mapping of names to values")
    for name in options:
        check_known("option of reset", name, [*_OPTIONS, *also])
    return {name: _rows(name, options[name], n) for name in options if name in _OPTIONS}


def _rows(name: str, given: Any, n: int) -> np.ndarray:
    shape, low, high, unit = _OPTIONS[name]
    try:
        values = np.asarray(given)
    except ValueError:
        values = np.array(None)
    if values.dtype.kind not in "iuf" or values.shape not in (shape, (n, *shape)):
        one = "one number" if not shape else f"{shape[0]} numbers"
        each = "" if n == 1 else f", or that for each of the {n} environments"
        raise ConfigError(f"options[{name!r}] = {given!r}: must be {one} [{unit}]{each}")
    whole = name == "sea_seed"
    if whole and values.dtype.kind not in "iu":
        raise ConfigError(f"options[{name!r}] = {given!r}: must be a whole number")
    for value in values.ravel().tolist():
        check_number(f"options[{name!r}]", value, low, high, unit)
    values = values if whole else values.astype(np.float64)
    return np.broadcast_to(values, (n, *shape))
