"""Tracks to sail: way-points, named shapes, random tracks, files, and where a ship is on a leg.

``guidance`` holds kernels and is imported by who needs it, so that this package stays light.
"""

from ship_gym.tracks.files import load_route, load_track, save_track
from ship_gym.tracks.generator import n_draws, random_points
from ship_gym.tracks.route import Route
from ship_gym.tracks.shapes import SHAPES, shape_track
from ship_gym.tracks.simplify import simplified
from ship_gym.tracks.track import Track
from ship_gym.tracks.waypoint import Leg, Waypoint

__all__ = [
    "SHAPES",
    "Leg",
    "Route",
    "Track",
    "Waypoint",
    "load_route",
    "load_track",
    "n_draws",
    "random_points",
    "save_track",
    "shape_track",
    "simplified",
]
