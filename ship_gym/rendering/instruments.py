"""The instruments beside the plan view: compass, rudder, rate of turn, speed, propeller, reward."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.conventions import DELTA, PSI, N, R
from ship_gym.rendering.canvas import (
    BLUE,
    DEGREE,
    GREEN,
    INK,
    LINE,
    MUTED,
    ORANGE,
    PALE,
    PAPER,
    RED,
    Canvas,
    toward,
)
from ship_gym.rendering.scene import Scene

WIDTH = 320.0  # of the panel [design units]
_EDGE = 18.0
_ROW = 40.0  # least height of an instrument
_TERM, _REWARD = 14.0, 40.0  # heights of a reward term and of what is above the first
_BAR = 19.0  # from the top of a row to its bar
_THICK = 8.0  # of a bar


def draw_instruments(canvas: Canvas, scene: Scene, left: float) -> None:
    """Draw the panel from `left` [design units] to the right edge of the picture."""
    canvas.cover(left, 0.0, WIDTH, canvas.height)
    canvas.line([(left, 0.0), (left, canvas.height)], LINE, 1.0)
    x, width = left + _EDGE, WIDTH - 2.0 * _EDGE
    canvas.text((x, 30), f"{scene.time:.1f} s", 18)
    scale = "full scale" if scene.scale == 1.0 else f"model 1 : {scene.scale:.4g}"
    canvas.text((x + width, 30), scale, 11, MUTED, "rs")
    _draw_compass(canvas, scene, (x + 68.0, 120.0), 56.0)
    _draw_angles(canvas, scene, x + 150.0, x + width)
    rows = [_draw_rudder, _draw_turn, _draw_speed, _draw_propeller]
    rows += [] if scene.track is None else [_draw_cross_track]
    y = 202.0
    room = canvas.height - y - _REWARD - _TERM * len(scene.reward_terms)
    pitch = min(max(room / len(rows), _ROW), 1.2 * _ROW)
    for draw in rows:
        draw(canvas, scene, x, y, width)
        y += pitch
    _draw_reward(canvas, scene, x, y + 4.0, width)


def _draw_compass(canvas: Canvas, scene: Scene, centre, radius: float) -> None:
    """North-up rose: the needle is the heading, the blue mark the order, red arcs the limits."""
    x, y = centre
    canvas.circle(centre, radius, None, LINE, 1.4)
    order = scene.psi_ordered
    if order is not None and scene.heading_limit is not None and scene.heading_limit < math.pi:
        free = (order + scene.heading_limit) % (2.0 * math.pi)
        beyond = 2.0 * (math.pi - scene.heading_limit)
        canvas.arc(centre, radius + 1.0, free, free + beyond, RED, 3.0)
    for degrees in range(0, 360, 10):
        way = toward(math.radians(degrees))
        inner = radius - (8.0 if degrees % 30 == 0 else 4.0)
        canvas.line([centre + inner * way, centre + (radius - 1.0) * way], MUTED, 0.8)
    for name, degrees in (("N", 0), ("E", 90), ("S", 180), ("W", 270)):
        place = centre + (radius - 17.0) * toward(math.radians(degrees))
        canvas.text(place, name, 11, MUTED, "mm")
    if order is not None:
        _draw_mark(canvas, centre, radius, order)
    ahead = toward(scene.state[PSI])
    abeam = np.array([-ahead[1], ahead[0]])
    body = np.array([[38, 0], [24, 6.5], [-30, 6.5], [-30, -6.5], [24, -6.5]]) * radius / 60.0
    canvas.polygon(np.array([x, y]) + body @ np.stack([ahead, abeam]), INK)


def _draw_mark(canvas: Canvas, centre, radius: float, order: float) -> None:
    """Blue triangle outside the rose, its tip on the ordered heading."""
    way = toward(order)
    side = 5.5 * np.array([-way[1], way[0]])
    foot = centre + (radius + 11.0) * way
    canvas.polygon([centre + (radius + 1.0) * way, foot + side, foot - side], BLUE)


def _draw_angles(canvas: Canvas, scene: Scene, x: float, right: float) -> None:
    """Heading, order, error and what the waves add, as numbers."""
    rows = [("Heading", f"{math.degrees(scene.state[PSI]) % 360.0:05.1f}{DEGREE}", INK)]
    error = scene.heading_error
    if scene.psi_ordered is not None and error is not None:
        rows.append(("Ordered", f"{math.degrees(scene.psi_ordered) % 360.0:05.1f}{DEGREE}", BLUE))
        rows.append(("Error", _degrees(error), INK))
    u, v = scene.water_velocity
    rows.append(("Drift angle", _degrees(math.atan2(-v, u)), INK))
    if scene.wave_height > 0.0:
        rows.append(("Yaw in waves", _degrees(scene.wave_yaw), INK))
        rows.append(("Roll in waves", _degrees(scene.wave_roll), INK))
    y = 120.0 - 0.5 * 22.0 * (len(rows) - 1)
    for label, value, color in rows:
        canvas.text((x, y), label, 11, MUTED, "lm")
        canvas.text((right, y), value, 13, color, "rm")
        y += 22.0


def _draw_rudder(canvas: Canvas, scene: Scene, x: float, y: float, width: float) -> None:
    delta, command = float(scene.state[DELTA]), float(scene.command[0])
    value = f"{_degrees(delta)}   command {_degrees(command)}"
    _draw_label(canvas, x, y, width, "Rudder", value)
    limit = scene.delta_max
    _draw_centred(canvas, x, y, width, delta / limit, f"{math.degrees(limit):.3g}{DEGREE}")
    _draw_command(canvas, x + 0.5 * width * (1.0 + _unit(command / limit)), y)


def _draw_turn(canvas: Canvas, scene: Scene, x: float, y: float, width: float) -> None:
    """Rate of turn; the bar ends at one ship length per radian, U0 / L."""
    limit = scene.U0 / scene.L
    _draw_label(canvas, x, y, width, "Rate of turn", f"{_degrees(scene.state[R], 2)}/s")
    end = f"{math.degrees(limit):.3g}{DEGREE}/s"
    _draw_centred(canvas, x, y, width, scene.state[R] / limit, end)


def _draw_speed(canvas: Canvas, scene: Scene, x: float, y: float, width: float) -> None:
    """Speed through the water; the mark is U0, the bar ends at 1.25 U0."""
    speed = math.hypot(*scene.water_velocity)
    value = f"{_number(speed)} m/s   {_number(speed / scene.U0)} U0"
    _draw_label(canvas, x, y, width, "Speed through water", value)
    _draw_filled(canvas, x, y, width, speed / (1.25 * scene.U0), "1.25 U0")
    canvas.line([(x + 0.8 * width, y + _BAR - 2.0), (x + 0.8 * width, y + _BAR + 10.0)], INK, 1.2)
    canvas.text((x + 0.8 * width, y + 37.0), "U0", 9, MUTED, "ms")


def _draw_propeller(canvas: Canvas, scene: Scene, x: float, y: float, width: float) -> None:
    n, command = float(scene.state[N]), float(scene.command[1])
    value = f"{_number(n)} rev/s   command {_number(command)}"
    _draw_label(canvas, x, y, width, "Propeller", value)
    _draw_filled(canvas, x, y, width, n / scene.n_max, f"{_number(scene.n_max)} rev/s")
    _draw_command(canvas, x + width * max(0.0, _unit(command / scene.n_max)), y)


def _draw_cross_track(canvas: Canvas, scene: Scene, x: float, y: float, width: float) -> None:
    off = scene.cross_track / scene.L
    limit = 5.0 if scene.cross_track_limit is None else scene.cross_track_limit / scene.L
    side = "starboard" if off > 0.0 else "port"
    value = f"{_number(abs(scene.cross_track))} m   {_number(abs(off))} L to {side}"
    _draw_label(canvas, x, y, width, "Off track", value)
    _draw_centred(canvas, x, y, width, off / limit, f"{limit:.3g} L")


def _draw_reward(canvas: Canvas, scene: Scene, x: float, y: float, width: float) -> None:
    """Reward and its terms; all bars by one scale, which is named."""
    terms = list(scene.reward_terms.items())
    full = _round_up(max((abs(value) for _, value in terms), default=0.0))
    canvas.line([(x, y - 2.0), (x + width, y - 2.0)], LINE, 1.0)
    canvas.text((x, y + 17.0), "Reward", 11, MUTED)
    canvas.text((x + width, y + 17.0), f"{scene.reward + 0.0:.3g}", 13, INK, "rs")
    if terms:
        canvas.text((x + 0.5 * width, y + 17.0), f"full bar {full:.3g}", 9, MUTED, "ms")
    most = int((canvas.height - y - 26.0) / _TERM)
    if len(terms) > most:
        rest = sum(value for _, value in terms[most - 1 :])
        terms = [*terms[: most - 1], (f"{len(terms) - most + 1} more", rest)]
    start, room = x + 92.0, width - 92.0 - 58.0
    for k, (name, value) in enumerate(terms):
        middle = y + 32.0 + _TERM * k
        canvas.text((x, middle), canvas.fitted(name.replace("_", " "), 10, 86.0), 10, INK, "lm")
        canvas.box(start, middle - 3.5, room, 7.0, PALE)
        size = room * min(abs(value) / full, 1.0)
        canvas.box(start, middle - 3.5, size, 7.0, MUTED if value < 0.0 else BLUE)
        canvas.text((x + width, middle), f"{value + 0.0:.3g}", 10, INK, "rm")


def _draw_label(canvas: Canvas, x: float, y: float, width: float, label: str, value: str) -> None:
    canvas.text((x, y + 13.0), label, 11, MUTED)
    canvas.text((x + width, y + 13.0), value, 12, INK, "rs")


def _draw_centred(canvas, x: float, y: float, width: float, share: float, end: str) -> None:
    """Bar from the middle, red to port and green to starboard, with the value at its ends."""
    canvas.box(x, y + _BAR, width, _THICK, PALE)
    middle, size = x + 0.5 * width, 0.5 * width * abs(_unit(share))
    start, color = (middle - size, RED) if share < 0.0 else (middle, GREEN)
    canvas.box(start, y + _BAR, size, _THICK, color)
    canvas.line([(middle, y + _BAR - 2.0), (middle, y + _BAR + 10.0)], INK, 1.2)
    canvas.text((x, y + 37.0), f"{end} port", 9, MUTED, "ls")
    canvas.text((x + width, y + 37.0), f"{end} starboard", 9, MUTED, "rs")


def _draw_filled(canvas, x: float, y: float, width: float, share: float, end: str) -> None:
    """Bar from the left, with the value at its end."""
    canvas.box(x, y + _BAR, width, _THICK, PALE)
    canvas.box(x, y + _BAR, width * max(0.0, _unit(share)), _THICK, MUTED)
    canvas.text((x, y + 37.0), "0", 9, MUTED, "ls")
    canvas.text((x + width, y + 37.0), end, 9, MUTED, "rs")


def _draw_command(canvas: Canvas, x: float, y: float) -> None:
    """Orange mark across a bar at what was commanded."""
    canvas.box(x - 3.0, y + _BAR - 4.0, 6.0, _THICK + 8.0, PAPER, 2)
    canvas.box(x - 2.0, y + _BAR - 3.0, 4.0, _THICK + 6.0, ORANGE, 1.5)


def _unit(share: float) -> float:
    """Limit to [-1, 1]."""
    return min(max(float(share), -1.0), 1.0)


def _degrees(angle: float, digits: int = 1) -> str:
    """Signed degrees; positive is to starboard."""
    value = round(math.degrees(angle), digits) + 0.0  # no "-0.0"
    return f"{value:+.{digits}f}{DEGREE}"


def _number(value: float) -> str:
    """Up to two decimals, fewer for a large value; powers of ten where that would be long."""
    size = abs(value)
    return (
        f"{value:.{2 if size < 10.0 else 1 if size < 100.0 else 0}f}"
        if size < 1e5
        else (f"{value:.2g}")
    )


def _round_up(value: float) -> float:
    """The next 1, 2 or 5 times a power of ten; 1 for zero."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return power * next(k for k in (1.0, 2.0, 5.0, 10.0) if k * power >= value * (1.0 - 1e-9))
