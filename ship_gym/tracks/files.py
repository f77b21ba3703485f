"""Tracks from a list or a GeoJSON file, and back to a file.

GeoJSON (RFC 7946) is longitude and latitude in degrees on WGS84. Such a file is projected by the
azimuthal equidistant projection about its first way-point: distances and bearings from there are
true, and lengths across grow with the distance c (by Earth's radius) as c / sin(c), 0.1 % at
500 km. `Track.projection` reports it. A file may say ``"units": "m"`` instead, at the top or in
the properties of a feature; its coordinates are then [east, north] in metres, which is our own
extension.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.charts import Chart
from ship_gym.config import ConfigError, check_known, check_number, shown, told_of
from ship_gym.reading import read_json
from ship_gym.tracks.route import Route, Waypoint
from ship_gym.tracks.track import Track
from ship_gym.writing import atomic_path

LARGEST_COUNT = 500  # way-points
LARGEST_EXTENT = 500e3  # [m] between any two way-points; beyond it a plane is no chart
_SUFFIXES = (".geojson", ".json")
_UNITS = ("m", "deg")
_WANTED = "wanted is one LineString, or Points in order"
_NO_PYPROJ = 'tracks in degrees need pyproj: pip install "ship-gym[geo]"'


def load_track(source: Track | str | os.PathLike | Sequence | np.ndarray) -> Track:
    """Track from way-points or from a GeoJSON file.

    Parameters
    ----------
    source : Track, list, array or path
        Way-points ``[north, east]`` [m], shape (W, 2), or a ``.geojson`` or ``.json`` file: a
        FeatureCollection, a Feature or a geometry, with one LineString or with Points in order. A
        third coordinate (height) is ignored.

    Returns
    -------
    Track
        In metres; `origin_deg` and `projection` tell where a file in degrees lies.

    Raises
    ------
    ConfigError
        What `Track` refuses, with the file's name; a file that cannot be read, holds more than one
        line, or seems not to be in degrees; more than 500 way-points; two of them more than 500 km
        apart.
    ImportError
        A file in degrees without pyproj; names the extra to install.
    """
    if isinstance(source, Track):
        return source
    if not isinstance(source, str | os.PathLike):
        _check_count(len(source) if isinstance(source, Sequence | np.ndarray) else 0)
        return _near(Track(source))
    path = _known_suffix(source)
    with told_of(path):
        return _near(_track_of(_checked(read_json(path))))


def save_track(
    track: Track, path: str | os.PathLike, origin_deg: tuple[float, float] | None = None
) -> None:
    """Write a track as a GeoJSON LineString, whole or not at all.

    Parameters
    ----------
    track : Track
        Way-points [m].
    path : path-like
        ``.geojson`` or ``.json``.
    origin_deg : tuple of float, optional
        Latitude and longitude [deg] of north = east = 0: the file is then in degrees on WGS84.
        Without it, in metres. Read again, a file in degrees begins at its first way-point; the
        points are the same if that is north = east = 0.

    Raises
    ------
    ConfigError
        Another file name, or an origin outside 90 and 180 deg.
    ImportError
        Degrees without pyproj; names the extra to install.
    """
    path = _known_suffix(path)
    north, east = track.points.T
    properties = {"units": "m"}
    if origin_deg is not None:
        north, east = Chart.about(*origin_deg).place(north, east)
        properties = {"units": "deg"}
    coordinates = np.stack([east, north], axis=-1).tolist()
    feature = {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": "LineString", "coordinates": coordinates},
    }
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(feature, indent=1) + "\n", encoding="utf-8")


def _check_count(count: int) -> None:
    """Refuse more way-points than a track may have."""
    if count > LARGEST_COUNT:
        raise ConfigError(f"track: {count} way-points; at most {LARGEST_COUNT} are allowed")


def _near(track: Track) -> Track:
    """Return the track if no two of its way-points are too far apart for a plane."""
    apart = np.linalg.norm(track.points[:, None] - track.points[None], axis=-1)
    if apart.max() > LARGEST_EXTENT:
        i, j = np.unravel_index(np.argmax(apart), apart.shape)
        raise ConfigError(
            f"way-points {i} and {j} are {apart.max() / 1e3:.0f} km apart; allowed is "
            f"{LARGEST_EXTENT / 1e3:.0f} km"
        )
    return track


def _known_suffix(path: str | os.PathLike) -> Path:
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        raise ConfigError(f"{path}: a track file is GeoJSON and ends in {' or '.join(_SUFFIXES)}")
    return path


def _checked(data: Any) -> dict[str, Any]:
    """Top-level object of a JSON file."""
    if not isinstance(data, dict) or "type" not in data:
        raise ConfigError('not GeoJSON: no object with a "type"')
    return data


def _track_of(data: dict[str, Any]) -> Track:
    """Track of a GeoJSON object in degrees or metres."""
    features = _features(data)
    positions = _positions([_member(feature, "geometry") for feature in features])
    _check_count(len(positions))
    x, y = np.array([_pair(i, position) for i, position in enumerate(positions)]).T
    if _units(data, features) == "m":
        return Track(np.stack([y, x], axis=-1))
    _check_degrees(x, y)
    return Route("", tuple(map(Waypoint, y.tolist(), x.tolist()))).track()


def _features(data: dict[str, Any]) -> list[dict[str, Any]]:
    """Features of an object; a bare geometry becomes one."""
    if data["type"] == "Feature":
        return [data]
    if data["type"] != "FeatureCollection":
        return [{"geometry": data}]
    features = data.get("features")
    if not isinstance(features, list) or not all(isinstance(f, dict) for f in features):
        raise ConfigError('the FeatureCollection has no list "features" of objects')
    return features


def _member(feature: dict[str, Any], name: str) -> dict[str, Any]:
    """Object `name` of a feature; null or missing is an empty one (RFC 7946, section 3.2)."""
    found = feature.get(name) or {}
    if not isinstance(found, dict):
        raise ConfigError(f'"{name}" of a feature must be an object')
    return found


def _positions(geometries: list[dict[str, Any]]) -> list[Any]:
    """Positions of the one line or of all points, in the order of the file."""
    kinds = [shown(geometry.get("type")).strip("'") for geometry in geometries]
    if kinds == ["LineString"]:
        found = geometries[0].get("coordinates")
        if not isinstance(found, list) or not found:
            raise ConfigError('the LineString has no list "coordinates"')
        return found
    if kinds and set(kinds) == {"Point"}:
        return [geometry.get("coordinates") for geometry in geometries]
    if kinds.count("LineString") > 1:
        raise ConfigError(f"holds {kinds.count('LineString')} lines; {_WANTED}")
    raise ConfigError(f"holds {', '.join(sorted(set(kinds))) or 'no geometry'}; {_WANTED}")


def _pair(i: int, position: Any) -> tuple[float, float]:
    """First two numbers of a position."""
    good = isinstance(position, list) and len(position) >= 2
    if not good or any(isinstance(v, bool) or not isinstance(v, int | float) for v in position):
        raise ConfigError(f"way-point {i} = {shown(position)}: must be a list of two numbers")
    x, y = (check_number(f"way-point {i}", v, unit="deg or m") for v in position[:2])
    return x, y


def _units(data: dict[str, Any], features: list[dict[str, Any]]) -> str:
    """``"m"`` or ``"deg"``, as declared; degrees if nothing is."""
    places = [data, *(_member(feature, "properties") for feature in features)]
    found = {check_known("units", place["units"], _UNITS) for place in places if "units" in place}
    if len(found) > 1:
        raise ConfigError(f"declares different units: {', '.join(sorted(found))}")
    return found.pop() if found else "deg"


def _check_degrees(longitude: np.ndarray, latitude: np.ndarray) -> None:
    """Refuse numbers that cannot be degrees, with a guess what they are."""
    bad = ~((np.abs(longitude) <= 180.0) & (np.abs(latitude) <= 90.0))
    for i in np.flatnonzero(bad)[:1]:
        swapped = (np.abs(latitude) <= 180.0).all() and (np.abs(longitude) <= 90.0).all()
        hint = (
            "longitude comes first, are they swapped?"
            if swapped
            else 'for [east, north] in metres add "units": "m" to the properties; another '
            "projection must first be converted to WGS84 (EPSG:4326)"
        )
        raise ConfigError(
            f"way-point {i} = [{longitude[i]}, {latitude[i]}]: not a longitude within 180 and a "
            f"latitude within 90 deg; {hint}"
        )
