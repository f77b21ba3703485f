"""The helm: observations become features, decisions become actions; for a batch of episodes.

The same helm serves training and the finished policy, so a feature cannot mean two things.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import observation_columns
from ship_gym_agents.forms.form import Form
from ship_gym_agents.forms.look import twin
from ship_gym_agents.forms.watchkeeper import Watchkeeper
from ship_gym_agents.fresh import indices


class Helm:
    """What stands between environment and learner, see ``docs/policy_forms.md``.

    Each interval: one `look`, then one `act`. `restart` and `peek` may come between `act` and the
    next `look`.

    Parameters
    ----------
    form : Form

    Attributes
    ----------
    names : tuple of str
        Of the F features, ``block.feature``, with ``@3`` behind those of three decisions ago;
        known after `reset`, as the following ones.
    signs : numpy.ndarray
        Mirror signs of the features, shape (F,): +1 even, -1 odd, nan unknown.
    decisions : tuple of str
        What a decision holds: ``rudder`` or ``heading``, and ``rpm`` where the learner sets it.
    decision_signs : numpy.ndarray
        Their mirror signs, shape (A,).
    """

    def __init__(self, form: Form):
        self.form = form

    def reset(self, count: int, ship: Ship | Sequence[Ship], scenario: Scenario) -> None:
        """Forget everything; `count` episodes of `scenario` begin together.

        Parameters
        ----------
        count : int
        ship : Ship or sequence of Ship
            One for all, or that of each episode (a mixed fleet).
        scenario : Scenario

        Raises
        ------
        ConfigError
            The form does not fit the scenario: control, observations, base, unknown mirror signs.
        """
        plain = dataclasses.replace(scenario, privileged=False)
        self._width = len(observation_columns(plain))
        self._crews = [
            (rows, Watchkeeper(self.form, n, one, plain)) for rows, n, one in _kinds(count, ship)
        ]
        first = self._crews[0][1]
        self.names, self.signs = tuple(first.names), np.array(first.signs)
        self.decisions = first.action.decisions
        self.decision_signs = np.array([1.0 if d == "rpm" else -1.0 for d in self.decisions])
        unknown = [n for n, s in zip(self.names, self.signs, strict=True) if np.isnan(s)]
        if self.form.symmetric and unknown:
            raise ConfigError(
                f"form.symmetric: the mirror sign of {', '.join(unknown)} is not known; give "
                f"`mirror` in the rows of task {scenario.task!r}, or symmetric = false"
            )

    def restart(self, rows: np.ndarray) -> None:
        """These rows begin a new episode with the next look; indices, or a mask (count,)."""
        rows = indices(rows)
        for own, crew in self._crews:
            here = rows if isinstance(own, slice) else np.flatnonzero(np.isin(own, rows))
            if len(here):
                crew.restart(here)

    def look(self, observations: np.ndarray) -> np.ndarray:
        """Features, shape (count, F), float64; once an interval.

        Parameters
        ----------
        observations : numpy.ndarray
            Of the environment, shape (count, columns); privileged columns behind are cut off.
        """
        return self._each(observations, [crew for _, crew in self._crews])

    def peek(self, observations: np.ndarray) -> np.ndarray:
        """The features that `look` would give, shape (count, F), without taking the measurement.

        For the last moment of an episode, beside which the next one has begun already.
        """
        return self._each(observations, [twin(crew) for _, crew in self._crews])

    def act(self, decision: np.ndarray | None = None) -> np.ndarray:
        """Actions in [-1, 1], shape (count, n_actions).

        Parameters
        ----------
        decision : numpy.ndarray, optional
            Shape (count, A), limited to [-1, 1]; None: the last one is held. 0 lets the base steer
            alone, as it does until the first decision of an episode.
        """
        if decision is not None:
            decision = np.clip(np.asarray(decision, dtype=np.float64), -1.0, 1.0)
        made = [
            crew.act(None if decision is None else decision[rows]) for rows, crew in self._crews
        ]
        return self._merged(made)

    def _each(self, observations: np.ndarray, crews: list[Watchkeeper]) -> np.ndarray:
        plain = np.asarray(observations)[:, : self._width].astype(np.float64)
        parts = zip(self._crews, crews, strict=True)
        return self._merged([crew.look(plain[rows]) for (rows, _), crew in parts])

    def _merged(self, parts: list[np.ndarray]) -> np.ndarray:
        """Rows of the kinds of ships in the order of the episodes."""
        if len(parts) == 1:
            return parts[0]
        whole = np.empty((sum(map(len, parts)), parts[0].shape[1]))
        for (rows, _), part in zip(self._crews, parts, strict=True):
            whole[rows] = part
        return whole


def _kinds(count: int, ship: Ship | Sequence[Ship]):
    """Rows, number and ship of each kind of ship."""
    if isinstance(ship, Ship):
        return [(slice(None), count, ship)]
    ships = list(ship)
    if len(ships) != count:
        raise ConfigError(f"helm: {len(ships)} ships for {count} episodes; one for each is needed")
    kinds: list[Ship] = []
    which = []
    for one in ships:
        known = next((k for k, kind in enumerate(kinds) if kind is one), None)
        if known is None:
            known = len(kinds)
            kinds.append(one)
        which.append(known)
    if len(kinds) == 1:
        return [(slice(None), count, kinds[0])]
    rows = [np.flatnonzero(np.array(which) == k) for k in range(len(kinds))]
    return [(own, len(own), kind) for own, kind in zip(rows, kinds, strict=True)]
