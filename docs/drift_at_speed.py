"""Table of docs/drift_at_speed.md: run ``python docs/drift_at_speed.py``. Nothing is tuned here.

Wave loads of three ships in waves of their length, term by term, and the turns that follow.
"""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path

import numpy as np
from joblib import Parallel, delayed

from ship_gym import load_ship
from ship_gym.reports.case import Case, sail
from ship_gym.sea.wave_response import wave_table_of
from ship_gym.seakeeping import calibration
from ship_gym.seakeeping.database import Grid, Problem, across_critical, head_weight, make_problem
from ship_gym.seakeeping.drift import drift, encounter_frequency
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.motions import Radiation, absorbed_action, motions
from ship_gym.seakeeping.near_field import near_field
from ship_gym.seakeeping.radiation_diffraction import diffraction, radiation
from ship_gym.ships.particulars import Ship
from ship_gym.text import table

# Speed [m/s], propeller [rev/s], wave height [m], rudder [deg]; waves as long as the ship, from
# ahead when the rudder is put over: Knight (2021) Table 6.2, White (2020)
TURNS = {
    "onrt_model": (1.11, 8.97, 0.063, -35.0),
    "kcs_model": (0.860, 13.2, 0.048, 35.0),
    "dtc_model": (1.48, 15.7, 0.112, 35.0),
}
K0 = 2.0 * np.pi  # of waves of the ship's length


@dataclasses.dataclass(frozen=True)
class Loads:
    """Surge, sway and yaw in Capytaine's axes, each of shape (froude, headings, 3)."""

    far: np.ndarray  # radiated waves only
    absorbed: np.ndarray  # what damping adds
    near: np.ndarray


def cell(problem: Problem, speed: float, heading: float) -> np.ndarray:
    """Far field, what damping adds, near field of one speed and heading, shape (3, 3)."""
    hull, omega_e = problem.hull, encounter_frequency(K0, heading, speed)
    omega = max(abs(omega_e), 0.1) * np.array([0.99, 1.01])
    waves = Radiation(omega, np.array([radiation(hull, w**2) for w in omega]))
    second = head_weight(K0, heading) if speed > 0.0 else 0.0
    found = np.zeros((3, 3))
    for weight, k in ((1.0 - second, None), (second, omega_e**2)):
        if weight > 0.0:
            flow = diffraction(hull, K0, np.array([heading]), k)[0]
            wave = K0, heading, speed
            xi, moving = motions(hull, problem.body, flow, waves, *wave)
            taken = absorbed_action(hull, problem.body, waves, xi, omega_e, speed)
            far, more = drift(hull, moving, *wave), drift(hull, moving, *wave, absorbed=taken)
            far, more = (np.array([d.surge, d.sway, d.yaw]) for d in (far, more))
            near = near_field(problem.surface, moving, xi, *wave).total
            found += weight * np.array([far, more - far, near])
    return found


def loads(ship: Ship, froude: tuple[float, ...], jobs: int = 2) -> tuple[Problem, Loads]:
    """All loads of a ship in waves of its length."""
    grid = Grid(froude, longest=1.001, shortest=0.999, frequencies=2)
    problem = make_problem(ship, parametric_mesh(ship), grid)
    tasks = [(U, mu) for U in froude for mu in grid.heading_points]
    cells = Parallel(jobs)(delayed(cell)(problem, *task) for task in tasks)
    shape = len(froude), grid.headings, 3, 3
    return problem, Loads(*np.moveaxis(np.array(cells).reshape(shape), 2, 0))


def candidates(problem: Problem, of: Loads) -> dict[str, np.ndarray]:
    """Surge, sway and yaw of every candidate, each with those before it, shape (f, h, 3)."""
    heading = np.degrees(problem.grid.heading_points)
    start, end = calibration.FAR_FIELD_TO_DEG, calibration.NEAR_FIELD_FROM_DEG
    share = np.clip((heading - start) / (end - start), 0.0, 1.0)
    absorbed = of.far + of.absorbed
    band = absorbed.copy()
    for i in (0, 1):
        both = np.repeat(absorbed[:, :, i, None], 2, axis=2)
        band[:, :, i] = across_critical(problem.grid, both)[:, :, 0]
    change = of.far[0] + of.near - of.near[0]
    everywhere, ahead = band.copy(), band.copy()
    everywhere[:, :, 2] = change[:, :, 2]
    ahead[:, :, 2] += share * (change - band)[:, :, 2]
    return {
        "far field": of.far,
        "+ action that damping takes": absorbed,
        "+ surge and sway across tau = 1/4": band,
        "+ yaw by the near field, all headings": everywhere,
        "+ yaw by the near field, head to beam (built)": ahead,
    }


def with_loads(ship: Ship, problem: Problem, values: np.ndarray, folder: Path) -> Ship:
    """The ship with these loads in waves of every length."""
    old, beam = wave_table_of(ship), ship.hull.B / ship.hull.L
    surge, sway, yaw = np.moveaxis(values, -1, 0)
    yaw = yaw - problem.body.x_G * sway
    sway[:, [0, -1]] = yaw[:, [0, -1]] = 0.0
    count = len(old.omega)
    CX, CY, CN = (
        np.repeat(c[:, :, None], count, axis=2).astype(np.float32)
        for c in (surge / beam**2, -2.0 * sway, -2.0 * yaw)
    )
    path = folder / "waves.npz"
    dataclasses.replace(old, CX_bem=CX, CY=CY, CN=CN).save(path)
    return dataclasses.replace(ship, wave_table=str(path))


def turn(ship: Ship) -> Case:
    """The turn of `TURNS`."""
    speed, n, height, delta = TURNS[ship.name]
    wave = {"wave_height": height, "wavelength": 1.0}
    return sail(ship, delta_deg=delta, speed=speed, n=n, **wave)


def rows(name: str) -> list[list[str]]:
    """Rows of the table of one ship."""
    ship, found = load_ship(name), []
    froude = tuple(float(x) for x in wave_table_of(ship).froude)
    problem, of = loads(ship, froude)
    for label, values in candidates(problem, of).items():
        with tempfile.TemporaryDirectory() as folder:
            m = turn(with_loads(ship, problem, values.copy(), Path(folder))).result.measures()
        direction = np.degrees(m["drift_direction"]) % 360.0
        numbers = m["tactical_diameter"], m["drift_distance"]
        found.append([name, label, *(f"{x:.2f}" for x in numbers), f"{direction:.0f}"])
    return found


if __name__ == "__main__":
    header = ["ship", "wave loads", "tactical diameter [L]", "drift [L]", "to [deg]"]
    print(table(header, [row for name in TURNS for row in rows(name)], markdown=True))
