"""The water of the 3-D view: a coarse grid that moves with the ship and with the waves."""

from __future__ import annotations

import numpy as np
import rerun as rr

from ship_gym.recording.rerun_export.log import Output, log, log_style
from ship_gym.recording.rerun_export.rows import first_in_step, send_chosen
from ship_gym.recording.wave_grid import SHADES, Grid

_PATH = "world/sea"
_DEEP, _BRIGHT = np.array([14, 52, 92]), np.array([108, 168, 204])
_ALPHA = 180  # of 255: rudder and propeller are seen through it


def send_water(out: Output, grid: Grid, t: np.ndarray, points: np.ndarray, chosen) -> None:
    """Send the pictures of the water that are due in the rows that are new.

    Parameters
    ----------
    out : Output
    grid : Grid
    t : numpy.ndarray
        Times [s], shape (T,).
    points : numpy.ndarray
        Places of the ship [m], shape (T, 3).
    chosen : numpy.ndarray of bool
        Rows that are shown at all.
    """
    if out.fixed:
        look = {"triangle_indices": grid.triangles, "albedo_factor": [255, 255, 255, _ALPHA]}
        log_style(out, _PATH, rr.Mesh3D, **look)
        look = {"vertex_positions": grid.rim, "triangle_indices": grid.rim_triangles}
        flat = [*_palette()[SHADES // 2].tolist(), _ALPHA]
        log(out, f"{_PATH}/rim", rr.Mesh3D(**look, albedo_factor=flat))
    due = chosen & first_in_step(t, grid.step)

    def pictures(new):
        rows = np.flatnonzero(new)
        heights, shades = grid.pictures(t[rows], points[rows, :2])
        corners = np.zeros((len(rows), len(grid.x), 3), dtype=np.float32)
        corners[..., 0], corners[..., 1] = grid.x, grid.y
        corners[..., 2] = -heights
        red, green, blue = np.moveaxis(_palette()[shades], -1, 0)
        colors = red << 24 | green << 16 | blue << 8 | 0xFF
        columns = rr.Mesh3D.columns(
            vertex_positions=corners.reshape(-1, 3), vertex_colors=colors.ravel()
        )
        places = rr.Transform3D.columns(translation=points[rows])
        return [*places, *columns.partition([len(grid.x)] * len(rows))]

    send_chosen(out, _PATH, t, due, pictures)


def _palette() -> np.ndarray:
    """Red, green and blue of the shades, uint32, shape (SHADES, 3)."""
    share = np.linspace(0.0, 1.0, SHADES)[:, None]
    return np.rint(_DEEP + share * (_BRIGHT - _DEEP)).astype(np.uint32)
