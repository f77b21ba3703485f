"""Short made-up runs for tests."""

from __future__ import annotations

import numpy as np

from ship_gym.recording import Trajectory

SHIP = {"name": "kcs", "L": 230.0, "B": 32.2, "d": 10.8, "scale": 1.0}


def run(controller: str = "pid", step: float = 1.0, end: float = 20.0, start: float = 0.0, **meta):
    """A ship that goes north at 2 m/s for "pid", else at 3 m/s and 1 m/s east."""
    t = np.arange(0.0, end + 1e-9, step)
    east = 0.0 if controller == "pid" else 1.0
    speed = 2.0 + east
    columns = {
        "t": t + start,
        "x": speed * t,
        "y": east * t,
        "psi": 0.1 * east * t,
        "u": speed + 0 * t,
    }
    columns |= {"v": 0.0 * t, "delta": 0.01 * t * (1.0 + east), "psi_ordered": 0.0 * t}
    columns |= {"reward": -1.0 + 0 * t, "reward_termination": 0.0 * t}
    about = {"task": "heading_keeping", "scenario": "heading_keeping", "controller": controller}
    about |= {"seed": 3, "ship": SHIP, "outcome": "end of time", "config": {"duration": 20.0}}
    about |= {"metrics": {"J_1": 2.0 * speed, "settling_time": None}, "units": {"J_1": "deg2"}}
    return Trajectory(columns, about | meta)
