"""Sailing a track of way-points (``track_following``)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.conventions import PSI, U, V, X, Y
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import cos_sin, wrapped
from ship_gym.tasks.base import RUNNING, Outcome, Row, Term, check_names
from ship_gym.tasks.bridge import N_BRIDGE, clipped, observe_bridge, settle
from ship_gym.tasks.rewards import costs
from ship_gym.tracks.guidance import leg_axes, leg_position, look_ahead_bearing, on_route, passed

TRACK_LIMIT, MISSED, STRAYED, ARRIVED = 2, 3, 4, 5  # outcomes
TERMS = (Term("cross_track", "(e / L)^2", "Of (e / L)^2, e the distance to the route."),)
OUTCOMES = (
    Outcome("cross-track limit", failed=True),
    Outcome("missed the end", failed=True),  # passed it outside the corridor
    Outcome("arrived, corridor left"),  # somewhere on the way
    Outcome("arrived", reached=True),
)
AT_THE_END = (OUTCOMES[STRAYED - 2].name, OUTCOMES[ARRIVED - 2].name)  # of a voyage sailed to it
OUTSIDE, KEPT, LEFT = 0, 1, 2  # corridor: not within it since the start, within ever since, left
PORT, STARBOARD = 2, 3  # columns of a plan whose legs have limits of their own [m]
LARGEST_CIRCLE = 0.25  # circle of acceptance over the shorter of the legs that meet in it
# behind those of the bridge; psi_e there is heading - bearing of the active leg
OBSERVATIONS = (
    Row(
        "cross_track",
        "e / L",
        "-",
        -10.0,
        10.0,
        "cross-track error, positive to starboard of the leg",
        -1,
    ),
    Row(
        "cross_track_rate",
        "e_dot / U0",
        "-",
        -3.0,
        3.0,
        "its rate: speed over ground across the leg",
        -1,
    ),
    Row("to_go", "s / L", "-", -5.0, 50.0, "distance to go along the leg", 1),
    Row(
        "next_turn",
        "d_chi / pi",
        "-",
        -1.0,
        1.0,
        "course change at its end, positive to starboard; last leg: 0",
        -1,
    ),
    Row(
        "sin_look_ahead",
        "sin(psi_l)",
        "-",
        -1.0,
        1.0,
        "sine of the look-ahead error, heading - line of sight",
        -1,
    ),
    Row("cos_look_ahead", "cos(psi_l)", "-", -1.0, 1.0, "cosine of the look-ahead error", 1),
)
FIELDS = (
    ("active", np.int64),  # active leg, and how many way-points there are
    ("count", np.int64),
    ("cross_limit", np.float64),  # distance to the route that ends the episode [m]
    ("corridor", np.float64),  # distance to the route that success allows [m]
    ("kept", np.int64),  # OUTSIDE, KEPT or LEFT
    ("x_0", np.float64),  # start of the previous leg, or of the first [m]
    ("y_0", np.float64),
    ("x_a", np.float64),  # ends of the active leg [m]
    ("y_a", np.float64),
    ("x_b", np.float64),
    ("y_b", np.float64),
    ("x_c", np.float64),  # end of the next leg, or of the last [m]
    ("y_c", np.float64),
    ("turn", np.float64),  # course change at the end of the active leg [rad]
    ("acceptance", np.float64),  # circle that the scenario gives, and what counts of it [m]
    ("circle", np.float64),
    ("look_ahead", np.float64),  # [m]
)


class TrackView(NamedTuple):
    """What a track adds to the observation of one ship, in the order of `OBSERVATIONS`."""

    cross_track: float
    cross_track_rate: float
    to_go: float
    next_turn: float
    sin_look_ahead: float
    cos_look_ahead: float


class TrackTerms(NamedTuple):
    """Terms of the reward that are a track's own, in the order of `TERMS`."""

    cross_track: float


check_names("the terms of a track", TrackTerms._fields, TERMS)
check_names("the rows of a track", TrackView._fields, OBSERVATIONS)
_LOW = tuple(row.low for row in OBSERVATIONS)
_HIGH = tuple(row.high for row in OBSERVATIONS)
N_TRACK = len(OBSERVATIONS)


@kernel
def observe(state, waves, command, ship, sea, task, interval, row):
    """Observation of one ship, float32, into the columns of bridge and track."""
    seen = observe_bridge(state, waves, command, ship, sea, task, interval, row)
    observe_track(seen, state, task, row)


@kernel
def observe_track(seen, state, task, row):
    """Write what the track adds to the observation of one ship, limited to its bounds.

    The rate of the cross-track error is that of a satellite receiver: over ground, exact.
    """
    along, cross, length = leg_axes(seen.north, seen.east, task.x_a, task.y_a, task.x_b, task.y_b)
    bearing = task.psi_ordered
    cos_leg, sin_leg = cos_sin(state[PSI] - bearing)
    rate = state[U] * sin_leg + state[V] * cos_leg
    cos_ahead, sin_ahead = cos_sin(seen.psi - look_ahead_bearing(bearing, cross, task.look_ahead))
    values = TrackView(
        cross_track=cross / task.L,
        cross_track_rate=rate / task.speed,
        to_go=(length - along) / task.L,
        next_turn=task.turn / math.pi,
        sin_look_ahead=sin_ahead,
        cos_look_ahead=cos_ahead,
    )
    for k in range(N_TRACK):
        row[N_BRIDGE + k] = clipped(values[k], _LOW[k], _HIGH[k])


@kernel
def sail_leg(task, plan, k):
    """Make leg k of the way-points (points, 2 or more), north and east [m] first, the active."""
    last = task.count - 1
    before, after = max(k - 1, 0), min(k + 2, last)
    task.active = k
    task.x_0, task.y_0 = plan[before, 0], plan[before, 1]
    task.x_a, task.y_a = plan[k, 0], plan[k, 1]
    task.x_b, task.y_b = plan[k + 1, 0], plan[k + 1, 1]
    task.x_c, task.y_c = plan[after, 0], plan[after, 1]
    _, _, bearing, length = leg_position(task.x_a, task.y_a, task.x_a, task.y_a, task.x_b, task.y_b)
    task.psi_ordered = bearing
    task.turn, task.circle = 0.0, 0.0
    if k + 1 < last:
        _, _, after_it, next_length = leg_position(
            task.x_b, task.y_b, task.x_b, task.y_b, task.x_c, task.y_c
        )
        task.turn = wrapped(after_it - bearing)
        task.circle = min(task.acceptance, LARGEST_CIRCLE * min(length, next_length))


@kernel
def where(state, task):
    """Position of one ship on its route, `OnRoute`."""
    return on_route(
        state[X],
        state[Y],
        task.x_0,
        task.y_0,
        task.x_a,
        task.y_a,
        task.x_b,
        task.y_b,
        task.x_c,
        task.y_c,
    )


@kernel
def off_route(state, task):
    """Distance [m] of one ship to its route, positive to starboard of the nearest leg."""
    return where(state, task).off


@kernel
def corridor_beside(task, plan, leg, aside):
    """Corridor [m] of a leg on the side of a distance from it, positive to starboard.

    Legs without a limit of their own have the scenario's in the plan.
    """
    if plan.shape[1] <= STARBOARD:
        return task.corridor
    return plan[leg, STARBOARD] if aside > 0.0 else plan[leg, PORT]


@kernel
def limit_beside(task, corridor):
    """Distance [m] that ends the episode where the corridor is so wide.

    To the corridor as the scenario has them; so a leg with the scenario's has its very number.
    """
    return task.cross_limit * (corridor / task.corridor)


@kernel
def outcome_of(here, at_end, task, plan):
    """Outcome of an interval, from the distance to the route and that across the last leg [m]."""
    corridor = corridor_beside(task, plan, task.active + here.nearest, here.off)
    if abs(here.off) > limit_beside(task, corridor):
        return TRACK_LIMIT
    if not at_end:
        return RUNNING
    if abs(here.cross) > corridor_beside(task, plan, task.active, here.cross):
        return MISSED
    return ARRIVED if task.kept == KEPT else STRAYED


@kernel
def sail_on(state, task, plan):
    """Begin the next leg, and those after it that are passed already and shorter than the ship.

    A planned turn is cut into legs that a ship passes several of in an interval.
    """
    sail_leg(task, plan, task.active + 1)
    while task.active + 2 < task.count:
        here = where(state, task)
        dx, dy = task.x_b - task.x_a, task.y_b - task.y_a
        short = dx * dx + dy * dy < task.L * task.L
        if not short or passed(here.to_go, here.along_next, here.cross, task.circle) == 0:
            break
        sail_leg(task, plan, task.active + 1)


@kernel
def judge(state, before, sea, task, plan, terms, result):
    """Terms (n,) and result of the interval just sailed by one ship, the error [m] in it.

    The error is the distance to the route. It is judged by the leg that was active during it; then
    the next leg begins where the way-point is passed. Passing the last one ends the episode.
    """
    here = where(state, task)
    reached = passed(here.to_go, here.along_next, here.cross, task.circle) == 1
    last = task.active + 2 >= task.count
    if abs(here.off) > corridor_beside(task, plan, task.active + here.nearest, here.off):
        task.kept = LEFT if task.kept == KEPT else task.kept
    elif task.kept == OUTSIDE:
        task.kept = KEPT
    outcome = outcome_of(here, reached and last, task, plan)
    error = here.off / task.L
    own = TrackTerms(cross_track=-task.interval * task.cross_track * error * error)
    failed = outcome == TRACK_LIMIT or outcome == MISSED
    paid = costs(state, before, sea, task, failed)
    settle(result, terms, here.off, own, paid, outcome, task)
    if reached and not last:
        sail_on(state, task, plan)
        result.error = off_route(state, task)


@kernel
def begin(task, plan):
    """Begin the first leg of an episode, whose plan is written."""
    task.kept = OUTSIDE
    sail_leg(task, plan, 0)


@kernel
def place_batch(which, points, bearing, L, plans):
    """Write tracks as plans: `points` (m, W, 2) in ship lengths, first leg on bearing 0.

    Parameters
    ----------
    bearing, L : ndarray (m,)
        Bearing of the first leg [rad] and length of the ship [m].
    """
    for row in range(len(which)):
        c, s = math.cos(bearing[row]), math.sin(bearing[row])
        for k in range(points.shape[1]):
            x, y = points[row, k, 0] * L[row], points[row, k, 1] * L[row]
            plans[which[row], k, 0] = x * c - y * s
            plans[which[row], k, 1] = x * s + y * c
