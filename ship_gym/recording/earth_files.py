"""Sailed tracks as files of other programs: GPX, GeoJSON and KML."""

from __future__ import annotations

import datetime
import hashlib
import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ship_gym.charts import Chart
from ship_gym.config import ConfigError, check_known
from ship_gym.recording.card import run_name
from ship_gym.recording.earth import chart_of, parted_at_antimeridian, sailed_places
from ship_gym.recording.trajectory import Trajectory
from ship_gym.writing import atomic_path

MARK = "Ship Gym voyage"  # with a digest of the record, in every file
_DIGITS = 8  # of a degree: 1 mm
_KML = "http://www.opengis.net/kml/2.2"
_SAILED, _PLANNED = "ff0b5ad6", "ff9e9e9e"  # aabbggrr
_NO_GPXPY = 'writing GPX needs gpxpy: pip install "ship-gym[geo]"'


def write_on_earth(
    trajectory: Trajectory,
    path: str | os.PathLike,
    origin: tuple[float, float] | None = None,
    start: datetime.datetime | None = None,
) -> None:
    """Write where a ship has sailed as ``.gpx`` (1.1), ``.geojson`` or ``.kml``, whole or not.

    Every row of the recording is a place. Of a route the KML file has the planned line, too.

    Parameters
    ----------
    trajectory : Trajectory
    path : path-like
    origin : tuple of float, optional
        Latitude and longitude [deg] of north = east = 0, for a recording without a chart.
    start : datetime, optional
        Time of its first row, with a time zone; without it the places have no times of day, as the
        recording has none.

    Raises
    ------
    ConfigError
        Another file name; no chart and no origin, or both; a start without a time zone.
    ImportError
        No pyproj, or no gpxpy for GPX; names the extra to install.
    """
    path = Path(path)
    write = FORMATS[check_known("format", path.suffix.lower().removeprefix("."), FORMATS)]
    if start is not None and start.tzinfo is None:
        raise ConfigError(f"start = {start.isoformat()}: needs a time zone, such as ...Z")
    chart = chart_of(trajectory, origin)
    if chart is None:
        raise ConfigError(
            "its x and y have no place on the earth, as it was not sailed on a chart: give the "
            "latitude and longitude of its north = east = 0"
        )
    text = write(trajectory, sailed_places(trajectory, chart), chart, start)
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def voyage_mark(trajectory: Trajectory) -> str:
    """What a file says of the record it is from: `MARK` and a digest of its columns."""
    found = hashlib.sha256()
    for name in ("t", "x", "y"):
        found.update(trajectory[name].tobytes())
    return f"{MARK} {found.hexdigest()[:16]}"


def _gpx(trajectory: Trajectory, places, chart: Chart, start) -> str:
    del chart
    try:
        from gpxpy.gpx import GPX, GPXTrack, GPXTrackPoint, GPXTrackSegment
    except ImportError:
        raise ImportError(_NO_GPXPY) from None
    file, segment = GPX(), GPXTrackSegment()
    file.creator, file.description = "Ship Gym", voyage_mark(trajectory)
    track = GPXTrack(name=run_name(trajectory.meta))
    file.tracks.append(track)
    track.segments.append(segment)
    times: Sequence[Any] = _times(trajectory, start) or [None] * len(trajectory)
    for lat, lon, time in zip(*_rounded(*places), times, strict=True):
        segment.points.append(GPXTrackPoint(lat, lon, time=time))
    return file.to_xml(version="1.1") + "\n"


def _geojson(trajectory: Trajectory, places, chart: Chart, start) -> str:
    """One feature: a line, or of one that crosses the antimeridian several."""
    del chart
    lines = [_positions(part) for part in parted_at_antimeridian(*places)]
    one = len(lines) == 1
    meta = trajectory.meta
    properties: dict[str, Any] = {
        "name": run_name(meta),
        "description": voyage_mark(trajectory),
        "units": "deg",
        **{name: meta[name] for name in ("outcome", "seed", "controller") if name in meta},
        "duration": float(trajectory["t"][-1] - trajectory["t"][0]),
    }
    times = _times(trajectory, start)
    if times and one:
        properties["coordTimes"] = [_iso(time) for time in times]
    elif times:
        properties |= {"start": _iso(times[0]), "end": _iso(times[-1])}
    geometry = {
        "type": "LineString" if one else "MultiLineString",
        "coordinates": lines[0] if one else lines,
    }
    feature = {"type": "Feature", "properties": properties, "geometry": geometry}
    return json.dumps(feature) + "\n"


def _kml(trajectory: Trajectory, places, chart: Chart, start) -> str:
    """The sailed track and, of a chart with legs, the planned line."""
    root = ElementTree.Element("kml", xmlns=_KML)
    document = ElementTree.SubElement(root, "Document")
    _leaf(document, "name", run_name(trajectory.meta))
    _leaf(document, "description", voyage_mark(trajectory))
    if len(chart.latitude) > 1:
        planned = parted_at_antimeridian(chart.latitude, chart.longitude)
        _placemark(document, "planned", planned, _PLANNED)
    sailed = _placemark(document, "sailed", parted_at_antimeridian(*places), _SAILED)
    times = _times(trajectory, start)
    if times:
        span = ElementTree.Element("TimeSpan")
        _leaf(span, "begin", _iso(times[0]))
        _leaf(span, "end", _iso(times[-1]))
        sailed.insert(1, span)  # after the name, as the schema has it
    ElementTree.indent(root, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def _placemark(document, name: str, lines: list[np.ndarray], color: str):
    mark = ElementTree.SubElement(document, "Placemark")
    _leaf(mark, "name", name)
    style = ElementTree.SubElement(ElementTree.SubElement(mark, "Style"), "LineStyle")
    _leaf(style, "color", color)
    _leaf(style, "width", "2")
    parent = mark if len(lines) == 1 else ElementTree.SubElement(mark, "MultiGeometry")
    for line in lines:
        string = ElementTree.SubElement(parent, "LineString")
        _leaf(string, "tessellate", "1")
        _leaf(string, "coordinates", " ".join(f"{e:.8f},{n:.8f}" for e, n in _positions(line)))
    return mark


def _leaf(parent, name: str, text: str) -> None:
    ElementTree.SubElement(parent, name).text = text


def _positions(line: np.ndarray) -> list[list[float]]:
    """Longitude and latitude [deg]; one place twice, as a line has two."""
    found = np.round(line[:, ::-1], _DIGITS).tolist()
    return found if len(found) > 1 else found * 2


def _rounded(*places: np.ndarray) -> tuple[list[float], ...]:
    return tuple(np.round(values, _DIGITS).tolist() for values in places)


def _times(trajectory: Trajectory, start: datetime.datetime | None) -> list[datetime.datetime]:
    """Time of day of each row; none without a start."""
    if start is None:
        return []
    passed = trajectory["t"] - trajectory["t"][0]
    return [start + datetime.timedelta(seconds=seconds) for seconds in passed.tolist()]


def _iso(time: datetime.datetime) -> str:
    utc = time.astimezone(datetime.UTC)
    return utc.isoformat(timespec="milliseconds").replace("+00:00", "Z")


FORMATS: dict[str, Callable[..., str]] = {"gpx": _gpx, "geojson": _geojson, "kml": _kml}
