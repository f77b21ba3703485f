"""Sail a track of way-points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import X, Y, wrap_angle
from ship_gym.tasks.base import ErrorColumn, Moment, Plot, Task
from ship_gym.tasks.track import NAME, VERSION, kernels
from ship_gym.tasks.track.kernels import PORT, STARBOARD
from ship_gym.tasks.track.metrics import METRICS, measure
from ship_gym.tasks.track.plan import Tracks
from ship_gym.tasks.track.section import Limits, Start, TrackRange
from ship_gym.tracks.guidance import cross_track, nearest_leg, off_route


def fill(scenario, tasks) -> None:
    """Write limit, corridor, circle of acceptance and look-ahead distance [m]."""
    tasks["cross_limit"] = scenario.limits.cross_track * tasks["L"]
    tasks["corridor"] = scenario.limits.corridor * tasks["L"]
    tasks["acceptance"] = scenario.track.acceptance * tasks["L"]
    tasks["look_ahead"] = scenario.track.look_ahead * tasks["L"]


def check(scenario) -> None:
    """Refuse a start beyond the limit."""
    start, limit = scenario.start.cross_track, scenario.limits.cross_track
    if start >= limit:
        raise ConfigError(
            f"start.cross_track = {start}: must be below limits.cross_track = {limit}"
        )


def info(episodes) -> dict[str, np.ndarray]:
    """Distance to the route [m] and active leg."""
    return {"cross_track": episodes.errors, "leg": episodes.tasks["active"]}


def columns(recorded, history, plan) -> dict[str, np.ndarray]:
    """Bearing of the active leg, its number and the errors of a recording."""
    psi, leg = history["psi_ordered"], history["active"]
    voyage = plan[:, :2], leg.astype(int), recorded["x"], recorded["y"]
    found = {
        "psi_ordered": psi,
        "psi_error": wrap_angle(recorded["psi"] - psi),
        "leg": leg,
        "cross_track_error": cross_track(*voyage),
        "off_route": off_route(*voyage),
    }
    if plan.shape[1] > STARBOARD:
        beside = plan[nearest_leg(*voyage).astype(int)]
        found |= {"corridor_port": beside[:, PORT], "corridor_starboard": beside[:, STARBOARD]}
    return found


def meta(plan) -> dict:
    """Way-points north, east [m]; corridor of each leg to port and to starboard, if of its own."""
    found = {"waypoints": plan[:, :2].tolist()}
    if plan.shape[1] > STARBOARD:
        found["leg_limits"] = plan[:-1, PORT:].tolist()
    return found


def scene(episodes, i) -> dict:
    """Track, active leg, limit and corridor for a picture."""
    task = episodes.tasks[i]
    leg, off, plan = int(task["active"]), float(episodes.errors[i]), episodes.plans[i]
    found = {
        "psi_ordered": float(task["psi_ordered"]),
        "track": plan[:, :2].copy(),
        "active_leg": leg,
        "cross_track": off,
        "cross_track_limit": float(task["cross_limit"]),
        "corridor": float(task["corridor"]),
    }
    if plan.shape[1] > STARBOARD:
        x, y = episodes.sim.state[i : i + 1, [X, Y]].T
        near = int(nearest_leg(plan[:, :2], np.array([leg]), x, y)[0])
        beside = float(plan[near, STARBOARD if off > 0.0 else PORT])
        found["cross_track_limit"] *= beside / found["corridor"]
        found |= {"corridor": beside, "leg_limits": plan[:-1, PORT:].copy()}
    if "leg_of" in episodes.given:
        found["leg_of"] = np.array(episodes.given["leg_of"])
    return found


def limits(scenario, ship) -> dict[str, float]:
    """Distance to the route that ends the episode, and that success allows [m]."""
    L, given = ship.hull.L, scenario.limits
    return {"cross_track": given.cross_track * L, "corridor": given.corridor * L}


def succeeds(scenario) -> str:
    """What ends an episode as reached."""
    limit = scenario.limits.corridor
    return f"last way-point abeam within {limit:g} L; a success if never farther off the route"


def fails(scenario) -> str:
    """What ends an episode as failed."""
    limits = scenario.limits
    return f"{limits.cross_track:g} L off the route, or at its end {limits.corridor:g} L aside"


TASK = Task(
    name=NAME,
    version=VERSION,
    title="Sail a track of way-points in a seaway.",
    sections={"start": Start, "limits": Limits, "track": TrackRange},
    terms=kernels.TERMS,
    observations=kernels.OBSERVATIONS,
    outcomes=kernels.OUTCOMES,
    fields=kernels.FIELDS,
    plan=Tracks,
    fill=fill,
    begin=kernels.begin,
    observe=kernels.observe,
    judge=kernels.judge,
    error=kernels.off_route,
    sees_position=True,
    check=check,
    info=info,
    info_text="`leg`, the active one, and `cross_track`, the distance to the route [m], to "
    "starboard positive, also after a reset",
    history=("psi_ordered", "active"),
    columns=columns,
    error_column=ErrorColumn("off_route", "distance to the route", "m"),
    limits=limits,
    meta=meta,
    plots=(Plot("off_route", "Off the route [m], + to starboard", ("off_route",)),),
    metrics=METRICS,
    measure=measure,
    headline="rms_route",
    controllers=("drift_los", "ilos"),
    scene=scene,
    succeeds=succeeds,
    fails=fails,
    page=Path(__file__).with_name("page.md").read_text(encoding="utf-8"),
    example={"sea.states": ["ss5"], "duration": 4800.0},
    moment=Moment("ilos", 0, 700),
)
