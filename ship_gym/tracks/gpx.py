"""GPX routes and tracks: what recreational plotters and OpenCPN exchange.

GPX knows places and names alone. Radius, limits, speeds and the geometry of the leg that leads to a
way-point stand in an extension of ours [m, m/s], so that a route read again is the same; a leg
without it is a rhumb line.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ship_gym.charts.geodesy import HIGHEST
from ship_gym.config import ConfigError, check_known, shown, told_of
from ship_gym.reading import read_xml
from ship_gym.tracks.route import Route
from ship_gym.tracks.waypoint import GEOMETRIES, Leg, Waypoint
from ship_gym.tracks.xml_values import child, children, decimal, needed, number, parted
from ship_gym.writing import atomic_path

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

NAMESPACES = ("http://www.topografix.com/GPX/1/1", "http://www.topografix.com/GPX/1/0", "")
EXTENSION = "urn:ship-gym:route:1"
_LIMITS = {"port": (1e6, "m"), "starboard": (1e6, "m")}
_LIMITS |= {"speed_min": (100.0, "m/s"), "speed_max": (100.0, "m/s")}
_NO_GPXPY = 'writing GPX needs gpxpy: pip install "ship-gym[geo]"'


def read_gpx(path: Path, geometry: str | None = None, name: str | None = None) -> Route:
    """The one route of a GPX file, else its one track; `geometry` of legs that say nothing.

    Of several routes or tracks the one of that `name`.

    Segments of a track are joined; a place that a track logs twice in a row is one way-point.

    Raises
    ------
    ConfigError
        Not GPX 1.0 or 1.1, no or several routes or tracks, a place that is none.
    """
    root = read_xml(path)
    with told_of(path):
        namespace, tag = parted(root.tag)
        if tag != "gpx" or namespace not in NAMESPACES:
            raise ConfigError(
                f"root element {shown(str(root.tag), 80)}: allowed is gpx of GPX 1.0 or 1.1, "
                f"{NAMESPACES[1]} or {NAMESPACES[0]}"
            )
        line, kind = _line(root, name)
        points: list[Waypoint] = []
        legs: list[Leg] = []
        for i, element in enumerate(_places(line, kind)):
            point, leg = _read_point(element, f"{kind}pt {i} (from 0)", geometry)
            if kind == "trk" and points and _same_place(point, points[-1]):
                continue
            points.append(point)
            legs.append(leg)
        return Route(_text(line, "name"), tuple(points), tuple(legs[1:]))


def write_gpx(route: Route, path: Path) -> None:
    """Write a route as a route of GPX 1.1, whole or not at all.

    Raises
    ------
    ImportError
        No gpxpy; names the extra to install.
    """
    try:
        from gpxpy.gpx import GPX, GPXRoute, GPXRoutePoint
    except ImportError:
        raise ImportError(_NO_GPXPY) from None
    file, line = GPX(), GPXRoute(name=route.name or None)
    file.creator = "ship-gym"
    file.nsmap["sg"] = EXTENSION
    file.routes.append(line)
    for i, point in enumerate(route.waypoints):
        made = GPXRoutePoint(point.latitude, point.longitude, name=point.name or None)
        made.extensions = _extensions(point, route.legs[i - 1] if i > 0 else None)
        line.points.append(made)
    with atomic_path(path) as temporary:
        temporary.write_text(file.to_xml("1.1"), encoding="utf-8")


def _line(root: Element, name: str | None = None) -> tuple[Element, str]:
    """The one route (of that name), else the one track, and ``rte`` or ``trk``."""
    for kind, word in (("rte", "routes"), ("trk", "tracks")):
        found = [line for line in children(root, kind) if _places(line, kind)]
        names = ", ".join(shown(_text(each, "name"), 20) for each in found[:4])
        if name is not None:
            found = [line for line in found if _text(line, "name") == name]
            if not found and names and kind == "trk":
                raise ConfigError(
                    f"name = {shown(name, 40)}: no route or track has it; there are {names}"
                )
        if len(found) > 1:
            raise ConfigError(
                f"holds {len(found)} {word} ({names}); wanted is one, or its name "
                "(ship-gym route --name)"
            )
        if found:
            return found[0], kind
    places = sum(1 for _ in children(root, "wpt"))
    held = f"{places} single way-points (wpt)" if places else "no places"
    raise ConfigError(f"holds {held}; wanted is one route (rte) or one track (trk)")


def _places(line: Element, kind: str) -> list[Element]:
    parts = children(line, "trkseg") if kind == "trk" else [line]
    return [place for part in parts for place in children(part, f"{kind}pt")]


def _read_point(element: Element, where: str, geometry: str | None) -> tuple[Waypoint, Leg]:
    name = _text(element, "name")
    if name:
        where = f"{where}, {shown(name, 40)}"
    extensions = child(element, "extensions")
    own = {parted(e.tag)[1]: e for e in ([] if extensions is None else extensions) if _is_own(e)}
    place, leg = own.get("waypoint"), own.get("leg")
    said: dict[str, Any] = {
        field: number(leg, field, f"{where}: leg", 0.0, high, unit)
        for field, (high, unit) in _LIMITS.items()
    }
    with told_of(where):
        run = geometry if leg is None else leg.get("geometry", geometry)
        said["geometry"] = check_known("geometry", run or GEOMETRIES[0], GEOMETRIES)
    id_ = number(place, "id", where, 0, 1e18, "-")
    point = Waypoint(
        needed(element, "lat", where, -HIGHEST, HIGHEST, "deg"),
        needed(element, "lon", where, -540.0, 540.0, "deg"),
        name,
        number(place, "radius", where, 0.0, 1e6, "m"),
        None if id_ is None else int(id_),
    )
    return point, Leg(**said)


def _extensions(point: Waypoint, leg: Leg | None) -> list[Element]:
    from xml.etree.ElementTree import Element

    place = {} if point.radius is None else {"radius": decimal(point.radius)}
    place |= {} if point.id is None else {"id": str(point.id)}
    made = [Element(f"{{{EXTENSION}}}waypoint", place)] if place else []
    if leg is not None:
        values = {field: getattr(leg, field) for field in _LIMITS}
        said = {field: decimal(value) for field, value in values.items() if value is not None}
        made.append(Element(f"{{{EXTENSION}}}leg", {"geometry": leg.geometry} | said))
    return made


def _is_own(element: Element) -> bool:
    return isinstance(element.tag, str) and parted(element.tag)[0] == EXTENSION


def _same_place(a: Waypoint, b: Waypoint) -> bool:
    return (a.latitude, a.longitude) == (b.latitude, b.longitude)


def _text(element: Element, name: str) -> str:
    found = child(element, name)
    return "" if found is None else (found.text or "").strip()
