"""The plan view: sea, wake, order or track, ship, and the cards over them."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

from ship_gym.conventions import DELTA, PSI, G, N, U, V
from ship_gym.recording.hull_shape import deck_outline
from ship_gym.rendering.camera import Camera, clipped, nearest_foot
from ship_gym.rendering.canvas import (
    BLUE,
    CREST,
    GREEN,
    GRID,
    INK,
    MUTED,
    PAPER,
    RED,
    SEA,
    WAKE,
    Canvas,
    Color,
    bearing,
    toward,
)
from ship_gym.rendering.cards import draw_cards
from ship_gym.rendering.scene import Scene

_SMALLEST_SHIP = 34.0  # length on the picture below which the ship is drawn larger than it is
_CLOSEST_GRID, _CLOSEST_CREST = 36.0, 26.0
_MOST_WAKE_POINTS = 400
_LEGS_ABOUT = 40  # before and after the active one, whose own corridor is drawn


def draw_chart(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """Draw the whole plan view; what lies beyond its right edge is for others to cover."""
    if scene.wave_height > 0.0 and scene.wave_period > 0.0:
        _draw_crests(canvas, camera, scene)
    cells = _draw_grid(canvas, camera, scene)
    if scene.track is not None:
        _draw_track(canvas, camera, scene)
    for run in camera.runs(_thinned(scene.wake)):
        canvas.line(run, WAKE, 2.0)
    if scene.track is None and scene.psi_ordered is not None:
        _draw_order(canvas, camera, scene)
    _draw_ship(canvas, camera, scene)
    draw_cards(canvas, camera, scene, cells)


def _thinned(wake: np.ndarray) -> np.ndarray:
    """The newest part of a wake, with not more points than a picture can show."""
    recent = wake[-8 * _MOST_WAKE_POINTS :]
    step = max(1, math.ceil(len(recent) / _MOST_WAKE_POINTS))
    return recent[::-1][::step]


def _draw_crests(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """Crests of a wave of the peak period in deep water, which run with their phase speed."""
    length = G * scene.wave_period**2 / (2.0 * math.pi)
    gap = length * camera.scale
    every = 2 ** max(0, math.ceil(math.log2(_CLOSEST_CREST / gap))) if gap > 0.0 else 1
    to = scene.wave_direction_to
    north, east = camera.centre
    along = (north * math.cos(to) + east * math.sin(to)) / length
    phase = (scene.time / scene.wave_period - along) / every
    reach = 0.5 * math.hypot(camera.width, camera.height)
    gap *= every
    count = math.ceil(reach / gap)
    middle, step = 0.5 * np.array([camera.width, camera.height]), toward(to)
    across = reach * np.array([-step[1], step[0]])
    at = middle + np.outer((np.arange(-count, count + 1) + phase % 1.0) * gap, step)
    size = (camera.width, camera.height)
    for start, end, seen in zip(*clipped(at - across, at + across, size), strict=True):
        if seen:
            canvas.line([start, end], CREST, min(0.16 * gap, 12.0))


def _draw_grid(canvas: Canvas, camera: Camera, scene: Scene) -> int:
    """Lines at whole ship lengths from the origin; returns how many lengths lie between two."""
    unit = scene.L * camera.scale
    rough = max(_CLOSEST_GRID / unit, 1.0)
    power = 10.0 ** math.floor(math.log10(rough))
    cells = round(power * next(k for k in (1.0, 2.0, 5.0, 10.0) if k * power >= rough * 0.999))
    size = cells * scene.L
    sides = np.array([camera.height, camera.width]) / camera.scale
    low = np.floor((camera.centre - 0.5 * sides) / size)
    for axis in (0, 1):
        count = int(sides[axis] / size) + 2
        places = camera.place(np.outer(low[axis] + np.arange(count), [size, size]))
        for x, y in places:
            ends = [(0.0, y), (camera.width, y)] if axis == 0 else [(x, 0.0), (x, camera.height)]
            canvas.line(ends, GRID, 0.6)
    return cells


def _draw_order(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """Rays of the ordered heading and of the errors that end the episode."""
    centre, unit = camera.place(scene.position), scene.L * camera.scale
    order, reach = scene.psi_ordered, 1.6 * unit
    assert order is not None
    if scene.heading_limit is not None:
        for side in (-1.0, 1.0):
            ray = toward(order + side * scene.heading_limit)
            canvas.dashed(centre + 0.75 * unit * ray, centre + reach * ray, RED, 1.4)
            place = centre + (reach + 14.0) * ray
            canvas.text(place, "limit", 11, RED, "mm", SEA)
    ray = toward(order)
    canvas.line([centre, centre + reach * ray], BLUE, 1.8)
    canvas.circle(centre + reach * ray, 3.0, BLUE)
    label = f"ordered {bearing(order)}"
    room = 12.0 + 0.5 * canvas.text_width(label, 11) * abs(ray[0])
    canvas.text(centre + (reach + room) * ray, label, 11, BLUE, "mm", SEA)


def _draw_track(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    track, leg = np.asarray(scene.track, dtype=float), scene.active_leg
    for run in camera.runs(track):
        canvas.line(run, MUTED, 1.2, joint=True)
    _draw_limits(canvas, camera, scene, track)
    for run in camera.runs(track[leg : leg + 2]):
        canvas.line(run, BLUE, 2.4)
    turning = scene.turning_points
    next_one = next(point for point in turning if point > leg)
    for number, point in enumerate(turning, start=1):
        x, y = camera.place(track[point])
        if -10.0 < x < camera.width + 10.0 and -10.0 < y < camera.height + 10.0:
            color = BLUE if point == next_one else MUTED
            canvas.circle((x, y), 5.0, PAPER, color, 2.0)
            canvas.text((x + 9, y - 6), f"{number}", 11, color, "ls", SEA)
    _draw_offset(canvas, camera, scene)


def _draw_limits(canvas: Canvas, camera: Camera, scene: Scene, track: np.ndarray) -> None:
    """Limit and corridor beside the active leg; of legs with their own, beside those about it."""
    leg, corridor, limit = scene.active_leg, scene.corridor, scene.cross_track_limit
    if scene.leg_limits is None:
        legs, beside = range(leg, leg + 1), np.array([[corridor or 0.0] * 2])
    else:
        legs = range(max(leg - _LEGS_ABOUT, 0), min(leg + _LEGS_ABOUT, len(track) - 1))
        beside = scene.leg_limits[legs[0] : legs[-1] + 1]
    for k, own in zip(legs, beside.tolist(), strict=True):
        ends = track[k : k + 2]
        if limit is not None:
            farther = limit / corridor if corridor and scene.leg_limits is not None else 0.0
            aside = [farther * side for side in own] if farther else [limit, limit]
            _draw_beside(canvas, camera, ends, aside, RED)
        if corridor is not None:
            _draw_beside(canvas, camera, ends, own, BLUE)


def _draw_beside(
    canvas: Canvas, camera: Camera, ends: np.ndarray, aside: Sequence[float], color: Color
) -> None:
    """Dashed lines beside a leg, so far to port and to starboard [m]."""
    along = ends[1] - ends[0]
    length = float(np.hypot(*along))
    if length == 0.0:
        return
    starboard = np.array([-along[1], along[0]]) / length
    for side, distance in zip((-1.0, 1.0), aside, strict=True):
        for run in camera.runs(ends + side * distance * starboard):
            canvas.dashed(run[0], run[-1], color, 1.2)


def _draw_offset(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """Line from the ship to the nearest leg, with the distance where there is room."""
    ends = np.stack([nearest_foot(scene), scene.position])
    for run in camera.runs(ends):
        canvas.dashed(run[0], run[-1], INK, 1.0, 3.0)
    start, end = camera.place(ends)
    off = scene.cross_track / scene.L
    if math.dist(start, end) > 60.0:
        text = f"{abs(off):.3g} L to {'starboard' if off > 0.0 else 'port'}"
        canvas.text(0.5 * (start + end) + (8.0, 0.0), text, 11, INK, "lm", SEA)


@functools.lru_cache(maxsize=8)
def _outline(L: float, B: float) -> np.ndarray:
    """Deck edge in body axes [m], every third point; its shape does not depend on the draught."""
    return deck_outline(L, B, 0.05 * L)[::3]


def _draw_ship(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """Hull, bridge, rudder and race to scale, or larger where they would be too small to see."""
    state, centre = scene.state, camera.place(scene.position)
    grown = max(1.0, _SMALLEST_SHIP / (scene.L * camera.scale)) * camera.scale
    ahead = toward(state[PSI] + scene.wave_yaw)
    abeam = np.array([-ahead[1], ahead[0]])
    axes, L, B = grown * np.stack([ahead, abeam]), scene.L, scene.B

    def body(points):
        return centre + np.asarray(points, dtype=float) @ axes

    race = min(max(float(state[N]) / scene.n_max, 0.0), 1.5)
    for y in (-0.12, 0.0, 0.12):
        canvas.line(body([(-0.53 * L, y * B), (-(0.53 + 0.22 * race) * L, y * B)]), PAPER, 1.4)
    _draw_course(canvas, scene, centre, grown)
    canvas.polygon(body(_outline(L, B)), INK, PAPER, 0.8)
    house = [(-0.36, -0.38), (-0.28, -0.38), (-0.28, 0.38), (-0.36, 0.38)]
    canvas.polygon(body([(x * L, y * B) for x, y in house]), PAPER)
    delta = state[DELTA]  # positive: trailing edge to starboard
    chord = 0.09 * L
    stock = np.array([-0.49 * L, 0.0])
    blade = [stock, stock + chord * np.array([-math.cos(delta), math.sin(delta)])]
    canvas.line(body(blade), _side_color(delta), 3.2)


def _side_color(value: float) -> Color:
    """Red for port, green for starboard, grey for neither."""
    return GREEN if value > 1e-3 else RED if value < -1e-3 else MUTED


def _draw_course(canvas: Canvas, scene: Scene, centre: np.ndarray, grown: float) -> None:
    """Arrow of the velocity over ground, one length long at U0, from the middle of the ship."""
    u, v = scene.state[U], scene.state[V]
    speed = math.hypot(u, v)
    if speed > 1e-3 * scene.U0:
        way = toward(scene.state[PSI] + math.atan2(v, u))
        reach = min(speed / scene.U0, 2.0) * scene.L * grown
        canvas.arrow(centre, centre + reach * way, INK, 1.4, 8.0)
