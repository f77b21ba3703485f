"""Features of the motion: as measured, as the filter of the base sees it, and the sea in it."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ship_gym.conventions import wrap_angle
from ship_gym.tasks import observations_of
from ship_gym_agents.autopilot import wrapped
from ship_gym_agents.forms.block import Block
from ship_gym_agents.forms.look import Look, Sailing
from ship_gym_agents.fresh import Fresh, begun, zeroed

_SLOW, _LONG = 2.0, 6.5  # time constants of the means of `Sea` [L / U0]; for kcs 1 and 3 minutes


class Observation(Block):
    """The columns of the environment as they are."""

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        rows = observations_of(sailing.scenario.task)
        self.features = {r.name: math.nan if r.mirror is None else float(r.mirror) for r in rows}

    def __call__(self, look: Look) -> np.ndarray:
        """See `Block`."""
        return look.observations


class Observer(Block):
    """Motion as the filter of the base sees it, and rudder angles."""

    FEATURES: ClassVar = {"psi": -1.0, "yaw_rate": -1.0, "sway": -1.0, "bias": -1.0, "rudder": -1.0}
    on_base = True

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        self._rudder = sailing.form.action != "guidance"
        if self._rudder:
            self.features["own_rudder"] = -1.0

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        psi, r, v, bias = look.steers[1].motion
        found = 2.0 * psi, 3.0 * r, 8.0 * v, 6.0 * bias, 2.0 * look.seen.rudder
        if not self._rudder:
            return found
        assert look.own is not None
        return *found, 2.0 * look.own[:, 0]


class Reference(Block):
    """How far the ship is from where the base leads it."""

    FEATURES: ClassVar = {"psi": -1.0, "yaw_rate": -1.0, "wanted": -1.0}
    on_base = True

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        assert look.followed is not None
        perceived, (psi_then, r_then) = look.steers[1], look.followed
        psi, r, *_ = perceived.motion
        return 4.0 * wrapped(psi - psi_then), 3.0 * (r - r_then), 2.0 * perceived.wanted


class Soft(Block):
    """Heading and yaw rate that saturate early: about the sign, without its jump."""

    FEATURES: ClassVar = {"psi": -1.0, "yaw_rate": -1.0}
    on_base = True

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        psi, r, *_ = look.steers[1].motion
        return np.tanh(psi / 0.035), np.tanh(r / 0.03)


class Sea(Block):
    """Slow means, and what the filter leaves of the motion: how large and how quick the waves are.

    Means are plain ones at first, then over `_SLOW` and (`long_...`) `_LONG`. `coupling`:
    correlation of the wave-frequency yaw rate and sway. `quickness`: mean square of the change of
    that yaw rate over an interval, by its own, less 1.
    """

    FEATURES: ClassVar = {
        "bias_change": -1.0,
        "slow_bias": -1.0,
        "slow_psi": -1.0,
        "slow_surge": 1.0,
        "long_bias": -1.0,
        "long_psi": -1.0,
        "long_surge": 1.0,
        "yaw_rate": -1.0,
        "yaw_rate_rms": 1.0,
        "sway_rms": 1.0,
        "psi_rms": 1.0,
        "coupling": 1.0,
        "quickness": 1.0,
    }
    needs = ("sin_error", "cos_error", "yaw_rate", "surge", "sway")
    on_base = True

    def __init__(self, sailing: Sailing):
        super().__init__(sailing)
        self._shares = sailing.step / _SLOW, sailing.step / _LONG
        self._taken = np.zeros(sailing.count)
        self._slow, self._long = np.zeros((8, sailing.count)), np.zeros((3, sailing.count))
        self._before, self._fresh = None, Fresh()

    def restart(self, rows: np.ndarray) -> None:
        """See `Block`."""
        self._taken, self._slow, self._long = (
            zeroed(x, rows) for x in (self._taken, self._slow, self._long)
        )
        self._fresh.add(rows)

    def values(self, look: Look) -> tuple:
        """See `Block`."""
        seen, (psi, r, v, bias) = look.seen, look.steers[1].motion
        bias = np.broadcast_to(bias, psi.shape)
        wave_r, wave_v = seen.yaw_rate - r, seen.sway - v
        wave_psi = wrap_angle(np.arctan2(seen.sin_error, seen.cos_error) - psi)
        change = wave_r - begun(self._before, self._fresh.take(), wave_r)
        self._before = wave_r
        means = np.stack([bias, psi, seen.surge])
        waves = np.stack([wave_r**2, wave_v**2, wave_psi**2, wave_r * wave_v, change**2])
        self._taken = self._taken + 1.0
        slow, long = (np.maximum(share, 1.0 / self._taken) for share in self._shares)
        self._slow = self._slow + slow * (np.concatenate([means, waves]) - self._slow)
        self._long = self._long + long * (means - self._long)
        return self._scaled(bias, wave_r)

    def _scaled(self, bias: np.ndarray, wave_r: np.ndarray) -> tuple:
        slow_bias, slow_psi, slow_surge, r2, v2, psi2, rv, change2 = self._slow
        long_bias, long_psi, long_surge = self._long
        rms_r, rms_v, rms_psi = (np.sqrt(np.maximum(x, 0.0)) for x in (r2, v2, psi2))
        return (
            8.0 * (bias - slow_bias),
            6.0 * slow_bias,
            np.tanh(slow_psi / 0.02),
            15.0 * (slow_surge - 0.95),
            6.0 * long_bias,
            np.tanh(long_psi / 0.02),
            15.0 * (long_surge - 0.95),
            5.0 * wave_r,
            15.0 * rms_r,
            30.0 * rms_v,
            150.0 * rms_psi,
            np.clip(rv / (rms_r * rms_v + 1e-6), -1.0, 1.0),
            np.clip(change2 / (r2 + 1e-8), 0.0, 4.0) - 1.0,
        )
