"""Metrics of one episode, computed from its recording alone, so that a stored file gives the same.

The integrals that define J and the RMS are means over the ends of the control intervals, as in the
reward. An episode that terminated early is judged over its planned duration: the intervals it did
not sail count with the heading error at the limit that ended it and the rudder hard over, the worst
that an episode still alive can do. So ending early never pays. Other metrics take what was sailed.
Times, and all "per hour", are full scale; angles are in degrees.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.recording.trajectory import Trajectory
from ship_gym.simulation import shaft_power, through_water

SETTLED_DEG = 2.0  # band of the settling time
DWELL = 60.0  # time to stay in the band [full-scale s]; later disturbances do not count
DEAD_BAND_DEG = 1.0  # smaller swings of the rudder are no reversals
SATURATED = 0.999  # share of the largest rudder angle that counts as hard over
LAMBDAS = (0.1, 1.0, 8.0)


class Metric(NamedTuple):
    """Unit, meaning and whether ``"lower"`` or ``"higher"`` is better."""

    unit: str
    meaning: str
    better: str


METRICS: dict[str, Metric] = {
    **{
        f"J_{lam:g}": Metric("deg2", f"mean(psi_e^2) + {lam:g} mean(delta^2)", "lower")
        for lam in LAMBDAS
    },
    "rms_error": Metric("deg", "root mean square of the heading error", "lower"),
    "max_error": Metric("deg", "largest absolute heading error, start included", "lower"),
    "overshoot": Metric("deg", "first swing past the ordered heading; 0 if not crossed", "lower"),
    "settling_time": Metric(
        "s", "first stay of 60 s within 2 deg begins; planned duration if there is none", "lower"
    ),
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
    "success": Metric("-", "1 if the episode did not terminate", "higher"),
    "return": Metric("-", "sum of the rewards", "higher"),
}

_COLUMNS = ("u", "v", "psi", "delta", "n", "torque", "psi_error", "reward")
_COLUMNS += ("current_speed", "current_direction_to")


def metrics(trajectory: Trajectory) -> dict[str, float]:
    """Metrics of one episode of heading keeping.

    Parameters
    ----------
    trajectory : Trajectory
        As made by ``Rollout.trajectory`` or read back from its file.

    Returns
    -------
    dict of str to float
        The keys of `METRICS`, with the units there.

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
    time = trajectory["t"] * math.sqrt(meta["ship"]["scale"])
    error = np.degrees(trajectory["psi_error"])
    psi_e, delta = _judged(trajectory)
    settled = settling_time(time, error)
    return {
        **{f"J_{lam:g}": float(control_cost(psi_e, delta, lam)) for lam in LAMBDAS},
        "rms_error": math.sqrt(control_cost(psi_e, delta, 0.0)),
        "max_error": float(np.abs(error).max()),
        "overshoot": overshoot(error),
        "settling_time": float(meta["config"]["duration"]) if settled is None else settled,
        **_rudder_use(trajectory, (time[-1] - time[0]) / 3600.0),
        "speed_loss": 1.0 - float(np.mean(through_water(trajectory)[0])) / meta["ship"]["speed"],
        "energy": _energy(trajectory),
        "success": 0.0 if meta["terminated"] else 1.0,
        "return": float(trajectory["reward"].sum()),
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
    missing += [f"meta {name}" for name in ("ship", "config", "terminated") if name not in meta]
    if missing:
        raise ConfigError(
            f"a recording of task {meta.get('task')!r} has no heading metrics: it lacks "
            f"{', '.join(missing)}"
        )
    if len(trajectory) < 2:
        raise ConfigError("a recording needs at least two rows for metrics")


def _judged(trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Heading error and rudder angle [rad] at the ends of the intervals that count."""
    meta, psi_e, delta = trajectory.meta, trajectory["psi_error"][1:], trajectory["delta"][1:]
    planned = round(meta["config"]["duration"] / meta["config"]["control_interval"])
    lost = max(0, planned - len(psi_e)) if meta["terminated"] else 0
    limit = math.radians(meta["config"]["limits"]["heading_error_deg"])
    hard_over = meta["ship"]["delta_max"]
    return np.append(psi_e, np.full(lost, limit)), np.append(delta, np.full(lost, hard_over))


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
