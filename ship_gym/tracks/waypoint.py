"""What a route is made of: way-points on the earth and the legs between them."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

from ship_gym.charts import geodesy
from ship_gym.config import ConfigError, check_known, check_number, shown

GEOMETRIES = ("loxodrome", "orthodrome")
LARGEST_COUNT = 20_000  # way-points of a route
_LONGEST_NAME = 1000  # characters
_NO_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_PLACES = 12  # decimals of a degree of a wrapped longitude: what 360 added may have lost
_FARTHEST_ASIDE = 1e6  # [m]
_FASTEST = 100.0  # [m/s]


def check_count(count: int) -> None:
    """Refuse more way-points than a track or a route may have."""
    if count > LARGEST_COUNT:
        raise ConfigError(f"track: {count} way-points; at most {LARGEST_COUNT} are allowed")


@dataclasses.dataclass(frozen=True)
class Waypoint:
    """A place to turn at.

    Attributes
    ----------
    latitude, longitude : float
        WGS84 [deg]; a longitude beyond 180 is taken round the earth to within [-180, 180).
    name : str
    radius : float, optional
        Planned turn [m]; None or 0: a corner. Of the first and the last way-point it says nothing.
    id : int, optional
        Number in an RTZ file.
    """

    latitude: float
    longitude: float
    name: str = ""
    radius: float | None = None
    id: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", checked_name(self.name))
        top = geodesy.HIGHEST
        check_number("latitude", self.latitude, -top, top, "deg", tiny=True)
        longitude = check_number("longitude", self.longitude, -540.0, 540.0, "deg", tiny=True)
        if not -180.0 <= longitude < 180.0:
            longitude = round(float(geodesy.wrap_longitude(longitude)), _PLACES)
        object.__setattr__(self, "longitude", longitude)
        if self.radius is not None:
            check_number("radius", self.radius, 0.0, _FARTHEST_ASIDE, "m")
        if self.id is not None:
            check_number("id", self.id, 0)


@dataclasses.dataclass(frozen=True)
class Leg:
    """From one way-point to the next.

    Attributes
    ----------
    geometry : str
        ``"loxodrome"`` (rhumb line) or ``"orthodrome"`` (great circle, on the ellipsoid).
    port, starboard : float, optional
        Limits of the cross-track distance to either side [m]; 0, too, is none.
    speed_min, speed_max : float, optional
        Planned speeds [m/s].
    """

    geometry: str = "loxodrome"
    port: float | None = None
    starboard: float | None = None
    speed_min: float | None = None
    speed_max: float | None = None

    def __post_init__(self) -> None:
        check_known("geometry", self.geometry, GEOMETRIES)
        for name in ("port", "starboard"):
            if (value := getattr(self, name)) is not None:
                check_number(name, value, 0.0, _FARTHEST_ASIDE, "m")
        for name in ("speed_min", "speed_max"):
            if (value := getattr(self, name)) is not None:
                check_number(name, value, 0.0, _FASTEST, "m/s")


def checked_name(name: Any) -> str:
    """A name without spaces at its ends, or ConfigError if XML could not hold it."""
    if not isinstance(name, str) or len(name) > _LONGEST_NAME or _NO_XML.search(name):
        raise ConfigError(
            f"name = {shown(name)}: must be a text of at most {_LONGEST_NAME} characters without "
            "control characters"
        )
    return name.strip()
