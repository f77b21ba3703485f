"""Spectra in netCDF, of buoys and of hindcasts: variables by name and standard name.

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

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, nearest, shown, told_of
from ship_gym.sea.hdf5_child import can_read_apart, read_apart
from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.measured_forms import check_spread, of_directions, of_moments, r_1_of
from ship_gym.sea.netcdf_file import check_installed, is_hdf5, open_netcdf
from ship_gym.sea.netcdf_values import (
    angles,
    bearings,
    check_finite,
    check_r_1,
    energy_of,
    frequencies,
    numbers,
    standard_name,
    way_of,
)
from ship_gym.sea.spectrum_files import to_way

_DENSITY_2 = ("sea_surface_wave_directional_variance_spectral_density",)
_DENSITY_1 = ("sea_surface_wave_variance_spectral_density",)
_NAMES_2 = ("efth", "d2fd", "density")
_NAMES_1 = ("spectral_wave_density", "waveEnergyDensity", "ef", "efth", "density")
_FREQUENCY = ("frequency", "freq", "waveFrequency", "f", "frequencyNumber")
_DIRECTION = ("direction", "dir", "directions", "theta", "waveDirection", "directionNumber")
_MEAN = ("mean_wave_dir", "waveMeanDirection", "th1m")
_WIDTH = ("wave_spectrum_r1", "sth1m")
_NO_ENERGY = 1e-6  # of the largest density
_ERA5_FIRST, _ERA5_RATIO, _ERA5_COUNT = 0.03453, 1.1, 30


def read_netcdf(path: str | Path, pick: str, directions: str) -> MeasuredSpectrum:
    """Spectrum of a file; arguments and errors as in ``sea.spectrum_files.read_spectrum``."""
    check_installed()
    if is_hdf5(path) and can_read_apart():
        return read_apart(path, pick, directions)
    return read_here(path, pick, directions)


def read_here(path: str | Path, pick: str, directions: str) -> MeasuredSpectrum:
    """As `read_netcdf`, by this process."""
    with told_of(path), open_netcdf(path) as data:
        density, two = _density(data)
        chosen = _picked(density, pick)
        if two:
            return _of_two(data, chosen, directions)
        return _of_one(data, chosen, pick, directions)


def _has(data: Any, dims: tuple, names: tuple[str, ...], ends: str) -> str | None:
    """Dimension whose coordinate has one of some names, or a standard name that ends so."""
    for dim in map(str, dims):
        if dim in names or (dim in data.coords and standard_name(data[dim]).endswith(ends)):
            return dim
    return None


def _dimension(data: Any, chosen: Any, names: tuple[str, ...], ends: str) -> str:
    """As `_has`, of the density, which was chosen because it has it."""
    found = _has(data, chosen.dims, names, ends)
    assert found is not None
    return found


def _density(data: Any) -> tuple[Any, bool]:
    """The variance density, and whether it is over directions too."""
    for standard, names, two in ((_DENSITY_2, _NAMES_2, True), (_DENSITY_1, _NAMES_1, False)):
        for name in [*data.data_vars]:
            variable = data[name]
            direction = _has(data, variable.dims, _DIRECTION, "_direction")
            frequency = _has(data, variable.dims, _FREQUENCY, "wave_frequency")
            wanted = standard_name(variable) in standard or str(name) in names
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


def _of_two(data: Any, chosen: Any, directions: str) -> MeasuredSpectrum:
    frequency = _dimension(data, chosen, _FREQUENCY, "wave_frequency")
    direction = _dimension(data, chosen, _DIRECTION, "_direction")
    chosen = chosen.transpose(frequency, direction)
    if str(chosen.name) == "d2fd":
        f, to, energy = _era5(data, chosen, frequency, direction)
    else:
        f = frequencies(_coordinate(data, frequency))
        axis = _coordinate(data, direction)
        to, energy = to_way(bearings(axis), way_of(axis, directions)), energy_of(chosen, True)
    check_finite(chosen, energy)
    order = np.argsort(f)
    return of_directions(f[order], to, energy[order])


def _coordinate(data: Any, name: str) -> Any:
    if name not in data.variables:
        raise ConfigError(f"dimension {name!r} has no values")
    return data[name]


def _era5(data: Any, chosen: Any, frequency: str, direction: str) -> tuple:
    """Frequencies [Hz], directions to [rad] and density [m2/Hz/rad] of ECMWF's own form."""
    values = numbers(chosen)
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
        f = frequencies(data[frequency])
    if _numbered(data, direction):
        return f, 2.0 * math.pi * (np.arange(bins) + 0.5) / bins, values
    return f, bearings(data[direction]), values


def _numbered(data: Any, name: str) -> bool:
    """Whether the bins of a dimension have numbers from 1 on, or none, instead of values."""
    if name not in data.variables:
        return True
    values = np.asarray(data[name].values)
    return bool(np.array_equal(values, np.arange(1, len(values) + 1)))


def _of_one(data: Any, chosen: Any, pick: str, directions: str) -> MeasuredSpectrum:
    frequency = _dimension(data, chosen, _FREQUENCY, "wave_frequency")
    f, energy = frequencies(_coordinate(data, frequency)), energy_of(chosen, False)
    check_finite(chosen, energy)
    mean = _beside(data, frequency, _MEAN, r"wave_(mean_)?(from|to)_direction$")
    width = _beside(data, frequency, _WIDTH, r"directional_spread$")
    moments = [_beside(data, frequency, (name,), "^$") for name in ("waveA1Value", "waveB1Value")]
    if mean is None or (width is None and any(one is None for one in moments)):
        return MeasuredSpectrum(tuple(f), tuple(energy))
    to = to_way(bearings(_picked(mean, pick)), way_of(mean, directions))
    if width is None:
        r_1 = np.hypot(*(numbers(_picked(one, pick)) for one in moments))
        check_r_1("length of waveA1Value, waveB1Value", r_1)
    elif str(width.name) == "wave_spectrum_r1":
        r_1 = check_r_1(width.name, numbers(_picked(width, pick)))
    else:
        r_1 = r_1_of(check_spread(angles(_picked(width, pick))))
    empty = energy <= _NO_ENERGY * energy.max()  # a direction of no energy may be missing
    to, r_1 = np.where(empty & np.isnan(to), 0.0, to), np.where(empty & np.isnan(r_1), 0.0, r_1)
    check_finite(mean, to)
    check_finite(mean if width is None else width, r_1)
    return of_moments(f, energy, to, r_1)


def _beside(data: Any, frequency: str, names: tuple[str, ...], standard: str) -> Any:
    """A variable over frequency alone, by name or standard name; None: there is none."""
    for name in data.variables:
        variable = data[name]
        wanted = str(name) in names or re.search(standard, standard_name(variable) or "-")
        if wanted and frequency in variable.dims and str(name) != frequency:
            return variable
    return None
