"""Sailing a track of way-points (``track_following``)."""

from __future__ import annotations

import math

from ship_gym.conventions import DELTA, PSI, U, V, X, Y
from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import wrapped
from ship_gym.physics.dynamics import water_velocity
from ship_gym.tasks.bridge import (
    ARRIVED,
    COST_TERMS,
    N_BRIDGE,
    RUNNING,
    TRACK_LIMIT,
    clipped,
    observe_bridge,
    reward_terms,
    settle,
)
from ship_gym.tracks.guidance import leg_position, look_ahead_bearing, passed

# after the nine of the bridge; psi_e there is heading - bearing of the active leg
OBSERVATIONS = (
    ("e / L", "-", -10.0, 10.0, "cross-track error, positive to starboard of the leg"),
    ("e_dot / U0", "-", -3.0, 3.0, "its rate: speed over ground across the leg"),
    ("s / L", "-", -5.0, 50.0, "distance to go along the leg"),
    ("d_chi / pi", "-", -1.0, 1.0, "course change at its end, positive to starboard; last leg: 0"),
    ("sin(psi_l)", "-", -1.0, 1.0, "sine of the look-ahead error, heading - line of sight"),
    ("cos(psi_l)", "-", -1.0, 1.0, "cosine of the look-ahead error"),
)
REWARD_TERMS = ("cross_track", *COST_TERMS)
_LOW = tuple(row[2] for row in OBSERVATIONS)
_HIGH = tuple(row[3] for row in OBSERVATIONS)


@kernel
def observe_batch(states, waves, commands, ships, seas, tasks, elapsed, observations):
    """Observation of every ship, float32, into the first fifteen columns."""
    for i in range(states.shape[0]):
        seen = observe_bridge(
            states[i], waves[i], commands[i], ships[i], seas[i], tasks[i], elapsed[i],
            observations[i],
        )  # fmt: skip
        observe_track(seen, states[i], tasks[i], observations[i])


@kernel
def observe_track(seen, state, task, row):
    """Write what the track adds to the observation of one ship, limited to its bounds.

    The rate of the cross-track error is that of a satellite receiver: over ground, exact.
    """
    along, cross, bearing, length = leg_position(
        seen[4], seen[5], task.x_a, task.y_a, task.x_b, task.y_b
    )
    to_leg = state[PSI] - bearing
    rate = state[U] * math.sin(to_leg) + state[V] * math.cos(to_leg)
    psi_l = seen[0] - look_ahead_bearing(bearing, cross, task.look_ahead)
    values = (
        cross / task.L,
        rate / task.speed,
        (length - along) / task.L,
        task.turn / math.pi,
        math.sin(psi_l),
        math.cos(psi_l),
    )
    for k in range(6):
        row[N_BRIDGE + k] = clipped(values[k], _LOW[k], _HIGH[k])


@kernel
def sail_leg(task, plan, k):
    """Make leg k of the way-points (points, 2) north and east [m] the active one."""
    task.active = k
    task.x_a, task.y_a = plan[k, 0], plan[k, 1]
    task.x_b, task.y_b = plan[k + 1, 0], plan[k + 1, 1]
    _, _, bearing, _ = leg_position(task.x_a, task.y_a, task.x_a, task.y_a, task.x_b, task.y_b)
    task.psi_ordered = bearing
    task.turn = 0.0
    if k + 2 < task.count:
        x_c, y_c = plan[k + 2, 0], plan[k + 2, 1]
        _, _, after, _ = leg_position(task.x_b, task.y_b, task.x_b, task.y_b, x_c, y_c)
        task.turn = wrapped(after - bearing)


@kernel
def off_leg(state, task):
    """Cross-track error [m] of one ship from its active leg, positive to starboard of it."""
    return leg_position(state[X], state[Y], task.x_a, task.y_a, task.x_b, task.y_b)[1]


@kernel
def off_leg_batch(which, states, tasks, errors):
    """Write the cross-track errors [m] of some ships, which are at the start of an episode."""
    for i in which:
        errors[i] = off_leg(states[i], tasks[i])


@kernel
def judge_batch(states, rudder_before, seas, tasks, plans, terms, verdict):
    """Reward terms (n, 5) and verdict (``bridge.settle``) of the interval just sailed.

    It is judged by the leg that was active during it; then the next leg begins where the ship has
    reached the circle of acceptance or passed the way-point, and the error in the verdict is that
    from this one, as in the observation. Reaching the last way-point ends the episode as arrived.
    """
    _, _, _, _, _, errors, _ = verdict
    for i in range(states.shape[0]):
        task, psi, delta = tasks[i], states[i, PSI], states[i, DELTA]
        u_c, _ = water_velocity(psi, seas[i])
        along, cross, _, length = leg_position(
            states[i, X], states[i, Y], task.x_a, task.y_a, task.x_b, task.y_b
        )
        reached = passed(along, cross, length, task.acceptance) == 1
        last = task.active + 2 >= task.count
        outcome = ARRIVED if reached and last else RUNNING
        if abs(cross) > task.cross_limit:
            outcome = TRACK_LIMIT
        stroke = delta - rudder_before[i]
        error = cross / task.L
        found = reward_terms(error, delta, stroke, states[i, U] - u_c, task, outcome == TRACK_LIMIT)
        settle(i, cross, found, outcome, verdict, terms)
        if reached and not last:
            sail_leg(task, plans[i], task.active + 1)
            errors[i] = off_leg(states[i], task)


@kernel
def begin_batch(which, tasks, plans):
    """Begin the first leg of some episodes, whose plans are written."""
    for i in which:
        sail_leg(tasks[i], plans[i], 0)


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
