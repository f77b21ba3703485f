"""FormVecEnv: a helm between the environments and the learner.

The learner sees the features of the helm instead of observations, and decides instead of acting;
one of its steps is as many control intervals as a decision is held. What a finished policy does,
the same helm does in training.
"""

from __future__ import annotations

import copy
import itertools
from typing import Any

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper

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
    """Features in, decisions out, for a batch of one ship.

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
        self.helm.reset(venv.num_envs, venv.env.ship, self.scenario)
        columns = observation_columns(self.scenario)
        self._n_plain = len(observations_of(self.scenario.task))
        self._rudder, self._degrees = columns["rudder"], np.degrees(venv.env.ship.gear.delta_max)
        self.n_features = len(self.helm.names)
        width = self.n_features + len(columns) - self._n_plain
        self.choices = None
        action_space = spaces.Box(-1.0, 1.0, (len(self.helm.decisions),), np.float32)
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
        self.helm.restart(np.arange(self.num_envs))
        self._meter.restart(np.arange(self.num_envs), observations[:, self._rudder] * self._degrees)
        self._features = self._look(observations)

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
            live = ~dones
            travel, reversals = self._rudder_moved(observations, ended, told)
            total[live] += (rewards - self.price.cost(travel, reversals, live))[live]
            if ended.any():
                self._end(np.flatnonzero(ended), dones, observations, told, infos)
                dones |= ended
            self._features = self._look(observations)
        return total, dones, infos

    def _rudder_moved(self, observations, ended, told) -> tuple[np.ndarray, np.ndarray]:
        """Travel [deg] and reversals of the interval; the meters of new episodes begin anew."""
        new = observations[:, self._rudder] * self._degrees
        angle = new.copy()
        rows = np.flatnonzero(ended)
        for i in rows:
            angle[i] = told[i]["terminal_observation"][self._rudder] * self._degrees
        moved = self._meter(angle)
        self._meter.restart(rows, new[rows])
        return moved

    def _end(self, rows, dones, observations, told, infos) -> None:
        """Keep the ends of episodes, with features of their last observations."""
        last = observations.copy()
        for i in rows:
            last[i] = told[i]["terminal_observation"]
        features = self._look(last, onward=False)
        for i in rows[~dones[rows]]:
            infos[i] = {**told[i], "terminal_observation": features[i].copy()}
        self.helm.restart(rows)

    def _look(self, observations: np.ndarray, onward: bool = True) -> np.ndarray:
        """What the learner sees; without `onward` the helm stays where it is."""
        helm = self.helm if onward else copy.deepcopy(self.helm)
        features = helm.look(observations[:, : self._n_plain])
        return np.concatenate(
            (features, observations[:, self._n_plain :]), axis=1, dtype=np.float32
        )


class FleetVecEnv(VecEnv):
    """Several `FormVecEnv` side by side, one for each ship: each helm steers one kind of ship.

    Parameters
    ----------
    parts : list of FormVecEnv
        With the same observations and decisions.
    """

    def __init__(self, parts: list[FormVecEnv]):
        self.parts = parts
        count = sum(part.num_envs for part in parts)
        super().__init__(count, parts[0].observation_space, parts[0].action_space)
        ends = np.cumsum([part.num_envs for part in parts])
        self._cuts = ends[:-1]

    def reset(self) -> np.ndarray:
        """Begin new episodes everywhere."""
        for part, seeds in zip(self.parts, self._split(self._seeds), strict=True):
            if seeds[0] is not None:
                part.seed(int(seeds[0]))
        self._reset_seeds()
        return np.concatenate([part.reset() for part in self.parts])

    def step_async(self, actions: np.ndarray) -> None:
        """Hand out the actions."""
        for part, own in zip(self.parts, self._split(actions), strict=True):
            part.step_async(own)

    def step_wait(self):
        """Sail one step, ship after ship."""
        found = [part.step_wait() for part in self.parts]
        observations, rewards, dones, infos = zip(*found, strict=True)
        return (
            np.concatenate(observations),
            np.concatenate(rewards),
            np.concatenate(dones),
            list(itertools.chain(*infos)),
        )

    def _split(self, values: Any) -> list[Any]:
        return np.split(np.asarray(values), self._cuts)

    def close(self) -> None:
        """Release all environments."""
        for part in self.parts:
            part.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Attribute of each environment, by the part that it is in."""
        values = [value for part in self.parts for value in part.get_attr(attr_name)]
        return [values[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of all environments."""
        for part in self.parts:
            part.set_attr(attr_name, value)

    def env_method(self, method_name: str, *method_args, indices: Any = None, **method_kwargs):
        """Call a method of each part."""
        found = [p.env_method(method_name, *method_args, **method_kwargs) for p in self.parts]
        return list(itertools.chain(*found))

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """As `ShipVecEnv` has it."""
        return [wrapped for part in self.parts for wrapped in part.env_is_wrapped(wrapper_class)]
