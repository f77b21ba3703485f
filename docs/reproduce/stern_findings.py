"""What sentences of Stern et al. (2021) state of KCS turning to port and to starboard, each tried.

A finding is a number of our model with the range that the source leaves it: an order ("larger to
port") is a sign, a number its printed digits or the spread of the facilities. What is not met is a
gap, and recorded as measured: ``python scripts/reproduce.py stern --record`` writes the table.
"""

from __future__ import annotations

import csv
import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from reproduce.stern_turns import AXES, FROUDE_NUMBERS, Pair, Turn, flow_angle, thrust_identity
from ship_gym.csv_file import read_csv
from ship_gym.writing import atomic_path

RECORD = Path(__file__).parent / "data" / "stern_2021_ours.csv"
MET, GAP = "met", "gap"
_ALL = math.inf


@dataclasses.dataclass(frozen=True)
class Finding:
    """One statement at one Froude number.

    Attributes
    ----------
    key, says : str
        Name, and the statement in our words.
    place : str
        Where the source has it.
    unit : str
        Of the number.
    low, high : float
        What the source leaves the number; infinite where it gives an order only.
    value : callable
        The number of our model, from a `Pair`.
    """

    key: str
    says: str
    place: str
    froude: float
    unit: str
    low: float
    high: float
    value: Callable[[Pair], float]

    def verdict(self, value: float) -> str:
        """``met`` or ``gap``."""
        return MET if self.low <= value <= self.high else GAP


# Facilities and CFD that print U/(nD) of the steady turn (Table 6), by Froude number
J_B = {
    0.157: {"starboard": (0.3693, 0.3724), "port": (0.3362, 0.3514), "asymmetry": (5.81, 9.38)},
    0.26: {"starboard": (0.3480, 0.4431), "port": (0.3200, 0.4322), "asymmetry": (2.49, 8.21)},
}
# radius to starboard over that to port [% of the mean]: tanks, CFD
RADIUS = {0.157: (8.0, 12.7), 0.26: (5.8, 9.5)}
# wake coefficient of the approach by thrust identity at IIHR (Table 5, appendix)
WAKE = {0.157: 0.675, 0.26: 0.701}
# mean angle of attack of the blade at 70 % radius [deg], CFD: approach, starboard, port
ATTACK = {0.157: (4.65, 7.84, 8.60), 0.26: (4.54, 7.86, 8.52)}
COMPONENTS = {
    "X": ("propeller", "hull", "rudder", "inertia"),
    "Y": ("hull", "rudder", "inertia"),
    "N": ("hull", "rudder"),
}
# stated too, but of what this model does not have
NOT_OURS = (
    "halves of the propeller disc (inboard and outboard, top and bottom; Table 4), vortices and "
    "their sense, wave patterns (3 to 4 times smaller at Fn 0.157), the hull towed without "
    "propeller or rudder, and the surge force of single blades over a revolution (Fig. 18)."
)


def _both(test: Callable[[Turn], float]) -> Callable[[Pair], float]:
    """Least of a number over both sides."""
    return lambda pair: min(test(turn) for turn in pair.turns.values())


def _share(axis: str, part: str, whole: str) -> Callable[[Turn], float]:
    """Magnitude of one component over that of another."""
    return lambda t: abs(t.forces[axis][part] / t.forces[axis][whole])


def _wake(pair: Pair, side: str) -> float:
    t = pair.turns[side]
    return thrust_identity(pair.ship, t.circle.steady_thrust, t.speed, t.n)


def attack(pair: Pair, side: str) -> float:
    """Growth of the blade's angle of attack from approach to turn [deg]."""
    t = pair.turns[side]
    before = flow_angle(pair.ship, pair.thrust, pair.speed, pair.n)
    return math.degrees(before - flow_angle(pair.ship, t.circle.steady_thrust, t.speed, t.n))


def _loading(thrust: float, speed: float) -> float:
    """T/U^2, t' but for a constant."""
    return thrust / speed**2


def _measure(name: str) -> Callable[[Pair], float]:
    """Starboard minus port of a measure of the circles [% of the mean]."""
    return lambda p: Pair.percent(
        *(abs(getattr(p.turns[s].circle, name)) for s in ("port", "starboard"))
    )


def _circles(fn: float) -> list[Finding]:
    """Tracks and speeds (slide with Fig. 2, Table 6)."""
    F = Finding
    at = J_B[fn]
    return [
        F("radius", "steady radius smaller to port, by tanks and CFD", "Fig. 2 text", fn,
          "% of mean", *RADIUS[fn], _measure("steady_diameter")),
        F("diameter", "tactical diameter smaller to port", "Fig. 2 text", fn,
          "% of mean", 0.0, _ALL, _measure("tactical_diameter")),
        F("advance", "advance alike to both sides (2 SD of the facilities)", "Fig. 2 text", fn,
          "% of mean", -6.6, 6.6, _measure("advance")),
        F("speed loss", "speed ratio smaller to port", "Fig. 2 text, Table 1", fn,
          "% of mean", 0.0, _ALL, _measure("steady_speed_ratio")),
        F("J approach", "J about 0.8 at self-propulsion", "Fig. 17 text", fn,
          "-", 0.75, 0.85, lambda p: p.J),
        F("J starboard", "U/(nD) of the turn to starboard", "Table 6", fn,
          "-", *at["starboard"], lambda p: p.turns["starboard"].J_B),
        F("J port", "U/(nD) of the turn to port", "Table 6", fn,
          "-", *at["port"], lambda p: p.turns["port"].J_B),
        F("J asymmetry", "U/(nD) larger to starboard, by tanks and CFD", "Table 6", fn,
          "% of mean", *at["asymmetry"],
          lambda p: Pair.percent(p.turns["port"].J_B, p.turns["starboard"].J_B)),
    ]  # fmt: skip


def _balance(fn: float) -> list[Finding]:
    """Force and moment balance (Figs. 4 to 6, 9, 10 and appendix)."""
    place = "Figs. 4, 5, 9" if fn == 0.157 else "appendix"
    larger = [
        Finding(f"{axis} {name}", f"{axis} of the {name} larger to port",
                "Figs. 6, 10" if fn == 0.157 else "appendix", fn, "% of mean", 0.0, _ALL,
                lambda p, a=axis, c=name: p.excess(a, c))
        for axis in AXES for name in COMPONENTS[axis]
    ]  # fmt: skip
    F = Finding
    return larger + [
        F("X by inertia", "X of the propeller balanced mostly by inertia: over the rudder's share",
          place, fn, "-", 1.0, _ALL, _both(_share("X", "inertia", "rudder"))),
        F("X resisted", "rudder, resistance R_0 and the rest of the hull resist too: least share",
          place, fn, "of X_P", 0.0, _ALL,
          _both(lambda t: -max(t.forces["X"][k] for k in ("rudder", "R_0", "hull"))
                / t.forces["X"]["propeller"])),
        F("Y by inertia", "Y of the hull balanced mostly by inertia",
          place, fn, "of Y_H", 0.5, 1.0, _both(_share("Y", "inertia", "hull"))),
        F("Y by rudder", "Y of the hull balanced by the rudder, too",
          place, fn, "of Y_H", 0.0, 0.5, _both(_share("Y", "rudder", "hull"))),
        F("N by rudder", "N of the hull balanced by the rudder (nine tenths: our reading)",
          place, fn, "of N_H", 0.9, 1.1, _both(_share("N", "rudder", "hull"))),
        F("Y propeller", "side force of the propeller small (a tenth of the rudder's: our reading)",
          "Fig. 9 text", fn, "of Y_R", 0.0, 0.1,
          lambda p: max(map(_share("Y", "propeller", "rudder"), p.turns.values()))),
        F("N propeller", "yaw moment of the propeller small, likewise",
          "Fig. 9 text", fn, "of N_R", 0.0, 0.1,
          lambda p: max(map(_share("N", "propeller", "rudder"), p.turns.values()))),
    ]  # fmt: skip


def _propeller(fn: float) -> list[Finding]:
    """Loading, wake and blade (Tables 4 to 6, Figs. 17 to 22)."""
    F = Finding

    def loading(pair: Pair, side: str) -> float:
        t = pair.turns[side]
        return _loading(t.circle.steady_thrust, t.speed)

    return [
        F("loaded turn", "propeller more loaded in the turn: t' over that of the approach",
          "Fig. 18 text", fn, "-", 1.0, _ALL,
          lambda p: loading(p, "starboard") / _loading(p.thrust, p.speed)),
        F("loaded port", "and most to port: t' port over starboard",
          "Fig. 18 text", fn, "-", 1.0, _ALL,
          lambda p: loading(p, "port") / loading(p, "starboard")),
        F("wake approach", "1 - w of the approach by thrust identity (5 %: our reading)",
          "Table 5" if fn == 0.157 else "appendix", fn, "-", 0.95 * WAKE[fn], 1.05 * WAKE[fn],
          lambda p: thrust_identity(p.ship, p.thrust, p.speed, p.n)),
        F("wake sides", "1 - w by thrust identity larger to port: port less starboard",
          "Table 5" if fn == 0.157 else "appendix", fn, "-", 0.0, _ALL,
          lambda p: _wake(p, "port") - _wake(p, "starboard")),
        F("attack turn", "angle of attack of the blade larger in the turn to starboard",
          "Fig. 19 text", fn, "deg", 0.0, _ALL, lambda p: attack(p, "starboard")),
        F("attack port", "and still larger to port: port less starboard",
          "Fig. 19 text", fn, "deg", 0.0, _ALL,
          lambda p: attack(p, "port") - attack(p, "starboard")),
    ]  # fmt: skip


def _drift() -> list[Finding]:
    """Drift along the hull (Fig. 3), printed for Fn 0.26; the sign at the bow follows from R."""
    F = Finding
    return [
        F(f"drift {end} {side}", f"drift at the {end} about {printed} deg, turn to {side}",
          "Fig. 3 text", 0.26, "deg", printed - 5.0, printed + 5.0,
          lambda p, s=side, x=x, m=sign: m * math.degrees(p.turns[s].drift(x)))
        for side in ("starboard", "port")
        for end, x, printed, sign in (("FP", 0.5, 10, -1.0), ("AP", -0.5, 40, 1.0))
    ]  # fmt: skip


def _rudder() -> list[Finding]:
    """Rudder force on the ship over that of F_N alone (Table 3, direct from CFD)."""

    def ratio(axis: str, part: float) -> Callable[[Pair], float]:
        return _both(
            lambda t: abs(t.forces[axis]["rudder"]) / (t.circle.rudder_normal_force * part)
        )

    place, s, c = "Table 3 text", math.sin(math.radians(35.0)), math.cos(math.radians(35.0))
    F = Finding
    return [
        F("X_R", "X of the rudder above F_N sin(delta): ratio", place, 0.157, "-",
          1.0, _ALL, ratio("X", s)),
        F("Y_R", "Y of the rudder below F_N cos(delta): ratio", place, 0.157, "-",
          0.0, 1.0, ratio("Y", c)),
    ]  # fmt: skip


FINDINGS: tuple[Finding, ...] = (
    *(f for fn in FROUDE_NUMBERS for part in (_circles, _balance, _propeller) for f in part(fn)),
    *_drift(),
    *_rudder(),
)


def evaluate(sailed: Callable[[float], Pair]) -> list[dict[str, Any]]:
    """Number and verdict of every finding, as plain data."""
    found = []
    for f in FINDINGS:
        value = f.value(sailed(f.froude))
        low, high = (x if math.isfinite(x) else None for x in (f.low, f.high))
        row = {"key": f.key, "froude": f.froude, "says": f.says, "place": f.place, "unit": f.unit}
        found.append(row | {"low": low, "high": high, "ours": value, "verdict": f.verdict(value)})
    return found


def record(rows: list[dict[str, Any]], path: Path = RECORD) -> None:
    """Write number and verdict of every finding to the table of what is met and what is a gap."""
    head = (
        "# title: findings of Stern et al. (2021) in our turning circles: met, or a gap this large",
        "# source: computed by this project",
        "# obtained: python scripts/reproduce.py stern --record",
        "# conventions: docs/reproduce/stern_findings.py says what each number is and its range",
    )
    with atomic_path(path) as temporary, open(temporary, "w", newline="") as stream:
        stream.writelines(f"{line}\n" for line in head)
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["key", "froude [-]", "ours [-]", "verdict"])
        for row in rows:
            writer.writerow([row["key"], row["froude"], f"{row['ours']:.4g}", row["verdict"]])


def recorded(path: Path = RECORD) -> dict[tuple[str, float], tuple[float, str]]:
    """What `record` wrote: key and Froude number to number and verdict."""
    c = read_csv(path).columns
    values = zip(c["ours"].tolist(), c["verdict"].tolist(), strict=True)
    return dict(zip(zip(c["key"].tolist(), c["froude"].tolist(), strict=True), values, strict=True))
