"""Measures that several tasks share, computed from a recording alone.

The integrals that define J and the RMS are means over the ends of the control intervals, as in the
reward, each judged by the order or leg that held during it. An episode that a limit ended early is
judged over its planned duration: the intervals it did not sail count with the error at that limit
and the rudder hard over, the worst that an episode still alive can do. So failing early never pays.
Other measures take what was sailed. Times, and all "per hour", are full scale; angles are in
degrees.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ship_gym.physics._kernel import in_python
from ship_gym.physics.propeller import shaft_power
from ship_gym.recording.trajectory import Trajectory
from ship_gym.simulation import through_water
from ship_gym.tasks.base import Metric, Task
from ship_gym.tasks.bridge import SATURATED

SETTLED_DEG = 2.0  # band of the settling time
DWELL = 60.0  # time to stay in the band [full-scale s]; later disturbances do not count
DEAD_BAND_DEG = 1.0  # smaller swings of the rudder are no reversals
LAMBDAS = (0.1, 1.0, 8.0)
TURN = 120.0  # the turn after an order [full-scale s]; what follows it is the steady part

COMMON: dict[str, Metric] = {
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
    "success": Metric(
        "-", "1 if no limit ended the episode; of a task with an aim: if it was reached", "higher"
    ),
    "return": Metric("-", "sum of the rewards", "higher"),
}

# columns and meta that `common` reads
COLUMNS: tuple[str, ...] = ("u", "v", "psi", "delta", "n", "torque", "reward")
COLUMNS += ("current_speed", "current_direction_to")
META = ("ship", "config", "failed", "outcome")


def common(trajectory: Trajectory, task: Task) -> dict[str, float]:
    """Values of `COMMON` for an episode of a task."""
    meta = trajectory.meta
    aims = {outcome.name for outcome in task.outcomes if outcome.reached}
    success = meta["outcome"] in aims if aims else not meta["failed"]
    return {
        **_rudder_use(trajectory),
        "speed_loss": 1.0 - float(np.mean(through_water(trajectory)[0])) / meta["ship"]["speed"],
        "energy": _energy(trajectory),
        "success": float(success),
        "return": float(trajectory["reward"].sum()),
    }


def full_scale_time(trajectory: Trajectory) -> np.ndarray:
    """Times of a recording at full scale [s], shape (T,)."""
    return trajectory["t"] * math.sqrt(trajectory.meta["ship"]["scale"])


def sailed_time(trajectory: Trajectory) -> float:
    """Duration of a recording at full scale [s]."""
    t = trajectory["t"]
    return (t[-1] - t[0]) * math.sqrt(trajectory.meta["ship"]["scale"])


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return math.sqrt(np.mean(values * values))


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


def turning(orders: Iterable[float], count: int, interval: float) -> np.ndarray:
    """Which of `count` intervals begin within `TURN` after an order, shape (count,), bool.

    Parameters
    ----------
    orders : iterable of int
        Intervals from which the orders hold; those from `count` on do not matter.
    count : int
    interval : float
        Control interval [full-scale s].
    """
    length = math.ceil(TURN / interval - 1e-9)
    found = np.zeros(count, dtype=np.bool_)
    for begins in orders:
        found[int(begins) : int(begins) + length] = True
    return found


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


def to_the_end(trajectory: Trajectory, values: np.ndarray, worst: float) -> np.ndarray:
    """Values at the ends of the intervals that count: those lost by failing are the `worst`."""
    config = trajectory.meta["config"]
    planned = round(config["duration"] / config["control_interval"])
    lost = max(0, planned - len(values)) if trajectory.meta["failed"] else 0
    return np.append(values, np.full(lost, worst))


def _rudder_use(trajectory: Trajectory) -> dict[str, float]:
    """Travel, reversals and saturation of the rudder."""
    delta, hours = trajectory["delta"], sailed_time(trajectory) / 3600.0
    angle, hard_over = np.degrees(delta), SATURATED * trajectory.meta["ship"]["delta_max"]
    return {
        "rudder_travel": float(np.abs(np.diff(angle)).sum() / hours),
        "rudder_reversals": float(reversals(angle) / hours),
        "saturation": float(np.mean(np.abs(delta[1:]) >= hard_over)),
    }


def delivered_energy(trajectory: Trajectory) -> float:
    """Energy delivered to the propellers, of the ship that sails, model or not [J]."""
    delivered = in_python(shaft_power)(trajectory["n"], trajectory["torque"])
    power = np.maximum(delivered, 0.0)  # none comes back
    return float(np.trapezoid(power, trajectory["t"]))


def _energy(trajectory: Trajectory) -> float:
    """Delivered energy per distance through the water, full scale [kWh/nmi]."""
    work = delivered_energy(trajectory)
    distance = np.trapezoid(np.hypot(*through_water(trajectory)), trajectory["t"])
    return float(work / distance) * trajectory.meta["ship"]["scale"] ** 3 * 1852.0 / 3.6e6
