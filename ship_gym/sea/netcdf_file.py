"""Open a netCDF file: the one door to xarray."""

from __future__ import annotations

import io
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, shown
from ship_gym.reading import read_as, read_bytes

HDF5 = b"\x89HDF\r\n\x1a\n"  # what netCDF 4 begins with


def check_installed() -> None:
    """Refuse to go on without the libraries of netCDF."""
    if not (find_spec("xarray") and find_spec("h5netcdf")):
        raise ImportError(
            'spectra in netCDF need xarray and h5netcdf: pip install "ship-gym[spectra]"'
        )


def is_hdf5(path: str | Path) -> bool:
    """Whether a file is netCDF 4, which is HDF5."""
    return read_bytes(path)[:8] == HDF5


def open_netcdf(path: str | Path) -> Any:
    """An open xarray.Dataset: netCDF 3 through scipy, netCDF 4 through h5netcdf; from memory."""
    import xarray

    data = read_bytes(path)
    if data[:3] == b"CDF":
        engine = "scipy"
    elif data[:8] == HDF5:
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
