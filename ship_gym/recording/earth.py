"""Where a recording lies on the earth; numpy only, but for the chart itself."""

from __future__ import annotations

import numpy as np

from ship_gym.charts import Chart
from ship_gym.config import ConfigError
from ship_gym.recording.trajectory import Trajectory


def chart_of(trajectory: Trajectory, origin: tuple[float, float] | None = None) -> Chart | None:
    """The chart of a recording, or that about the place of its north = east = 0; None: neither.

    Parameters
    ----------
    trajectory : Trajectory
    origin : tuple of float, optional
        Latitude and longitude [deg], for a recording without a chart.

    Raises
    ------
    ConfigError
        An origin of a recording that has a chart, or that is no place; a chart that is none.
    """
    found = trajectory.meta.get("chart")
    if found is None:
        return None if origin is None else Chart.about(*origin)
    if origin is not None:
        raise ConfigError("the recording has a chart, so its place is known; leave the origin out")
    return Chart.from_meta(found)


def sailed_places(trajectory: Trajectory, chart: Chart) -> tuple[np.ndarray, np.ndarray]:
    """Latitude and longitude [deg] of each row, shapes (T,), longitudes in [-180, 180).

    Raises
    ------
    ConfigError
        A recording without x and y.
    """
    if not {"x", "y"} <= trajectory.columns.keys():
        raise ConfigError("a recording without x and y has no places")
    leg = trajectory["leg"].astype(int) if "leg" in trajectory else None
    return chart.place(trajectory["x"], trajectory["y"], leg)


def parted_at_antimeridian(latitude: np.ndarray, longitude: np.ndarray) -> list[np.ndarray]:
    """A line in parts that do not cross the antimeridian (RFC 7946, section 3.1.9).

    Parameters
    ----------
    latitude, longitude : numpy.ndarray
        [deg], shapes (T,), T >= 1.

    Returns
    -------
    list of numpy.ndarray
        Latitude and longitude of each part, shapes (P, 2), P >= 2 unless T = 1; both sides of a
        crossing have its place, at longitude 180 and -180.
    """
    places = np.column_stack([latitude, longitude]).astype(np.float64)
    parts, start = [], [places[:0]]
    begin = 0
    for k in np.flatnonzero(np.abs(np.diff(places[:, 1])) > 180.0).tolist():
        (lat, lon), (lat_to, lon_to) = places[k], places[k + 1]
        edge = 180.0 if lon > 0.0 else -180.0
        beyond = lon_to + 2.0 * edge  # on the branch of the place before
        share = (edge - lon) / (beyond - lon) if beyond != lon else 0.0
        middle = lat + share * (lat_to - lat)
        parts.append(np.concatenate([*start, places[begin : k + 1], [[middle, edge]]]))
        start, begin = [np.array([[middle, -edge]])], k + 1
    parts.append(np.concatenate([*start, places[begin:]]))
    return parts
