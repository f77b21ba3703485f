"""GeoJSON (RFC 7946) lines and points as routes, and in metres as tracks.

GeoJSON is longitude and latitude in degrees on WGS84. A file may say ``"units": "m"`` instead, at
the top or in the properties of a feature; its coordinates are then [east, north] in metres, which
is our own extension. So are ``"geometry"`` (how legs run), ``"name"``, ``"waypoints"`` and
``"legs"`` in the properties, by which a route read again is the same.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.charts import geodesy
from ship_gym.config import ConfigError, build, check_known, check_number, shown, told_of
from ship_gym.reading import read_json
from ship_gym.tracks.geojson_lines import features_of, is_cut, member, positions_of, the_line
from ship_gym.tracks.route import Route
from ship_gym.tracks.track import Track
from ship_gym.tracks.waypoint import GEOMETRIES, Leg, Waypoint, check_count
from ship_gym.writing import atomic_path

NEAR_ZERO = 1.0  # [deg] from latitude and longitude 0: more likely metres of a towing tank
LONG_LEG = 200e3  # [m] of a leg of a file that does not say its units
BASIN = (100.0, 20.0)  # length and width [m] that a basin may have to either side of 0
_UNITS = ("m", "deg")
# at the end of the name that QGIS and GDAL write as "crs" (GeoJSON of 2008): WGS84, ETRS89, NAD83
_IN_DEGREES = ("CRS84", "CRS84h", "4326", "4979", "4258", "4269")
_HINT = 'write "units": "m" (for [east, north] in metres) or "units": "deg" in the properties'


def read_geojson(path: Path, geometry: str | None = None) -> Route | Track:
    """Route of a GeoJSON file in degrees, track of one in metres.

    Parameters
    ----------
    path : Path
        A FeatureCollection, a Feature or a geometry: one LineString, a MultiLineString whose lines
        meet end to start (Points beside it are marks), or Points in order. Features without a
        geometry are passed over, a third coordinate (height) is ignored.
    geometry : str, optional
        Of legs of which the file says nothing.

    Raises
    ------
    ConfigError
        Anything else, different units, numbers that cannot be degrees or may be metres.
    """
    with told_of(path):
        data = read_json(path)
        if not isinstance(data, dict) or "type" not in data:
            raise ConfigError('not GeoJSON: no object with a "type"')
        features = features_of(data)
        units = _units(data, features)
        features = the_line(features)
        positions = positions_of(features, 0.0 if units == "m" else 360.0)
        check_count(len(positions))
        pairs = np.array([_pair(i, position) for i, position in enumerate(positions)])
        if units == "m":
            return Track(pairs[:, ::-1])
        _check_degrees(*pairs.T)
        route = _route(pairs, data, features, geometry)
        if units is None and not is_cut(features):
            _check_likely(route)
        return route


def write_geojson(route: Route, path: Path) -> None:
    """Write a route as one LineString, whole or not at all.

    Its longitudes run on beyond 180 deg across the antimeridian, which maps draw as one line; a
    cut, as RFC 7946 would have it, would add a way-point.
    """
    latitude, longitude = np.array([[p.latitude, p.longitude] for p in route.waypoints]).T
    turns = np.round((longitude[1:] - longitude[:-1]) / 360.0)
    longitude = longitude - 360.0 * np.concatenate([[0.0], np.cumsum(turns)])
    meta = route.to_meta()
    for point in meta["waypoints"]:
        del point["latitude"], point["longitude"]
    properties: dict[str, Any] = {"name": route.name, "units": "deg"}
    properties |= {key: list(map(_said, meta[key])) for key in ("waypoints", "legs")}
    _write(np.stack([longitude, latitude], axis=-1), properties, path)


def write_metres(track: Track, path: Path) -> None:
    """Write a track as one LineString in metres, whole or not at all."""
    _write(track.points[:, ::-1], {"units": "m"}, path)


def _write(coordinates: np.ndarray, properties: dict[str, Any], path: Path) -> None:
    feature = {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": "LineString", "coordinates": coordinates.tolist()},
    }
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(feature, indent=1) + "\n", encoding="utf-8")


def _said(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value not in (None, "")}


def _route(pairs: np.ndarray, data: dict, features: list[dict], geometry: str | None) -> Route:
    """Route of longitudes and latitudes and of what the properties say of it."""
    said = _properties(data, features)
    count = len(pairs)
    points = _listed(said, "waypoints", count)
    legs = _listed(said, "legs", count - 1)
    usual = check_known("geometry", said.get("geometry", geometry or GEOMETRIES[0]), GEOMETRIES)
    name = said.get("name") or ""  # GDAL writes null
    return Route(
        name,
        tuple(
            build(Waypoint, point | {"longitude": lon, "latitude": lat}, f"way-point {i}")
            for i, (point, (lon, lat)) in enumerate(zip(points, pairs.tolist(), strict=True))
        ),
        tuple(build(Leg, {"geometry": usual} | leg, f"leg {k}") for k, leg in enumerate(legs)),
    )


def _properties(data: dict[str, Any], features: list[dict[str, Any]]) -> dict[str, Any]:
    """Properties of the line or the first point; what the collection says goes before them."""
    said = member(features[0], "properties")
    if data["type"] != "FeatureCollection":
        return said
    keys = ("name", "geometry", "waypoints", "legs")
    return said | {key: data[key] for key in keys if key in data}


def _listed(said: dict[str, Any], key: str, count: int) -> list[dict[str, Any]]:
    """A list of one object for each way-point or leg; empty ones if the file has none."""
    found = said.get(key)
    if found is None:
        return [{}] * count
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise ConfigError(f'"{key}" in the properties must be a list of objects')
    if len(found) != count:
        raise ConfigError(f'"{key}" in the properties: {len(found)} of them; must be {count}')
    return found


def _pair(i: int, position: Any) -> tuple[float, float]:
    """First two numbers of a position."""
    good = isinstance(position, list) and len(position) >= 2
    if not good or any(isinstance(v, bool) or not isinstance(v, int | float) for v in position):
        raise ConfigError(f"way-point {i} = {shown(position)}: must be a list of two numbers")
    x, y = (check_number(f"way-point {i}", v, unit="deg or m") for v in position[:2])
    return x, y


def _units(data: dict[str, Any], features: list[dict[str, Any]]) -> str | None:
    """``"m"`` or ``"deg"``, as declared; None if nothing is, or null, as GDAL writes it."""
    places = [data, *(member(feature, "properties") for feature in features)]
    said = [place["units"] for place in places if place.get("units") is not None]
    found = {check_known("units", unit, _UNITS) for unit in said}
    if len(found) > 1:
        raise ConfigError(f"declares different units: {', '.join(sorted(found))}")
    return found.pop() if found else _units_of_crs(data)


def _units_of_crs(data: dict[str, Any]) -> str | None:
    """``"deg"`` of a file with a system of coordinates that is in degrees; None without one."""
    crs = data.get("crs")
    if crs is None:
        return None
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else crs
    if isinstance(name, str) and name.rpartition(":")[2] in _IN_DEGREES:
        return "deg"
    raise ConfigError(
        f"crs = {shown(name, 80)}: must be WGS84 (urn:ogc:def:crs:OGC:1.3:CRS84 or EPSG:4326); "
        'convert it first, or add "units": "m" for [east, north] in metres'
    )


def _check_degrees(longitude: np.ndarray, latitude: np.ndarray) -> None:
    """Refuse numbers that cannot be degrees, with a guess what they are."""
    bad = ~((np.abs(longitude) <= 540.0) & (np.abs(latitude) <= 90.0))
    for i in np.flatnonzero(bad)[:1]:
        swapped = (np.abs(latitude) <= 180.0).all() and (np.abs(longitude) <= 90.0).all()
        hint = (
            "longitude comes first, are they swapped?"
            if swapped
            else 'for [east, north] in metres add "units": "m" to the properties; another '
            "projection must first be converted to WGS84 (EPSG:4326)"
        )
        raise ConfigError(
            f"way-point {i} = [{longitude[i]}, {latitude[i]}]: not a longitude within 540 and a "
            f"latitude within 90 deg; {hint}"
        )


def _check_likely(route: Route) -> None:
    """Refuse degrees that may be metres, of a file that does not say which."""
    for i, point in enumerate(route.waypoints):
        if max(abs(point.latitude), abs(point.longitude)) <= NEAR_ZERO:
            raise ConfigError(
                f"way-point {i} = [{point.longitude}, {point.latitude}] would be within "
                f"{NEAR_ZERO:g} deg of latitude and longitude 0, or it is in metres: {_HINT}"
            )
    lat, lon = np.array([[p.latitude, p.longitude] for p in route.waypoints]).T
    lengths = geodesy.geodesic(lat[:-1], lon[:-1], lat[1:], lon[1:]).length
    for i in np.flatnonzero(lengths > LONG_LEG)[:1]:
        raise ConfigError(
            f"the leg from way-point {i} to {i + 1} would be {lengths[i] / 1e3:.0f} km long, or "
            f"it is in metres: {_HINT}"
        )
    if (np.abs(lon) <= BASIN[0]).all() and (np.abs(lat) <= BASIN[1]).all():
        if (length := lengths.sum()) > LONG_LEG:
            raise ConfigError(
                f"the line would be {length / 1e3:.0f} km long, or it is in metres: {_HINT}"
            )
