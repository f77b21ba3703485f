"""Tables of docs/turning_circle_speed.md: run ``python docs/turning_circle_speed.py``.

Where the missing speed of the KCS model goes in its 35 deg turning circle. Nothing is tuned here.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Iterable, Iterator

from scipy.optimize import brentq

from reproduce.surge import hull_surge_terms
from ship_gym import load_ship
from ship_gym.manoeuvres import TurningCircle, turning_circle
from ship_gym.physics.dynamics import forces
from ship_gym.physics.quantities import Tables
from ship_gym.reports.balance import inertia_terms, last_turn
from ship_gym.ships.loader import attach_surrogate
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import anchored, fleet
from ship_gym.surrogates.fit import fit
from ship_gym.surrogates.force_table import table_of
from ship_gym.surrogates.samples import KCS
from ship_gym.text import table

markdown = functools.partial(table, markdown=True)
DELTA, U0, N = math.radians(35.0), 0.860, 10.2  # rudder, approach speed [m/s], [rev/s]
N_IMPLIED = 0.410 / (0.105 * 0.3724)  # from J_B = U/(n D) of Stern et al. (2021), starboard
# measured steady motion, starboard and port: U [m/s], r L/U = 2 / (steady diameter in L)
MEASURED = {1: (0.410, 2.0 / 2.602), -1: (0.382, 2.0 / 2.4)}
SHIP = load_ship("kcs_model")


def circle(ship: Ship, side: int = 1, n: float = N) -> TurningCircle:
    """Turning circle of the trial, to starboard (1) or port (-1)."""
    return turning_circle(ship, side * DELTA, U0, n)


def state(side: int, U: float, r_: float, beta: float, n: float) -> dict[str, float]:
    """Forces of the model in a given steady motion, mirrored so that port reads as starboard."""
    u, v, r = U * math.cos(beta), -side * U * math.sin(beta), side * r_ * U / SHIP.hull.L
    made = fleet([SHIP])
    tables = Tables(made.open_water[0], made.deflected[0])
    (H, P, R), flow = forces((u, v, r), (side * DELTA, n), made.records[0], tables)
    centripetal, offset = inertia_terms(SHIP, u, v, r)
    inertia = SHIP.inertia
    return {
        "U/U0": U / U0,
        "r L/U": r_,
        "beta [deg]": math.degrees(beta),
        "n [rev/s]": n,
        "U/(n D)": U / (n * SHIP.propeller.D),
        "thrust T [N]": flow[3],
        "torque Q [N m]": flow[4],
        "F_N, whole rudder [N]": abs(flow[5]),
        **{f"X: {k} [N]": x for k, x in hull_surge_terms(SHIP, u, v, r).items()},
        "X: rudder [N]": R[0],
        "X: (m + m_y) v r [N]": centripetal,
        "X: m x_G r^2 [N]": offset,
        "X: propeller, (1 - t_P) T [N]": P[0],
        "surge left over [N]": H[0] + R[0] + P[0] + centripetal + offset,
        "sway left over [N]": side * (H[1] + P[1] + R[1] - inertia.m_u * u * r),
        "yaw left over [N m]": side * (H[2] + P[2] + R[2] - inertia.m_xG * u * r),
    }


def in_measured_motion(side: int, n: float) -> dict[str, float]:
    """The measured speed and yaw rate with the drift angle at which the sway forces balance."""
    U, r_ = MEASURED[side]
    beta = brentq(lambda b: state(side, U, r_, b, n)["sway left over [N]"], 0.05, 0.45)
    return state(side, U, r_, beta, n)


def in_own_motion(side: int) -> dict[str, float]:
    """The steady motion that the model finds itself."""
    mean = last_turn(circle(SHIP, side).trajectory)
    U = math.hypot(mean["u"], mean["v"])
    beta = side * math.atan2(-mean["v"], mean["u"])
    return state(side, U, side * mean["r"] * SHIP.hull.L / U, beta, N)


def balance_table() -> str:
    """Steady balance in the model's own motion and in the measured one."""
    columns = {
        "stbd, model": in_own_motion(1),
        "stbd, measured motion": in_measured_motion(1, N),
        f"the same, n = {N_IMPLIED:.2f}": in_measured_motion(1, N_IMPLIED),
        "port, model": in_own_motion(-1),
        "port, measured motion": in_measured_motion(-1, N),
    }
    rows = [
        [key, *(f"{round(c[key], 3) + 0.0:.3f}" for c in columns.values())]
        for key in columns["stbd, model"]
    ]
    return markdown(["", *columns], rows)


def changed(section: str, **values: float) -> Ship:
    """The ship with some of its numbers replaced."""
    part = dataclasses.replace(getattr(SHIP, section), **values)
    return dataclasses.replace(SHIP, **{section: part})


def multiplied(thrust: float = 1.0, normal: float = 1.0, ship: Ship = SHIP) -> Ship:
    """The ship with thrust and torque, or rudder normal force, of its surrogate multiplied."""
    table = anchored(ship)
    factors = [1.0] * len(table.names)
    for k, name in enumerate(table.names):
        factors[k] = {"C_T": thrust, "C_Q": thrust, "C_N": normal}.get(name, 1.0)
    card = {**table.card, "anchored": False}  # it has been
    return dataclasses.replace(
        ship, surrogate=dataclasses.replace(table, values=table.values * factors, card=card)
    )


def without_captive_set() -> Ship:
    """The ship as without captive tests: law and thrust of the samples, t_R = 0, set C's wake."""
    bare = load_ship("kcs_model", surrogate="none")
    wake = dataclasses.replace(bare.propeller, wake_l_P=0.0, wake_beta2=4.0)
    doubted = {**bare.estimated, "rudder.kappa": "left aside"}
    ship = dataclasses.replace(bare, propeller=wake, estimated=doubted)
    return attach_surrogate(ship, table_of(fit(KCS), ship), "G2_SA")


def remedies() -> Iterator[tuple[str, Callable[[], Ship], float]]:
    """What the captive set changes, one by one and together."""
    old, rudder = without_captive_set(), SHIP.rudder
    shift = dataclasses.replace(old.surrogate, card={**old.surrogate.card, "anchored": True})
    yield "0: samples' law and thrust, t_R = 0, set C's wake", lambda: old, N
    steered = dataclasses.replace(old.rudder, t_R=rudder.t_R)
    yield "0 with t_R = 0.258", lambda: dataclasses.replace(old, rudder=steered), N
    yield "0 with thrust shifted to the tank", lambda: dataclasses.replace(old, surrogate=shift), N
    yield "0 with set B's wake", lambda: dataclasses.replace(old, propeller=SHIP.propeller), N
    level = dataclasses.replace(rudder, t_R=0.0)
    yield "0 with set B's rudder law", lambda: dataclasses.replace(old, rudder=level), N
    yield "all of them: as it is", lambda: SHIP, N
    yield "as it is, but t_R = 0", lambda: changed("rudder", t_R=0.0), N
    yield "as it is, but t_R = a_H = 0", lambda: changed("rudder", t_R=0.0, a_H=0.0), N
    yield "as it is, but no surrogate", lambda: load_ship("kcs_model", surrogate="none"), N


def variations() -> Iterator[tuple[str, Callable[[], Ship], float]]:
    """What is varied: label, ship, propeller speed."""
    yield "as it is", lambda: SHIP, N
    yield f"n = {N_IMPLIED:.2f} rev/s (no other change)", lambda: SHIP, N_IMPLIED
    for t_P in (0.1, 0.0):
        yield f"t_P = {t_P:g} (published 0.178)", lambda t=t_P: changed("propeller", t_P=t), N
    for X in (0.0, -0.1):
        yield f"X_vr = {X:g} (published -0.0424)", lambda X=X: changed("hull", X_vr=X), N
    yield "X_rr = 0 (published -0.0139)", lambda: changed("hull", X_rr=0.0), N
    yield "R_0 halved", lambda: changed("hull", R_0=0.5 * SHIP.hull.R_0), N
    yield "thrust x 1.05", lambda: multiplied(thrust=1.05), N
    for factor in (0.9, 1.1, 1.2):
        yield f"rudder normal force x {factor:g}", lambda f=factor: multiplied(normal=f), N
    yield "normal force x 1.2, thrust x 1.05", lambda: multiplied(1.05, 1.2), N
    for name in ("hull_a", "hull_c"):
        yield f"hull set {name[-1].upper()}", lambda v=name: load_ship("kcs_model", variant=v), N
    for name in ("G2_SST", "G3_SA", "gp", "none"):
        yield f"surrogate {name}", lambda s=name: load_ship("kcs_model", surrogate=s), N


HEADER = [
    "", "U/U0", "diameter [L]", "thrust [N]", "u/(n D)", "tactical d. [L]", "max advance [L]",
    "max transfer [L]", "F_N [N]", "movable [N]",
]  # fmt: skip
MOVABLE = SHIP.trials[0].movable_factor  # F_N of the movable part, on which it was measured
MEASURED_ROWS = {
    1: ["measured, starboard", "0.477", "2.60", "5.14", "", "3.2", "3.10", "3.22", "", "2.92"],
    -1: ["measured, port", "0.444", "2.4", "", "", "2.9", "", "", "", "2.59"],
}


def row(label: str, c: TurningCircle) -> list[str]:
    """Steady measures of one circle."""
    values = (c.steady_diameter, c.steady_thrust, c.steady_J, c.tactical_diameter)
    return [
        label,
        f"{c.steady_speed_ratio:.3f}",
        *(f"{x:.{d}f}" for x, d in zip(values, (2, 2, 3, 2), strict=True)),
        f"{c.max_advance:.2f}",
        f"{c.max_transfer:.2f}",
        f"{c.rudder_normal_force:.2f}",
        f"{c.rudder_normal_force * MOVABLE:.2f}",
    ]


def circles(cases: Iterable[tuple[str, Callable[[], Ship], float]], side: int) -> str:
    """Table of turning circles to one side."""
    rows = [row(label, circle(make(), side, n)) for label, make, n in cases]
    return markdown(HEADER, [MEASURED_ROWS[side], *rows])


def port_table() -> str:
    """Port turn under the published ratios of flow straightening gamma_R,n / gamma_R,p."""
    rows = [*MEASURED_ROWS.values(), row("model, starboard", circle(SHIP))]
    ratios = {"set B, default": 0.338 / 0.492, "IIHR": 0.45 / 0.55, "none": 1.0, "HU": 0.35 / 0.20}
    for name, ratio in ratios.items():
        ship = changed("rudder", gamma_R_n=ratio * SHIP.rudder.gamma_R_p)
        rows.append(row(f"model, port, ratio {ratio:.3f} ({name})", circle(ship, -1)))
    return markdown(HEADER, rows)


# Stern et al. (2021), Fn 0.26, mean of six facilities; standard deviation of the mean in brackets
FASTER = {
    1: ["mean, starboard", "2.9 (0.09)", "2.9 (0.17)", "1.24 (0.05)", "0.465"],
    -1: ["mean, port", "2.9 (0.09)", "2.6 (0.15)", "1.17 (0.02)", "0.447"],
}


def faster_table() -> str:
    """Both turns at Fn 0.26, self-propulsion, before and after, beside the facilities."""
    U = 0.26 * math.sqrt(9.80665 * SHIP.hull.L)
    ships = {
        "0": without_captive_set(),
        "as it is": SHIP,
        "no surrogate": load_ship("kcs_model", surrogate="none"),
    }
    rows = []
    for side, measured in FASTER.items():
        rows.append(measured)
        for label, ship in ships.items():
            c = turning_circle(ship, side * DELTA, U)
            values = (c.advance, c.tactical_diameter, 0.5 * c.steady_diameter)
            numbers = [f"{x:.2f}" for x in values]
            rows.append([label, *numbers, f"{c.steady_speed_ratio:.3f}"])
    return markdown(["", "advance [L]", "tactical d. [L]", "radius [L]", "U/U0"], rows)


if __name__ == "__main__":
    for title, make in (
        ("Balance", balance_table),
        ("Remedies, starboard", lambda: circles(remedies(), 1)),
        ("Remedies, port", lambda: circles(remedies(), -1)),
        ("Sensitivity", lambda: circles(variations(), 1)),
        ("Port against starboard", port_table),
        ("Fn 0.26", faster_table),
    ):
        print(f"\n{title}\n\n{make()}")
