"""Numbers of a new ship that nobody gives: by dimension of another one, or by regressions."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.ships import estimators
from ship_gym.ships.b_series import b_series
from ship_gym.ships.four_quadrants import Screw
from ship_gym.ships.open_water import open_water_table
from ship_gym.ships.particulars import Ship
from ship_gym.ships.plausible import basis
from ship_gym.ships.powering import powering
from ship_gym.ships.ranges import RANGES
from ship_gym.ships.scaling import correlation_allowance, scaled, viscous_resistance

NEAR = 0.10  # of L/B, B/d and C_b: up to here the other ship's derivatives hold, else regressions
# slopes of C_wp and C_m over C_b, of the ships of the package by least squares
WATERPLANE, MIDSHIP = 0.54, 0.47
FINENESS = 0.3  # |x_G| / L by 1 - C_b, at most: a full hull has its volume amidships
GIVEN = "given"


class Made:
    """A ship while she is made, and where each number comes from."""

    def __init__(self, like: Ship, p: dict, fixed: dict, name: str, units: int):
        parent = scaled(like, p["L"], name=like.name)  # at the length of the new one
        self.like, self.parent, self.p, self.fixed, self.units = like, parent, p, fixed, units
        h = parent.hull
        self.parent_C_b = estimators.block_coefficient(h.L, h.B, h.d, h.volume)
        pairs = ((p["B"], h.B), (p["d"] / p["B"], h.d / h.B), (p["C_b"], self.parent_C_b))
        self.near = all(abs(new / old - 1.0) <= NEAR for new, old in pairs)
        water: dict[str, Any] = {key: float(fixed[key]) for key in ("rho", "nu") if key in fixed}
        self.ship = dataclasses.replace(
            parent, name=name, title=f"{name}, {p['L']:g} m, like {parent.name}",
            status=f"estimated from particulars and {parent.name}; validated by nothing",
            full_length=p["L"], speed=p["speed"], share=1.0, trials=(), propulsion=(),
            wave_table="", wave_state=(), surrogate=None, surrogate_name="none", implausible=(),
            strict=True, variant=f"like {parent.name}", sources=dict.fromkeys(water, GIVEN),
            estimated={}, **water,
        )  # fmt: skip

    def set(self, section: str, values: Mapping[str, tuple[float, str]]) -> None:
        """Numbers of a section, each with why; `GIVEN` is no estimate. Those fixed go before."""
        fixed = {k: (self.fixed[w], GIVEN) for k in values if (w := f"{section}.{k}") in self.fixed}
        values = {**values, **fixed}
        ship = self.ship
        part = dataclasses.replace(
            getattr(ship, section), **{k: float(x) for k, (x, _) in values.items()}
        )
        why = {f"{section}.{k}": text for k, (_, text) in values.items()}
        self.ship = dataclasses.replace(
            ship,
            sources=ship.sources | {k: text for k, text in why.items() if text == GIVEN},
            estimated={k: t for k, t in ship.estimated.items() if k not in why}
            | {k: text for k, text in why.items() if text != GIVEN},
            **{section: part},
        )

    def by_dimension(self, section: str, *left: str) -> None:
        """A section as the other ship has it, each number by its dimension; but those `left`."""
        old = self.parent
        for key, allowed in RANGES[section].items():
            if key in left:
                continue
            value = getattr(getattr(old, section), key)
            over, under = (basis(s, allowed.by, s.file_speed) for s in (self.ship, old))
            if value not in (0.0, math.inf) and over is not None and under is not None:
                if math.inf not in (over, under):
                    value *= over / under  # None: a number that is fixed is not above zero
            by = f", by {allowed.by}" if allowed.by else ""
            self.set(section, {key: (value, f"as {old.name}{by}")})


def _hull(m: Made) -> None:
    p, h = m.p, m.parent.hull
    m.set("hull", {key: (p[key], GIVEN) for key in ("L", "B", "d", "volume")})
    left = ["L", "B", "d", "volume", "S", "C_A", "R_0"]
    most = FINENESS * max(0.0, 1.0 - p["C_b"]) * p["L"]
    if "x_G" in p:
        m.set("hull", {"x_G": (p["x_G"], GIVEN)})
        left.append("x_G")
    elif abs(h.x_G) > most:  # `parent` has the length of the new ship
        why = f"as {m.parent.name}, by L, but at most {FINENESS} (1 - C_b) L"
        m.set("hull", {"x_G": (math.copysign(most, h.x_G), why)})
        left.append("x_G")
    old, new = (
        estimators.wetted_surface(*of)
        for of in ((h.L, h.B, h.d, m.parent_C_b), (p["L"], p["B"], p["d"], p["C_b"]))
    )
    m.set("hull", {
        "S": (h.S * new / old, f"that of {m.parent.name} by Denny-Mumford, L (1.7 d + C_b B)"),
        "C_A": (correlation_allowance(p["L"]), "Holtrop & Mennen (1982), at this length"),
    })  # fmt: skip
    if m.near:
        m.by_dimension("hull", *left)
        return
    m.by_dimension("hull", *left, *estimators.ESTIMATED)
    x_G = m.ship.hull.x_G
    found = estimators.estimated_hull(p["L"], p["B"], p["d"], p["volume"], x_G)
    m.set("hull", {key: _within(m, key, *found[key]) for key in found})


def _within(m: Made, key: str, value: float, why: str) -> tuple[float, str]:
    """An estimate; the other ship's number where a regression leaves the range of ships."""
    allowed = RANGES["hull"][key]
    if allowed.low <= value <= allowed.high:
        return value, why
    return getattr(m.parent.hull, key), f"as {m.parent.name}; {why} has {value:.3g}, of no ship"


def _propeller(m: Made) -> None:
    p, old = m.p, m.parent
    left = ["D"]
    halved = m.units > old.propellers  # one propeller becomes two
    if "D_P" in p:
        m.set("propeller", {"D": (p["D_P"], GIVEN)})
    else:
        D = old.propeller.D * p["d"] / old.hull.d / (math.sqrt(2.0) if halved else 1.0)
        m.set("propeller", {"D": (D, f"as {old.name}, by d" + ", half the disc each" * halved)})
    if halved:
        left += [
            key for key in RANGES["propeller"] if key.startswith(("wake_", "y_P", "w_P", "t_"))
        ]
        unused = {k: (float("C2" in k), "not used") for k in left if k.startswith("wake_")}
        t_P = 0.325 * p["C_b"] - 0.1885 * m.ship.propeller.D / math.sqrt(p["B"] * p["d"])
        m.set("propeller", unused | {
            "w_P0": (0.55 * p["C_b"] - 0.20, "Taylor, twin screw: 0.55 C_b - 0.20"),
            "t_P": (t_P, "Holtrop & Mennen (1982), twin screw: 0.325 C_b - 0.1885 D / sqrt(B d)"),
            "y_P": (0.219 * p["B"], "as onrt_model, by B"),
        })  # fmt: skip
    m.by_dimension("propeller", *left)
    _open_water(m)


def _open_water(m: Made) -> None:
    """The other ship's curve, or one of the B-series if the propeller is described."""
    p, card = m.p, m.parent.open_water.card
    if not {"z", "pitch_ratio", "area_ratio"} & p.keys():
        why = f"that of {m.parent.name}"
        m.ship = dataclasses.replace(m.ship, estimated=m.ship.estimated | {"open_water": why})
        return
    screw = dict(card["four_quadrants"])
    pairs = (("blades", "z"), ("pitch_ratio", "pitch_ratio"), ("area_ratio", "area_ratio"))
    screw |= {own: p[key] for own, key in pairs if key in p}
    screw["blades"] = int(screw["blades"])
    J = np.linspace(0.0, 1.6, 161)
    K_T, K_Q = b_series(J, **screw)
    ahead = K_T > 0.0
    J = J[: int(np.argmin(ahead)) if not ahead.all() else len(J)]
    K_T, K_Q = (np.polyfit(J, K[: len(J)], 3) for K in (K_T, K_Q))
    text = ", ".join(f"{key} {value:g}" for key, value in screw.items())
    table = open_water_table(
        K_T, K_Q, (0.0, float(J[-1])), Screw(**screw), {"source": "Wageningen B-series"}
    )
    why = f"Wageningen B-series: {text}"
    m.ship = dataclasses.replace(
        m.ship, open_water=table, estimated=m.ship.estimated | {"open_water": why}
    )


def _rudder(m: Made) -> None:
    p, old = m.p, m.parent
    left = ["A_R", "eta"]
    halved = m.units > old.propellers
    A_R = old.rudder.A_R * p["d"] / old.hull.d * (0.5 if halved else 1.0)
    why = f"as {old.name}, by L d" + ", half of it each" * halved
    m.set("rudder", {"A_R": (p["A_R"], GIVEN) if "A_R" in p else (A_R, why)})
    by = m.ship.propeller.D / old.propeller.D * math.sqrt(old.rudder.A_R / m.ship.rudder.A_R)
    m.set("rudder", {"eta": (min(1.0, old.rudder.eta * by), f"D / H_R, aspect as {old.name}")})
    if halved:
        left += ["y_R", "neutral", "epsilon", "gamma_R_p", "gamma_R_n", "v_rrr", "v_rrv"]
        gamma = estimators.flow_straightening(p["L"], p["B"], p["C_b"])
        m.set("rudder", {
            "y_R": (m.ship.propeller.y_P, "behind the propellers"),
            "neutral": (0.0, "two propellers"), "epsilon": (1.0, "as onrt_model"),
            "gamma_R_p": (gamma, "2.06 C_b B/L + 0.14"), "gamma_R_n": (gamma, "as gamma_R_p"),
            "v_rrr": (0.0, "not used"), "v_rrv": (0.0, "not used"),
        })  # fmt: skip
    m.by_dimension("rudder", *left)


def _others(m: Made) -> None:
    """Gear, form and what the wind sees."""
    m.by_dimension("gear")
    if m.ship.wind is not None:
        m.by_dimension("wind")
    if m.ship.form is None:
        return
    old, C_b = m.parent, m.p["C_b"]
    assert old.form is not None  # as hers is the one the ship began with
    more = C_b - m.parent_C_b
    C_wp = min(0.97, old.form.C_wp + WATERPLANE * more)
    C_m = min(max(0.998, old.form.C_m), old.form.C_m + MIDSHIP * more)
    m.by_dimension("form", "x_B", "C_wp", "C_m")
    m.set("form", {
        "x_B": (m.ship.hull.x_G, "as x_G, on even keel"),
        "C_m": (C_m, f"that of {old.name}, {MIDSHIP} for each unit of C_b"),
        "C_wp": (C_wp, f"that of {old.name}, {WATERPLANE} for each unit of C_b"),
    })  # fmt: skip


def _resistance(m: Made) -> None:
    """(1 + k) C_F + C_A at the ship's speed, and the other ship's rest by its S."""
    old, new = m.parent, m.ship
    total = old.hull.R_0 * old.hull.L * old.hull.d / old.hull.S
    rest = max(0.0, total - viscous_resistance(old.hull, old.speed, old.nu, old.full_length))
    own = viscous_resistance(new.hull, new.speed, new.nu, new.full_length) + rest
    Fn = f"{new.froude(new.speed):.3f}, there {old.froude(old.speed):.3f}"
    why = f"ITTC-57 with 1 + k and C_A, and the rest of {old.name}, {rest:.2g} on S; Fn {Fn}"
    m.set("hull", {"R_0": (own * new.hull.S / (new.hull.L * new.hull.d), why)})


def _engine(m: Made) -> None:
    """Margins over self-propulsion as the other ship has them; times by sqrt(L/g)."""
    old, there = m.like, powering(m.like)
    engine = old.engine
    trial = dataclasses.replace(engine, n_max=10.0 * m.p["speed"] / m.ship.propeller.D)
    here = powering(dataclasses.replace(m.ship, engine=trial))
    margin = engine.n_max / there.n
    why = f"{margin:.3g} times self-propulsion at {m.p['speed']:.4g} m/s, as {old.name}"
    n_max = (m.p["n_max"], GIVEN) if "n_max" in m.p else (margin * here.n, why)
    m.set("engine", {"n_max": n_max})
    share = engine.torque_max / (there.torque / old.propellers * margin**2)
    torque = share * here.torque / m.units * (m.ship.engine.n_max / here.n) ** 2
    why = f"{share:.3g} times that at n_max and the advance ratio of self-propulsion"
    m.set("engine", {"torque_max": (torque, f"{why}, as {old.name}")})
    m.by_dimension("engine", "n_max", "torque_max")


STEPS = (_hull, _propeller, _rudder, _others, _resistance, _engine)  # in this order
