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
``turn``        base, a track        place beside an arc into the next leg, its bearings ahead
``drift``       base drift_los       drift along and across the leg
``speed``                            speed through the water, propeller
``effect``                           effect of the rudder at this speed and propeller
``hold``                             rudder that holds her on her course, by the largest
``voyage``      track of one leg     time left and the speed still needed
``ship``                             constants of the ship that a bridge knows
``products``    other blocks         odd times even features, for linear networks
=============== ==================== =========================================================

Values are of the order of 1 and within +-5, but for those of ``observation``. A mirror sign
is -1 where a feature changes its sign when port and starboard change places, else +1; nan where
nobody has said so of a column of the environment.
"""

from __future__ import annotations

from ship_gym.config import ConfigError
from ship_gym_agents.forms.block import Block
from ship_gym_agents.forms.motion_blocks import Observation, Observer, Reference, Sea, Soft
from ship_gym_agents.forms.route_blocks import Drift, Route, Turn, Voyage
from ship_gym_agents.forms.ship_blocks import Effect, Hold, Ship, Speed

PRODUCTS = "products"  # name of the block that is made from the others
BLOCKS: dict[str, type[Block]] = {
    block.name(): block
    for block in (
        Observation,
        Observer,
        Reference,
        Soft,
        Sea,
        Route,
        Turn,
        Drift,
        Voyage,
        Speed,
        Effect,
        Hold,
        Ship,
    )
}
# even feature -> odd ones that it may be needed beside
_MOTION = ("observer.psi", "observer.yaw_rate", "observer.sway", "observer.bias")
_BIASES = ("observer.bias", "sea.slow_bias")
_PAIRS: dict[str, tuple[str, ...]] = {
    "sea.slow_surge": ("observer.psi", "soft.psi", *_BIASES),
    "sea.yaw_rate_rms": ("observer.psi", "observer.yaw_rate", *_BIASES),
    "sea.coupling": _BIASES,
    "sea.quickness": _BIASES,
    "sea.long_surge": _BIASES,
    "speed.surge": (*_MOTION, "turn.cross_arc", "turn.bearing_ahead", "hold.hard"),
    "speed.propeller": ("observer.psi", "observer.bias", "hold.rudder", "hold.hard"),
    "effect.effect": _MOTION,
    # only one constant of the ship: with few ships more could not be told from each other
    "ship.time": (*_MOTION, "observer.rudder", "observer.own_rudder", "sea.yaw_rate"),
    "route.near": (
        "observer.psi",
        "observer.yaw_rate",
        "observer.rudder",
        "observer.own_rudder",
        "route.cross_track",
        "route.cross_track_rate",
        "drift.across",
    ),
    "route.size_near": ("route.cross_track", "route.turn_near"),
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
