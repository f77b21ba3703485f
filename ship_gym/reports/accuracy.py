"""Error of the integration step beside the time it takes: every ship, in calm water and at sea."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Iterator, Sequence

import numpy as np

from ship_gym.conventions import PSI
from ship_gym.sea.state import CALM, Sea, load_sea
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim, longest_step
from ship_gym.text import table

SHIPS = 64  # of each run
LEG = 4  # default steps from one rudder order to the next; headings are compared at its end
LEGS = 150
FRACTIONS = (2.0, 1.0, 0.5, 0.25, 0.125)  # of the default step
REFERENCE = 1.0 / 32.0
MEDIAN, NINETY = 0.02, 0.1  # largest error of the heading [deg] that the default step may have
_HELD = 0.3  # share of the largest angle, within which rudders are held at sea


@dataclasses.dataclass(frozen=True)
class Condition:
    """What the ships meet and what their rudders do.

    Attributes
    ----------
    name : str
    title : str
    sea : Sea
        At full scale.
    rudder : float
        Angles are drawn evenly within this share of the largest one.
    redrawn : bool
        A new angle every leg; otherwise each ship holds one.
    any_heading : bool
        Headings at the start all round; otherwise 0.
    """

    name: str
    title: str
    sea: Sea
    rudder: float
    redrawn: bool
    any_heading: bool


@dataclasses.dataclass(frozen=True)
class Point:
    """Error and cost of one step length: errors of the heading [deg] over the ships, times [s].

    The error of a ship is its largest during the run; ``seconds`` is the processor time of one ship
    and one default step.
    """

    ship: str
    condition: str
    fraction: float
    step: float
    median: float
    ninety: float
    largest: float
    seconds: float


def conditions() -> tuple[Condition, ...]:
    """Calm water, and sea state 5 with gusts from ahead and from anywhere."""
    rough = dataclasses.replace(load_sea("ss5"), gusts=True)
    return (
        Condition(
            "calm", f"calm water, new rudder angle every {LEG} steps", CALM, 1.0, True, False
        ),
        Condition("ahead", "sea state 5 from ahead, rudder held", rough, _HELD, False, False),
        Condition("anywhere", "sea state 5 from anywhere, rudder held", rough, _HELD, False, True),
    )


def default_step(ship: Ship) -> float:
    """Integration step [s] in which a control interval of 1 s is sailed."""
    return 1.0 / math.ceil(1.0 / longest_step(ship) - 1e-9)


def sail(ship: Ship, condition: Condition, fraction: float) -> tuple[np.ndarray, float]:
    """Headings [rad] at the ends of the legs, shape (LEGS, SHIPS), and the time of `Point` [s].

    Parameters
    ----------
    ship : Ship
    condition : Condition
    fraction : float
        Integration step by the default one; `LEG` must be a whole number of it.
    """
    default = default_step(ship)
    sea = condition.sea.scaled(ship.scale)
    sim = ShipSim(ship, SHIPS, sea, parallel=False)
    sim.longest[:] = fraction * default
    rng = np.random.default_rng(0)
    shape = (LEGS if condition.redrawn else 1, SHIPS)
    rudder = condition.rudder * ship.gear.delta_max * rng.uniform(-1.0, 1.0, shape)
    rudder = np.broadcast_to(rudder, (LEGS, SHIPS))
    psi = rng.uniform(-math.pi, math.pi, SHIPS) if condition.any_heading else 0.0
    sim.reset(0, speed=ship.speed, psi=psi)
    sim.commands[:, 1] = sim.state[:, -1]
    sim.set_interval(LEG * default)
    headings, times = np.zeros((LEGS, SHIPS)), []
    for leg in range(LEGS):
        sim.commands[:, 0] = rudder[leg]
        start = time.process_time()
        sim.advance()
        times.append(time.process_time() - start)
        headings[leg] = sim.state[:, PSI]
    return headings, min(times) / (SHIPS * LEG)


def measure(
    ship: Ship, condition: Condition, fractions: Sequence[float] = FRACTIONS
) -> list[Point]:
    """Errors and times of some step lengths, against `REFERENCE`."""
    exact, _ = sail(ship, condition, REFERENCE)
    found = []
    for fraction in fractions:
        headings, seconds = sail(ship, condition, fraction)
        error = np.degrees(np.abs(headings - exact)).max(axis=0)
        half, most, largest = (float(np.quantile(error, share)) for share in (0.5, 0.9, 1.0))
        step = fraction * default_step(ship)
        errors = half, most, largest
        found.append(Point(ship.name, condition.name, fraction, step, *errors, seconds))
    return found


def jobs(names: Sequence[str] = ()) -> Iterator[tuple[Ship, Condition]]:
    """Every ship of these names, or of the package, in each condition that she can meet."""
    for ship in map(load_ship, names or available_ships()):
        for condition in conditions():
            if condition.sea is CALM or (ship.wave_table and ship.wind):
                yield ship, condition


def tables(points: Sequence[Point], markdown: bool = False) -> dict[str, str]:
    """Tables by name: ``default``, and one of all step lengths for each condition."""
    return {"default": _default_table(points, markdown)} | {
        c.name: _step_table([p for p in points if p.condition == c.name], markdown)
        for c in conditions()
        if any(p.condition == c.name for p in points)
    }


def _default_table(points: Sequence[Point], markdown: bool) -> str:
    header = ["ship", "step [s]", "condition", "median [deg]", "90 % [deg]", "largest [deg]", "us"]
    rows = [
        [
            p.ship,
            f"{p.step:.3f}",
            p.condition,
            f"{p.median:.4f}",
            f"{p.ninety:.4f}",
            f"{p.largest:.3f}",
            f"{1e6 * p.seconds:.2f}",
        ]
        for p in points
        if p.fraction == 1.0
    ]
    return table(header, rows, markdown=markdown)


def _step_table(points: Sequence[Point], markdown: bool) -> str:
    """Median, 90 % and time by ship and step length."""
    fractions = list(dict.fromkeys(p.fraction for p in points))
    by = {(p.ship, p.fraction): p for p in points}
    rows = []
    for ship in dict.fromkeys(p.ship for p in points):
        row = [by[ship, fraction] for fraction in fractions]
        cells = [f"{p.median:.2g} / {p.ninety:.2g} / {1e6 * p.seconds:.1f}" for p in row]
        rows.append([ship, *cells])
    return table(["ship", *(f"{f:g}" for f in fractions)], rows, markdown=markdown)


def as_text(points: Sequence[Point]) -> str:
    """The tables with a line above each that says what is shown."""
    found = tables(points)
    lines = ["Heading error at the default step; us: of one ship and step", "", found["default"]]
    for condition in conditions():
        if condition.name in found:
            title = f"{condition.title}: median / 90 % [deg] / us, by step over the default one"
            lines += ["", title, "", found[condition.name]]
    return "\n".join(lines)
