"""Positions of a GeoJSON file in order: of its one line, of lines that meet, or of its points."""

from __future__ import annotations

import itertools
from typing import Any

from ship_gym.config import ConfigError, shown

_WANTED = "wanted is one LineString, one MultiLineString, or Points in order"
_ANTIMERIDIAN = 180.0


def features_of(data: dict[str, Any]) -> list[dict[str, Any]]:
    """Features of an object that have a geometry (null is none); a bare geometry becomes one."""
    if data["type"] == "Feature":
        features = [data]
    elif data["type"] == "FeatureCollection":
        found = data.get("features")
        if not isinstance(found, list) or not all(isinstance(f, dict) for f in found):
            raise ConfigError('the FeatureCollection has no list "features" of objects')
        features = found
    else:
        features = [{"geometry": data}]
    return [feature for feature in features if member(feature, "geometry")]


def member(feature: dict[str, Any], name: str) -> dict[str, Any]:
    """Object `name` of a feature; null or missing is an empty one (RFC 7946, section 3.2)."""
    found = feature.get(name)
    if found is None:
        return {}
    if not isinstance(found, dict):
        raise ConfigError(f'"{name}" of a feature must be an object')
    return found


def the_line(features: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """What is sailed: of one line with points beside it, its marks, the line alone."""
    kinds = [member(feature, "geometry").get("type") for feature in features]
    lines = [k for k, kind in enumerate(kinds) if kind in ("LineString", "MultiLineString")]
    if len(lines) == 1 and kinds.count("Point") == len(kinds) - 1:
        return [features[lines[0]]]
    return features


def positions_of(features: list[dict[str, Any]], round_earth: float = 0.0) -> list[Any]:
    """Positions of the one line or of all points, in the order of the file.

    `round_earth` is what may lie between the first numbers of one place: 360 deg, or 0 in metres.
    """
    geometries = [member(feature, "geometry") for feature in features]
    kinds = [shown(geometry.get("type")).strip("'") for geometry in geometries]
    if kinds == ["LineString"]:
        return _listed(geometries[0], "the LineString")
    if kinds == ["MultiLineString"]:
        return _joined(_listed(geometries[0], "the MultiLineString"), round_earth)
    if kinds and set(kinds) == {"Point"}:
        return [geometry.get("coordinates") for geometry in geometries]
    lines = kinds.count("LineString") + kinds.count("MultiLineString")
    if lines > 1:
        raise ConfigError(f"holds {lines} lines; {_WANTED}")
    raise ConfigError(f"holds {', '.join(sorted(set(kinds))) or 'no geometry'}; {_WANTED}")


def is_cut(features: list[dict[str, Any]]) -> bool:
    """Whether a MultiLineString that `positions_of` has joined is cut at the antimeridian."""
    lines = [
        geometry["coordinates"]
        for geometry in (member(feature, "geometry") for feature in features)
        if geometry.get("type") == "MultiLineString"
    ]
    return any(_is_cut(a[-1], b[0]) for parts in lines for a, b in itertools.pairwise(parts))


def _listed(geometry: dict[str, Any], what: str) -> list[Any]:
    found = geometry.get("coordinates")
    if not isinstance(found, list) or not found:
        raise ConfigError(f'{what} has no list "coordinates"')
    return found


def _joined(lines: list[Any], round_earth: float) -> list[Any]:
    """Lines that meet end to start as one; where the antimeridian cut them is no way-point."""
    joined: list[Any] = []
    for k, line in enumerate(lines):
        if not isinstance(line, list) or len(line) < 2:
            raise ConfigError(f"line {k} of the MultiLineString: must be a list of two positions")
        if not joined:
            joined += line
            continue
        end, start = joined[-1], line[0]
        if not _meet(end, start, round_earth):
            raise ConfigError(
                f"line {k} of the MultiLineString begins at {shown(start)}, line {k - 1} ends at "
                f"{shown(end)}: must be the same place"
            )
        if _is_cut(end, start):
            joined.pop()
        joined += line[1:]
    return joined


def _meet(end: Any, start: Any, round_earth: float) -> bool:
    if not (_plain(end) and _plain(start) and end[1] == start[1]):
        return False
    apart = abs(end[0] - start[0])
    return apart in (0.0, round_earth)


def _is_cut(end: Any, start: Any) -> bool:
    """Whether the antimeridian lies between; they meet."""
    return abs(end[0]) == _ANTIMERIDIAN and end[0] != start[0]


def _plain(position: Any) -> bool:
    """Whether it begins with two numbers; what it is else is said where all are checked."""
    return (
        isinstance(position, list)
        and len(position) >= 2
        and all(isinstance(v, int | float) and abs(v) < 1e9 for v in position[:2])
    )
