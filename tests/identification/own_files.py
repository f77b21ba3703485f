"""Files of tests as others write them, from what is sailed here."""

import math
from pathlib import Path

import numpy as np

from ship_gym.ships import load_ship

HEAD = "# title: own\n# source: me\n# obtained: computed\n# conventions: as here\n"
AHEAD = 100  # rows straight ahead before the rudder moves: a quarter of L / U
L = load_ship("kvlcc2_model").hull.L


def own_record(path: Path, result, noise=(0.0, 0.0, 0.0), scale: float = 1.0) -> Path:
    """A manoeuvre as a tracker would write it down, the ship `scale` times as large."""
    c, rng = dict(result.trajectory.columns), np.random.default_rng(3)
    before = np.arange(-AHEAD, 0) * (c["t"][1] - c["t"][0])  # straight ahead, for the start
    u = c["u"][0]
    ahead = {"t": before, "x": before * u, "n": np.full(AHEAD, c["n"][0])}
    rows = []
    for name in ("t", "x", "y", "psi", "delta", "n"):
        values = np.concatenate([ahead.get(name, np.zeros(AHEAD)), c[name]])
        if name in ("x", "y", "psi"):
            sigma = noise[("x", "y", "psi").index(name)] * (1.0 if name == "psi" else L)
            late = np.arange(len(values)) > AHEAD
            values = values + late * rng.normal(0.0, 1.0, len(values)) * sigma
        rows.append(values)
    t, x, y, psi, delta, n = rows
    time = math.sqrt(scale)
    table = np.c_[
        t * time, x * scale, y * scale, np.degrees(psi), np.degrees(delta), 60.0 * n / time
    ]
    lines = [f"{HEAD}# length: {L * scale}", "t [s],x [m],y [m],psi [deg],delta [deg],n [rpm]"]
    lines += [",".join(map(repr, row)) for row in table.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path
