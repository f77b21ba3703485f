"""The report on a wave table: its sections as plain data, and how fast a ship can need it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import G
from ship_gym.keys import Keys
from ship_gym.provenance import sha256
from ship_gym.reports.page import Block, Grid, Picture, Section, Text
from ship_gym.sea.wave_table import BOUNDS, UNCERTAINTY, WaveTable
from ship_gym.seakeeping.hull_mesh import HullMesh
from ship_gym.seakeeping.hydrostatics import Hydrostatics, comparison
from ship_gym.seakeeping.table_checks import compare_with_snnm
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import self_propulsion

# Keys of the pictures that `sections` puts in their places.
PICTURES = ("mesh", "motions", "drift", "surge", "classes")
_FASTEST = 0.6  # Froude number; SNNM ends there
_BODY = {
    "mass": "displaced volume / L^3",
    "x_G": "centre of gravity forward of midship / L",
    "z_G": "centre of gravity above the waterline / L",
    "k_xx": "radius of gyration in roll / L",
    "k_yy": "radius of gyration in pitch / L",
    "k_zz": "radius of gyration in yaw / L",
    "GM": "metacentric height / L (imposed)",
    "Y_v": "lift damping in sway Y_v'",
    "N_r": "lift damping in yaw N_r'",
}


def largest_froude(ship: Ship) -> float:
    """Largest Froude number U / sqrt(g L) that the ship's engine holds in calm water, to 0.001.

    0.6 for a ship that holds more; 0 for one that cannot move.
    """
    low, high = 0.0, _FASTEST
    if _holds(ship, high):
        return high
    while high - low > 0.001:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _holds(ship, middle) else (low, middle)
    return low


def _holds(ship: Ship, froude: float) -> bool:
    try:
        self_propulsion(ship, froude * math.sqrt(G * ship.hull.L))
    except ConfigError:
        return False
    return True


def chosen(values: np.ndarray, wanted: Sequence[float]) -> list[int]:
    """Indices of the points nearest to some wanted values, each once, in the order wanted."""
    return list(dict.fromkeys(int(np.abs(values - x).argmin()) for x in wanted))


def sections(
    table: WaveTable,
    ship: Ship,
    mesh: HullMesh | None,
    pictures: Mapping[str, Sequence[Picture]],
) -> list[Section]:
    """The report in reading order, without provenance.

    Parameters
    ----------
    table : WaveTable
    ship : Ship
        The ship of the table, for the hydrostatics and its largest speed.
    mesh : HullMesh or None
        The panels it was computed with, of the size of `ship`; None if they are not at hand.
    pictures : mapping
        Some of `PICTURES` to what was drawn.
    """

    def drawn(name: str) -> list[Picture]:
        return list(pictures.get(name, ()))

    return [
        Section("What it is", [_facts(table, ship)]),
        Section("Checks", [_checks(table)]),
        Section("Hull", [*_hull(ship, mesh), *drawn("mesh"), _body(table)]),
        Section("Motions", drawn("motions")),
        Section("Drift forces", drawn("drift")),
        Section("Surge beside SNNM", [*_surge(table), *drawn("surge")]),
        Section("How sure each cell is", [_classes(table), *drawn("classes")]),
    ]


@dataclasses.dataclass(frozen=True)
class _Card:
    """What `seakeeping.database.build` writes beside the numbers, and a report tells of."""

    ship: str
    title: str
    mesh: tuple[str, ...]
    panels: int
    lid_panels: int
    minutes: float
    made_for: dict
    body: dict[str, float]
    calibration: dict[str, float]
    checks: dict
    uncertainty: dict[str, str]
    capytaine: str
    versions: dict[str, str]
    git_commit: str


def check_card(table: WaveTable, path: Path) -> None:
    """Refuse a table whose card lacks what its report tells.

    Raises
    ------
    ConfigError
        A key that is missing or of another type.
    """
    card = Keys(table.card, str(path), "card").build(_Card)
    largest = card.checks.get("largest")
    parts = {
        "body": (card.body, _BODY),
        "checks": (card.checks, ("energy", "fore_aft")),
        "checks.largest": (largest if isinstance(largest, dict) else {}, BOUNDS),
        "calibration": (card.calibration, card.calibration),
    }
    for part, (found, wanted) in parts.items():
        for name in wanted:
            check_number(f"{path}: card.{part}.{name}", found.get(name), tiny=True)
    if not card.mesh:
        raise ConfigError(f"{path}: card.mesh is empty: allowed is a line at least")


def provenance(table: WaveTable, path: Path) -> Section:
    """Where everything comes from.

    Parameters
    ----------
    table : WaveTable
    path : Path
        Its file.
    """
    card = table.card
    versions = {"capytaine": card["capytaine"], **card["versions"]}
    rows = [
        [f"SHA-256 of {path.name}", sha256(path)],
        ["commit", card["git_commit"]],
        *([name, version] for name, version in versions.items()),
    ]
    constants = [[name, f"{value:g}"] for name, value in card["calibration"].items()]
    text = (
        "Constants that no theory gives. Those of the far field, the blend and the damping in heave"
        " and pitch were chosen by comparison with SNNM in head and bow seas: there SNNM is no "
        "independent check. ship_gym/seakeeping/calibration.py says how each was found."
    )
    blocks: list[Block] = [
        Grid("", ["", ""], rows, left=2),
        Text(text),
        Grid("", ["", ""], constants),
    ]
    return Section("Provenance", blocks)


def _facts(table: WaveTable, ship: Ship) -> Grid:
    card, made = table.card, table.card["made_for"]
    ratio = 2.0 * math.pi / table.omega**2
    largest = largest_froude(ship)
    holds = f"{largest:.3f}" if largest < _FASTEST else f"{_FASTEST:g} or more"
    if largest > table.froude[-1] + 1e-9:
        holds += "; beyond the table, whose last speed serves there"
    rows = [
        ["ship", card["title"]],
        ["made for", f"L {made['L']:g} m, B {made['B']:g} m, d {made['d']:g} m; serves all scales"],
        ["panels", f"{card['panels']} and {card['lid_panels']} on the lid at the waterline"],
        ["Froude numbers", ", ".join(f"{x:g}" for x in table.froude)],
        ["engine holds in calm water", f"Froude number {holds}"],
        ["headings", f"{len(table.heading)} from following (0 deg) to head sea (180 deg)"],
        ["wavelengths", f"{len(ratio)} from {ratio[0]:.3g} L to {ratio[-1]:.3g} L"],
        ["computing time", f"{card['minutes']:g} minutes"],
    ]
    return Grid("wave table", ["", ""], rows, left=2)


def _checks(table: WaveTable) -> Grid:
    """Measured checks; what a bound is, the last column says."""
    checks = table.card["checks"]
    rows = [
        [
            "energy balance, head sea at rest",
            f"{100.0 * checks['energy']:.1f} %",
            "far-field energy beside that of the optical theorem, 0.4 to 1 L",
        ],
        [
            "CX ahead and astern, at rest",
            f"{100.0 * checks['fore_aft']:.1f} %",
            "|CX(180) + CX(0)| / |CX(180)|, 0.9 to 1.5 L; not zero for a real hull",
        ],
    ]
    for name, value in checks["largest"].items():
        verdict = "within" if value <= BOUNDS[name] else "BEYOND"
        rows.append([f"largest |{name}|", f"{value:.3g}", f"{verdict} the bound {BOUNDS[name]:g}"])
    return Grid("", ["check", "found", "what it is"], rows, left=3)


def _hull(ship: Ship, mesh: HullMesh | None) -> list[Grid | Text]:
    if mesh is None:
        return [Text("The panels this table was computed with are not at hand.")]
    fields = {f.name: f.metadata for f in Hydrostatics.__dataclass_fields__.values()}
    rows = []
    for name, (found, given) in comparison(mesh, ship).items():
        by, of = (ship.hull.L, "% L") if name in ("x_B", "x_F") else (given, "%")
        difference = f"{100.0 * (found - given) / by:+.2f} {of}"
        numbers = [f"{found:.5g}", f"{given:.5g}", difference]
        rows.append([name, fields[name]["meaning"], fields[name]["unit"], *numbers])
    header = ["", "", "unit", "mesh", "ship file", "difference"]
    note = (
        "Mass, centre of gravity and metacentric height come from the ship file, so a KM that "
        "differs does not reach the roll motion."
    )
    made = Text("Mesh: " + "; ".join(mesh.report) + ".")
    return [made, Grid(f"{ship.name}, {mesh.count} panels", header, rows, left=3), Text(note)]


def _body(table: WaveTable) -> Grid:
    rows = [[meaning, f"{table.card['body'][name]:.5g}"] for name, meaning in _BODY.items()]
    return Grid("mass and added damping", ["", ""], rows)


def _surge(table: WaveTable) -> list[Grid | Text]:
    """Tables of rms difference, peak and its place, a row for each heading."""
    found = compare_with_snnm(table)
    every = chosen(np.degrees(table.heading), (180, 150, 120, 90, 60, 30, 0))
    speeds = [f"{x:.2f}" for x in table.froude]
    header = ["heading [deg]", *(f"Fn {s}" for s in speeds)]

    def rows(cell) -> list[list[str]]:
        return [
            [f"{np.degrees(table.heading[j]):.0f}", *(cell(s, j) for s in speeds)] for j in every
        ]

    def peak(s: str, j: int) -> str:
        ours, theirs = found["peak"][s][j], found["peak_snnm"][s][j]
        return f"{_plus(ours)} ({_plus(theirs)})"

    def place(s: str, j: int) -> str:
        """No place where waves of all lengths push the ship ahead."""
        ours, theirs = (
            f"{found['at' + of][s][j]:.2f}" if found["peak" + of][s][j] > 0.005 else "-"
            for of in ("", "_snnm")
        )
        return f"{ours} ({theirs})"

    return [
        Text(
            "SNNM is a regression of measured added resistance (ITTC 7.5-04-01-01.1): good in head "
            "and bow seas, weak in beam and following seas. All numbers are for wavelengths of 0.4 "
            "to 2 L, and of the boundary elements alone, not of the blend."
        ),
        Grid(
            "rms difference by SNNM's largest value",
            header,
            rows(lambda s, j: f"{found['rms'][s][j]:.2f}"),
        ),
        Grid("largest -CX, SNNM in brackets", header, rows(peak)),
        Grid("wavelength / L of it, SNNM in brackets", header, rows(place)),
    ]


def _plus(value: float) -> str:
    """Two digits, without a sign on zero."""
    return f"{round(value, 2) + 0.0:.2f}"


def largest_rms(table: WaveTable) -> dict[int, tuple[float, float, float]]:
    """Largest rms difference from SNNM at speed in the headings of classes 1 and 2.

    Returns
    -------
    dict
        Class to (rms by SNNM's largest value, Froude number, heading [deg]); see
        `compare_with_snnm`. A class without headings is left out.
    """
    rms = compare_with_snnm(table)["rms"]
    heading = np.degrees(table.heading)
    every = [
        (value, float(U), float(mu))
        for U in table.froude[1:]
        for value, mu in zip(rms[f"{U:.2f}"], heading, strict=True)
    ]
    classes = {1: (149.9, 181.0), 2: (89.9, 149.9)}
    within = {key: [e for e in every if low < e[2] <= high] for key, (low, high) in classes.items()}
    return {key: max(entries) for key, entries in within.items() if entries}


def _classes(table: WaveTable) -> Grid:
    """What the classes promise, and what the comparison with SNNM finds in this table."""
    worst = {
        key: f"{rms:.2f} at Fn {U:g}, {mu:.0f} deg"
        for key, (rms, U, mu) in largest_rms(table).items()
    }
    total = table.uncertainty.size
    rows = []
    for key, text in UNCERTAINTY.items():
        share = f"{100.0 * np.count_nonzero(table.uncertainty == key) / total:.0f} %"
        rows.append([str(key), text, worst.get(key, ""), share])
    return Grid("", ["class", "meaning", "largest rms here", "share of cells"], rows, left=2)
