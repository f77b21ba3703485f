"""Sections of the scenario of a track: which one, where the ship starts, how far off it may be."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from ship_gym.config import ConfigError, check_fields, check_known, shown
from ship_gym.tasks import base
from ship_gym.tracks.generator import MARGIN
from ship_gym.tracks.shapes import SHAPES


@dataclasses.dataclass(frozen=True)
class TrackRange:
    """The track to sail (task ``track_following``), lengths in ship lengths L.

    Attributes
    ----------
    kind : str
        ``random``, the name of a shape (``ship_gym.tracks.shapes.SHAPES``) or ``points``.
    legs : int
        Number of legs of a random track.
    leg_min, leg_max : float
        Length of a leg [L], uniform between them.
    turn_max_deg : float
        Largest course change.
    turn_radius : float
        Radius of a turn that the ship can follow [L]; course changes of a random track are limited
        so that a turn fits between its neighbours, and a given track is refused where none fits.
    any_turns : bool
        Sail a given track even so.
    acceptance : float
        Radius of a circle about a way-point in which the next leg begins too [L], at most a quarter
        of the shorter leg that ends there, and none at the last; 0: only across the bisector.
    look_ahead : float
        Distance of the point on the leg that the look-ahead error aims at [L].
    points : tuple of tuples of float
        North and east of the way-points [m], for ``kind = "points"``; in metres of the ship that
        sails, model or not.
    file : str
        Or a file with them: a route (RTZ, GPX) or GeoJSON, see ``tracks.files``. Cross-track limits
        of its legs are the corridor there.
    geometry : str
        How the legs of a file are meant that does not say so: ``loxodrome`` or ``orthodrome``; "":
        as the format has it.
    """

    PATHS: ClassVar = ("file",)  # keys that a scenario file gives from its own folder

    kind: str = "random"
    legs: int = 5
    leg_min: float = 3.0
    leg_max: float = 15.0
    turn_max_deg: float = 90.0
    turn_radius: float = 3.0
    any_turns: bool = False
    acceptance: float = 0.0
    look_ahead: float = 3.0
    points: tuple[tuple[float, ...], ...] = ()
    file: str = ""
    geometry: str = ""

    def __post_init__(self):
        check_known("kind of track", self.kind, ("random", "points", *SHAPES))
        ranges = {
            "legs": (1, 100, "-"),
            "leg_max": (0.1, 1000.0, "L"),
            "leg_min": (0.1, self.leg_max, "L"),
            "turn_max_deg": (0.0, 150.0, "deg"),
            "turn_radius": (1e-3, 100.0, "L"),
            "acceptance": (0.0, 20.0, "L"),
            "look_ahead": (0.1, 100.0, "L"),
        }
        check_fields("track", self, ranges)
        if self.leg_min <= MARGIN:
            raise ConfigError(f"track.leg_min = {self.leg_min}: allowed is above {MARGIN:g} [L]")
        check_known("track.geometry", self.geometry, ("", "loxodrome", "orthodrome"))
        if self.geometry and not self.file:
            raise ConfigError(f"track.geometry = {shown(self.geometry)}: only of a track.file")
        given = bool(self.points) + bool(self.file)
        if given != (self.kind == "points"):
            raise ConfigError(
                f"track.kind = {shown(self.kind)} with {len(self.points)} points and file = "
                f"{shown(self.file)}: kind = 'points' needs either points or a file, others neither"
            )


@dataclasses.dataclass(frozen=True)
class Start(base.Start):
    """Distribution of the start.

    Attributes
    ----------
    heading_error_deg : float
        Uniform within plus and minus this, of the ordered heading or the first leg.
    cross_track : float
        Distance from the first leg, uniform within plus and minus this [L].
    """

    cross_track: float = 0.0

    def __post_init__(self):
        super().__post_init__()
        check_fields("start", self, {"cross_track": (0.0, 100.0, "L")})


@dataclasses.dataclass(frozen=True)
class Limits:
    """What ends an episode as failed.

    Attributes
    ----------
    cross_track : float
        Distance from the route, the nearest of the previous, the active and the next leg [L].
    corridor : float
        The same, but leaving it only costs the success; passing the end outside it is failing [L].
        Where a leg of the track has a limit of its own to port or to starboard, that is the
        corridor on its side, and the episode ends at ``cross_track / corridor`` times it.
    """

    cross_track: float = 5.0
    corridor: float = 1.5

    def __post_init__(self):
        allowed = (0.1, 100.0, "L")
        check_fields("limits", self, {"cross_track": allowed, "corridor": allowed})
