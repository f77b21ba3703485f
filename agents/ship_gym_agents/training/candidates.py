"""Candidates of Gauss-Newton: sets of weights of a small network that sail the same episodes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from gymnasium.utils import seeding

from ship_gym.config import ConfigError
from ship_gym.envs.env import resolved_scenario
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.evaluation.splits import SPLITS
from ship_gym.ships.loader import load_ship
from ship_gym_agents.forms.helm import Helm
from ship_gym_agents.policies.networks import Mirror, Mlp
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.sb3.config import RunConfig
from ship_gym_agents.sb3.options import GaussNewtonOptions
from ship_gym_agents.training.residuals import residuals_of

MOST_WEIGHTS = 200  # each takes a voyage of all episodes in every iteration
LIMIT = 3.0  # of scaled features: a linear law shall not grow where it has hardly ever been
_FLOOR = 0.05  # of the scale of a feature: one that hardly varies is not blown up to noise


class Layout:
    """Which numbers of a network are free, and the network that they make.

    A linear network that is symmetric has the weights of features with the mirror sign of the
    decision only. A hidden layer makes all of them free; the network is then symmetric by its
    `Mirror`.

    Parameters
    ----------
    helm : Helm
        After its reset.
    hidden : sequence of int
        Sizes of hidden layers.
    activation : str

    Attributes
    ----------
    size : int
        Free numbers.
    """

    def __init__(self, helm: Helm, hidden: Sequence[int], activation: str):
        sizes = [len(helm.names), *hidden, len(helm.decisions)]
        self._shapes = [s for a, b in itertools.pairwise(sizes) for s in ((b, a), (b,))]
        self._activation, self._hidden = activation, bool(hidden)
        free = [np.ones(shape, dtype=np.bool_) for shape in self._shapes]
        self._mirror = None
        if helm.form.symmetric:
            self._mirror = Mirror(helm.signs, helm.decision_signs)
        if self._mirror is not None and not hidden:
            free[0] = helm.decision_signs[:, None] == helm.signs
            free[1] = helm.decision_signs > 0.0
        self._free = np.concatenate([mask.ravel() for mask in free])
        self.size = int(self._free.sum())
        if self.size > MOST_WEIGHTS:
            raise ConfigError(
                f"gauss_newton: {self.size} free weights for {sizes[0]} features and hidden = "
                f"{list(hidden)}; allowed are {MOST_WEIGHTS}: each takes a voyage of all episodes"
            )

    def first(self, seed: int) -> np.ndarray:
        """Weights to begin at, shape (size,): the network's decision is zero."""
        parts = [np.zeros(shape) for shape in self._shapes]
        generator = np.random.default_rng(seed)
        for part in parts[:-2:2]:  # of hidden layers; with zeros all units would stay alike
            part[:] = generator.normal(size=part.shape) / math.sqrt(part.shape[1])
        return np.concatenate([part.ravel() for part in parts])[self._free]

    def network(self, vector: np.ndarray) -> Mlp:
        """The network of free weights, shape (size,)."""
        flat = np.zeros(len(self._free))
        flat[self._free] = vector
        cuts = np.cumsum([math.prod(shape) for shape in self._shapes])[:-1]
        pieces = zip(np.split(flat, cuts), self._shapes, strict=True)
        parts = [piece.reshape(shape) for piece, shape in pieces]
        weights, biases = tuple(parts[::2]), tuple(parts[1::2])
        return Mlp(weights, biases, self._activation, "tanh", self._mirror)

    def vector(self, network: Mlp) -> np.ndarray:
        """Free weights of a network, shape (size,).

        Raises
        ------
        ConfigError
            Other layers than these.
        """
        pairs = zip(network.weights, network.biases, strict=True)
        parts = [part for pair in pairs for part in pair]
        if [part.shape for part in parts] != self._shapes or network.output != "tanh":
            raise ConfigError(
                f"init: a network of layers {[part.shape for part in parts]} and output "
                f"{network.output!r}; this run has {self._shapes} and 'tanh'"
            )
        return np.concatenate([part.ravel() for part in parts])[self._free]


class Voyages:
    """Sails candidates on the same episodes: common random numbers.

    Parameters
    ----------
    config : RunConfig
        Of an algorithm with `GaussNewtonOptions`.

    Attributes
    ----------
    helm : Helm
        For its names and signs.
    seeds : list of int
        Of the episodes, training seeds drawn by the seed of the run.
    price_of_travel : float
        What a policy is chosen by beside the score of its task [unit of the score h/deg].
    samples : int
        Intervals sailed so far, of all episodes.
    """

    def __init__(self, config: RunConfig):
        hyper = config.hyperparameters
        assert isinstance(hyper.algorithm, GaussNewtonOptions)
        self._options, self.form = hyper.algorithm, hyper.form
        duration = self._options.horizon or hyper.training.episode or config.scenario.duration
        overrides = {"duration": duration, **hyper.training.overrides}
        self.scenario, _ = resolved_scenario(config.scenario, None, None, None, False, overrides)
        names = hyper.training.ships or (self.scenario.ship,)
        self._ships = [load_ship(name, surrogate=self.scenario.surrogate) for name in names]
        count, split = self._options.episodes, SPLITS["training"]
        if count % len(names):
            raise ConfigError(
                f"algorithm.episodes = {count}: allowed are multiples of {len(names)}, the number "
                "of training.ships"
            )
        generator = np.random.default_rng(config.seed)
        self.seeds = (split.first + generator.choice(split.size, count, replace=False)).tolist()
        batch = self._batch(1)
        draws = [seeding.np_random(seed)[0].random(batch.n_draws) for seed in self.seeds]
        self._draws, self.samples = np.stack(draws), 0
        self.helm = self._helm(batch)
        self.price_of_travel = residuals_of(batch, self._options).price_of_travel

    def _batch(self, candidates: int) -> EpisodeBatch:
        n = candidates * len(self.seeds)
        # One thread: threads that wait for each other on a shared machine are slower than none.
        return EpisodeBatch(n, self.scenario, self._ships, parallel=False)

    def _helm(self, batch: EpisodeBatch) -> Helm:
        helm = Helm(self.form)
        helm.reset(batch.n, batch.ships, self.scenario)
        return helm

    def scales(self, network: Mlp) -> Normaliser:
        """Normaliser of the features that occur while `network` steers; odd ones keep mean 0."""
        moments = _Moments(len(self.helm.names))
        none = Normaliser(np.zeros(len(self.helm.names)), np.ones(len(self.helm.names)))
        self.sail([network], none, moments)
        odd = self.form.symmetric & (self.helm.signs < 0.0)
        mean = np.where(odd, 0.0, moments.mean)
        spread = np.sqrt(np.maximum(moments.square - mean**2, 0.0))
        return Normaliser(mean, np.maximum(spread, _FLOOR), LIMIT)

    def sail(
        self, networks: Sequence[Mlp], normaliser: Normaliser, moments: _Moments | None = None
    ) -> np.ndarray:
        """Residuals of each candidate and episode, shape (candidates, episodes, R), float32.

        The mean over the episodes of the sum of their squares is the cost.
        """
        batch, n = self._batch(len(networks)), len(self.seeds)
        batch.start(np.arange(batch.n), np.tile(self._draws, (len(networks), 1)))
        helm, residuals = self._helm(batch), residuals_of(batch, self._options)
        steps = self.scenario.steps
        found = np.zeros((steps, residuals.PARTS, batch.n), dtype=np.float32)
        for k in range(steps):
            features = helm.look(batch.observations)
            decision = None
            if k % self.form.every == 0:
                scaled = normaliser(features).reshape(len(networks), n, -1)
                each = [network(own) for network, own in zip(networks, scaled, strict=True)]
                decision = np.concatenate(each)
            residuals.begin()
            self.samples += int(residuals.sailing.sum())
            if moments is not None:
                moments.add(features[residuals.sailing])
            batch.step(helm.act(decision))
            found[k] = residuals.end()
            if not residuals.sailing.any():
                found[k + 1 :] = residuals.end() if k + 1 < steps else 0.0
                break
        found /= math.sqrt(steps)
        return np.moveaxis(found.reshape(-1, len(networks), n), 0, 2)


class _Moments:
    """Means of features and of their squares."""

    def __init__(self, n_features: int):
        self._sums, self._count = np.zeros((2, n_features)), 0

    def add(self, features: np.ndarray) -> None:
        self._sums += features.sum(axis=0), (features * features).sum(axis=0)
        self._count += len(features)

    @property
    def mean(self) -> np.ndarray:
        return self._sums[0] / self._count

    @property
    def square(self) -> np.ndarray:
        return self._sums[1] / self._count
