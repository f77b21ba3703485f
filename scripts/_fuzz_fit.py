"""Tests of ships for ``ship-gym fit-hull``: captive runs, records of the free ship; small fits."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from _fuzz_made import _HEAD
from _fuzz_seeds import Seed
from _fuzz_use import Nonsense, _finite

_SHIP = "kvlcc2_model"
_LINEAR = {"static": ("Y_v", "N_v"), "planar": ("Y_r", "N_r", "J_z")}
_LONGEST = 300  # characters of a line of the report or of the ship file, tables too


@functools.cache
def _ship() -> Any:
    from ship_gym.ships.loader import load_ship

    return load_ship(_SHIP)


# --- good files ----------------------------------------------------------------------------------


def captive() -> Iterator[Seed]:
    """Static drift, and planar motion as harmonics, as ``measure`` gives them with some noise."""
    from ship_gym.captive import Condition, measure

    ship = _ship()
    U, n, omega = 1.179, 9.9, 1.2
    static = [
        Condition(U, n, math.radians(b), math.radians(d)) for b in (-8, -4, 4, 8) for d in (0, 9)
    ]
    planar = [Condition(U, n, yaw_rate=r, omega=omega) for r in (0.1, 0.2, 0.3, 0.4, 0.5)]
    rng = np.random.default_rng(0)
    for name, runs, forces in (
        ("static", static, ("X", "Y", "N", "T")),
        ("planar", planar, ("X_mean", "Y_in", "Y_out", "N_in", "N_out")),
    ):
        titles = "speed [m/s],n [rev/s],beta [deg],delta [deg],yaw_rate [-],frequency [1/s],"
        rows = [_HEAD + "# length: 6.893", titles + ",".join(f"{one} [-]" for one in forces)]
        for run, found in zip(runs, measure(ship, runs), strict=True):
            angles = math.degrees(run.beta), math.degrees(run.delta)
            cells = [run.speed, run.n, *angles, run.yaw_rate, run.omega / (2.0 * math.pi)]
            cells += [found[one] + rng.normal(0.0, 1e-3) for one in forces]
            rows.append(",".join(f"{x:.6g}" for x in cells))
        text = "\n".join(rows) + "\n"
        yield Seed(name, {f"{name}.csv": text.encode()}, {"names": _LINEAR[name]})


def records() -> Iterator[Seed]:
    """A zig-zag of our own form with a turn that is held out, and one in the form of MARIN."""
    from ship_gym.simulation import self_propulsion

    ship = _ship()
    n = self_propulsion(ship, ship.speed)
    made = {name: _sailed(name == "turn", n) for name in ("zigzag", "turn")}
    titles = "t [s],x [m],y [m],psi [deg],delta [deg],n [rev/s]"
    own = {f"{k}.csv": _text(_HEAD + "# length: 7.0\n" + titles, v) for k, v in made.items()}
    yield Seed("own", own)
    full, lam = made["zigzag"].copy(), 320.0 / ship.hull.L
    full *= [lam**0.5, lam, lam, 1.0, -1.0, 60.0 / lam**0.5]
    head = "# KVLCC2 free-running test at MARIN, of made-up numbers\n"
    rows = _text(head + "t [s],x [m],y [m],psi [deg],delta [deg],n [rpm]", full)
    yield Seed("marin", {"marin.csv": rows})


def _sailed(turn: bool, n: float) -> np.ndarray:
    """Rows t, x, y, psi [deg], delta [deg], n: straight ahead, then the rudder over."""
    from ship_gym.simulation import ShipSim

    sim = ShipSim(_SHIP, 1)
    sim.reset(0)
    rows = []
    for k in range(110):
        delta = 0.0 if k < 15 else 15.0 if turn or k % 40 < 20 else -15.0
        x, y, psi = sim.state[0, 3:6]
        rows.append([0.4 * k, x, y, math.degrees(psi), delta, n])
        sim.step(np.array([[math.radians(delta), n]]), 0.4)
    return np.array(rows)


def _text(head: str, rows: np.ndarray) -> bytes:
    return "\n".join([head, *(",".join(f"{x:.6g}" for x in row) for row in rows)]).encode()


# --- what is done with them ----------------------------------------------------------------------


def fit_captive(path: Path, names: tuple[str, ...], **_: Any) -> None:
    """Few numbers fitted; the report; and the ship file, if such a ship can be."""
    from ship_gym.identification import captive_fit, report

    _told(captive_fit.fit_captive(_ship(), [path], names), report, path)


def calibrate(path: Path, **_: Any) -> None:
    """One number calibrated, with the other file held out."""
    from ship_gym.identification import calibration, calibration_report

    rest = [one for one in sorted(path.parent.glob("*.csv")) if one != path]
    _told(calibration.calibrate(_ship(), [path], ["N_r"], rest), calibration_report, path)


def _told(found: Any, report: Any, path: Path) -> None:
    from ship_gym.identification.ship_text import write_ship

    _finite("fitted numbers", found.estimate.values)
    _finite("standard errors", found.estimate.errors)
    text = report.as_text(found)
    if max(map(len, text.splitlines())) > _LONGEST:
        raise Nonsense("a line of the report of more than 300 characters")
    report.as_dict(found)
    if not report.implausible(found):
        told = report.sources_of(found), report.lines_of(found)
        write_ship(path.with_name("fitted.toml"), _SHIP, found.fitted, *told)
