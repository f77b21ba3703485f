"""A spectrum in HDF5 is read by a process of its own.

A damaged file may keep the HDF5 library in a loop for ever, or end the process that reads it. So a
child reads it, with a limit of time, and gives back plain numbers in JSON.
"""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

from ship_gym.config import ConfigError, build
from ship_gym.reading import parsed_json
from ship_gym.sea.measured import MeasuredSpectrum

LONGEST = 60.0  # [s]; a spectrum takes two
_CALL = "from ship_gym.sea.hdf5_child import answer; answer()"


def read_apart(path: str | Path, pick: str, directions: str) -> MeasuredSpectrum:
    """As ``sea.spectrum_netcdf.read_here``, by a child."""
    package = str(Path(__file__).parents[2])
    known = filter(None, (package, os.environ.get("PYTHONPATH")))
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", _CALL, os.fspath(path), pick, directions],
            env=os.environ | {"PYTHONPATH": os.pathsep.join(known)},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=LONGEST,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ConfigError(f"{path}: not a netCDF file, or damaged: the HDF5 library does not come "
                          f"back in {LONGEST:.0f} s") from None  # fmt: skip
    if done.returncode != 0:
        raise ConfigError(f"{path}: not a netCDF file, or damaged: its reader ended with code "
                          f"{done.returncode}")  # fmt: skip
    found = parsed_json(done.stdout, path)
    if "error" in found:
        raise ConfigError(found["error"])
    return build(MeasuredSpectrum, found, str(path))


def can_read_apart() -> bool:
    """Whether this process is Python, which can be started again, and not part of a program."""
    return "python" in Path(sys.executable or "").name.lower()


def answer() -> None:
    """In the child: read the file of the arguments, print its numbers or what is wrong."""
    from ship_gym.sea.spectrum_netcdf import read_here

    try:
        found = dataclasses.asdict(read_here(*sys.argv[1:4]))
    except ConfigError as error:
        found = {"error": str(error)}
    print(json.dumps(found))
