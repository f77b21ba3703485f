"""The watch over ships of one kind: base, features, memory of past moments, held decision."""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import observation_columns
from ship_gym_agents.autopilot import Autopilot
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.forms.actions import ACTIONS
from ship_gym_agents.forms.block import LIMIT
from ship_gym_agents.forms.features import BLOCKS, PRODUCTS, pairs
from ship_gym_agents.forms.form import Form
from ship_gym_agents.forms.look import Look, Sailing
from ship_gym_agents.fresh import Fresh, begun


class Watchkeeper:
    """`Helm` for `count` ships of one kind.

    Parameters
    ----------
    form : Form
    count : int
    ship : Ship
    scenario : Scenario
        Without privileged observations.
    """

    def __init__(self, form: Form, count: int, ship: Ship, scenario: Scenario):
        self._columns = observation_columns(scenario)
        base = _base(form, count, ship, scenario)
        step = scenario.control_interval / ship.time_unit * ship.speed / ship.hull.L
        sailing = Sailing(form, count, ship, scenario, base, step)
        self._base, self._steers_last = base, form.action == "guidance"
        self.action = ACTIONS[form.action](sailing)
        self._blocks = [BLOCKS[name](sailing) for name in form.features if name != PRODUCTS]
        self._names_now(PRODUCTS in form.features)
        self._lags = form.lags
        self._past: np.ndarray | None = None
        self.names = list(self._now)
        self.signs = list(self._now.values())
        for lag in form.lags:
            self.names += [f"{name}@{lag}" for name in self._now]
            self.signs += list(self._now.values())
        self._look: Look | None = None
        self._followed: np.ndarray | None = None
        self._fresh, self._fresh_past = Fresh(), Fresh()

    def _names_now(self, with_products: bool) -> None:
        """Names and signs of the features of one moment."""
        self._now = {
            f"{block.name()}.{name}": sign
            for block in self._blocks
            for name, sign in block.features.items()
        }
        self._pairs = pairs(list(self._now)) if with_products else []
        names = list(self._now)
        for odd, even in self._pairs:
            one, other = names[odd], names[even]
            self._now[f"{PRODUCTS}.{one}*{other}"] = self._now[one] * self._now[other]

    def restart(self, rows: np.ndarray) -> None:
        """These rows begin a new episode with the next look."""
        for part in (self._base, self.action, *self._blocks):
            if part is not None:
                part.restart(rows)
        self._fresh.add(rows)
        self._fresh_past.add(rows)

    def look(self, observations: np.ndarray) -> np.ndarray:
        """Features (count, F) for plain observations; once an interval."""
        self._look = look = self._perceive(observations)
        self._features = features = np.concatenate([block(look) for block in self._blocks], axis=1)
        if self._pairs:
            odd, even = np.transpose(self._pairs)
            products = np.clip(features[:, odd] * features[:, even], -LIMIT, LIMIT)
            self._features = features = np.concatenate([features, products], axis=1)
        return self._with_past(features) if self._lags else features

    def _with_past(self, features: np.ndarray) -> np.ndarray:
        """Features of now and of earlier decisions; what has no past takes the present for it."""
        rows = self._fresh_past.take()
        past = self._past
        if past is None:
            past = np.repeat(features[None], max(self._lags), axis=0)
        elif not isinstance(rows, slice) and len(rows):
            past = past.copy()
            past[:, rows] = features[rows]
        self._past = past
        return np.concatenate([features, *(past[lag - 1] for lag in self._lags)], axis=1)

    def _perceive(self, observations: np.ndarray) -> Look:
        seen = self._columns.view(observations)
        if self._base is None:
            return Look(observations, seen, None, None, None, None)
        perceived, own = self._base.perceive(observations), None
        if self._steers_last:
            # what it led to in the interval before; at the start where the ship is
            now = np.stack(perceived.motion[:2])
            psi, r = begun(self._followed, self._fresh.take(), now)
            followed = psi + perceived.jump, r
        else:
            own = self._base.steer(perceived)
            followed = self._base.followed[:2]
        return Look(observations, seen, self._base, perceived, own, followed)

    def act(self, decision: np.ndarray | None) -> np.ndarray:
        """Actions (count, n_actions); None holds the decision before."""
        if self._look is None:
            raise ConfigError(
                "helm: act without a look; each interval takes one look, then one act"
            )
        if decision is not None and self._past is not None:
            self._past = np.concatenate([self._features[None], self._past[:-1]])
        action = self.action.act(self._look, decision)
        if self._steers_last:
            psi, r = self._look.steers[0].followed[:2]
            self._followed = np.stack(np.broadcast_arrays(psi, r, action[:, 0])[:2])
        self._look = None
        return action


def _base(form: Form, count: int, ship: Ship, scenario: Scenario) -> Autopilot | None:
    """The classical controller of a form, reset; a ConfigError if it cannot be one."""
    if not form.base:
        return None
    base = make_controller(form.base)
    if not (isinstance(base, Autopilot) and callable(base.restart)):
        raise ConfigError(
            f"form.base = {form.base!r}: allowed are autopilots that can begin one episode while "
            "others go on: pid, lqg, adaptive, bang_bang; on tracks los_pid, ilos, drift_los, "
            "just_in_time"
        )
    base.filter_noise = form.filter_noise
    base.reset(count, ship, scenario)
    return base
