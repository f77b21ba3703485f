"""RTZ, the routes of ECDIS (IEC 61174, annex S), versions 1.0 to 1.2.

Radii and cross-track limits are in nautical miles, speeds in knots. A leg stands at the way-point
that it leads to; what it and its way-point do not say is said by ``defaultWaypoint``, and a leg
whose geometry nobody says is a rhumb line. Schedules, extensions, depths and notes are passed over.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree  # writes; what is read goes through ``reading.read_xml``

from ship_gym.charts.geodesy import HIGHEST
from ship_gym.config import ConfigError, check_number, shown, told_of
from ship_gym.conventions import KNOT
from ship_gym.reading import read_xml
from ship_gym.tracks.route import Route
from ship_gym.tracks.waypoint import Leg, Waypoint
from ship_gym.tracks.xml_values import child, children, decimal, needed, number, parted
from ship_gym.writing import atomic_path

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

MILE = 1852.0  # [m]
VERSIONS = ("1.0", "1.1", "1.2")
_NAMESPACES = {f"http://www.cirm.org/RTZ/{v.replace('.', '/')}": v for v in VERSIONS}
_GEOMETRIES = {"Loxodrome": "loxodrome", "Orthodrome": "orthodrome"}
_ID = re.compile(r"\+?\d{1,18}", re.ASCII)
_LARGEST_RADIUS = {"1.0": 10.0, "1.1": 5.0, "1.2": 5.0}  # [NM] by the schemas
_LARGEST_XTD = 10.0  # [NM] by the schemas, which want less than that
_FASTEST = 194.0  # [kn]; the schemas have no largest speed
# field of a leg -> attribute, its largest value and unit, and that in SI
_LEG = {
    "port": ("portsideXTD", _LARGEST_XTD, "NM", MILE),
    "starboard": ("starboardXTD", _LARGEST_XTD, "NM", MILE),
    "speed_min": ("speedMin", _FASTEST, "kn", KNOT),
    "speed_max": ("speedMax", _FASTEST, "kn", KNOT),
}


def read_rtz(path: Path, geometry: str | None = None) -> Route:
    """Route of an RTZ file; `geometry` is that of legs of which the file says nothing.

    Raises
    ------
    ConfigError
        Not RTZ of a known version, a way-point or leg that is not as the schema wants it; names
        the way-point by its id.
    """
    root = read_xml(path)
    with told_of(path):
        widest = _LARGEST_RADIUS[_checked_version(root)]
        info, waypoints = child(root, "routeInfo"), child(root, "waypoints")
        if waypoints is None:
            raise ConfigError("the route has no element waypoints")
        name = "" if info is None else info.get("routeName", "")
        default = child(waypoints, "defaultWaypoint")
        usual = _radius(default, "defaultWaypoint", widest)
        legs_say = _leg(child(default, "leg"), "defaultWaypoint: leg", {})
        if geometry is not None:
            legs_say = {"geometry": geometry} | legs_say
        points, legs, seen = [], [], set()
        for i, element in enumerate(children(waypoints, "waypoint")):
            number_ = _id(element, i)
            where = f"way-point id {number_}"
            if number_ in seen:
                raise ConfigError(f"{where}: the id is there twice; each must be one of its own")
            seen.add(number_)
            radius = _radius(element, where, widest)
            points.append(_waypoint(element, number_, where, usual if radius is None else radius))
            leg = _leg(child(element, "leg"), f"{where}: leg", legs_say)
            if i > 0:  # no leg leads to the first way-point
                legs.append(Leg(**leg))
        return Route(name, tuple(points), tuple(legs))


def write_rtz(route: Route, path: Path) -> None:
    """Write a route as RTZ 1.2, whole or not at all.

    Raises
    ------
    ConfigError
        A radius above 5 or a limit not below 10 nautical miles, which the schema does not allow.
    """
    namespace = next(name for name, version in _NAMESPACES.items() if version == "1.2")
    root = ElementTree.Element("route", {"xmlns": namespace, "version": "1.2"})
    ElementTree.SubElement(root, "routeInfo", {"routeName": route.name or path.stem})
    waypoints = ElementTree.SubElement(root, "waypoints")
    ids = _ids(route)
    with told_of(path):
        for i, point in enumerate(route.waypoints):
            where = f"way-point id {ids[i]}"
            given = {"id": str(ids[i]), "revision": "0"} | (
                {"name": point.name} if point.name else {}
            )
            if point.radius is not None:
                widest = _LARGEST_RADIUS["1.2"]
                check_number(f"{where}: radius", point.radius / MILE, 0.0, widest, "NM")
                given["radius"] = decimal(point.radius, MILE)
            element = ElementTree.SubElement(waypoints, "waypoint", given)
            position = {"lat": decimal(point.latitude), "lon": decimal(point.longitude)}
            ElementTree.SubElement(element, "position", position)
            if i > 0:
                said = _leg_attributes(route.legs[i - 1], f"{where}: leg")
                ElementTree.SubElement(element, "leg", said)
    ElementTree.indent(root)
    with atomic_path(path) as temporary:
        ElementTree.ElementTree(root).write(temporary, encoding="UTF-8", xml_declaration=True)


def _checked_version(root: Element) -> str:
    namespace, name = parted(root.tag)
    known = f"allowed is route of RTZ {', '.join(VERSIONS)}, {' or '.join(_NAMESPACES)}"
    if name != "route" or (namespace and namespace not in _NAMESPACES):
        raise ConfigError(f"root element {shown(str(root.tag), 80)}: {known}")
    version = root.get("version", _NAMESPACES.get(namespace))
    if version not in VERSIONS:
        raise ConfigError(f"route: version = {shown(version)}: allowed is {', '.join(VERSIONS)}")
    return version


def _id(element: Element, i: int) -> int:
    text = element.get("id")
    if text is None or not _ID.fullmatch(text.strip()):
        told = "no id" if text is None else f"id = {shown(text)}"
        name = f", name {shown(element.get('name'), 40)}" if element.get("name") else ""
        raise ConfigError(f"way-point {i} (from 0{name}): {told}; must be a whole number from 0")
    return int(text)


def _waypoint(element: Element, number_: int, where: str, radius: float | None) -> Waypoint:
    position = child(element, "position")
    if position is None:
        raise ConfigError(f"{where}: no element position with lat and lon")
    return Waypoint(
        needed(position, "lat", f"{where}: position", -HIGHEST, HIGHEST, "deg"),
        needed(position, "lon", f"{where}: position", -540.0, 540.0, "deg"),
        element.get("name", ""),
        radius,
        number_,
    )


def _radius(element: Element | None, where: str, widest: float) -> float | None:
    radius = number(element, "radius", where, 0.0, widest, "NM")
    return None if radius is None else radius * MILE


def _leg(element: Element | None, where: str, usual: dict) -> dict:
    """Fields of a leg: those of the element, else the usual ones."""
    said = dict(usual)
    if element is None:
        return said
    if (geometry := element.get("geometryType")) is not None:
        if geometry not in _GEOMETRIES:
            known = " or ".join(_GEOMETRIES)
            raise ConfigError(f"{where}: geometryType = {shown(geometry)}: allowed is {known}")
        said["geometry"] = _GEOMETRIES[geometry]
    for field, (name, high, unit, size) in _LEG.items():
        if (value := number(element, name, where, 0.0, high, unit)) is not None:
            said[field] = value * size
    return said


def _leg_attributes(leg: Leg, where: str) -> dict[str, str]:
    said = {}
    for field, (name, high, unit, size) in _LEG.items():
        if (value := getattr(leg, field)) is not None:
            check_number(f"{where}: {name}", value / size, 0.0, high, unit)
            if unit == "NM" and value / size >= high:
                raise ConfigError(
                    f"{where}: {name} = {value / size:g}: must be below {high:g} [NM]"
                )
            said[name] = decimal(value, size)
    said["geometryType"] = next(k for k, v in _GEOMETRIES.items() if v == leg.geometry)
    return said


def _ids(route: Route) -> list[int]:
    """Ids of the way-points: their own if all have one and no two the same, else 1, 2, 3..."""
    count = len(route.waypoints)
    ids = [point.id for point in route.waypoints if point.id is not None]
    return ids if len(set(ids)) == count else list(range(1, count + 1))
