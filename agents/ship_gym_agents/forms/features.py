"""Features by blocks: each has names, and a mirror sign for every feature.

=============== ==================== =========================================================
block           needs                features
=============== ==================== =========================================================
``observation``                      the columns of the environment as they are
``observer``    base                 filtered heading, yaw rate, sway and rudder bias, the
                                     rudder, and the base's rudder order (not with guidance)
``reference``   base                 deviation from the heading and rate that the base leads
                                     to, and the heading it wants
``soft``        base                 filtered heading and yaw rate that saturate early
``sea``         base                 slow means and the wave-frequency motion left by the filter
``route``       base, a track        place beside and along the route, next turn
``drift``       base drift_los       drift along and across the leg
``speed``                            speed through the water, propeller
``effect``                           effect of the rudder at this speed and propeller
``voyage``      track of one leg     time left and the speed still needed
``ship``                             constants of the ship that a bridge knows
``products``    other blocks         odd times even features, for linear networks
=============== ==================== =========================================================

Values are of the order of 1 and within +-`LIMIT`, but for those of ``observation``. A mirror sign
is -1 where a feature changes its sign when port and starboard change places, else +1; nan where
nobody has said so of a column of the environment.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.simulation import self_propulsion
from ship_gym.tasks import observations_of
from ship_gym.tasks.columns import observation_columns
from ship_gym_agents.autopilot import wrapped
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.forms.look import Look, Voyage
from ship_gym_agents.rudder_effect import RudderEffect

LIMIT = 5.0
PRODUCTS = "products"  # name of the block that is made from the others


class Block:
    """Some features that belong together.

    Attributes
    ----------
    FEATURES : dict
        Name to mirror sign.
    needs : tuple of str
        Columns of the observation.
    on_base : bool
        Whether a classical controller is needed.
    """

    FEATURES: ClassVar[dict[str, float]] = {}
    needs: ClassVar[tuple[str, ...]] = ()
    on_base: ClassVar[bool] = False

    def __init__(self, voyage: Voyage):
        who = f"the block {self.name()!r} of form.features"
        observation_columns(voyage.scenario).require(self.needs, who)
        self.features = dict(self.FEATURES)

    @classmethod
    def name(cls) -> str:
        """As in ``form.features``."""
        return cls.__name__.lower()

    def __call__(self, look: Look) -> np.ndarray:
        """Features, shape (count, features); once an interval."""
        columns = np.broadcast_arrays(*self.values(look))
        return np.clip(np.stack(columns, axis=1), -LIMIT, LIMIT)

    def values(self, look: Look) -> tuple:
        """The features one by one, in the order of `features`."""
        raise NotImplementedError

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows with the next look."""


class Observation(Block):
    """The columns of the environment as they are."""

    def __init__(self, voyage: Voyage):
        super().__init__(voyage)
        rows = observations_of(voyage.scenario.task)
        self.features = {r.name: math.nan if r.mirror is None else float(r.mirror) for r in rows}

    def __call__(self, look: Look) -> np.ndarray:
        """See `Block`."""
        return look.observations


class Observer(Block):
    """Motion as the filter of the base sees it, and rudder angles."""

    FEATURES: ClassVar = {"psi": -1.0, "yaw_rate": -1.0, "sway": -1.0, "bias": -1.0, "rudder": -1.0}
    on_base = True

    def __init__(self, voyage: Voyage):
        super().__init__(voyage)
        self._rudder = voyage.form.action != "guidance"
        if self._rudder:
            self.features["own_rudder"] = -1.0

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        psi, r, v, bias = look.perceived.motion
        found = 2.0 * psi, 3.0 * r, 8.0 * v, 6.0 * bias, 2.0 * look.seen.rudder
        return (*found, 2.0 * look.own[:, 0]) if self._rudder else found


class Reference(Block):
    """How far the ship is from where the base leads it."""

    FEATURES: ClassVar = {"psi": -1.0, "yaw_rate": -1.0, "wanted": -1.0}
    on_base = True

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        (psi, r, *_), (psi_then, r_then) = look.perceived.motion, look.followed
        return 4.0 * wrapped(psi - psi_then), 3.0 * (r - r_then), 2.0 * look.perceived.wanted


class Soft(Block):
    """Heading and yaw rate that saturate early: about the sign, without its jump."""

    FEATURES: ClassVar = {"psi": -1.0, "yaw_rate": -1.0}
    on_base = True

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        psi, r, *_ = look.perceived.motion
        return np.tanh(psi / 0.035), np.tanh(r / 0.03)


class Route(Block):
    """Place beside and along the route in L, and the turn at the next way-point [rad].

    `near` is ``exp(-to_go / 3)``: 1 at the way-point.
    """

    FEATURES: ClassVar = {
        "cross_track": -1.0,
        "soft_cross_track": -1.0,
        "cross_track_rate": -1.0,
        "to_go": 1.0,
        "near": 1.0,
        "turn": -1.0,
        "turn_near": -1.0,
        "turn_soon": -1.0,
        "turn_near_to_go": -1.0,
        "size_near": 1.0,
        "psi_near": -1.0,
    }
    needs = ("cross_track", "cross_track_rate", "to_go", "next_turn")
    on_base = True

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        seen = look.seen
        e, to_go, turn = seen.cross_track, seen.to_go, seen.next_turn * math.pi
        near = np.exp(-np.clip(to_go, 0.0, 12.0) / 3.0)
        return (
            e,
            np.tanh(4.0 * e),
            2.0 * seen.cross_track_rate,
            np.clip(to_go, -1.0, 8.0) / 4.0,
            2.0 * near,
            turn,
            2.0 * turn * near,
            np.sin(turn) * np.tanh(np.clip(3.5 - to_go, -3.0, 3.0)),
            turn * near * np.clip(to_go, -1.0, 4.0),
            2.0 * np.abs(turn) * near,
            np.sin(look.perceived.motion[0]) * near,
        )


class Drift(Block):
    """Drift over ground that `DriftLOS` estimates, along and across the active leg."""

    FEATURES: ClassVar = {"along": 1.0, "across": -1.0}
    on_base = True

    def __init__(self, voyage: Voyage):
        super().__init__(voyage)
        if not isinstance(voyage.base, DriftLOS):
            raise ConfigError(
                "form.features: the block 'drift' is what drift_los estimates; allowed with base = "
                f"'drift_los', not {voyage.form.base!r}"
            )

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        along, across = look.base.drift
        return 5.0 * along, 5.0 * across


class Speed(Block):
    """Speed through the water and propeller speed, from the nominal ones."""

    FEATURES: ClassVar = {"surge": 1.0, "propeller": 1.0}
    needs = ("surge", "propeller")

    def __init__(self, voyage: Voyage):
        super().__init__(voyage)
        ship = voyage.ship
        self._turns_by = ship.engine.n_max / self_propulsion(ship, ship.speed)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        seen = look.seen
        return 8.0 * (seen.surge - 0.95), 4.0 * (seen.propeller * self._turns_by - 1.0)


class Effect(Block):
    """Effect of the rudder at this speed and propeller by the nominal one."""

    FEATURES: ClassVar = {"effect": 1.0}
    needs = ("surge", "propeller")

    def __init__(self, voyage: Voyage):
        super().__init__(voyage)
        self._effect = RudderEffect(voyage.ship, voyage.step)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        return (4.0 * (self._effect(look.seen) - 1.0),)

    def restart(self, rows: np.ndarray) -> None:
        """See `Block`."""
        self._effect.restart(rows)


BLOCKS: dict[str, type[Block]] = {
    block.name(): block
    for block in (Observation, Observer, Reference, Soft, Route, Drift, Speed, Effect)
}
# even feature -> odd ones that it may be needed beside
_MOTION = ("observer.psi", "observer.yaw_rate", "observer.sway", "observer.bias")
_PAIRS: dict[str, tuple[str, ...]] = {
    "speed.surge": _MOTION,
    "speed.propeller": ("observer.psi", "observer.bias"),
    "effect.effect": _MOTION,
    "route.near": ("observer.psi", "observer.yaw_rate", "drift.across"),
    "drift.along": ("route.turn", "route.turn_near"),
}


def pairs(names: list[str]) -> list[tuple[int, int]]:
    """Which features the block ``products`` multiplies, odd and even, by their places.

    Raises
    ------
    ConfigError
        None of those that it knows are there.
    """
    place = {name: k for k, name in enumerate(names)}
    found = [
        (place[odd], place[even])
        for even, odds in _PAIRS.items()
        for odd in odds
        if even in place and odd in place
    ]
    if not found:
        raise ConfigError(
            f"form.features: {PRODUCTS!r} multiplies odd by even features of other blocks, such as "
            "'observer' and 'speed'; these have none of them"
        )
    return found
