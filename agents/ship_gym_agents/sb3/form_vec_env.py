"""FormVecEnv: a helm between the environments and the learner.

The learner sees the features of the helm instead of observations, and decides instead of acting;
one of its steps is as many control intervals as a decision is held. What a finished policy does,
the same helm does in training.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.vec_env import VecEnvWrapper

from ship_gym.tasks import observations_of
from ship_gym.tasks.columns import observation_columns
from ship_gym_agents.forms.form import Form
from ship_gym_agents.forms.helm import Helm
from ship_gym_agents.policies.networks import Mirror
from ship_gym_agents.sb3.rudder_price import RudderMeter, RudderPrice
from ship_gym_agents.sb3.sections import Price
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv

_LONGEST = 2000  # intervals in which the travel of the base is measured, at most


class FormVecEnv(VecEnvWrapper):
    """Features in, decisions out, for a batch of ships.

    A step sails ``form.every`` intervals; its reward is the sum of theirs less the price. An
    episode that ends within a step ends the step for its environment: the features of its last
    observation are the ``terminal_observation``, and the new episode sails without a decision, by
    the base alone, until the step is over. Infos are those of `ShipVecEnv`: the return ``r`` of an
    episode is without the price, its length ``l`` in intervals.

    Parameters
    ----------
    venv : ShipVecEnv
        With privileged observations if the critic shall see those columns; they follow the
        features as they are.
    form : Form
    price : Price, optional
    levels : int
        Of each decision, evenly from -1 to 1, for an algorithm that chooses one of several; 0: the
        decisions are numbers.

    Attributes
    ----------
    helm : Helm
    n_features : int
        First columns of an observation of the learner, those of the actor.
    choices : numpy.ndarray or None
        Decisions to choose from, shape (n_choices, n_decisions).
    price : RudderPrice
    """

    def __init__(self, venv: ShipVecEnv, form: Form, price: Price | None = None, levels: int = 0):
        self.form, self.helm, self.scenario = form, Helm(form), venv.env.scenario
        ships = venv.env.ships
        self.helm.reset(venv.num_envs, ships, self.scenario)
        columns = observation_columns(self.scenario)
        self._n_plain = len(observations_of(self.scenario.task))
        self._rudder = columns["rudder"]
        self._hard_over = np.degrees([ship.gear.delta_max for ship in ships])
        self.n_features = len(self.helm.names)
        width = self.n_features + len(columns) - self._n_plain
        self.choices = None
        action_space: spaces.Space = spaces.Box(-1.0, 1.0, (len(self.helm.decisions),), np.float32)
        if levels:
            each = np.linspace(-1.0, 1.0, levels)
            self.choices = np.array(list(itertools.product(each, repeat=len(self.helm.decisions))))
            action_space = spaces.Discrete(len(self.choices))
        seen = spaces.Box(-np.inf, np.inf, (width,), np.float32)
        super().__init__(venv, seen, action_space)
        self._meter = RudderMeter(self.num_envs)
        self.price = RudderPrice(price or Price(), self.scenario.control_interval)
        self._features = np.zeros((self.num_envs, width), dtype=np.float32)

    @property
    def mirror(self) -> Mirror | None:
        """Signs of features and decisions, for a symmetric form."""
        if not self.form.symmetric:
            return None
        return Mirror(self.helm.signs, self.helm.decision_signs)

    def reset(self) -> np.ndarray:
        """Begin new episodes everywhere; features, float32 (n, n_features + privileged)."""
        if self.price.waits_for_limit:
            seeds = list(self.venv._seeds)
            self.price.limit = self._travel_of_base()
            self.venv._seeds = seeds
        self._begin()
        return self._features

    def _begin(self) -> None:
        observations = self.venv.reset()
        everyone = np.arange(self.num_envs)
        self.helm.restart(everyone)
        self._meter.restart(everyone, self._angle(observations))
        self._features = self._seen(self.helm.look, observations)

    def _travel_of_base(self) -> float:
        """Travel without decisions, of the first episodes [deg/h]."""
        self._begin()
        none = np.zeros((self.num_envs, len(self.helm.decisions)))
        for _ in range(-(-min(self.scenario.steps, _LONGEST) // self.form.every)):
            self._sail(none)
        travel = self.price.rate_so_far()
        self.price.forget()
        return travel

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the decisions, or the numbers of those chosen, for `step_wait`."""
        self._decisions = actions if self.choices is None else self.choices[actions]

    def step_wait(self):
        """Sail one step: observations, rewards (n,), dones (n,), infos [n dicts]."""
        rewards, dones, infos = self._sail(np.asarray(self._decisions, dtype=np.float64))
        return self._features, rewards.astype(np.float32), dones, infos

    def _sail(self, decisions: np.ndarray):
        """The intervals of one step."""
        total, dones = np.zeros(self.num_envs), np.zeros(self.num_envs, dtype=np.bool_)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for k in range(self.form.every):
            actions = self.helm.act(decisions if k == 0 else None)
            observations, rewards, ended, told = self.venv.step(actions)
            rows, live = np.flatnonzero(ended), ~dones
            last = _last(observations, rows, told)
            travel, reversals = self._meter(self._angle(last))
            total[live] += (rewards - self.price.cost(travel, reversals, live))[live]
            if len(rows):
                features = self._seen(self.helm.peek, last)
                for i in rows[live[rows]]:
                    infos[i] = told[i]  # changed, not copied: a copy builds all that it tells
                    infos[i]["terminal_observation"] = features[i]
                dones |= ended
                self.helm.restart(rows)
                self._meter.restart(rows, self._angle(observations)[rows])
            self._features = self._seen(self.helm.look, observations)
        return total, dones, infos

    def _angle(self, observations: np.ndarray) -> np.ndarray:
        """Rudder angles [deg], shape (n,)."""
        return observations[:, self._rudder] * self._hard_over

    def _seen(self, look: Callable, observations: np.ndarray) -> np.ndarray:
        """What the learner sees, by the helm's `look` or `peek`."""
        privileged = observations[:, self._n_plain :]
        return np.concatenate((look(observations), privileged), axis=1, dtype=np.float32)


def _last(observations: np.ndarray, rows: np.ndarray, told: list[dict[str, Any]]) -> np.ndarray:
    """Observations at the ends of the interval, also of the episodes that ended with it."""
    if not len(rows):
        return observations
    last = observations.copy()
    for i in rows:
        last[i] = told[i]["terminal_observation"]
    return last
