"""Policy: a helm, a normaliser and a network make a controller."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym_agents.forms.form import Form
from ship_gym_agents.forms.helm import Helm
from ship_gym_agents.policies.networks import Network
from ship_gym_agents.policies.normaliser import Normaliser


class Policy:
    """A learned policy; its decisions are the mean ones, its normaliser is frozen.

    Implements ``Controller``, and ``restart`` for rows that begin anew.

    Parameters
    ----------
    form : Form
        What it sees and how its decision becomes an action.
    normaliser : Normaliser
    network : Mlp or Lstm
    card : mapping
        Where it comes from. ``name`` is shown in tables. ``features`` and ``decisions``, names of
        what the network was made for, are checked at each reset; without them the first reset
        sets them.

    Attributes
    ----------
    file : pathlib.Path or None
        What it was read from (``policy_file.load_policy``); a recording names it.

    Raises
    ------
    ConfigError
        Parts that do not fit each other.
    """

    def __init__(
        self, form: Form, normaliser: Normaliser, network: Network, card: Mapping[str, Any]
    ):
        self.form, self.normaliser, self.network = form, normaliser, network
        self.card = dict(card)
        self.file: Path | None = None
        self.name = str(self.card["name"])
        n_features = len(self.card.get("features", normaliser.mean))
        if not n_features == len(normaliser.mean) == network.n_features:
            raise ConfigError(
                f"policy {self.name}: {n_features} features, a normaliser of "
                f"{len(normaliser.mean)} and a network of {network.n_features}"
            )
        if len(self.card.get("decisions", "?" * network.n_decisions)) != network.n_decisions:
            raise ConfigError(
                f"policy {self.name}: {len(self.card['decisions'])} decisions and a network of "
                f"{network.n_decisions}"
            )

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Forget everything; `count` episodes of `scenario` with `ship` begin together.

        Raises
        ------
        ConfigError
            The scenario has other observations or actions than the policy was made for, or the
            autopilot it steers with has no gains of the ship.
        """
        helm = Helm(self.form)
        try:
            helm.reset(count, ship, scenario)
        except ConfigError as error:
            raise ConfigError(f"policy {self.name}: {error}") from error
        self._check_names(helm, scenario)
        self._helm, self._interval = helm, 0
        self._state = self.network.start(count)

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions in [-1, 1], shape (count, n_actions), for observations of the scenario."""
        features = self._helm.look(observations)
        decision = None
        if self._interval % self.form.every == 0:
            scaled = self.normaliser(features)
            decision, self._state = self.network.step(scaled, self._state)
        self._interval += 1
        return self._helm.act(decision)

    def restart(self, rows: np.ndarray) -> None:
        """These rows begin a new episode with the next observations.

        Until the next decision is due, the same for all rows, they sail without one.
        """
        self._helm.restart(rows)
        if self._state is not None:
            self._state[:, rows] = 0.0

    def about(self) -> dict[str, Any]:
        """What stands beside results: form, network and seed of the training."""
        found = {"form": self.form_in_words, "network": self.network.in_words}
        seed = self.card.get("config", {}).get("seed")
        return found | ({} if seed is None else {"seed": seed})

    @property
    def form_in_words(self) -> str:
        """Action, base, interval, features: one phrase."""
        form = self.form
        every = f" every {form.every} intervals" if form.every > 1 else ""
        base = f" on {form.base}" if form.base else ""
        return f"{form.action}{base}{every}, sees {', '.join(form.features)}"

    def _check_names(self, helm: Helm, scenario: Scenario) -> None:
        """Refuse features or decisions of other names than the network was made for."""
        for what, names in (("decisions", helm.decisions), ("features", helm.names)):
            now_named = list(names)
            had = self.card.setdefault(what, list(names))
            if had == now_named:
                continue
            trained = self.card.get("config", {}).get("scenario", {})
            for key, words in (("task", "trained on"), ("control", "trained for control =")):
                now = getattr(scenario, key)
                if trained.get(key, now) != now:
                    raise ConfigError(
                        f"policy {self.name}: {words} {trained[key]!r}, not {now!r}; its {what}: "
                        f"{_difference(had, now_named)}"
                    )
            raise ConfigError(
                f"policy {self.name}: made for other {what} than this version makes for control = "
                f"{scenario.control!r}: {_difference(had, now_named)}"
            )


def _difference(had: list[str], made: list[str]) -> str:
    """The first names that differ."""
    gone = [name for name in had if name not in made]
    new = [name for name in made if name not in had]
    if not gone and not new:
        return "another order"
    parts = [f"{', '.join(gone[:3])} missing" if gone else "", f"{', '.join(new[:3])} new"]
    return " and ".join(part for part in parts[: 2 if new else 1] if part)
