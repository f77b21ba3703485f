"""The printed KVLCC2 trials against MARIN's time histories, where those are at hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.ships.loader import load_ship

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "reference" / "kvlcc2"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="MARIN's files are not here")
L, U0 = 320.0, 15.5 * 1852.0 / 3600.0
MOVED = 2.0  # deg of rudder at which it counts as executed


def history(name: str) -> dict[str, np.ndarray]:
    """Columns of a file; its rudder angle is positive to port."""
    lines = [x for x in (FOLDER / name).read_text().splitlines() if not x.startswith("#")]
    names = [column.split(" [")[0] for column in lines[0].split(",")]
    columns = dict(zip(names, np.loadtxt(lines[1:], delimiter=",").T, strict=True))
    start = int((np.abs(columns["delta"] - columns["delta"][0]) > MOVED).argmax())
    return {name: values[start:] for name, values in columns.items()}


@pytest.mark.parametrize(("place", "name"), [(0, "turn_-35"), (1, "turn_35")])
def test_turning_circles(place, name):
    t, trial = history(f"marin_free_{name}.csv"), load_ship("kvlcc2_model").trials[place]
    psi = np.unwrap(np.radians(t["psi"]))
    side, first = math.copysign(1.0, trial.delta_deg), psi[0]
    turned = np.degrees(side * (psi - first))
    x, y = t["x"] - t["x"][0], t["y"] - t["y"][0]
    along = (x * math.cos(first) + y * math.sin(first)) / L
    across = side * (y * math.cos(first) - x * math.sin(first)) / L
    steady = (np.abs(t["delta"]) > 33.0) & (turned >= 320.0) & (turned < 680.0)
    fit = np.c_[x, y, np.ones_like(x)][steady]
    a, b, c = np.linalg.lstsq(fit, (x**2 + y**2)[steady], rcond=None)[0]
    found = {
        "advance": np.interp(90.0, turned, along),
        "transfer": np.interp(90.0, turned, across),
        "tactical_diameter": np.interp(180.0, turned, across),
        "max_transfer": across[turned <= 360.0].max(),
        "steady_diameter": 2.0 * math.sqrt(c + 0.25 * (a**2 + b**2)) / L,
        "steady_speed_ratio": np.hypot(t["u"], t["v"])[steady].mean() / U0,
    }
    assert set(found) == set(trial.measures)
    tolerance = dict.fromkeys(found, 0.025) | {"steady_speed_ratio": 0.002}
    for measure, value in found.items():
        assert trial.measures[measure] == pytest.approx(value, abs=tolerance[measure]), measure


@pytest.mark.parametrize(
    ("place", "name"),
    [(2, "zigzag_-10"), (3, "zigzag_10"), (4, "zigzag_-20"), (5, "zigzag_20")],
)
def test_zigzags(place, name):
    t, trial = history(f"marin_free_{name}.csv"), load_ship("kvlcc2_model").trials[place]
    psi, limit = t["psi"], abs(trial.psi_deg)
    side, start, found = math.copysign(1.0, trial.psi_deg), 0, []
    for _ in trial.measures["overshoots_deg"]:
        reached = start + int((side * psi[start:] >= limit).argmax())
        back = side * psi[reached:] < 0.0
        end = reached + int(back.argmax()) if back.any() else len(psi)
        found.append(float((side * psi[reached:end]).max()) - limit)
        side, start = -side, end
    assert trial.measures["overshoots_deg"] == pytest.approx(found, abs=0.15)
    if "initial_turning" in trial.measures:
        first = int((np.abs(psi) >= limit).argmax())
        way = (t["x"][first] - t["x"][0]) / L
        assert trial.measures["initial_turning"] == pytest.approx(way, abs=0.01)


def test_they_ran_at_one_propeller_speed():
    """91.66 rpm, which is 10.33 rev/s of the 7 m model."""
    for file in FOLDER.glob("marin_free_*.csv"):
        n = history(file.name)["n"].mean()
        assert n == pytest.approx(91.66, abs=0.02)
        assert n / 60.0 * math.sqrt(L / 7.0) == pytest.approx(10.33, abs=0.005)
