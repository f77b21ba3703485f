"""Compute a ship's wave table: parallel over frequencies, resumed where it was broken off.

Here the results of `radiation_diffraction`, `motions` and `drift` (z up, y to port, e^{-i omega t},
L = g = rho = 1) are turned into the ship's axes and factors of ``wave_table``.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import shutil
import time
from collections.abc import Callable, Iterable
from functools import cached_property
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.locks import held, locked
from ship_gym.provenance import provenance
from ship_gym.reading import read_npy
from ship_gym.sea.wave_hull import hull_facts
from ship_gym.sea.wave_table import BOUNDS, UNCERTAINTY, WaveTable
from ship_gym.seakeeping import calibration
from ship_gym.seakeeping.drift import drift, encounter_frequency
from ship_gym.seakeeping.hull_form import DRAWN
from ship_gym.seakeeping.hull_mesh import HullMesh, lid
from ship_gym.seakeeping.mesh_form import with_form
from ship_gym.seakeeping.motions import ROLL, Radiation, RigidBody, absorbed_action, motions
from ship_gym.seakeeping.near_field import near_field, short_wave_drift
from ship_gym.seakeeping.radiation_diffraction import (
    Flow,
    HalfHull,
    diffraction,
    half_hull,
    radiation,
)
from ship_gym.seakeeping.snnm import added_resistance, snnm_hull
from ship_gym.seakeeping.surface import Surface
from ship_gym.seakeeping.table_checks import critical, uncertainty
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.writing import atomic_path, sweep

_VOLUME_TOLERANCE = 0.05
_FLIP = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])  # half a turn about x


@dataclasses.dataclass(frozen=True)
class Grid:
    """Where a table is computed.

    Attributes
    ----------
    froude : tuple of float
        Increasing, from 0.
    headings : int
        Points from 0 to 180 deg.
    frequencies : int
        Points of the true frequency between wavelengths of `longest` and `shortest` L.
    encounter : int
        Points of the encounter frequency for radiation, up to `encounter_max` sqrt(g/L); beyond it
        the last one holds, where motions are negligible and panels too coarse.
    """

    froude: tuple[float, ...] = (0.0, 0.05, 0.10, 0.15, 0.20, 0.26, 0.30)
    headings: int = 13
    frequencies: int = 40
    longest: float = 3.3
    shortest: float = 0.2
    encounter: int = 77
    encounter_max: float = 7.7

    def __post_init__(self):
        if self.froude[0] != 0.0 or (np.diff(self.froude) <= 0.0).any():
            raise ConfigError(f"froude = {self.froude}: allowed is increasing from 0")
        if min(self.headings, self.frequencies, self.encounter) < 2:
            raise ConfigError("grid: allowed is at least 2 headings and 2 frequencies of each kind")

    def up_to(self, froude: float) -> Grid:
        """The same grid with speeds that end at the first one at or above a Froude number.

        A ship that never sails faster is spared cells far beyond its speed, in which the theory is
        worst. At least one speed above rest remains; a larger number than the last changes nothing.
        """
        last = int(np.searchsorted(self.froude, froude - 1e-9)) + 1
        return dataclasses.replace(self, froude=self.froude[: max(last, 2)])

    @property
    def heading_points(self) -> np.ndarray:
        """Headings mu [rad], shape (headings,)."""
        return np.linspace(0.0, np.pi, self.headings)

    @property
    def omega_points(self) -> np.ndarray:
        """True frequencies omega sqrt(L/g), shape (frequencies,)."""
        low, high = np.sqrt(2.0 * np.pi / np.array([self.longest, self.shortest]))
        return np.linspace(low, high, self.frequencies)

    @property
    def encounter_points(self) -> np.ndarray:
        """Encounter frequencies by sqrt(g/L), shape (encounter,)."""
        return np.linspace(self.encounter_max / self.encounter, self.encounter_max, self.encounter)


QUICK = Grid((0.0, 0.15, 0.30), 7, 12, encounter=26)


@dataclasses.dataclass(frozen=True)
class Problem:
    """One ship on one grid: what every part of the computation needs."""

    hull: HalfHull
    body: RigidBody
    grid: Grid

    @cached_property
    def surface(self) -> Surface:
        """Both sides of the hull, for the pressure on it."""
        return Surface(self.hull)


def head_weight(k0: float, heading: float) -> float:
    """Share of the solution with diffraction at the encounter frequency, at speed."""
    c = calibration
    ratio = 2.0 * np.pi / k0
    long = (ratio - c.LONG_WAVE_START) / (c.LONG_WAVE_END - c.LONG_WAVE_START)
    head = 1.0 - (180.0 - np.degrees(heading)) / c.HEAD_SECTOR_DEG
    return float(np.clip(long, 0.0, 1.0) * np.clip(head, 0.0, 1.0))


def cell(
    problem: Problem,
    flow: Flow,
    second: Callable[[], Flow],
    waves: Radiation,
    k0: float,
    heading: float,
    speed: float,
) -> np.ndarray:
    """One cell in Capytaine's axes: drift, energy closure, six motions.

    Parameters
    ----------
    problem : Problem
    flow : Flow
        Diffraction at the true wave number.
    second : callable
        Gives the diffraction at the encounter frequency; called only where it has a share.
    waves : Radiation
    k0, heading, speed : float
        Wave number by 1/L, mu [rad], Froude number.

    Returns
    -------
    numpy.ndarray
        complex, shape (11,): surge, sway and yaw by the far field, yaw by the near field, closure,
        motions.
    """
    share = head_weight(k0, heading) if speed > 0.0 else 0.0
    omega_e = encounter_frequency(k0, heading, speed)
    found = np.zeros(11, complex)
    for weight, solution in ((1.0 - share, lambda: flow), (share, second)):
        if weight > 0.0:
            wave = k0, heading, speed
            xi, moving = motions(problem.hull, problem.body, solution(), waves, *wave)
            absorbed = absorbed_action(problem.hull, problem.body, waves, xi, omega_e, speed)
            d = drift(problem.hull, moving, *wave, absorbed=absorbed)
            near = near_field(problem.surface, moving, xi, *wave).total[2]
            lost = d.action + d.absorbed
            closure = lost / d.extinction - 1.0 if d.extinction != 0.0 else 0.0
            found += weight * np.array([d.surge, d.sway, d.yaw, near, closure, *xi])
    return found


def frequency_row(problem: Problem, waves: Radiation, index: int) -> np.ndarray:
    """All cells of one true frequency, complex, shape (froude, headings, 11), see `cell`."""
    grid = problem.grid
    k0 = float(grid.omega_points[index] ** 2)
    flows = diffraction(problem.hull, k0, grid.heading_points)
    rows = np.empty((len(grid.froude), grid.headings, 11), complex)
    for i, speed in enumerate(grid.froude):
        for j, heading in enumerate(grid.heading_points):
            encounter_k = encounter_frequency(k0, heading, speed) ** 2

            def second(heading=heading, encounter_k=encounter_k):
                return diffraction(problem.hull, k0, np.array([heading]), encounter_k)[0]

            rows[i, j] = cell(problem, flows[j], second, waves, k0, heading, speed)
    return rows


def compute(
    problem: Problem,
    work: Path,
    jobs: int = 1,
    progress: Callable[..., Iterable] = lambda items, description, total: items,
) -> np.ndarray:
    """All cells, parallel over frequencies; what is already in the folder is not done again.

    Parameters
    ----------
    problem : Problem
    work : Path
        Folder of results per frequency. It must belong to this problem: see `work_name`.
    jobs : int
        Processes.
    progress : callable
        ``progress(iterable, description, total)`` gives the iterable back.

    Returns
    -------
    numpy.ndarray
        complex, shape (froude, headings, frequencies, 11), see `cell`.
    """
    grid = problem.grid
    work.mkdir(parents=True, exist_ok=True)
    tasks: list[tuple] = [(radiation, problem.hull, w**2) for w in grid.encounter_points]
    potentials = _each(tasks, work, "radiation", jobs, progress)
    waves = Radiation(grid.encounter_points, np.array(potentials))
    tasks = [(frequency_row, problem, waves, i) for i in range(grid.frequencies)]
    return np.stack(_each(tasks, work, "waves", jobs, progress), axis=2)


def _each(tasks: list[tuple], work: Path, name: str, jobs: int, progress) -> list[np.ndarray]:
    """Results of the tasks (function, *arguments), each kept in a file of the folder."""
    from joblib import Parallel, delayed, parallel_config

    paths = [work / f"{name}_{i:03d}.npy" for i in range(len(tasks))]
    kept = [_kept(path) for path in paths]
    missing = [i for i, found in enumerate(kept) if found is None]
    # one thread each: the processes share the cores, not the matrices
    with parallel_config("loky", inner_max_num_threads=1):
        run = Parallel(n_jobs=jobs, return_as="generator_unordered")
        done = run(delayed(_keep)(paths[i], *tasks[i]) for i in missing)
        for _ in progress(done, name, len(missing)):
            pass
    return [read_npy(paths[i]) if found is None else found for i, found in enumerate(kept)]


def _kept(path: Path) -> np.ndarray | None:
    """A result of an earlier, broken off build; None if there is none or it is damaged."""
    if not path.is_file():
        return None
    try:
        found = read_npy(path)
    except ConfigError:
        return None
    return found if found.dtype.kind == "c" and np.isfinite(found).all() else None


def _keep(path: Path, function: Callable[..., np.ndarray], *arguments) -> None:
    """Call and write the result, whole or not at all."""
    result = function(*arguments)
    with atomic_path(path) as temporary, temporary.open("wb") as file:
        np.save(file, result)


def across_critical(grid: Grid, force: np.ndarray) -> np.ndarray:
    """Far-field force with the cells above tau = 1/4 replaced, shape (f, h, w).

    There the gap between long and short free waves has just closed, and short ones that the flow of
    the resting hull does not resolve enter at once: at Fn 0.10 they are more than half of KVLCC2's
    surge. A cell of `critical` takes the straight line in Froude number between the next speeds
    outside of the band; without a faster one it stays.
    """
    found, froude = force.copy(), np.array(grid.froude)
    inside = critical(froude, grid.heading_points, grid.omega_points)
    for j, w in zip(*np.nonzero(inside.any(axis=0)), strict=True):
        outside = np.flatnonzero(~inside[:, j, w])
        between = inside[:, j, w] & (np.arange(len(froude)) < outside[-1])
        known = force[outside, j, w]
        found[between, j, w] = np.interp(froude[between], froude[outside], known)
    return found


def yaw_at_speed(problem: Problem, far: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Yaw moment about the origin from that of both fields, shape (f, h, w).

    In head to beam seas the far field at rest, which is exact, and the change with speed by the
    near field; of waves too short for the panels, by the short-wave asymptote.
    """
    grid, c = problem.grid, calibration
    axes = grid.froude, grid.heading_points, grid.omega_points
    waves = [(w * w, mu, U) for U in axes[0] for mu in axes[1] for w in axes[2]]
    tail = np.array([short_wave_drift(problem.surface, *wave)[2] for wave in waves])
    tail = tail.reshape(far.shape)
    ratio = 2.0 * np.pi / axes[2] ** 2
    resolved = _ramp(ratio, c.SHORT_WAVES_TO, c.NEAR_FIELD_FROM)
    change = resolved * (near - near[0]) + (1.0 - resolved) * (tail - tail[0])
    ahead = _ramp(np.degrees(axes[1]), c.FAR_FIELD_TO_DEG, c.NEAR_FIELD_FROM_DEG)[:, None]
    return far + ahead * (far[0] + change - far)


def _ramp(x: np.ndarray, start: float, end: float) -> np.ndarray:
    """0 below `start`, 1 above `end`, linear between."""
    return np.clip((x - start) / (end - start), 0.0, 1.0)


def coefficients(problem: Problem, cells: np.ndarray, beam: float) -> dict[str, np.ndarray]:
    """Drift coefficients and motions of `compute` in ship axes, as in `WaveTable`.

    Parameters
    ----------
    problem : Problem
    cells : numpy.ndarray
        Shape (f, h, w, 11).
    beam : float
        B / L.
    """
    surge, sway, far, near = np.moveaxis(cells[..., :4].real, -1, 0)
    surge, sway = (across_critical(problem.grid, force) for force in (surge, sway))
    yaw = yaw_at_speed(problem, far, near)
    # sway and yaw change sign with the half turn about x; the force on the centreline is zero
    CY, CN = -2.0 * sway, -2.0 * (yaw - problem.body.x_G * sway)
    moved = (cells[..., 5:] * _FLIP).conj()
    moved[..., ROLL:] /= (problem.grid.omega_points**2)[:, None]
    for symmetric in (CY, CN, moved[..., 1], moved[..., 3], moved[..., 5]):
        symmetric[:, [0, -1]] = 0.0  # exactly, where the sea is symmetric
    return {
        "CX_bem": (surge / beam**2).astype(np.float32),
        "CY": CY.astype(np.float32),
        "CN": CN.astype(np.float32),
        "motions": moved.astype(np.complex64),
    }


def make_problem(ship: Ship, mesh: HullMesh, grid: Grid = Grid()) -> Problem:
    """Hull by L and mass distribution of a ship.

    Parameters
    ----------
    ship : Ship
        With a section ``form`` (KG, GM, radii of gyration).
    mesh : HullMesh
        Starboard half in ship axes [m], with its waterline at z = 0.
    grid : Grid

    Raises
    ------
    ConfigError
        No form, a mesh without symmetry, or a volume more than 5 % off the ship's.
    """
    form, h = ship.form, ship.hull
    if form is None:
        raise ConfigError(f"{ship.name}: no section [form], which motions in waves need")
    hull = half_hull(mesh, lid(mesh), h.L)
    volume = hull.volume * h.L**3
    if abs(volume / h.volume - 1.0) > _VOLUME_TOLERANCE:
        raise ConfigError(
            f"{ship.name}: the mesh displaces {volume:.6g} m3, the ship {h.volume:.6g} m3: allowed "
            f"is a difference of {100.0 * _VOLUME_TOLERANCE:g} %; check draught, scale and units"
        )
    body = RigidBody(
        mass=hull.volume,
        x_G=h.x_G / h.L,
        z_G=(form.KG - h.d) / h.L,
        k_xx=form.k_xx / h.L,
        k_yy=form.k_yy / h.L,
        k_zz=h.k_zz / h.L,
        GM=form.GM / h.L,
        Y_v=h.Y_v,
        N_r=h.N_r,
    )
    return Problem(hull, body, grid)


def work_name(problem: Problem) -> str:
    """Name of the folder of intermediate results: another one if anything that matters changes."""
    facts = {
        "body": dataclasses.asdict(problem.body),
        "grid": dataclasses.asdict(problem.grid),
        "calibration": calibration.values(),
        "capytaine": metadata.version("capytaine"),
    }
    key = hashlib.sha256(json.dumps(facts, sort_keys=True).encode())
    key.update(problem.hull.panels.tobytes() + problem.hull.lid.tobytes())
    return f"waves-{key.hexdigest()[:12]}"


def build(
    ship: Named | Ship,
    mesh: HullMesh,
    path: Path,
    grid: Grid = Grid(),
    jobs: int = 1,
    progress: Callable[..., Iterable] = lambda items, description, total: items,
) -> WaveTable:
    """Compute a ship's wave table and write it.

    Results per frequency wait in a folder beside `path` (`work_name`), so that a build that was
    broken off goes on; it is removed at the end.

    Parameters
    ----------
    ship, mesh, grid
        As in `make_problem`; a ship without a form gets that of the mesh (``mesh_form``).
    path : Path
        File to write (.npz).
    jobs : int
        Processes; -1 for all cores.
    progress : callable
        ``progress(iterable, description, total)`` gives the iterable back.

    Returns
    -------
    WaveTable

    Raises
    ------
    ConfigError
        As in `make_problem`, before any work starts; or another process builds this table.
    """
    started, ship = time.monotonic(), load_ship(ship)
    ship, mesh = with_form(ship, mesh)
    problem = make_problem(ship, mesh, grid)
    snnm = snnm_hull(ship)  # refuses before the work
    work, doing = path.parent / work_name(problem), "builds this wave table"
    with held(path, doing), locked(work / "lock", doing, path):
        sweep(work)
        sweep(path.parent, path)
        cells = compute(problem, work, jobs, progress)
        table = _tabulated(ship, snnm, mesh, problem, cells)
        table.card["minutes"] = round((time.monotonic() - started) / 60.0, 2)
        table.save(path)
        shutil.rmtree(work, ignore_errors=os.name == "nt")  # which keeps the lock that is open
    return table


def _tabulated(
    ship: Ship, snnm: Any, mesh: HullMesh, problem: Problem, cells: np.ndarray
) -> WaveTable:
    """The table of the cells of `compute`, with its card and checks."""
    grid = problem.grid
    axes = np.array(grid.froude), grid.heading_points, grid.omega_points
    length = 2.0 * np.pi / grid.omega_points**2 * ship.hull.L
    resistance = [added_resistance(snnm, U, length, axes[1][:, None]) for U in grid.froude]
    values = coefficients(problem, cells, ship.hull.B / ship.hull.L)
    card = {
        "ship": ship.name,
        "title": ship.title,
        "made_for": hull_facts(ship, drawn=DRAWN in "".join(mesh.report[:1])),
        "mesh": list(mesh.report),
        "panels": 2 * len(problem.hull.panels),
        "lid_panels": 2 * len(problem.hull.lid),
        "body": dataclasses.asdict(problem.body),
        "grid": dataclasses.asdict(grid) | {"froude": list(grid.froude)},
        "calibration": calibration.values(),
        "uncertainty": {str(key): text for key, text in UNCERTAINTY.items()},
        "capytaine": metadata.version("capytaine"),
        **provenance(),
    }
    table = WaveTable(
        *axes,
        CX_snnm=-np.array(resistance, np.float32),
        uncertainty=uncertainty(*axes),
        card=card,
        **values,
    )
    table.card["checks"] = checks(table, cells)
    return table


def checks(table: WaveTable, cells: np.ndarray) -> dict[str, Any]:
    """What a table must satisfy, measured.

    Parameters
    ----------
    table : WaveTable
    cells : numpy.ndarray
        As of `compute`; the fifth column holds the energy closure.

    Returns
    -------
    dict
        ``energy``: far-field action by that of the optical theorem, less 1, largest in head seas at
        rest for 0.4 to 1 L. ``fore_aft``: |CX(180) + CX(0)| by |CX(180)| there for 0.9 to 1.5 L.
        ``largest``: largest |CX|, |CY|, |CN|; ``within_bounds``: those are below 12, 1.5, 0.2.
    """
    ratio = 2.0 * np.pi / table.omega**2
    head, following = table.CX_bem[0, -1], table.CX_bem[0, 0]
    resolved = (ratio >= 0.4) & (ratio <= 1.0)
    middle = (ratio >= 0.9) & (ratio <= 1.5)
    largest = {
        name: float(np.abs(values).max())
        for name, values in (("CX", table.CX_bem), ("CY", table.CY), ("CN", table.CN))
    }
    return {
        "energy": float(np.max(np.abs(cells[0, -1, resolved, 4].real), initial=0.0)),
        "fore_aft": float(np.max(np.abs((head + following)[middle] / head[middle]), initial=0.0)),
        "largest": largest,
        "within_bounds": all(largest[name] <= limit for name, limit in BOUNDS.items()),
    }
