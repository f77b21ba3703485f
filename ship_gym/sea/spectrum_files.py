"""Files of measured and hindcast spectra: csv here, netCDF in ``sea.spectrum_netcdf``.

A csv has a row of column names with units in brackets, and after it a row for each frequency, or,
two-dimensional, for each pair of frequency and direction; lines that begin with ``#`` are passed
over. Columns:

- ``frequency [Hz]`` or ``[rad/s]``, and ``density``, one-dimensional in ``[m2/Hz]`` or
  ``[m2 s/rad]`` (per rad/s), two-dimensional in ``[m2/Hz/rad]`` or ``[m2/Hz/deg]``;
- ``direction_from`` (nautical, where waves come from, as buoys say it) or ``direction_to``
  (oceanographic), ``[deg]`` or ``[rad]`` clockwise from north: in a one-dimensional file the mean
  direction of each frequency, beside which stands ``spread [deg]``, the standard deviation of the
  directions, or ``r1 [-]``, the length of their mean unit vector;
- or ``a1_from [-]``, ``b1_from [-]`` (``_to``): north and east component of that vector.
"""

from __future__ import annotations

import functools
import math
import os
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, nearest, shown, told_of
from ship_gym.plain_csv import PlainCsv, read_plain_csv
from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.measured_forms import LONGEST_R_1, of_directions, of_moments, r_1_of

WAYS = ("from", "to")
_NETCDF = (".nc", ".nc3", ".nc4", ".cdf", ".netcdf")
_UNITS = {
    "frequency": {"Hz": 1.0, "rad/s": 0.5 / math.pi},
    "density": {"m2/Hz": 1.0, "m2 s/rad": 2.0 * math.pi},
    "direction": {"deg": math.pi / 180.0, "rad": 1.0},
    "spread": {"deg": math.pi / 180.0, "rad": 1.0},
    "r1": {"-": 1.0},
    "moment": {"-": 1.0},
}
_TURN = 6.28319  # [rad]
_OF_TWO = {"m2/Hz/rad": 1.0, "m2/Hz/deg": 180.0 / math.pi}
_KIND = {"direction_from": "direction", "direction_to": "direction"} | {
    f"{name}_{way}": "moment" for name in ("a1", "b1") for way in WAYS
}
_NAMES = ("frequency", "density", "spread", "r1", *_KIND)


def read_spectrum(path: str | Path, pick: str = "", directions: str = "") -> MeasuredSpectrum:
    """Read a spectrum.

    Parameters
    ----------
    path : path-like
        ``.csv``, or netCDF by its suffix: ``.nc``, ``.nc3``, ``.nc4``, ``.cdf``, ``.netcdf``.
    pick : str
        Of netCDF: which of several spectra, see ``sea.spectrum_netcdf``.
    directions : str
        Of netCDF: whether its directions are those ``"from"`` which waves come or ``"to"`` which
        they go, where the file does not say, or says it wrongly; empty: as the file says.

    Returns
    -------
    MeasuredSpectrum

    Raises
    ------
    ConfigError
        A file that is none; one line with the file, column or variable, the value and what is
        allowed.
    ImportError
        netCDF without xarray and h5netcdf.
    """
    suffix = Path(path).suffix.lower()
    if directions and directions not in WAYS:
        raise ConfigError(f"directions = {shown(directions)}: allowed is 'from' or 'to'")
    if suffix in _NETCDF:
        from ship_gym.sea.spectrum_netcdf import read_netcdf

        return read_netcdf(path, pick, directions)
    if suffix != ".csv":
        raise ConfigError(f"{path}: suffix {suffix!r}: allowed is .csv, {', '.join(_NETCDF)}")
    if pick or directions:
        given = f"pick = {shown(pick)}" if pick else f"directions = {shown(directions)}"
        raise ConfigError(f"{path}: {given}: a csv holds one spectrum and names its directions; "
                          "allowed of netCDF only")  # fmt: skip
    return _read_csv(path)


def read_again(path: str | Path, pick: str = "", directions: str = "") -> MeasuredSpectrum:
    """As `read_spectrum`, but a file that has not changed since is not read twice."""
    try:
        state = os.stat(path)
    except (OSError, ValueError):
        return read_spectrum(path, pick, directions)  # which says what is wrong
    return _kept(str(path), pick, directions, state.st_mtime_ns, state.st_size)


@functools.lru_cache(maxsize=16)
def _kept(path: str, pick: str, directions: str, *_: int) -> MeasuredSpectrum:
    return read_spectrum(path, pick, directions)


def _read_csv(path: str | Path) -> MeasuredSpectrum:
    table = read_plain_csv(path)
    titles = {}
    for title in table.columns:
        name, _, unit = title.partition("[")
        name, unit = name.strip(), unit.strip().removesuffix("]").strip()
        unit = unit.replace("^", "").replace("²", "2")
        if name not in _NAMES:
            raise ConfigError(f"{path}: unknown column {shown(title)};{nearest(name, _NAMES)}")
        if name in titles:
            raise ConfigError(f"{path}: column {shown(name)} is there twice")
        titles[name] = (title, unit)
    columns = _Columns(table, titles)
    with told_of(path):
        ways = [name for name in titles if name.startswith("direction_")]
        if len(ways) > 1:
            raise ConfigError("direction_from and direction_to: allowed is one of them")
        if titles.get("density", ("", ""))[1] in _OF_TWO:
            return _of_two(columns, ways)
        return _of_one(columns, ways)


class _Columns:
    """Columns of a file in SI, by name."""

    def __init__(self, table: PlainCsv, titles: dict[str, tuple[str, str]]):
        self.table, self.titles = table, titles

    def __contains__(self, name: str) -> bool:
        return name in self.titles

    def si(self, name: str, units: dict[str, float] | None = None) -> np.ndarray:
        """Numbers of a column in SI; a unit that is none of its kind is refused."""
        if name not in self.titles:
            raise ConfigError(f"no column {name!r};{nearest(name, self.titles)}")
        title, unit = self.titles[name]
        units = units or _UNITS[_KIND.get(name, name)]
        if unit not in units:
            also = list(_OF_TWO) if name == "density" else []
            allowed = ", ".join(f"[{u}]" for u in dict.fromkeys([*units, *also]))
            raise ConfigError(f"column {shown(title)}: allowed units are {allowed}")
        return self.table.numbers(title) * units[unit]

    def line(self, row: int) -> int:
        """Line of a row in the file."""
        return self.table.lines[row]

    def check(self, name: str, low: float, high: float) -> None:
        """Refuse a number outside its range, with its line."""
        title = self.titles[name][0]
        for row, value in enumerate(self.table.numbers(title)):
            if not low <= value <= high:
                raise ConfigError(
                    f"{self.table.path}:{self.line(row)}: {title} = {shown(float(value))}: allowed "
                    f"is {low:g} to {high:g}"
                )

    def check_angle(self, name: str, low: float, high: float) -> None:
        """Refuse an angle outside a range [rad], with its line, in the unit of its column."""
        unit = _UNITS["direction"][self.titles[name][1]]
        self.check(name, low / unit, high / unit)


def _towards(columns: _Columns, name: str) -> np.ndarray:
    """Where waves go to [rad]; more than a full turn, such as 999 for a missing one, is refused."""
    found = columns.si(name)
    columns.check_angle(name, -_TURN, _TURN)
    return to_way(found, name.rpartition("_")[2])


def _of_one(columns: _Columns, ways: list[str]) -> MeasuredSpectrum:
    f, density = columns.si("frequency"), columns.si("density")
    columns.check("density", 0.0, 1e6)
    for row in np.flatnonzero(np.diff(f) <= 0.0).tolist():
        raise ConfigError(
            f"{columns.table.path}:{columns.line(row + 1)}: frequency {f[row + 1]:.6g} Hz after "
            f"{f[row]:.6g} Hz: frequencies must rise"
        )
    for way in WAYS:
        if f"a1_{way}" in columns or f"b1_{way}" in columns:
            a, b = columns.si(f"a1_{way}"), columns.si(f"b1_{way}")
            for name in ("a1", "b1"):
                columns.check(f"{name}_{way}", -1.0, 1.0)
            r_1 = np.hypot(a, b)
            for row in np.flatnonzero(r_1 > LONGEST_R_1).tolist():
                raise ConfigError(
                    f"{columns.table.path}:{columns.line(row)}: a1, b1 have the length "
                    f"{r_1[row]:.6g}: allowed is 0 to 1"
                )
            return of_moments(f, density, to_way(np.arctan2(b, a), way), r_1)
    if not ways:
        _no_spread(columns)
        return MeasuredSpectrum(tuple(f), tuple(density))
    to = _towards(columns, ways[0])
    if "spread" in columns:
        columns.check_angle("spread", 0.0, math.sqrt(2.0))
        return of_moments(f, density, to, r_1_of(columns.si("spread")))
    columns.si("r1") if "r1" in columns else _no_width(ways[0])
    columns.check("r1", 0.0, 1.0)
    return of_moments(f, density, to, columns.si("r1"))


def _no_width(name: str) -> None:
    raise ConfigError(f"column {name!r} without 'spread [deg]' or 'r1 [-]': allowed is both, or "
                      "neither (long-crested)")  # fmt: skip


def _no_spread(columns: _Columns) -> None:
    for name in ("spread", "r1"):
        if name in columns:
            raise ConfigError(f"column {name!r} without 'direction_from [deg]' or 'direction_to "
                              "[deg]': allowed is both, or neither")  # fmt: skip


def _of_two(columns: _Columns, ways: list[str]) -> MeasuredSpectrum:
    f, density = columns.si("frequency"), columns.si("density", _OF_TWO)
    if not ways:
        raise ConfigError("density per direction without a column 'direction_from [deg]' or "
                          "'direction_to [deg]'")  # fmt: skip
    columns.check("density", 0.0, 1e6)
    to = _towards(columns, ways[0])
    frequencies, rows = np.unique(f, return_inverse=True)
    directions, places = np.unique(np.round(to % (2.0 * math.pi), 9), return_inverse=True)
    found = np.full((len(frequencies), len(directions)), np.nan)
    for row, (i, j) in enumerate(zip(rows.tolist(), places.tolist(), strict=True)):
        if not np.isnan(found[i, j]):
            raise ConfigError(f"{columns.table.path}:{columns.line(row)}: {f[row]:.6g} Hz and this "
                              "direction are there twice")  # fmt: skip
        found[i, j] = density[row]
    for i, j in np.argwhere(np.isnan(found)):
        raise ConfigError(
            f"no row of {frequencies[i]:.6g} Hz with the direction to {_deg(directions[j])} deg: "
            "allowed is every pair of frequency and direction"
        )
    return of_directions(frequencies, directions, found)


def _deg(to: float) -> str:
    return f"{math.degrees(to):.4g}"


def to_way(direction: np.ndarray, way: str) -> np.ndarray:
    """Directions to which waves go [rad]."""
    return direction + (math.pi if way == "from" else 0.0)
