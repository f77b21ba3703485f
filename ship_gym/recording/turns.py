"""Moments of a manoeuvre: orders, quarters of a turn, where the heading turns back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ship_gym.recording.task_error import DEGREE

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

_MOST_ORDERS = 60  # more are no steps of an order
_STEP = 1e-9  # smaller changes of a command are rounding [rad, rev/s]


def turn_marks(trajectory: Trajectory) -> Iterator[tuple[float, str]]:
    """Times [s] and texts of a manoeuvre's moments; none of an episode.

    New orders of rudder and propeller; each quarter of a turn under one order; after a reversed
    order, as in a zig-zag, where the heading turns back.
    """
    if not is_manoeuvre(trajectory):
        return
    orders = _orders(trajectory, "delta_command")
    for row in orders:
        yield float(trajectory["t"][row]), f"rudder ordered {_rudder(trajectory, row)}"
    for row in _orders(trajectory, "n_command"):
        order = trajectory["n_command"][row]
        yield float(trajectory["t"][row]), f"propeller ordered to {order:.3g} rev/s"
    if "psi" in trajectory:
        yield from _reversals(trajectory, orders) if orders else _quarters(trajectory)


def is_manoeuvre(trajectory: Trajectory) -> bool:
    """Whether a recording is of a manoeuvre, not of an episode."""
    config = trajectory.meta.get("config")
    named = isinstance(config, dict) and "manoeuvre" in config
    return named or trajectory.meta.get("kind") == "manoeuvre"


def _orders(trajectory: Trajectory, name: str) -> list[int]:
    """Rows after the first from which a command has another value."""
    if name not in trajectory:
        return []
    rows = (np.flatnonzero(np.abs(np.diff(trajectory[name])) > _STEP) + 1).tolist()
    return rows if len(rows) <= _MOST_ORDERS else []


def _rudder(trajectory: Trajectory, row: int) -> str:
    angle = math.degrees(trajectory["delta_command"][row])
    side = "starboard" if angle > 0.0 else "port"
    return "midships" if abs(angle) < 0.05 else f"{abs(angle):.3g}{DEGREE} to {side}"


def _quarters(trajectory: Trajectory) -> Iterator[tuple[float, str]]:
    """Quarters of the first turn and then every half, with the row that has reached each."""
    turned = np.abs(np.unwrap(trajectory["psi"]) - trajectory["psi"][0])
    for quarter in range(1, int(turned.max() / (0.5 * math.pi)) + 1):
        if quarter > 4 and quarter % 2:
            continue
        row = int(np.argmax(turned >= quarter * 0.5 * math.pi))
        yield float(trajectory["t"][row]), f"{90 * quarter}{DEGREE} turned"


def _reversals(trajectory: Trajectory, orders: list[int]) -> Iterator[tuple[float, str]]:
    """Where the heading, after an order, first turns the other way."""
    t, psi = trajectory["t"], np.unwrap(trajectory["psi"])
    for order, end in zip(orders, [*orders[1:], len(psi)], strict=True):
        rate = np.diff(psi[order - 1 : end])
        back = np.flatnonzero(rate * rate[0] < 0.0)
        if len(back):
            row = order - 1 + int(back[0])
            change = math.degrees(psi[row] - psi[0])
            side = "starboard" if change > 0.0 else "port"
            yield float(t[row]), f"heading turns back {abs(change):.3g}{DEGREE} to {side}"
