"""Tracks and routes from lists and files, and back to files: RTZ, GPX and GeoJSON.

A file in degrees holds a `Route`, whose legs run as its file says; `Route.track` lays it into the
plane that is sailed. Lists and GeoJSON that says ``"units": "m"`` are in metres from the start.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.charts import Chart
from ship_gym.config import ConfigError, check_known, shown, told_of
from ship_gym.tracks.geojson import read_geojson, write_geojson, write_metres
from ship_gym.tracks.gpx import read_gpx, write_gpx
from ship_gym.tracks.route import Route
from ship_gym.tracks.rtz import read_rtz, write_rtz
from ship_gym.tracks.track import Track
from ship_gym.tracks.waypoint import GEOMETRIES, Waypoint, check_count

_READERS: dict[str, Callable[..., Route | Track]] = {
    ".rtz": read_rtz,
    ".gpx": read_gpx,
    ".geojson": read_geojson,
    ".json": read_geojson,
}
_WRITERS = {".rtz": write_rtz, ".gpx": write_gpx, ".geojson": write_geojson, ".json": write_geojson}


def load_track(
    source: Track | Route | str | os.PathLike[str] | Sequence[Sequence[float]] | np.ndarray,
    geometry: str | None = None,
) -> Track:
    """Track from way-points, a route or a file.

    Parameters
    ----------
    source : Track, Route, list, array or path
        Way-points ``[north, east]`` [m], shape (W, 2), or a file: RTZ 1.0 to 1.2, GPX, GeoJSON.
    geometry : str, optional
        ``"loxodrome"`` or ``"orthodrome"``: legs of a file that says nothing of them. Rhumb lines
        without it.

    Returns
    -------
    Track
        In metres; of a file in degrees with its `route`, `chart` and `limits`.

    Raises
    ------
    ConfigError
        What `Track` and `Route` refuse, with the file's name; a file that cannot be read or is
        not as its format wants it; more than 20,000 way-points.
    ImportError
        Degrees without pyproj, XML without defusedxml; names the extra to install.
    """
    if isinstance(source, Track):
        return source
    if isinstance(source, Route):
        return source.track()
    if not isinstance(source, str | os.PathLike):
        check_count(len(source) if isinstance(source, Sequence | np.ndarray) else 0)
        points: Any = source
        return Track(points)
    found = _read(source, geometry)
    with told_of(Path(source)):
        return found.track() if isinstance(found, Route) else found


def load_route(
    path: str | os.PathLike, geometry: str | None = None, name: str | None = None
) -> Route:
    """Route of a file in degrees, as `load_track` reads one.

    `name` picks one of several routes or tracks of a GPX file.

    Raises
    ------
    ConfigError, ImportError
        As `load_track`; a file in metres.
    """
    found = _read(path, geometry, name)
    if isinstance(found, Track):
        raise ConfigError(
            f"{path}: is in metres; a route needs latitudes and longitudes "
            "(ship-gym route --origin LATITUDE LONGITUDE gives it a place)"
        )
    return found


def save_track(
    track: Track | Route, path: str | os.PathLike, origin_deg: tuple[float, float] | None = None
) -> None:
    """Write a track or a route as RTZ 1.2, GPX 1.1 or GeoJSON, whole or not at all.

    Parameters
    ----------
    track : Track or Route
        A track that was made of a route is written as that route.
    path : path-like
        ``.rtz``, ``.gpx``, ``.geojson`` or ``.json``. A track without a place on the earth is
        written as GeoJSON in metres.
    origin_deg : tuple of float, optional
        Latitude and longitude [deg] of north = east = 0 of a track without a place.

    Raises
    ------
    ConfigError
        Another file name, a place outside 89 and 180 deg, RTZ or GPX without a place, values that
        RTZ does not allow.
    ImportError
        Degrees without pyproj, GPX without gpxpy; names the extra to install.
    """
    path = Path(path)
    write = _WRITERS[_suffix(path)]
    route = track if isinstance(track, Route) else track.route
    if isinstance(track, Track) and route is None:
        chart = track.chart if origin_deg is None else Chart.about(*origin_deg)
        if chart is None:
            _save_metres(track, path)
            return
        north, east = track.points.T
        places = zip(*(v.tolist() for v in chart.place(north, east)), strict=True)
        route = Route("", tuple(Waypoint(*place) for place in places))
    assert route is not None
    write(route, path)


def _save_metres(track: Track, path: Path) -> None:
    if _WRITERS[_suffix(path)] is not write_geojson:
        raise ConfigError(
            f"{path}: the track is in metres without a place on the earth; give its origin "
            "(latitude, longitude), or write .geojson"
        )
    write_metres(track, path)


def _read(path: str | os.PathLike, geometry: str | None, name: str | None = None) -> Route | Track:
    path = Path(path)
    if geometry is not None:
        check_known("geometry", geometry, GEOMETRIES)
    suffix = _suffix(path)
    if name is None:
        return _READERS[suffix](path, geometry)
    if suffix != ".gpx":
        raise ConfigError(
            f"name = {shown(name, 40)}: {path} holds one route; a GPX file may hold several"
        )
    return read_gpx(path, geometry, name)


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        *most, last = _READERS
        packed = "; a .rtzp is a zip archive, unpack the .rtz" if suffix == ".rtzp" else ""
        raise ConfigError(f"{path}: a track file ends in {', '.join(most)} or {last}{packed}")
    return suffix
