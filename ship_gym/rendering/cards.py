"""Cards over the plan view: what surrounds the ship, scale, north, overview, how it ended."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import polar
from ship_gym.rendering.camera import Camera
from ship_gym.rendering.canvas import (
    BLUE,
    INK,
    LINE,
    MUTED,
    ORANGE,
    PAPER,
    RED,
    SKY,
    Canvas,
    Color,
    bearing,
    toward,
)
from ship_gym.rendering.scene import Scene


def draw_cards(canvas: Canvas, camera: Camera, scene: Scene, cells: int) -> None:
    """Draw all cards; a cell of the grid is `cells` ship lengths."""
    _draw_scale(canvas, camera, scene, cells)
    _draw_surroundings(canvas, scene)
    _draw_north(canvas, camera)
    if scene.track is not None:
        _draw_overview(canvas, camera, scene)
    if scene.outcome:
        _draw_outcome(canvas, camera, scene)


def _draw_scale(canvas: Canvas, camera: Camera, scene: Scene, cells: int) -> None:
    """Bar of one grid cell, in ship lengths and metres, and what the ship's arrow means."""
    texts = (f"{cells} L = {cells * scene.L:.4g} m", "velocity over ground")
    width = cells * scene.L * camera.scale
    x, y = 16.0, camera.height - 18.0
    second = x + max(width, canvas.text_width(texts[0], 11)) + 18.0
    right = second + canvas.text_width(texts[1], 11)
    canvas.cover(8, y - 24, right, 34, 4)
    canvas.line([(x, y), (x + width, y)], INK, 1.4)
    for end in (x, x + width):
        canvas.line([(end, y - 4), (end, y + 4)], INK, 1.4)
    canvas.arrow((second, y), (second + 40.0, y), INK, 1.4, 8.0)
    canvas.text((x, y - 9), texts[0], 11)
    canvas.text((second, y - 9), texts[1], 11)


def _draw_north(canvas: Canvas, camera: Camera) -> None:
    x, y = camera.width - 24.0, 30.0
    canvas.cover(x - 16.0, y - 16.0, 32.0, 32.0, 16)
    canvas.polygon([(x, y - 13), (x + 5, y + 1), (x, y - 2), (x - 5, y + 1)], INK)
    canvas.text((x, y + 8), "N", 10, anchor="mm")


def _draw_surroundings(canvas: Canvas, scene: Scene) -> None:
    """Card with a small arrow and the numbers of each of waves, wind and current."""
    rows: list[tuple[float, Color, str]] = []
    if scene.wave_height > 0.0:
        to = scene.wave_direction_to
        text = f"H {scene.wave_height:.3g} m, T {scene.wave_period:.3g} s"
        rows.append((to, BLUE, f"Waves  {text}, from {bearing(to + math.pi)}"))
    speed, to = polar(*scene.wind)
    if speed > 0.0:
        rows.append((to, MUTED, f"Wind  {speed:.3g} m/s from {bearing(to + math.pi)}"))
    speed, to = polar(*scene.current)
    if speed > 0.0:
        rows.append((to, SKY, f"Current  {speed:.3g} m/s to {bearing(to)}"))
    title = canvas.fitted(f"{scene.task}, {scene.ship}", 14, 330.0)
    texts = [text for *_, text in rows] or ["No waves, wind or current"]
    widest = max(canvas.text_width(text, 11) for text in texts) + (28 if rows else 0)
    width = max(widest, canvas.text_width(title, 14))
    canvas.cover(8, 8, width + 20, 30 + 24 * len(texts), 4)
    canvas.text((18, 28), title, 14)
    for k, text in enumerate(texts):
        y = 48.0 + 24.0 * k
        if rows:
            to, color, _ = rows[k]
            canvas.circle((28, y), 10.0, None, LINE, 1.0)
            canvas.arrow((28, y) - 8.0 * toward(to), (28, y) + 9.0 * toward(to), color, 2.0, 7.0)
        canvas.text((46 if rows else 18, y), text, 11, MUTED if not rows else INK, "lm")


def _draw_overview(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """The whole track with the ship on it, small, in the corner."""
    width, height, edge = 132.0, 104.0, 12.0
    x, y = camera.width - width - 8.0, camera.height - height - 8.0
    canvas.cover(x, y, width, height, 4)
    track = np.asarray(scene.track, dtype=float)
    points = np.concatenate([track, scene.position[None]])
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.array([height, width]) - 2.0 * edge
    scale = float((room / np.maximum(high - low, scene.L)).min())
    away = (points - 0.5 * (low + high)) * scale
    places = np.array([x + 0.5 * width, y + 0.5 * height]) + away[:, ::-1] * (1.0, -1.0)
    canvas.line(places[:-1], MUTED, 1.2)
    canvas.line(places[scene.active_leg : scene.active_leg + 2], BLUE, 2.0)
    canvas.circle(places[-1], 3.4, ORANGE, INK, 1.0)


def _draw_outcome(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    failed = "limit" in scene.outcome
    text = canvas.fitted(scene.outcome, 15, 0.5 * camera.width)
    width = canvas.text_width(text, 15) + 32.0
    x, y = 0.5 * (camera.width - width), camera.height - 96.0
    canvas.cover(x, y, width, 32.0, 16)
    canvas.box(x + 1.0, y + 1.0, width - 2.0, 30.0, RED if failed else BLUE, 15)
    canvas.text((0.5 * camera.width, y + 16.0), text, 15, PAPER, "mm")
