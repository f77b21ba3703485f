"""What is done with files of the tools of marine people, as ``_fuzz_use`` does with others."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import redirect_stdout, suppress
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from _fuzz_use import Nonsense, _finite, track


def route(path: Path, **_: Any) -> None:
    """Read, laid into the plane, a reset of an environment on it; written in each format again."""
    from ship_gym.tracks import load_route, save_track

    track(path)
    found = load_route(path)
    laid = found.track()
    _finite("way-points", laid.points)
    for suffix in (".rtz", ".gpx", ".geojson"):
        other = path.with_name(f"again{suffix}")
        save_track(found, other)
        again = load_route(other)
        if len(again.waypoints) != len(found.waypoints):
            raise Nonsense(f"{suffix}: other way-points than those that were written")


def spectrum(path: Path, pick: str = "", **_: Any) -> None:
    """Its moments, its waves, and the surface that they make."""
    import h5netcdf  # noqa: F401  loaded here, its forks have it
    import xarray  # noqa: F401

    from ship_gym.sea import hdf5_child, read_spectrum
    from ship_gym.sea.state import Sea

    with mock.patch.object(hdf5_child.subprocess, "run", _by_fork):
        found = read_spectrum(path, pick)
    _finite("height and period", [found.height, found.peak_period])
    if not 0.0 <= found.height < 100.0:
        raise Nonsense("waves of 100 m or more")
    sea = Sea(spectrum=found)
    _finite("elevation", sea.elevation(np.zeros(2), np.ones(2), 1.0, seed=0))


def _by_fork(command: list[str], timeout: float, **_: Any) -> subprocess.CompletedProcess:
    """As ``subprocess.run`` of the reader of HDF5, without the second that a start takes."""
    from ship_gym.sea.hdf5_child import answer

    with tempfile.TemporaryFile() as out:
        child = os.fork()
        if child == 0:
            with suppress(BaseException):
                sys.argv = ["-c", *command[4:]]
                with open(out.fileno(), "w", closefd=False) as text, redirect_stdout(text):
                    answer()
                os._exit(0)
            os._exit(1)
        end = time.monotonic() + timeout
        while not (status := os.waitpid(child, os.WNOHANG))[0]:
            if time.monotonic() > end:
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
                raise subprocess.TimeoutExpired(command, timeout)
            time.sleep(0.002)
        out.seek(0)
        return subprocess.CompletedProcess(
            command, os.waitstatus_to_exitcode(status[1]), out.read()
        )


def hull(path: Path, **_: Any) -> None:
    """The hull of KCS as it is, then coarsened."""
    from ship_gym.seakeeping.hull_file import read_hull

    _finite("vertices", read_hull(path, "kcs", panels=400).vertices)


@functools.cache
def _steered() -> Any:
    from ship_gym_agents import make_controller
    from ship_gym_agents.serve.vessel import SteeredShip

    return SteeredShip(make_controller("pid"), ship="kcs", duration=1e5)


def sentences(path: Path, **_: Any) -> None:
    """Every line is heard, and the ship sails by the orders among them."""
    from ship_gym_agents.serve.nmea import Dropped, read
    from ship_gym_agents.serve.orders import order_of

    ship = _steered()
    for line in path.read_bytes().split(b"\n"):
        try:
            order = order_of(read(line.strip()), apb=True)
        except Dropped as why:
            if len(str(why)) > 300:
                raise Nonsense("a line of more than 300 characters") from None
            continue
        if order is not None:
            _finite("order", order.angle)
            ship.obey(order)
            ship.sail()
    _finite("state", ship.batch.sim.state)
