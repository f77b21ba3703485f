"""What White (2020) prints of turning circles in waves, beside ours; each a number of one run.

He compares two computations, a hybrid method and free-surface CFD; nothing was measured. Chapter 3
is DTC, chapter 4 KCS; all turns are 35 deg to starboard, waves as long as the ship from ahead.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ship_gym.reports.case import Case, sail
from ship_gym.ships.loader import load_ship
from ship_gym.text import table

# approach speed [m/s], propeller [rev/s], wave height [m]; lambda = L, head sea
CIRCLES = {"kcs_model": (0.860, 13.2, 0.048), "dtc_model": (1.48, 15.7, 0.112)}
KCS_CALM_N = 10.4  # rev/s of his calm turn of KCS
_SHOWN = 110.0  # s to which he shows DTC
_TRANSIENT = 10.0  # s that he calls the transient phase of DTC
_RUDDER_OVER = 2.0  # s; 35 deg at 18 deg/s take 1.94 s


@dataclasses.dataclass(frozen=True)
class Finding:
    """A printed statement as a number.

    Attributes
    ----------
    ship : str
    what : str
        Quantity, with its unit.
    place : str
        Section, figure.
    printed : str
        What is printed, as a number or a bound.
    ours : float
    low, high : float
        Between which ours agrees: the bound that is printed, or 5 % of a number that is.
    digits : int
        Shown.
    """

    ship: str
    what: str
    place: str
    printed: str
    ours: float
    low: float
    high: float
    digits: int = 2

    @property
    def met(self) -> bool:
        """Whether ours agrees."""
        return self.low <= self.ours <= self.high


def circle(name: str, side: int = 1) -> Case:
    """Turning circle in White's waves, 35 deg to starboard (1) or port (-1)."""
    speed, n, height = CIRCLES[name]
    wave = {"wave_height": height, "wavelength": 1.0}
    return sail(load_ship(name), delta_deg=35.0 * side, speed=speed, n=n, **wave)


def kcs_in_calm_water() -> Case:
    """His calm turn of KCS."""
    return sail(load_ship("kcs_model"), speed=CIRCLES["kcs_model"][0], n=KCS_CALM_N)


def findings(dtc: Case, kcs: Case, kcs_calm: Case) -> list[Finding]:
    """Every printed number and bound beside ours.

    Parameters
    ----------
    dtc, kcs : Case
        `circle` of both ships, to starboard.
    kcs_calm : Case
        `kcs_in_calm_water`.
    """
    found = [*_track(dtc), *_surge(dtc), *_sway_and_yaw(dtc), *_kcs(kcs, kcs_calm)]
    d, k = (case.result.drift_distance for case in (dtc, kcs))
    less = Finding("KCS", "drift over that of DTC", "5.1", "less than 1", k / d, 0.0, 1.0)
    return [*found, less, *_turning_moment(dtc, "DTC"), *_turning_moment(kcs, "KCS")]


def _number(ship: str, what: str, place: str, printed: float, ours: float, **more) -> Finding:
    """A printed number, met within 5 %."""
    low, high = 0.95 * printed, 1.05 * printed
    return Finding(ship, what, place, f"{printed:g}", ours, low, high, **more)


def _track(dtc: Case) -> Iterator[Finding]:
    t = dtc.result.trajectory
    psi = math.degrees(np.interp(_SHOWN, t["t"], t["psi"]))
    yield _number("DTC", f"heading at {_SHOWN:g} s [deg]", "5.1", 630.0, psi, digits=0)
    L = dtc.ship.hull.L
    sailed = np.cumsum(np.hypot(np.gradient(t["x"]), np.gradient(t["y"]))) / L
    aside = float(np.interp(1.0, sailed, t["y"])) / L
    what = "off the approach course after 1 L [L]"
    yield Finding("DTC", what, "3.3", "about 0", aside, -0.05, 0.05, 3)


def _surge(dtc: Case) -> Iterator[Finding]:
    """Shares of hull, rudder and waves in their sum, thrust left out (his Figure 3.20)."""
    t = dtc.result.trajectory
    total = sum(t[f"X_{k}"] for k in ("hull", "rudder", "wave"))
    for name in ("hull", "rudder", "wave"):
        share = float(np.interp(_RUDDER_OVER, t["t"], t[f"X_{name}"] / total))
        what = f"{name}, share of surge force at {_RUDDER_OVER:g} s"
        yield _number("DTC", what, "Fig. 3.20", round(1.0 / 3.0, 3), share)
    over = t["t"] >= _RUDDER_OVER
    share = float((t["X_wave"] / total)[over].max())
    yield Finding("DTC", "waves, largest share, rudder over", "3.3", "at most 0.4", share, 0.0, 0.4)


def _sway_and_yaw(dtc: Case) -> Iterator[Finding]:
    t = dtc.result.trajectory
    sway = np.abs(t["Y_wave"]).max() / np.abs(t["Y_rudder"]).max()
    yield Finding("DTC", "sway force, waves over rudder", "3.3", "less than 1", sway, 0.0, 1.0)
    first = (t["t"] > 0.0) & (t["t"] < _TRANSIENT)
    ratio = float(np.max(np.abs(t["N_hull"][first]) / np.abs(t["N_rudder"][first])))
    yield _number("DTC", "yaw moment, hull over rudder, up to 10 s", "Fig. 3.22", 2.0, ratio)
    ratio = np.abs(t["N_wave"][1:]) / np.abs(t["N_rudder"][1:])
    start, later = t["t"][1:] < _RUDDER_OVER, t["t"][1:] >= _RUDDER_OVER
    what = "yaw moment, waves over rudder"
    at_first = float(ratio[start].max())
    yield _number("DTC", f"{what}, before the rudder is over", "3.3", 1.0, at_first)
    after = float(ratio[later].max())
    yield Finding("DTC", f"{what}, after", "3.3", "less than 0.5", after, 0.0, 0.5)


def _kcs(kcs: Case, calm: Case) -> Iterator[Finding]:
    t = kcs.result.trajectory
    ratio = t["X_propeller"][0] / -(t["X_hull"][0] + t["X_wave"][0])
    what = "propeller force over resistance at first, in waves"
    yield _number("KCS", what, "4.4", 1.04, float(ratio))
    loss = 1.0 - calm.result.steady_speed_ratio * math.cos(calm.result.steady_drift)
    yield _number("KCS", "forward speed lost in the calm turn", "4.3", 0.65, loss)


def _turning_moment(case: Case, ship: str) -> Iterator[Finding]:
    """Mean of the wave yaw moment over a quarter of the turn, by the largest; into it positive.

    White has the sign of the total hydrodynamic moment; the waves' part is tried here.
    """
    t, side = case.result.trajectory, math.copysign(1.0, case.delta)
    turned = np.degrees(np.abs(t["psi"]))
    moment = side * t["N_wave"] / np.abs(t["N_wave"]).max()
    for start, into in ((0, True), (90, False), (360, True), (450, False)):
        quarter = (turned >= start) & (turned < start + 90)
        low, high = (0.0, 1.0) if into else (-1.0, 0.0)
        what = f"wave yaw moment from {start} to {start + 90} deg, by its largest"
        printed = "into the turn, above 0" if into else "out of it, below 0"
        place = "4.4" if ship == "KCS" else "3.3" if into else "4.4, of KCS"
        yield Finding(ship, what, place, printed, float(moment[quarter].mean()), low, high)


def rows(found: list[Finding]) -> list[list[str]]:
    """Cells of a table under `HEADER`."""
    return [
        [f.ship, f.what, f.place, f.printed, f"{f.ours:.{f.digits}f}", "yes" if f.met else "no"]
        for f in found
    ]


def as_dict() -> dict[str, Any]:
    """All findings, each as plain numbers, and how many agree."""
    found = findings(circle("dtc_model"), circle("kcs_model"), kcs_in_calm_water())
    plain = [dataclasses.asdict(f) | {"met": f.met} for f in found]
    return {"findings": plain, "met": sum(f.met for f in found), "of": len(found)}


def as_text(data: dict[str, Any]) -> str:
    """The findings as a table for people."""
    fields = [f.name for f in dataclasses.fields(Finding)]
    found = [Finding(**{name: each[name] for name in fields}) for each in data["findings"]]
    return "\n".join(
        [
            "White (2020), turning circles in head waves, starboard; within 5 %, or a bound kept",
            table(HEADER, rows(found), 4),
            f"{data['met']} of {data['of']} agree",
        ]
    )


HEADER = ("ship", "what", "place", "White", "here", "agrees")
