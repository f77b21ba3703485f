"""Features of tracks: place beside and along the route, drift, time that is left."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ship_gym.config import ConfigError
from ship_gym_agents.autopilot import wrapped
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.forms.block import Block
from ship_gym_agents.forms.look import Look, Sailing
from ship_gym_agents.fresh import zeroed
from ship_gym_agents.route_preview import Path
from ship_gym_agents.speed_keeping import check_one_leg

_RADIUS = 2.5  # of the arc of `Turn` [L], that of a moderate turn
_AHEAD = np.array([0.5, 2.0])  # where it looks [L]


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
            np.sin(look.steers[1].motion[0]) * near,
        )


class Turn(Block):
    """The way into the next leg: place beside an arc into it, and its bearings ahead.

    The arc has a radius of `_RADIUS`. Bearings are less the filtered heading [rad].
    """

    FEATURES: ClassVar = {
        "cross_arc": -1.0,
        "soft_cross_arc": -1.0,
        "bearing": -1.0,
        "bearing_ahead": -1.0,
        "at": -1.0,
        "size_at": -1.0,
        "cross_next": -1.0,
    }
    needs = ("cross_track", "to_go", "next_turn")
    on_base = True

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        seen, psi = look.seen, look.steers[1].motion[0]
        path = Path(seen, _RADIUS)
        now, ahead = path.bearings(_AHEAD[None, :]).T
        e, to_go, turn = seen.cross_track, seen.to_go, seen.next_turn * math.pi
        at = turn * np.exp(-np.clip(to_go, 0.0, 12.0) / 1.2)
        across_next = to_go * np.sin(turn) + e * np.cos(turn)
        return (
            path.error,
            np.tanh(4.0 * path.error),
            2.0 * wrapped(psi - now),
            2.0 * wrapped(psi - ahead),
            2.0 * at,
            2.0 * np.abs(turn) * at,
            np.tanh(across_next),
        )


class Drift(Block):
    """Drift over ground that `DriftLOS` estimates, along and across the active leg."""

    FEATURES: ClassVar = {"along": 1.0, "across": -1.0}
    on_base = True

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        if not isinstance(sailing.base, DriftLOS):
            raise ConfigError(
                "form.features: the block 'drift' is what drift_los estimates; allowed with base = "
                f"'drift_los', not {sailing.form.base!r}"
            )

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        assert isinstance(look.base, DriftLOS)
        along, across = look.base.drift
        return 5.0 * along, 5.0 * across


class Voyage(Block):
    """Time that is left to the end of the episode, and the speed over ground still needed."""

    FEATURES: ClassVar = {"time_left": 1.0, "to_go": 1.0, "needed": 1.0, "lacking": 1.0}
    needs = ("to_go", "surge")

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        check_one_leg(sailing.scenario, "the block 'voyage' of form.features")
        self._step, self._steps = sailing.step, sailing.scenario.steps
        self._sailed = np.zeros(sailing.count)

    def restart(self, rows: np.ndarray) -> None:
        """See `Block`."""
        self._sailed = zeroed(self._sailed, rows)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        left = np.maximum(self._steps - self._sailed, 1.0)
        self._sailed = self._sailed + 1.0
        needed = look.seen.to_go / (left * self._step)
        share, lacking = left / self._steps, needed - look.seen.surge
        return share, look.seen.to_go / 10.0, 4.0 * (needed - 0.8), 4.0 * lacking
