"""`Track`: way-points joined by straight legs, checked once."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ship_gym.config import ConfigError, check_angle, check_number
from ship_gym.conventions import wrap_angle

if TYPE_CHECKING:
    from ship_gym.charts import Chart
    from ship_gym.tracks.route import Route

SHORTEST_LEG = 1e-3  # [m]; shorter is a way-point given twice
FARTHEST = 1e9  # [m] from north = east = 0; more is no place on Earth
SHARPEST_TURN = math.radians(150.0)  # beyond it the ship would sail back along the leg


@dataclasses.dataclass(frozen=True, eq=False)
class Track:
    """Way-points joined by straight legs.

    Attributes
    ----------
    points : numpy.ndarray, shape (W, 2)
        North and east [m] of W >= 2 way-points; float64, read-only. Any list that makes such an
        array is accepted. Messages count way-points from 0.
    chart : Chart, optional
        Where the plane lies on the earth, if the track is from a chart.
    route : Route, optional
        What the track was made of; `points` then has more way-points than the route: great circles
        and planned turns are cut into short legs.
    limits : numpy.ndarray, shape (W - 1, 2), optional
        How far the ship may be to port and to starboard of each leg [m]; nan: as the scenario says.
    leg_of : numpy.ndarray of int, shape (W - 1,), optional
        Leg of the route, from 0, that each leg of the plane is a part of.

    Raises
    ------
    ConfigError
        Not a list of pairs of numbers, fewer than two points, a number that is not finite, a leg
        shorter than 1 mm, a turn sharper than 150 deg; the message names the way-point.
    """

    points: np.ndarray
    chart: Chart | None = None
    route: Route | None = None
    limits: np.ndarray | None = None
    leg_of: np.ndarray | None = None

    def __post_init__(self) -> None:
        points = _array_of(self.points)
        points.setflags(write=False)
        object.__setattr__(self, "points", points)
        for name, shape in (("limits", (len(points) - 1, 2)), ("leg_of", (len(points) - 1,))):
            object.__setattr__(self, name, _array_or_none(name, getattr(self, name), shape))
        for i in np.flatnonzero(~(self.leg_lengths >= SHORTEST_LEG))[:1]:
            raise ConfigError(
                f"way-point {i + 1} = {points[i + 1].tolist()}: {self.leg_lengths[i]:.3g} m from "
                f"the one before, at least {SHORTEST_LEG:g} m is needed; is it there twice?"
            )
        sharp = np.abs(self.course_changes) > SHARPEST_TURN * (1.0 + 1e-12)
        for i in np.flatnonzero(sharp)[:1]:
            raise ConfigError(
                f"way-point {i + 1} = {points[i + 1].tolist()}: the track turns by "
                f"{math.degrees(self.course_changes[i]):.1f} deg, allowed is "
                f"{math.degrees(SHARPEST_TURN):.0f} deg to either side"
            )

    @property
    def leg_lengths(self) -> np.ndarray:
        """Lengths of the legs [m], shape (W - 1,)."""
        north, east = np.diff(self.points, axis=0).T
        return np.hypot(north, east)

    @property
    def leg_bearings(self) -> np.ndarray:
        """Bearings of the legs [rad] from north, clockwise, in [-pi, pi]; shape (W - 1,)."""
        north, east = np.diff(self.points, axis=0).T
        return np.arctan2(east, north)

    @property
    def course_changes(self) -> np.ndarray:
        """Changes of course at the inner way-points [rad], (-pi, pi], positive to starboard.

        Shape (W - 2,).
        """
        return -wrap_angle(-np.diff(self.leg_bearings))

    @property
    def distances(self) -> np.ndarray:
        """Distance sailed at each way-point [m], from 0 at the first; shape (W,)."""
        return np.concatenate([[0.0], np.cumsum(self.leg_lengths)])

    @property
    def total_length(self) -> float:
        """Length of the track [m]."""
        return float(self.distances[-1])

    @property
    def origin_deg(self) -> tuple[float, float] | None:
        """Latitude and longitude [deg] of the first way-point, if the track is from a chart."""
        if self.chart is None:
            return None
        return float(self.chart.latitude[0]), float(self.chart.longitude[0])

    def check_turns(self, radius: float) -> Track:
        """Return the track if a ship with a turning radius [m] can sail it.

        A turn D needs ``radius tan(|D| / 2)`` of both its legs. `tracks.generator` draws by this
        rule.

        Raises
        ------
        ConfigError
            Names the first leg too short for the turns at its ends, with both lengths; of a route
            also the first way-point whose planned turn she would leave by more than its limits.
        """
        if self.route is not None:
            self.route.check_turns(radius)
            return self
        turns = np.concatenate([[0.0], np.abs(self.course_changes), [0.0]])
        need = radius * np.tan(0.5 * turns)
        need = need[:-1] + need[1:]
        lengths = self.leg_lengths
        for i in np.flatnonzero(lengths < need * (1.0 - 1e-9))[:1]:
            before, after = np.degrees(turns[i : i + 2])
            raise ConfigError(
                f"track: the leg from way-point {i} to {i + 1} is {lengths[i]:.0f} m long; turns "
                f"of {before:.0f} and {after:.0f} deg at its ends need {need[i]:.0f} m at a "
                f"turning radius of {radius:.0f} m"
            )
        return self

    def scaled(self, factor: float) -> Track:
        """The same track `factor` times as large, about north = east = 0.

        Makes a track in units of ship length one in metres, or a full-scale one a model's. It has
        no place on the earth.
        """
        factor = check_number("factor", factor, 1e-9, 1e9)
        limits = None if self.limits is None else self.limits * factor
        return Track(self.points * factor, limits=limits)

    def moved(self, north: float, east: float, turn: float = 0.0) -> Track:
        """The track turned about north = east = 0, then shifted; it has no place on the earth.

        Parameters
        ----------
        north, east : float
            Shift [m].
        turn : float
            Angle [rad], clockwise: it is added to every bearing.
        """
        cos, sin = math.cos(check_angle("turn", turn)), math.sin(turn)
        shift = check_number("north", north, unit="m"), check_number("east", east, unit="m")
        x, y = self.points.T
        points = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1) + shift
        return Track(points, limits=self.limits)

    def to_list(self) -> list[list[float]]:
        """Way-points as plain lists ``[[north, east], ...]`` [m], for TOML or JSON."""
        return self.points.tolist()


def _array_or_none(name: str, values: Any, shape: tuple[int, ...]) -> np.ndarray | None:
    """A read-only copy of one value for each leg, or None."""
    if values is None:
        return None
    array = np.array(values, dtype=np.int64 if name == "leg_of" else np.float64)
    if array.shape != shape:
        raise ConfigError(f"track.{name}: shape {array.shape}, must be {shape}")
    array.setflags(write=False)
    return array


def _array_of(points: Any) -> np.ndarray:
    """A new float64 array (W, 2) of finite numbers, or ConfigError."""
    try:
        found = np.asarray(points)
    except ValueError:  # rows of different length
        found = np.empty(0, dtype=object)
    if found.ndim != 2 or found.shape[1] != 2 or found.dtype.kind not in "fiu":
        raise ConfigError("track: must be a list of way-points [north, east] in metres")
    if len(found) < 2:
        raise ConfigError(f"track: {len(found)} way-point; a track needs at least 2")
    found = found.astype(np.float64)  # a copy: the caller may change his
    for i in np.flatnonzero(~(np.abs(found) <= FARTHEST).all(axis=1))[:1]:
        raise ConfigError(
            f"way-point {i} = {found[i].tolist()}: must be two finite numbers up to {FARTHEST:g} m"
        )
    return found
