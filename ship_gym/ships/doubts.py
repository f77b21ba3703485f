"""What of a new ship is doubtful though it is in range: how far she is from what estimates know."""

from __future__ import annotations

from collections.abc import Iterator

from ship_gym.ships.estimators import block_coefficient
from ship_gym.ships.particulars import Ship
from ship_gym.ships.ranges import RANGES

FULLNESS = 0.1  # difference of C_b up to which a form factor is taken for the same
FROUDE = 0.05  # difference up to which a residual coefficient is taken for the same
LOADING = 1.5  # times the n D / U of the ship that she is like
C_B, L_B = (0.65, 0.81), (5.5, 7.1)  # of KCS and KVLCC2, which the regressions are judged by
NEAR = 0.05  # beyond these
SHALLOW = (RANGES["hull"]["d"].published or (0.0, 1.0))[0]  # d / B of the ships of the package


def doubts(ship: Ship, like: Ship) -> tuple[str, ...]:
    """Lines about a new ship; what is given is not doubted.

    Parameters
    ----------
    ship : Ship
        As ``new_ship.new_ship`` makes her.
    like : Ship
        The ship that she is like.
    """
    return tuple(line for rule in (_resistance, _propeller, _hull) for line in rule(ship, like))


def _resistance(ship: Ship, like: Ship) -> Iterator[str]:
    if "hull.R_0" not in ship.estimated:
        return
    here, there = _fullness(ship), _fullness(like)
    if abs(here - there) > FULLNESS:
        way = "more" if here > there else "less"
        yield (
            f"resistance: C_b {here:.2f}, {like.name}'s {there:.2f}; her form makes {way} of it "
            "than this (hull.R_0)"
        )
    here, there = ship.froude(ship.speed), like.froude(like.speed)
    if abs(here - there) > FROUDE:
        way = "more" if here > there else "less"
        yield (
            f"resistance: Fn {here:.2f}, {like.name}'s {there:.2f}; waves make {way} of it than "
            "this (hull.R_0)"
        )


def _fullness(ship: Ship) -> float:
    h = ship.hull
    return block_coefficient(h.L, h.B, h.d, h.volume)


def _propeller(ship: Ship, like: Ship) -> Iterator[str]:
    here, there = (s.engine.n_max * s.propeller.D / s.speed for s in (ship, like))
    if "propeller.D" in ship.estimated and here > LOADING * there:
        yield (
            f"propeller: n_max D / U = {here:.1f}, {like.name}'s {there:.1f}; "
            f"{ship.propeller.D:.3g} m is small for her resistance (--D_P)"
        )


def _hull(ship: Ship, like: Ship) -> Iterator[str]:
    h, C_b, far = ship.hull, _fullness(ship), []
    if "Yoshimura" not in ship.estimated.get("hull.Y_v", ""):
        return
    for name, value, (low, high) in (("C_b", C_b, C_B), ("L/B", h.L / h.B, L_B)):
        if not (1.0 - NEAR) * low <= value <= (1.0 + NEAR) * high:
            far.append(f"{name} {value:.2f} (judged at {low} to {high})")
    if h.d / h.B < (1.0 - NEAR) * SHALLOW:
        far.append(f"d/B {h.d / h.B:.2f} (from {SHALLOW:.2f})")
    if far:
        yield f"hull derivatives: regressions at {', '.join(far)}; turns are guesses"
