"""Moments of a run that a reader looks for: largest error, limits, failures, legs, the end."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ship_gym.conventions import wrap_angle
from ship_gym.physics._kernel import in_python
from ship_gym.physics.propeller import shaft_power
from ship_gym.recording.surroundings import section, speed_through_water
from ship_gym.recording.task_error import DEGREE, steps, task_error, worst_row
from ship_gym.recording.turns import is_manoeuvre, turn_marks

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

KINDS = ("error", "saturation", "limit", "failure", "leg", "end")
AT_LIMIT = 0.999  # share of a limit that counts as reached, as for the metric ``saturation``
_APART = 30.0  # spells at a limit that are closer are one [full-scale s]
_MOST = 3  # spells of one kind that are marked, the longest
_SLOW = 0.5  # share of the nominal speed
# Columns that say how far the model is outside what it was made from.
_OUTSIDE = {
    "extrapolation": ("propeller or rudder outside their trained box", "its size"),
    "waves_extrapolation": ("faster than the wave table goes", "its fastest"),
}


class Mark(NamedTuple):
    """A moment: its time [s, of the ship that sails], one of `KINDS`, and a text for people."""

    time: float
    kind: str
    text: str


def marks(trajectory: Trajectory) -> list[Mark]:
    """Moments of a run in the order of time.

    Parameters
    ----------
    trajectory : Trajectory
        An episode or a manoeuvre; what it lacks is not looked for.

    Returns
    -------
    list of Mark
    """
    found = [
        *_errors(trajectory),
        *_saturation(trajectory),
        *_limits(trajectory),
        *_failure(trajectory),
        *_legs(trajectory),
        *_fastest_turn(trajectory),
        *(Mark(time, "leg", text) for time, text in turn_marks(trajectory)),
        _end(trajectory),
    ]
    return sorted(found, key=lambda mark: (mark.time, KINDS.index(mark.kind)))


def worst_moment(trajectory: Trajectory) -> float:
    """Time to look at first [s].

    The end of a run that failed; else the largest error that was made under way; of a run without
    an error, such as a manoeuvre, the fastest turn.
    """
    t = trajectory["t"]
    if trajectory.meta.get("failed"):
        return float(t[-1])
    error = task_error(trajectory)
    if error is not None:
        return float(t[worst_row(trajectory, error)])
    return next((mark.time for mark in _fastest_turn(trajectory)), float(t[-1]))


def time_unit(meta: Mapping) -> float:
    """A second of the ship that sails in full-scale seconds, by Froude's law."""
    return math.sqrt(section(meta, "ship").get("scale", 1.0))


def spells(mask: np.ndarray, t: np.ndarray, apart: float) -> list[tuple[int, int]]:
    """First and last row of each time that a mask holds; those closer than `apart` [s] are one."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]])))
    found: list[tuple[int, int]] = []
    for first, beyond in edges.reshape(-1, 2).tolist():
        if found and t[first] - t[found[-1][1]] < apart:
            found[-1] = (found[-1][0], beyond - 1)
        else:
            found.append((first, beyond - 1))
    return found


def _errors(trajectory: Trajectory) -> Iterator[Mark]:
    """Largest error that was made under way, and that of the start where it is larger."""
    error = task_error(trajectory)
    if error is None:
        return
    t, worst = trajectory["t"], worst_row(trajectory, error)
    at_start = worst > 0 and abs(error.values[0]) > abs(error.values[worst])
    if at_start:
        yield Mark(float(t[0]), "error", f"{error.label} at the start {error.text(0)}")
    aside = ", that of the start aside" if at_start else ""
    yield Mark(float(t[worst]), "error", f"largest {error.label} {error.text(worst)}{aside}")


def _fastest_turn(trajectory: Trajectory) -> Iterator[Mark]:
    """The fastest turn of a run without an error to judge it by."""
    if "r" not in trajectory or task_error(trajectory) is not None:
        return
    row = int(np.argmax(np.abs(trajectory["r"])))
    rate = math.degrees(trajectory["r"][row])
    if rate != 0.0:
        side = "starboard" if rate > 0.0 else "port"
        text = f"fastest turn, {abs(rate):.2g}{DEGREE}/s to {side}"
        yield Mark(float(trajectory["t"][row]), "leg", text)


def _saturation(trajectory: Trajectory) -> Iterator[Mark]:
    limit = section(trajectory.meta, "ship").get("delta_max")
    if limit is None or "delta" not in trajectory:
        return
    delta = trajectory["delta"]
    hard = np.abs(delta) >= AT_LIMIT * limit
    for first, last, text in _longest(trajectory, hard):
        sides = np.sign(delta[first : last + 1][hard[first : last + 1]])
        side = "to starboard" if sides.min() > 0 else "to port" if sides.max() < 0 else "both ways"
        time = float(trajectory["t"][first])
        yield Mark(time, "saturation", f"rudder at its limit {side}, {text}")


def _limits(trajectory: Trajectory) -> Iterator[Mark]:
    """Begin of what lies beyond a limit, but for the rudder angle."""
    for what, mask in _beyond(trajectory):
        for first, _, text in _longest(trajectory, mask):
            yield Mark(float(trajectory["t"][first]), "limit", f"{what}, {text}")
    for name, (what, whole) in _OUTSIDE.items():
        if name in trajectory:
            outside = trajectory[name]
            for first, last, text in _longest(trajectory, outside > 0.0, most=1):
                largest = f"by up to {100.0 * outside[first : last + 1].max():.0f} % of {whole}"
                yield Mark(float(trajectory["t"][first]), "limit", f"{what}, {text}, {largest}")


def _beyond(trajectory: Trajectory) -> Iterator[tuple[str, np.ndarray]]:
    """What is beyond a limit, and in which rows."""
    ship, columns = section(trajectory.meta, "ship"), trajectory.columns
    corridor = section(trajectory.meta, "limits").get("corridor")  # [m]
    if {"off_route", "corridor_port", "corridor_starboard"} <= columns.keys():
        off = columns["off_route"]
        yield (
            "outside the corridor of the leg",
            (off > columns["corridor_starboard"]) | (-off > columns["corridor_port"]),
        )
    elif corridor is not None and "off_route" in columns:
        yield f"outside the corridor of {corridor:.0f} m", np.abs(columns["off_route"]) > corridor
    if {"u", "v", "psi"} <= columns.keys() and ship.get("speed"):
        slow = speed_through_water(columns) < _SLOW * ship["speed"]
        yield "slower through the water than half the nominal speed", slow
    if "n" in columns and ship.get("n_max"):
        yield "propeller at its largest speed", np.abs(columns["n"]) >= AT_LIMIT * ship["n_max"]
    if {"n", "torque"} <= columns.keys() and ship.get("power_max"):
        power = in_python(shaft_power)(columns["n"], columns["torque"])
        yield "engine at its largest power", power >= AT_LIMIT * ship["power_max"]


def _longest(
    trajectory: Trajectory, mask: np.ndarray, most: int = _MOST
) -> Iterator[tuple[int, int, str]]:
    """Longest spells of a mask: first row, last row, how long [s] and of how many spells."""
    t, meta = trajectory["t"], trajectory.meta
    steps = np.append(np.diff(t), 0.0)
    found = spells(mask, t, _APART / time_unit(meta))
    held = {
        (first, last): float(steps[first : last + 1][mask[first : last + 1]].sum())
        for first, last in found
    }
    kept = sorted(held, key=held.__getitem__, reverse=True)[:most]
    for first, last in sorted(kept):
        text, whole = seconds(held[first, last]), float(steps[first : last + 1].sum())
        text += "" if mask[first : last + 1].all() else f" of {seconds(whole)}"
        if len(found) > most and (first, last) == kept[0]:
            text += f", the longest of {len(found)} times"
        yield first, last, text


def _failure(trajectory: Trajectory) -> Iterator[Mark]:
    """Begin of the scenario's failure, at the control interval that has it first."""
    given = section(trajectory.meta, "config", "failure")
    texts = list(_failing(given, time_unit(trajectory.meta)))
    if not texts:
        return
    time, interval = given.get("time", 0.0), trajectory.meta["config"].get("control_interval")
    if interval:
        time = math.ceil(time / interval - 1e-9) * interval
    time /= time_unit(trajectory.meta)
    if time <= trajectory["t"][-1]:
        yield Mark(time, "failure", "; ".join(texts))


def _failing(given: Mapping[str, Any], unit: float) -> Iterator[str]:
    """Say what of a section ``failure`` fails; its times are full scale, see `time_unit`."""
    rate, propeller = given.get("rudder_rate", 1.0), given.get("propeller_speed")
    if rate == 0.0:
        yield "the rudder is stuck"
    elif rate != 1.0:
        yield f"the rudder moves at {100.0 * rate:.3g} % of its rate"
    if propeller is not None:
        yield f"the engine turns at most {100.0 * propeller:.3g} % of the self-propulsion speed"
    if given.get("heading_bias_deg"):
        yield f"the gyro is wrong by {given['heading_bias_deg']:+.3g}{DEGREE}"
    if given.get("dropout"):
        yield f"the gyro is lost for {seconds(given['dropout'] / unit)}"


def _legs(trajectory: Trajectory) -> Iterator[Mark]:
    """Begin of each leg of a track, else changes of the ordered heading."""
    if trajectory.meta.get("leg_of") and "leg" in trajectory:
        yield from _legs_of_route(trajectory)
        return
    legs = len(trajectory.meta.get("waypoints") or ()) - 1
    name = "leg" if "leg" in trajectory else "psi_ordered"
    for row in steps(trajectory, name):
        order = _order(trajectory, row) if "psi_ordered" in trajectory else ""
        text = f"ordered heading {order}"
        if name == "leg":
            number = f"{trajectory['leg'][row] + 1:.0f}" + (f" of {legs}" if legs > 0 else "")
            text = f"leg {number} begins" + (f", course {order}" if order else "")
        yield Mark(float(trajectory["t"][row]), "leg", text)


def _legs_of_route(trajectory: Trajectory) -> Iterator[Mark]:
    """Begin of each leg of a planned route, of which the track has pieces."""
    pieces = np.asarray(trajectory.meta["leg_of"])
    legs = pieces[trajectory["leg"].astype(int)]
    for row in (np.flatnonzero(np.diff(legs)) + 1).tolist():
        text = f"leg {legs[row] + 1} of {pieces[-1] + 1} of the route begins"
        yield Mark(float(trajectory["t"][row]), "leg", text)


def _order(trajectory: Trajectory, row: int) -> str:
    """The ordered heading of a row, and its change from the row before."""
    before, order = trajectory["psi_ordered"][row - 1 : row + 1]
    change = math.degrees(wrap_angle(order - before))
    side = "starboard" if change > 0.0 else "port"
    return f"{bearing(order)}, {abs(change):.3g}{DEGREE} to {side}"


def bearing(angle: float) -> str:
    """Direction from north [rad] as three digits, 000 to 359 deg."""
    return f"{round(math.degrees(angle)) % 360:03d}{DEGREE}"


def seconds(time: float) -> str:
    """A time [s] for people."""
    return f"{time:.1f} s" if time < 9.95 else f"{time:.0f} s"


def _end(trajectory: Trajectory) -> Mark:
    meta, time = trajectory.meta, float(trajectory["t"][-1])
    outcome = meta.get("outcome")
    if not meta.get("complete", True):
        text = "the recording breaks off here"
    elif outcome is None:
        text = "end of the manoeuvre" if is_manoeuvre(trajectory) else "end"
    else:
        text = f"{outcome}: the episode has failed" if meta.get("failed") else str(outcome)
    return Mark(time, "end", text)
