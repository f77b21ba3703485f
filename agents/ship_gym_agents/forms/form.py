"""The form of a policy: what the learner sees and what its decision does, as a section of TOML."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from ship_gym.config import ConfigError, build, check_fields, check_known
from ship_gym_agents.forms.actions import ACTIONS
from ship_gym_agents.forms.features import BLOCKS, PRODUCTS

_MOST_EVERY, _MOST_LAG = 1000, 1000


@dataclasses.dataclass(frozen=True)
class Form:
    """What stands between environment and learner, see ``docs/policy_forms.md``.

    Attributes
    ----------
    action : str
        ``direct``: the decision is the action. ``increment``: it moves the rudder order on.
        ``residual``: it is added to the action of `base`. ``guidance``: it is added to the heading
        that `base` steers.
    base : str
        Classical controller by name, such as ``pid``, ``pid@kcs``, ``drift_los``; empty: none.
    scale : float
        What decision 1 is. residual: share of the largest rudder angle. guidance: heading offset
        [rad]. increment: share of what the steering gear moves in `every` intervals. direct: 1.
    scale_rpm : float
        With control rudder+rpm, what decision 1 adds to the propeller's action in [-1, 1]:
        residual and guidance to that of `base`, increment to the last one. 0: the learner leaves
        the propeller alone. direct does not use it: its decision is the whole range.
    every : int
        Intervals that a decision is held.
    features : tuple of str
        Names of blocks, see ``ship_gym_agents.forms.features``.
    lags : tuple of int
        Decisions ago whose features are appended.
    symmetric : bool
        Whether the network shall answer mirrored features with the mirrored decision.
    filter_noise : float
        Noise of the ship's own sway and yaw that the observer of `base` assumes, by that of its
        gains; below 1 it takes more of the motion for waves, and the base moves the rudder less.
    """

    action: str = "direct"
    base: str = ""
    scale: float = 1.0
    scale_rpm: float = 0.0
    every: int = 1
    features: tuple[str, ...] = ("observation",)
    lags: tuple[int, ...] = ()
    symmetric: bool = False
    filter_noise: float = 1.0

    def __post_init__(self):
        check_known("form.action", self.action, ACTIONS)
        largest = ACTIONS[self.action].largest
        ranges = {"scale": (0.0, largest, "-"), "scale_rpm": (0.0, 2.0, "-")}
        check_fields("form", self, ranges | {"every": (1, _MOST_EVERY, "intervals")})
        check_fields("form", self, {"filter_noise": (0.01, 100.0, "-")})
        if self.scale == 0.0:
            raise ConfigError("form.scale = 0: a decision would do nothing; allowed is above 0")
        if self.action == "direct" and (self.scale, self.scale_rpm) != (1.0, 0.0):
            raise ConfigError(
                f"form.scale = {self.scale}, scale_rpm = {self.scale_rpm}: with action = 'direct' "
                "the decision is the whole action; allowed are 1 and 0"
            )
        self._check_features()
        for lag in self.lags:
            if isinstance(lag, bool) or not isinstance(lag, int) or not 1 <= lag <= _MOST_LAG:
                raise ConfigError(f"form.lags = {self.lags}: allowed are 1 to {_MOST_LAG}")
        _check_once("lags", self.lags)
        self._check_base()

    def _check_features(self) -> None:
        for name in self.features:
            check_known("block in form.features", name, [*BLOCKS, PRODUCTS])
        _check_once("features", self.features)
        if set(self.features) <= {PRODUCTS}:
            raise ConfigError(
                f"form.features = {self.features}: at least one block besides {PRODUCTS!r} is "
                f"needed; allowed are {', '.join(BLOCKS)}"
            )

    def _check_base(self) -> None:
        if self.base:
            return
        if ACTIONS[self.action].on_base:
            raise ConfigError(
                f"form.base is empty: action = {self.action!r} needs a classical controller, such "
                "as base = 'pid'"
            )
        if self.filter_noise != 1.0:
            raise ConfigError(
                f"form.filter_noise = {self.filter_noise} without form.base: allowed is 1"
            )
        for name in self.features:
            if name in BLOCKS and BLOCKS[name].on_base:
                raise ConfigError(
                    f"form.base is empty: the block {name!r} of form.features needs a classical "
                    "controller, such as base = 'pid'"
                )


def form_from(values: Mapping[str, Any], where: str = "form") -> Form:
    """The form of a section ``[form]`` or of a card; what is missing is the default.

    Raises
    ------
    ConfigError
        Unknown key or name (with the nearest one), or values that do not go together.
    """
    return build(Form, values, where)


def _check_once(field: str, values: tuple) -> None:
    if len(set(values)) < len(values):
        raise ConfigError(f"form.{field} = {values}: each is allowed once")
