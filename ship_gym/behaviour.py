"""What every ship does, whatever her numbers: a few short runs that an own ship must pass.

Ranges of single numbers let through what no ship is: a rudder that turns her the other way, a hull
that gains speed by drifting. So ``simulation.ShipSim``, through which everything that sails goes,
lets a ship of an own file make the runs of `RUNS` once, side by side in calm water: she holds her
course and service speed, also after a small push, turns to the side of her rudder, turns hard
without spinning, and loses energy without thrust; her hull resists drift and turning.
A ship file cannot switch this off, but for the circle at 35 deg of rudder, which ``strict = false``
lets be of any width.

The limits are ours and wide; beside each stands the nearest of the ships, hulls and surrogates of
the package, whose numbers are of tanks and trials, an unstable tanker among them.
"""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import FORCE_COMPONENTS, PSI, N, R, U, V
from ship_gym.ships.files import available_ships
from ship_gym.ships.loader import available_variants, load_ship
from ship_gym.ships.particulars import Ship

_LONG, _SHORT = 16.0, 5.0  # of the runs and of what is asked early [L / U0]
_EVERY = 0.25  # time between two looks [L / U0]
_AFTER = f"in the time of {_SHORT:g} ship lengths"
_EARLY = round(_SHORT / _EVERY)  # row of the look after the short time
_RUDDER = math.radians(20.0)
_PUSH = 0.05  # r' of a small push: 3 deg in the time of a ship length

# Largest values, beside them the largest of the package's ships (hulls, variants, surrogates)
_OFF_COURSE = math.radians(20.0)  # after the short time, also after a push; 8 deg, kvlcc2
_SLOWEST, _FASTEST = 0.5, 1.15  # speeds straight ahead by U0; 0.93 (kvlcc2 pushed), 1.00
_LEAST_TURN = math.radians(10.0)  # after the short time at 20 deg of rudder; 67 deg, s175
# r L / U0 at any time hard over at service speed; 0.74, onrt_model without surrogate. Not how wide
# her circle is or whether she stops in it: a short and wide ship, or one with a rudder of high lift
# at 45 to 70 deg, turns on the spot
_MOST_YAW = 1.5
_USUAL = math.radians(35.0)  # rudder of the circle that is asked of a strict ship
_TIGHTEST = 1.0  # her steady diameter [L]; 2.2, dtc_model
_FASTEST_TURN = 3.0  # speed at any time of a turn, by U0; 1.12, kcs_model at full ahead
_GAIN = 0.01  # energy won without thrust, by that at the start; none, it falls in every interval
_DRIFTS = tuple(math.radians(angle) for angle in (3.0, 10.0, 20.0))
_YAWS = (0.1, 0.3, 0.6)  # r'


class Run(NamedTuple):
    """A run from a straight course in calm water, without dimensions."""

    name: str
    kind: str  # what is asked of it
    rudder: int = 0  # positive to starboard, 1: 20 deg, 2: hard over, 3: at most 35 deg
    engine: str = "service"  # or "full", "stopped"
    u: float = 1.0
    v: float = 0.0
    r: float = 0.0


RUNS = (
    Run("rudder amidships", "straight"),
    Run("rudder amidships, pushed to starboard", "straight", r=_PUSH),
    Run("rudder amidships, pushed to port", "straight", r=-_PUSH),
    Run("20 deg of rudder to starboard", "turn", 1),
    Run("20 deg of rudder to port", "turn", -1),
    Run("hard over to starboard", "hard", 2),
    Run("hard over to port", "hard", -2),
    Run("hard over to starboard, full ahead", "hard", 2, "full"),
    Run("hard over to port, full ahead", "hard", -2, "full"),
    Run("propeller stopped, straight", "coast", 0, "stopped"),
    Run("propeller stopped, drifting", "coast", 0, "stopped", 0.95, -0.3),
    Run("propeller stopped, swinging", "coast", 0, "stopped", 0.95, 0.0, 0.5),
    Run("propeller stopped, in a turn", "coast", 0, "stopped", 0.9, -0.3, 0.5),
    Run("propeller stopped, checking a turn", "coast", 0, "stopped", 0.9, 0.3, 0.5),
    Run("35 deg of rudder to starboard", "circle", 3),
    Run("35 deg of rudder to port", "circle", -3),
)


def check_behaviour(ship: Ship, simulation: Callable[[Ship, int], Any]) -> None:
    """Refuse a ship of an own file that does what no ship does.

    Parameters
    ----------
    ship : Ship
        One of the package, with its own numbers, is not looked at; one changed in Python is.
    simulation : callable
        Makes a ``ShipSim`` of n such ships that does not come here again.

    Raises
    ------
    ConfigError
        A line for each thing that is wrong, with the number that shows it.
    """
    if _of_the_package(ship):
        return
    if lines := findings(ship.at_share(1.0), simulation):
        raise ConfigError("\n".join(f"{ship.name}: {line}" for line in lines))


_NUMBERS = ("rho", "nu", "hull", "propeller", "rudder", "gear", "engine", "open_water", "surrogate")


@functools.cache
def _names() -> frozenset[str]:
    return frozenset(available_ships())


def _of_the_package(ship: Ship) -> bool:
    """Whether a ship is one of the package: by her numbers, since a changed one keeps her name."""
    return ship.name in _names() and any(
        math.isclose(ship.file_speed, known.file_speed, rel_tol=1e-12)
        and all(getattr(ship, name) == getattr(known, name) for name in _NUMBERS)
        for known in _published(ship.name, ship.surrogate_name)
    )


@functools.lru_cache(maxsize=64)
def _published(name: str, surrogate: str) -> tuple[Ship, ...]:
    """A ship of the package with one of her surrogates, and each hull of hers."""
    found = []
    for variant in (None, *available_variants(name)):
        with contextlib.suppress(ConfigError):  # no such surrogate
            found.append(load_ship(name, surrogate=surrogate, variant=variant))
    return tuple(found)


@functools.lru_cache(maxsize=4096)  # fleets of ships that all differ are made again and again
def findings(ship: Ship, simulation: Callable[[Ship, int], Any]) -> tuple[str, ...]:
    """What a ship does that no ship does, one line each; looked at once for equal ships.

    Parameters
    ----------
    ship, simulation
        As in `check_behaviour`.
    """
    if ship.inertia.m_u <= 0.0:
        return (
            f"mass with added mass in surge {ship.inertia.m_u:.4g} kg: must be > 0 (hull.m_x, "
            "hull.volume)",
        )
    try:
        sim = simulation(ship, len(RUNS))
        sim.reset(0, speed=ship.speed)
        sim.set_interval(_EVERY * ship.hull.L / ship.speed)
    except ConfigError as error:
        lines = str(error).splitlines()
        return tuple(line.removeprefix(ship.name).removeprefix(":").strip() for line in lines)
    held = tuple(_no_resistance(ship, sim))
    history = sailed(ship, sim)
    whole = np.isfinite(history).all(axis=(0, 2))
    motions = by_size(ship, np.where(whole[None, :, None], history, 0.0))
    runs = [(k, run) for k, run in enumerate(RUNS) if whole[k]]
    found = (
        *_not_finite(history, whole),
        *held,
        *_off_course(motions, runs),
        *_wrong_side(motions, runs),
        *_no_turn(motions, runs),
        *_gains(motions, runs),
        *(_no_circle(motions, runs) if ship.strict else ()),
    )
    return tuple(f"no ship does this: {line}" for line in found)


def _unit(ship: Ship) -> np.ndarray:
    """Units of u, v [m/s] and r [rad/s]."""
    return np.array([ship.speed, ship.speed, ship.speed / ship.hull.L])


def sailed(ship: Ship, sim: Any) -> np.ndarray:
    """States of `RUNS`, shape (looks, runs, 8), of ships that were reset at service speed."""
    most = ship.gear.delta_max
    rudder = (0.0, min(_RUDDER, most), most, min(_USUAL, most))
    n = {"service": float(sim.state[0, N]), "full": ship.engine.n_max, "stopped": 0.0}
    sim.state[:, [U, V, R]] = [(run.u, run.v, run.r) for run in RUNS] * _unit(ship)
    sim.state[:, N] = [n[run.engine] for run in RUNS]
    sim.commands[:, 0] = [math.copysign(rudder[abs(run.rudder)], run.rudder) for run in RUNS]
    sim.commands[:, 1] = sim.state[:, N]
    looks = [sim.state.copy()]
    with np.errstate(all="ignore"):
        for _ in range(round(_LONG / _EVERY)):
            sim.sail()  # not `step`: one that diverges is no error here
            looks.append(sim.state.copy())
    return np.array(looks)


class Motions(NamedTuple):
    """What is asked of the runs, each (looks, runs).

    Speed and u by U0; r' and heading [rad], positive to the side of rudder or push; kinetic energy
    with the added mass, by that at the start.
    """

    speed: np.ndarray
    u: np.ndarray
    r: np.ndarray
    turned: np.ndarray
    energy: np.ndarray


def by_size(ship: Ship, history: np.ndarray) -> Motions:
    """The motions of `RUNS`, whose states (looks, runs, 8) are given, without dimensions."""
    U0, L, b = ship.speed, ship.hull.L, ship.inertia
    side = np.array([math.copysign(1.0, run.rudder or run.r or 1.0) for run in RUNS])
    u, v, r = (history[..., k] for k in (U, V, R))
    energy = 0.5 * (b.m_u * u * u + b.m_v * v * v + b.I_r * r * r) + b.m_xG * v * r
    start = np.where(energy[0] > 0.0, energy[0], 1.0)
    speed, turned = np.hypot(u, v) / U0, side * history[..., PSI]
    return Motions(speed, u / U0, side * r * L / U0, turned, energy / start)


def _not_finite(history: np.ndarray, whole: np.ndarray) -> Iterator[str]:
    """One line for all runs: they have one reason."""
    if whole.all():
        return
    when = (~np.isfinite(history).all(axis=2)).argmax(axis=0)
    first = min(np.flatnonzero(~whole), key=lambda k: when[k])
    yield (
        f"{RUNS[first].name}: her motion is no finite number in the time of "
        f"{when[first] * _EVERY:g} ship lengths; so it is in {np.sum(~whole)} of {len(RUNS)} runs"
    )


def _no_resistance(ship: Ship, sim: Any) -> Iterator[str]:
    """What the bare hull does when she is held drifting or turning: it must push back."""
    held = [(math.cos(a), math.sin(a), 0.0) for a in _DRIFTS] + [(1.0, 0.0, r) for r in _YAWS]
    which = np.arange(len(held))
    sim.state[which[:, None], [U, V, R]] = held * _unit(ship)
    hull = sim.loads_now(which)[0][:, FORCE_COMPONENTS.index("hull")]
    Y, M = hull[: len(_DRIFTS), 1], hull[len(_DRIFTS) :, 2]
    if not (Y < 0.0).all():
        angle = math.degrees(_DRIFTS[int((Y >= 0.0).argmax())])
        yield (
            f"held {angle:.0f} deg across the flow: her hull is drawn on instead of pushing back "
            "(hull.Y_v, Y_vvv)"
        )
    if not (M < 0.0).all():
        yaw = _YAWS[int((M >= 0.0).argmax())]
        yield (
            f"held in a turn of r L/U0 = {yaw}: her hull turns on by itself instead of resisting "
            "(hull.N_r, N_rrr)"
        )


Named = list[tuple[int, Run]]  # the runs that are finite, with their numbers


def _off_course(m: Motions, runs: Named) -> Iterator[str]:
    for k, run in _of_kind("straight", runs):
        slow, fast = m.speed[: _EARLY + 1, k].min(), m.speed[:, k].max()
        speed = fast if fast > _FASTEST else slow
        if not _SLOWEST <= speed <= _FASTEST:
            yield (
                f"{run.name}: she sails at {speed:.3g} times her service speed; allowed is "
                f"{_SLOWEST} to {_FASTEST} (hull.R_0, m_x, open water)"
            )
        off = abs(math.degrees(m.turned[_EARLY, k]))
        if off > math.degrees(_OFF_COURSE):
            yield (
                f"{run.name}: she is {off:.0f} deg off her course {_AFTER}; allowed is "
                f"{math.degrees(_OFF_COURSE):.0f} (hull.Y_v, N_v, Y_r, N_r, x_G)"
            )


def _wrong_side(m: Motions, runs: Named) -> Iterator[str]:
    for k, run in _of_kind("turn", runs):
        turned = m.turned[_EARLY, k]
        if not turned >= _LEAST_TURN:
            way = "to that side" if turned >= 0.0 else "to the OTHER side"
            yield (
                f"{run.name}: she has turned {abs(math.degrees(turned)):.0f} deg {way} {_AFTER}; "
                f"allowed is from {math.degrees(_LEAST_TURN):.0f} to that side (rudder.x_R, "
                "epsilon, f_alpha, A_R)"
            )


def _no_turn(m: Motions, runs: Named) -> Iterator[str]:
    for k, run in _of_kind("hard", runs):
        r, most, yaw = m.r[-1, k], m.speed[:, k].max(), abs(m.r[:, k]).max()
        if most > _FASTEST_TURN:
            yield (
                f"{run.name}: she reaches {most:.3g} times her service speed; allowed is "
                f"{_FASTEST_TURN}"
            )
        elif r <= 0.0:
            yield f"{run.name}: at last she turns to the OTHER side, r L/U0 = {-r:.2f}"
        elif run.engine == "service" and yaw > _MOST_YAW:
            yield (
                f"{run.name}: she spins at r L/U0 = {yaw:.2f}; allowed is up to {_MOST_YAW} "
                "(rudder.A_R, f_alpha, a_H, x_R, hull.N_r, J_z, k_zz)"
            )


def _no_circle(m: Motions, runs: Named) -> Iterator[str]:
    """What a short, wide ship or one with a rudder of high lift may do: asked of strict ships."""
    for k, run in _of_kind("circle", runs):
        u, diameter = m.u[-1, k], 2.0 * m.speed[-1, k] / max(abs(m.r[-1, k]), 1e-9)
        if u <= 0.0:
            told = f"at last she goes astern, at {-u:.2f} U0; allowed is ahead"
        elif diameter < _TIGHTEST:
            told = f"her circle is {diameter:.2f} L wide; allowed is from {_TIGHTEST:g}"
        else:
            continue
        yield (
            f"{run.name}: {told} (rudder.A_R, f_alpha, a_H, hull.N_r); if it is meant: "
            "strict = false"
        )


def _gains(m: Motions, runs: Named) -> Iterator[str]:
    rise = (m.energy - np.minimum.accumulate(m.energy, axis=0)).max(axis=0)
    for k, run in _of_kind("coast", runs):
        if rise[k] > _GAIN:
            yield (
                f"{run.name}: her energy rises by {100.0 * rise[k]:.3g} % without thrust; allowed "
                f"is {100.0 * _GAIN:.3g} (hull.R_0, X_vv, X_vr, Y_v, N_r)"
            )


def _of_kind(kind: str, runs: Named) -> Named:
    return [(k, run) for k, run in runs if run.kind == kind]
