"""Spectra in netCDF, of buoys and of hindcasts: the one door to xarray.

Variables are found by their CF ``standard_name``, else by the names of WAVEWATCH III and
wavespectra (``efth``), SWAN (``density``), ERA5 (``d2fd``), NDBC (``spectral_wave_density``) and
CDIP (``waveEnergyDensity``). ``units`` are read, and refused where they are missing. Whether a
direction is one from which waves come or one to which they go is said by its ``standard_name``
(``..._from_direction``, ``..._to_direction``); NDBC, CDIP (from) and ERA5 (to) are known. Any other
file needs the argument ``directions``.

ERA5 keeps log10 of the density [m2/Hz/rad], missing where there is none, and numbers its bins from
1: direction k goes to (k - 1/2) 360 / D degrees, frequency k is 0.03453 Hz 1.1^(k - 1) (ECMWF,
About ERA wave spectra).

Of several spectra one is picked: ``"time=2020-02-01T06:00, station=3"`` takes the nearest value of
each named dimension, ``"time=#0"`` the place in the file from 0 on.
"""

from __future__ import annotations

import io
import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, nearest, shown, told_of
from ship_gym.reading import read_as, read_bytes
from ship_gym.sea.measured import MeasuredSpectrum, of_directions, of_moments
from ship_gym.sea.spectrum_files import check_spread, r_1_of, to_way

_DENSITY_2 = ("sea_surface_wave_directional_variance_spectral_density",)
_DENSITY_1 = ("sea_surface_wave_variance_spectral_density",)
_NAMES_2 = ("efth", "d2fd", "density")
_NAMES_1 = ("spectral_wave_density", "waveEnergyDensity", "ef", "efth", "density")
_FREQUENCY = ("frequency", "freq", "waveFrequency", "f")
_DIRECTION = ("direction", "dir", "directions", "theta", "waveDirection")
_MEAN = ("mean_wave_dir", "waveMeanDirection", "th1m")
_WIDTH = ("wave_spectrum_r1", "sth1m")
_KNOWN_FROM = ("mean_wave_dir", "waveMeanDirection")
_DEG = ("deg", "degree", "degrees", "degrees_true", "degree_true", "degreet")
_RAD = ("rad", "radian", "radians")
_HZ = ("hz", "hertz", "s-1", "1/s", "s^-1", "cycles/s")
_RAD_S = ("rad/s", "rad s-1", "radian/s", "radians/s", "rad s^-1")
_WORDS = (("m", "m|met(er|re)s?"), ("s", "s|sec|seconds?|hz|hertz"), ("rad", "rad|radians?"),
          ("deg", "deg|degr|degrees?"))  # fmt: skip
_NO_ENERGY = 1e-6  # of the largest density
_ERA5_FIRST, _ERA5_RATIO, _ERA5_COUNT = 0.03453, 1.1, 30


def read_netcdf(path: str | Path, pick: str, directions: str) -> MeasuredSpectrum:
    """Spectrum of a file; arguments and errors as in ``sea.spectrum_files.read_spectrum``."""
    with told_of(path), _opened(path) as data:
        density, two = _density(data)
        chosen = _picked(density, pick)
        if two:
            return _of_two(data, chosen, directions)
        return _of_one(data, chosen, pick, directions)


def _opened(path: str | Path) -> Any:
    """An open xarray.Dataset: netCDF 3 through scipy, netCDF 4 through h5netcdf; from memory."""
    data = read_bytes(path)
    try:
        import h5netcdf  # noqa: F401  what xarray needs for netCDF 4
        import xarray
    except ImportError:
        raise ImportError(
            'spectra in netCDF need xarray and h5netcdf: pip install "ship-gym[spectra]"'
        ) from None
    if data[:3] == b"CDF":
        engine = "scipy"
    elif data[:8] == b"\x89HDF\r\n\x1a\n":
        engine = "h5netcdf"
        _check_alone(data, path)
    else:
        raise ConfigError(f"{path}: begins with {shown(data[:8])}: allowed is netCDF 3 or 4")
    with read_as(path, "a netCDF file"):
        return xarray.open_dataset(io.BytesIO(data), engine=engine, decode_timedelta=False)


def _check_alone(data: bytes, path: str | Path) -> None:
    """Refuse HDF5 whose data lie in other files."""
    import h5py

    with read_as(path, "a netCDF file"), h5py.File(io.BytesIO(data), "r") as file:
        for name in file:
            if isinstance(file.get(name, getlink=True), h5py.ExternalLink):
                raise ConfigError(f"{path}: {shown(name)} lies in another file, which is not read")
            one = file[name]
            if isinstance(one, h5py.Dataset) and (one.external or one.is_virtual):
                raise ConfigError(f"{path}: {shown(name)} lies in another file, which is not read")


def _standard(variable: Any) -> str:
    return str(variable.attrs.get("standard_name", ""))


def _has(data: Any, dims: tuple, names: tuple[str, ...], ends: str) -> str | None:
    """Dimension whose coordinate has one of some names, or a standard name that ends so."""
    for dim in map(str, dims):
        if dim in names or (dim in data.coords and _standard(data[dim]).endswith(ends)):
            return dim
    return None


def _density(data: Any) -> tuple[Any, bool]:
    """The variance density, and whether it is over directions too."""
    for standard, names, two in ((_DENSITY_2, _NAMES_2, True), (_DENSITY_1, _NAMES_1, False)):
        for name in [*data.data_vars]:
            variable = data[name]
            direction = _has(data, variable.dims, _DIRECTION, "_direction")
            frequency = _has(data, variable.dims, _FREQUENCY, "wave_frequency")
            wanted = _standard(variable) in standard or str(name) in names
            if wanted and frequency and bool(direction) == two:
                return variable, two
    raise ConfigError(
        "no variable of a wave spectrum over frequency: allowed is the standard_name "
        f"{_DENSITY_2[0]}, or one of {', '.join((*_NAMES_2, *_NAMES_1[:2]))}"
    )


def _picked(variable: Any, pick: str) -> Any:
    """One spectrum of a variable: no dimension is left but frequency and direction."""
    wanted = {}
    for part in filter(None, (part.strip() for part in pick.split(","))):
        name, equal, value = part.partition("=")
        if not equal:
            raise ConfigError(f"pick = {shown(pick)}: allowed is as 'time=2020-02-01, station=#0'")
        wanted[name.strip()] = value.strip()
    kept = {
        _has(variable, variable.dims, _FREQUENCY, "wave_frequency"),
        _has(variable, variable.dims, _DIRECTION, "_direction"),
    }
    rest = [str(dim) for dim in variable.dims if str(dim) not in kept]
    for name in wanted:
        if name not in rest:
            raise ConfigError(f"pick: no dimension {shown(name)};{nearest(name, rest)}")
    for dim in rest:
        if dim in wanted:
            variable = _taken(variable, dim, wanted[dim])
        elif variable.sizes[dim] == 1:
            variable = variable.isel({dim: 0})
        else:
            raise ConfigError(
                f"{variable.name} has {variable.sizes[dim]} of dimension {dim!r}: pick one, as "
                f"pick = '{dim}=#0'"
            )
    return variable


def _taken(variable: Any, dim: str, value: str) -> Any:
    count = variable.sizes[dim]
    if re.fullmatch(r"#\d{1,9}", value):
        if int(value[1:]) >= count:
            raise ConfigError(f"pick: {dim} = {value}: allowed is #0 to #{count - 1}")
        return variable.isel({dim: int(value[1:])})
    if dim not in variable.coords:
        raise ConfigError(f"pick: {dim} = {shown(value)}: it has no values; allowed is #0 to "
                          f"#{count - 1}")  # fmt: skip
    axis = variable[dim].values
    try:
        time = axis.dtype.kind == "M"
        at = np.datetime64(value).astype(axis.dtype) if time else float(value)
        away = np.abs(axis - at)
        if np.isnat(away).all() if time else not np.isfinite(away).any():
            raise ValueError
    except (ValueError, TypeError):
        kind = "an instant as 2020-02-01T06:00" if axis.dtype.kind == "M" else "a number"
        raise ConfigError(f"pick: {dim} = {shown(value)}: allowed is {kind} or #0 to "
                          f"#{count - 1}") from None  # fmt: skip
    return variable.isel({dim: int(np.argmin(away))})


def _unit(variable: Any, allowed: tuple[tuple[tuple[str, ...], float], ...]) -> float:
    """Factor to SI of a variable with one of some units."""
    given = variable.attrs.get("units")
    text = " ".join(str(given).lower().split())
    for names, factor in allowed:
        if text in names:
            return factor
    known = ", ".join(names[0] for names, _ in allowed)
    raise ConfigError(f"{variable.name}: units = {shown(given)}: allowed is {known}")


def _angles(variable: Any) -> np.ndarray:
    return _numbers(variable) * _unit(variable, ((_DEG, math.pi / 180.0), (_RAD, 1.0)))


def _frequencies(variable: Any) -> np.ndarray:
    return _numbers(variable) * _unit(variable, ((_HZ, 1.0), (_RAD_S, 0.5 / math.pi)))


def _numbers(variable: Any) -> np.ndarray:
    if variable.dtype.kind not in "fiu":
        raise ConfigError(f"{variable.name} is of type {variable.dtype}: allowed are numbers")
    with read_as(str(variable.name), "numbers of a netCDF file"):
        return np.asarray(variable.values, dtype=float)


def density_factor(units: object, two: bool) -> float | None:
    """Factor from the unit of a density to m2/Hz, or m2/Hz/rad of a two-dimensional one; or None.

    Per hertz is also written as times a second.
    """
    text = str(units).lower()
    words = re.findall("[a-z]+", text)
    kinds = [next((k for k, form in _WORDS if re.fullmatch(form, w)), "?") for w in words]
    rad, deg = kinds.count("rad"), kinds.count("deg")
    square = kinds.count("m") == 2 or re.match(r"\W*[a-z]+\W*2", text)
    rate = re.search(r"/\s*s|s\W*-\W*1", text) and not rad  # m2/s is none
    if "?" in kinds or kinds[:1] != ["m"] or not square or "s" not in kinds or rate:
        return None
    of = (
        {(1, 0): 1.0, (0, 1): 180.0 / math.pi, (2, 0): 2.0 * math.pi}
        if two
        else {(0, 0): 1.0, (1, 0): 2.0 * math.pi}
    )
    return of.get((rad, deg))


def _energy(variable: Any, two: bool) -> np.ndarray:
    """Numbers of the density in m2/Hz or m2/Hz/rad."""
    units = variable.attrs.get("units")
    factor = density_factor(units, two)
    if factor is None:
        allowed = "m2 s rad-1, m2/Hz/deg" if two else "m2/Hz, m2 s, m2 s rad-1 (per rad/s)"
        raise ConfigError(f"{variable.name}: units = {shown(units)}: allowed is {allowed}")
    return _numbers(variable) * factor


def _way(variable: Any, directions: str) -> str:
    """Whether directions are from or to."""
    if directions:
        return directions
    if str(variable.name) in _KNOWN_FROM:
        return "from"
    said = re.search(r"(from|to)_direction$", _standard(variable))
    if said is None:
        raise ConfigError(
            f"{variable.name}: standard_name = {shown(variable.attrs.get('standard_name'))} does "
            "not say whether waves come from or go to it: give directions = 'from' or 'to'"
        )
    return said[1]


def _of_two(data: Any, chosen: Any, directions: str) -> MeasuredSpectrum:
    frequency = _has(data, chosen.dims, _FREQUENCY, "wave_frequency")
    direction = _has(data, chosen.dims, _DIRECTION, "_direction")
    chosen = chosen.transpose(frequency, direction)
    if str(chosen.name) == "d2fd":
        f, to, energy = _era5(data, chosen, frequency, direction)
    else:
        f = _frequencies(_coordinate(data, frequency))
        axis = _coordinate(data, direction)
        to, energy = to_way(_angles(axis), _way(axis, directions)), _energy(chosen, True)
    _check_finite(chosen, energy)
    order = np.argsort(f)
    return of_directions(f[order], to, energy[order])


def _coordinate(data: Any, name: str) -> Any:
    if name not in data.variables:
        raise ConfigError(f"dimension {name!r} has no values")
    return data[name]


def _era5(data: Any, chosen: Any, frequency: str, direction: str) -> tuple:
    """Frequencies [Hz], directions to [rad] and density [m2/Hz/rad] of ECMWF's own form."""
    values = _numbers(chosen)
    if np.nanmin(values, initial=0.0) < 0.0:  # no density is negative: log10
        values = 10.0**values
    values = np.where(np.isnan(values), 0.0, values)
    count, bins = values.shape
    if _numbered(data, frequency):
        if count != _ERA5_COUNT:
            raise ConfigError(f"{frequency}: {count} numbers and no frequencies: allowed are the "
                              f"{_ERA5_COUNT} of ERA5, or frequencies with units")  # fmt: skip
        f = _ERA5_FIRST * _ERA5_RATIO ** np.arange(count)
    else:
        f = _frequencies(data[frequency])
    if _numbered(data, direction):
        return f, 2.0 * math.pi * (np.arange(bins) + 0.5) / bins, values
    return f, _angles(data[direction]), values


def _numbered(data: Any, name: str) -> bool:
    """Whether the bins of a dimension have numbers from 1 on, or none, instead of values."""
    if name not in data.variables:
        return True
    values = np.asarray(data[name].values)
    return bool(np.array_equal(values, np.arange(1, len(values) + 1)))


def _of_one(data: Any, chosen: Any, pick: str, directions: str) -> MeasuredSpectrum:
    frequency = _has(data, chosen.dims, _FREQUENCY, "wave_frequency")
    f, energy = _frequencies(_coordinate(data, frequency)), _energy(chosen, False)
    _check_finite(chosen, energy)
    mean = _beside(data, frequency, _MEAN, r"wave_(mean_)?(from|to)_direction$")
    width = _beside(data, frequency, _WIDTH, r"directional_spread$")
    moments = [_beside(data, frequency, (name,), "^$") for name in ("waveA1Value", "waveB1Value")]
    if mean is None or (width is None and any(one is None for one in moments)):
        return MeasuredSpectrum(tuple(f), tuple(energy))
    to = to_way(_angles(_picked(mean, pick)), _way(mean, directions))
    if width is None:
        r_1 = np.hypot(*(_numbers(_picked(one, pick)) for one in moments))
    elif str(width.name) == "wave_spectrum_r1":
        r_1 = _numbers(_picked(width, pick))
    else:
        r_1 = r_1_of(check_spread(_angles(_picked(width, pick))))
    empty = energy <= _NO_ENERGY * energy.max()  # a direction of no energy may be missing
    to, r_1 = np.where(empty & np.isnan(to), 0.0, to), np.where(empty & np.isnan(r_1), 0.0, r_1)
    _check_finite(mean, to)
    _check_finite(mean if width is None else width, r_1)
    return of_moments(f, energy, to, r_1)


def _beside(data: Any, frequency: str, names: tuple[str, ...], standard: str) -> Any:
    """A variable over frequency alone, by name or standard name; None: there is none."""
    for name in data.variables:
        variable = data[name]
        wanted = str(name) in names or re.search(standard, _standard(variable) or "-")
        if wanted and frequency in variable.dims and str(name) != frequency:
            return variable
    return None


def _check_finite(variable: Any, values: np.ndarray) -> None:
    for index in np.argwhere(~np.isfinite(values)):
        place = ", ".join(map(str, index))
        raise ConfigError(
            f"{variable.name}[{place}] = {values[tuple(index)]}: allowed is a finite number"
        )
