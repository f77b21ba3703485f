"""Metrics of one episode, computed from its recording alone, so that a stored file gives the same.

The integrals that define J and the RMS are means over the ends of the control intervals, as in the
reward, each judged by the order or leg that held during it. An episode that a limit ended early is
judged over its planned duration: the intervals it did not sail count with the error at that limit
and the rudder hard over, the worst that an episode still alive can do. So failing early never pays.
Other metrics take what was sailed.
Times, and all "per hour", are full scale; angles are in degrees.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import wrap_angle
from ship_gym.physics.propeller import shaft_power
from ship_gym.recording.trajectory import Trajectory
from ship_gym.simulation import through_water
from ship_gym.tasks.bridge import ARRIVED, OUTCOMES, SATURATED
from ship_gym.tracks.guidance import cross_track

SETTLED_DEG = 2.0  # band of the settling time
DWELL = 60.0  # time to stay in the band [full-scale s]; later disturbances do not count
DEAD_BAND_DEG = 1.0  # smaller swings of the rudder are no reversals
LAMBDAS = (0.1, 1.0, 8.0)


class Metric(NamedTuple):
    """Unit, meaning and whether ``"lower"`` or ``"higher"`` is better."""

    unit: str
    meaning: str
    better: str


_HEADING: dict[str, Metric] = {
    **{
        f"J_{lam:g}": Metric("deg2", f"mean(psi_e^2) + {lam:g} mean(delta^2)", "lower")
        for lam in LAMBDAS
    },
    "rms_error": Metric("deg", "root mean square of the heading error", "lower"),
    "max_error": Metric("deg", "largest absolute heading error, start included", "lower"),
    "overshoot": Metric(
        "deg", "first swing past the ordered heading; 0 if not crossed; mean over steps", "lower"
    ),
    "settling_time": Metric(
        "s",
        "until the first stay of 60 s within 2 deg begins; if there is none, the time that was "
        "planned; mean over steps",
        "lower",
    ),
}
_TRACK: dict[str, Metric] = {
    "rms_cross_track": Metric("L", "root mean square of the cross-track error", "lower"),
    "max_cross_track": Metric("L", "largest absolute cross-track error, start included", "lower"),
    "voyage_time": Metric("s", "until arrival; if there is none, the planned duration", "lower"),
}
_COMMON: dict[str, Metric] = {
    "rudder_travel": Metric("deg/h", "rudder angle covered per hour", "lower"),
    "rudder_reversals": Metric("1/h", "changes of direction by more than 1 deg, per hour", "lower"),
    "saturation": Metric("-", "share of the intervals that end with the rudder hard over", "lower"),
    "speed_loss": Metric("-", "1 - mean surge speed through the water / nominal speed", "lower"),
    "energy": Metric(
        "kWh/nmi",
        "delivered energy per nautical mile through the water; of a model: by Froude's law, "
        "without corrections for friction and density",
        "lower",
    ),
    "success": Metric("-", "1 if no limit ended the episode; on a track: if it arrived", "higher"),
    "return": Metric("-", "sum of the rewards", "higher"),
}
METRICS: dict[str, Metric] = {**_HEADING, **_TRACK, **_COMMON}

_COLUMNS = ("u", "v", "psi", "delta", "n", "torque", "psi_error", "psi_ordered", "reward")
_COLUMNS += ("current_speed", "current_direction_to")
_META = ("ship", "config", "failed", "outcome")


def metrics_of(task: str) -> dict[str, Metric]:
    """Metrics of a task, in the order of a table."""
    return {**(_TRACK if task == "track_following" else _HEADING), **_COMMON}


def metrics(trajectory: Trajectory) -> dict[str, float]:
    """Metrics of one episode.

    Parameters
    ----------
    trajectory : Trajectory
        As made by ``Rollout.trajectory`` or read back from its file.

    Returns
    -------
    dict of str to float
        The keys of `metrics_of` its task, with the units there.

    Raises
    ------
    ConfigError
        A recording of something else.
    """
    if not isinstance(trajectory, Trajectory):
        raise ConfigError(
            f"metrics of a {type(trajectory).__name__}: needs a Trajectory, for example "
            "rollout.trajectory(0)"
        )
    _check(trajectory)
    meta = trajectory.meta
    on_track = meta["task"] == "track_following"
    hours = (trajectory["t"][-1] - trajectory["t"][0]) * math.sqrt(meta["ship"]["scale"]) / 3600.0
    return {
        **(_track_metrics(trajectory) if on_track else _heading_metrics(trajectory)),
        **_rudder_use(trajectory, hours),
        "speed_loss": 1.0 - float(np.mean(through_water(trajectory)[0])) / meta["ship"]["speed"],
        "energy": _energy(trajectory),
        "success": float(meta["outcome"] == OUTCOMES[ARRIVED] if on_track else not meta["failed"]),
        "return": float(trajectory["reward"].sum()),
    }


def _heading_metrics(trajectory: Trajectory) -> dict[str, float]:
    psi_e = wrap_angle(trajectory["psi"][1:] - trajectory["psi_ordered"][:-1])
    limit = math.radians(trajectory.meta["config"]["limits"]["heading_error_deg"])
    psi_e = _to_the_end(trajectory, psi_e, limit)
    delta = _to_the_end(trajectory, trajectory["delta"][1:], trajectory.meta["ship"]["delta_max"])
    return {
        **{f"J_{lam:g}": float(control_cost(psi_e, delta, lam)) for lam in LAMBDAS},
        "rms_error": math.sqrt(control_cost(psi_e, delta, 0.0)),
        "max_error": float(np.abs(np.degrees(trajectory["psi_error"])).max()),
        **_step_response(trajectory),
    }


def _step_response(trajectory: Trajectory) -> dict[str, float]:
    """Overshoot and settling, mean over the steps of the ordered heading; of one heading: its own.

    The order that holds at first is a step only if it is the only one.
    """
    config = trajectory.meta["config"]
    time = trajectory["t"] * math.sqrt(trajectory.meta["ship"]["scale"])
    error = np.degrees(trajectory["psi_error"])
    begins = np.flatnonzero(np.diff(trajectory["psi_ordered"]) != 0.0) + 1
    parts = np.split(np.arange(len(time)), begins)
    found = []
    for part in parts[1:] or parts:
        settled = settling_time(time[part], error[part])
        planned = config["duration"] if len(parts) == 1 else time[part[-1]] - time[part[0]]
        found.append((overshoot(error[part]), planned if settled is None else settled))
    over, settling = np.mean(found, axis=0).tolist()
    return {"overshoot": over, "settling_time": settling}


def _track_metrics(trajectory: Trajectory) -> dict[str, float]:
    meta = trajectory.meta
    L = meta["ship"]["L"]
    legs = trajectory["leg"][:-1].astype(int)
    ends = cross_track(np.array(meta["waypoints"]), legs, trajectory["x"][1:], trajectory["y"][1:])
    judged = _to_the_end(trajectory, ends / L, meta["config"]["limits"]["cross_track"])
    arrived = meta["outcome"] == OUTCOMES[ARRIVED]
    sailed = (trajectory["t"][-1] - trajectory["t"][0]) * math.sqrt(meta["ship"]["scale"])
    return {
        "rms_cross_track": math.sqrt(np.mean(judged * judged)),
        "max_cross_track": float(
            max(np.abs(ends).max(), abs(trajectory["cross_track_error"][0])) / L
        ),
        "voyage_time": float(sailed if arrived else meta["config"]["duration"]),
    }


def control_cost(psi_error: np.ndarray, delta: np.ndarray, lam: float) -> np.ndarray:
    """J = mean(psi_e^2) + lambda mean(delta^2) over the first axis [deg2].

    Parameters
    ----------
    psi_error, delta : numpy.ndarray
        Heading error and rudder angle at the ends of the intervals [rad], shape (T, ...).
    lam : float
        lambda [-].
    """
    return np.mean(np.degrees(psi_error) ** 2 + lam * np.degrees(delta) ** 2, axis=0)


def settling_time(time: np.ndarray, error: np.ndarray) -> float | None:
    """Time from the start until the error [deg] begins to stay `DWELL` within `SETTLED_DEG`."""
    inside = np.abs(error) <= SETTLED_DEG
    entries = np.flatnonzero(inside & ~np.append(False, inside[:-1]))
    for entry in entries:
        outside = np.flatnonzero(~inside[entry:])
        last = entry + outside[0] - 1 if len(outside) else len(time) - 1
        if time[last] - time[entry] >= DWELL:
            return float(time[entry] - time[0])
    return None


def overshoot(error: np.ndarray) -> float:
    """Largest value of the first swing of the error past zero, in the unit given."""
    beyond = -math.copysign(1.0, error[0]) * error
    crossed = np.flatnonzero(beyond > 0.0)
    if error[0] == 0.0 or len(crossed) == 0:
        return 0.0
    back = np.flatnonzero(beyond[crossed[0] :] < 0.0)
    end = crossed[0] + back[0] if len(back) else len(beyond)
    return float(beyond[crossed[0] : end].max())


def reversals(angle: np.ndarray, dead_band: float = DEAD_BAND_DEG) -> int:
    """Changes of direction, each followed and preceded by a swing of more than `dead_band`."""
    count, direction = 0, 0
    low = high = float(angle[0])
    for value in angle.tolist():
        low, high = min(low, value), max(high, value)
        if direction <= 0 and value - low > dead_band:
            count += direction < 0
            direction, high = 1, value
        elif direction >= 0 and high - value > dead_band:
            count += direction > 0
            direction, low = -1, value
    return count


def _check(trajectory: Trajectory) -> None:
    meta = trajectory.meta
    missing = [name for name in _COLUMNS if name not in trajectory]
    missing += [f"meta {name}" for name in _META if name not in meta]
    if missing:
        raise ConfigError(
            f"a recording of task {meta.get('task')!r} has no metrics: it lacks "
            f"{', '.join(missing)}"
        )
    if len(trajectory) < 2:
        raise ConfigError("a recording needs at least two rows for metrics")


def _to_the_end(trajectory: Trajectory, values: np.ndarray, worst: float) -> np.ndarray:
    """Values at the ends of the intervals that count: those lost by failing are the worst."""
    config = trajectory.meta["config"]
    planned = round(config["duration"] / config["control_interval"])
    lost = max(0, planned - len(values)) if trajectory.meta["failed"] else 0
    return np.append(values, np.full(lost, worst))


def _rudder_use(trajectory: Trajectory, hours: float) -> dict[str, float]:
    """Travel, reversals and saturation of the rudder."""
    delta = trajectory["delta"]
    angle, hard_over = np.degrees(delta), SATURATED * trajectory.meta["ship"]["delta_max"]
    return {
        "rudder_travel": float(np.abs(np.diff(angle)).sum() / hours),
        "rudder_reversals": float(reversals(angle) / hours),
        "saturation": float(np.mean(np.abs(delta[1:]) >= hard_over)),
    }


def _energy(trajectory: Trajectory) -> float:
    """Delivered energy per distance through the water, full scale [kWh/nmi]."""
    time = trajectory["t"]
    work = np.trapezoid(shaft_power(trajectory["n"], trajectory["torque"]), time)
    distance = np.trapezoid(np.hypot(*through_water(trajectory)), time)
    return float(work / distance) * trajectory.meta["ship"]["scale"] ** 3 * 1852.0 / 3.6e6
