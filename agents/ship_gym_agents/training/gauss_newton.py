"""A run that learns by Gauss-Newton: least squares over the weights of a small network.

The residuals of a task (``residuals``) are sailed on the same episodes for all candidates
(``candidates``), so their differences are free of the chance of the sea. An iteration moves each
free weight a little (forward differences), solves the damped linear problem (``least_squares``) for
several dampings, sails these and takes the best if it lowers the cost. Where the headroom is
smaller than the noise of a policy gradient, this finds it. An episode may count by its cost at the
beginning: a few hard seas would else decide alone.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import LARGEST, ConfigError
from ship_gym.reading import check_array, read_as, read_npz
from ship_gym_agents.policies.networks import Mlp
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.policies.policy import Policy
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.sb3.options import GaussNewtonOptions
from ship_gym_agents.training.candidates import Layout, Voyages
from ship_gym_agents.training.least_squares import SHARES, next_damping, steps
from ship_gym_agents.training.progress import Progress
from ship_gym_agents.training.run import Run

_FIRST_DAMPING = 1e-2
_LEAST_GAIN = 1e-4  # of the cost, in an iteration
_PATIENCE = 2  # iterations that gain less end the run
_STATE = "gauss_newton.npz"
_SAVED = ("vector", "mean", "scale", "limit", "weights", "counts", "damping")


def learn(
    run: Run, init: str | Path | None, bar: Any, judge: Callable[[Any], dict[str, Any]] | None
) -> dict[str, Any]:
    """Learn to the end of the budget or of the iterations; what there is stays.

    Parameters
    ----------
    run : Run
    init : path, optional
        Policy to begin with, of the same form and layers.
    bar : object, optional
    judge : callable, optional
        Final evaluation of the best policy.

    Returns
    -------
    dict
        The card.
    """
    search = _Search(run, init)
    progress = Progress(run, bar)
    with run.broken_off(lambda: search.samples, search.save):
        run.begin(search.policy, search.save)
        while search.goes_on and run.budget.used(search.samples) < 1.0:
            search.iterate(lambda: progress.show(search.samples, search.told))
            run.between(search.samples, search.policy, search.save, **search.told())
        return run.end(search.samples, search.policy, search.save, judge, **search.told())


class _Search:
    """Weights, normaliser, damping and what they cost; the state of a run."""

    def __init__(self, run: Run, init: str | Path | None):
        config = run.config
        network = config.hyperparameters.network
        assert isinstance(config.hyperparameters.algorithm, GaussNewtonOptions)
        self._run, self._options = run, config.hyperparameters.algorithm
        self._voyages = Voyages(config)
        self._layout = Layout(self._voyages.helm, network.hidden, network.activation)
        # the base is the first policy that is judged: less travel at the same score is a gain
        run.score = run.score._replace(wear=run.score.wear or self._voyages.price_of_travel)
        self._sailed_before = 0
        self._normaliser: Normaliser | None = None
        self._weights: np.ndarray | None = None
        self._base: np.ndarray | None = None  # residuals of the present weights, and their cost
        self._cost: float | None = None
        if run.checkpoint is not None:
            self._load(run.checkpoint / _STATE)
            return
        self._vector = self._layout.first(config.seed)
        self._damping, self._iterations, self._idle = _FIRST_DAMPING, 0, 0
        if init is not None:
            self._take(load_policy(init))

    def _take(self, policy: Policy) -> None:
        """Begin with the weights of a policy."""
        if policy.form != self._voyages.form:
            raise ConfigError(
                f"init: a policy that {policy.form_in_words}; this run has another form"
            )
        network: Any = policy.network  # `vector` refuses other layers
        self._vector = self._layout.vector(network)
        self._normaliser = policy.normaliser

    @property
    def samples(self) -> int:
        """Intervals sailed, earlier parts of the run included."""
        return self._sailed_before + self._voyages.samples

    @property
    def goes_on(self) -> bool:
        """Whether there are iterations left and the last ones gained."""
        return self._iterations < self._options.iterations and self._idle < _PATIENCE

    def told(self) -> dict[str, float]:
        """What the curve tells beside the validation."""
        found = {"iteration": float(self._iterations), "damping": self._damping}
        return found if self._cost is None else found | {"cost": self._cost}

    def iterate(self, tick: Callable[[], None]) -> None:
        """One step; left unfinished, and so without effect, where the budget ends in it.

        Parameters
        ----------
        tick : callable
            Called after each batch of candidates.
        """
        if self._base is None or self._cost is None:
            self._base, self._cost = self._begin()
        jacobian = self._slopes(self._base, tick)
        if jacobian is None:
            return
        dampings = [self._damping * share for share in SHARES]
        ridge = self._options.ridge
        tried = steps(jacobian, self._base, self._vector, dampings, ridge)
        del jacobian
        sailed = self._sail(tried)
        costs = self._costs(sailed, tried)
        best = int(np.argmin(costs))
        self._iterations += 1
        gain = 1.0 - costs[best] / self._cost
        self._idle = 0 if gain > _LEAST_GAIN else self._idle + 1
        self._damping = next_damping(self._damping, dampings[best] if gain > 0.0 else None)
        if gain > 0.0:
            self._vector, self._base = tried[best], sailed[best]
            self._cost = float(costs[best])
        tick()

    def policy(self) -> Policy:
        """The present policy."""
        normaliser, helm = self._scales(), self._voyages.helm
        card: dict[str, Any] = {"name": self._run.name}
        card |= {"features": list(helm.names), "decisions": list(helm.decisions)}
        return Policy(self._voyages.form, normaliser, self._network(self._vector), card)

    def save(self, folder: Path) -> None:
        """Write the state."""
        normaliser = self._scales()
        weights = np.zeros(0) if self._weights is None else self._weights
        np.savez(
            folder / _STATE,
            vector=self._vector,
            mean=normaliser.mean,
            scale=normaliser.scale,
            limit=np.array(normaliser.limit),
            weights=weights,
            counts=np.array([self._iterations, self._idle, self.samples]),
            damping=np.array(self._damping),
            cost=np.array(np.nan if self._cost is None else self._cost),
        )

    def _load(self, file: Path) -> None:
        state = read_npz(file, *_SAVED, what="a state of Gauss-Newton")
        seen = (len(self._voyages.helm.names),)
        shapes: dict[str, tuple[int, ...]] = {"vector": (self._layout.size,), "mean": seen}
        shapes |= {"scale": seen, "counts": (3,)}
        shapes |= {"limit": (), "damping": (), "weights": (len(self._voyages.seeds),)}
        if state["weights"].shape == (0,):  # the episodes were not weighed yet
            shapes["weights"] = (0,)
        for name, shape in shapes.items():
            low = 0.0 if name in ("counts", "damping", "weights") else -LARGEST
            check_array(f"{file}: {name}", state[name], shape, low)
        self._vector, self._damping = state["vector"], float(state["damping"])
        with read_as(file, "a state of Gauss-Newton"):
            self._normaliser = Normaliser(state["mean"], state["scale"], float(state["limit"]))
            self._iterations, self._idle, self._sailed_before = map(int, state["counts"].tolist())
            weights = state["weights"]
            cost = float(state["cost"]) if "cost" in state else np.nan  # older ones have none
        self._weights = weights if len(weights) else None
        self._base, self._cost = None, None if np.isnan(cost) else cost

    def _scales(self) -> Normaliser:
        """The normaliser, made at the first need."""
        if self._normaliser is None:
            self._normaliser = self._voyages.scales(self._network(self._vector))
        return self._normaliser

    def _begin(self) -> tuple[np.ndarray, float]:
        """Residuals of the present weights, sailed, and cost; the first time, weigh the episodes.

        What an earlier part of the run has sailed already is not counted again.
        """
        normaliser = self._scales()
        before = self._voyages.samples
        sailed = self._voyages.sail([self._network(self._vector)], normaliser)
        if self._cost is not None:
            self._sailed_before -= self._voyages.samples - before
        if self._weights is None:
            self._weights = self._weighed(np.square(sailed[0], dtype=np.float64).sum(axis=1))
        base = self._flat(sailed)[0]
        return base, float(self._costs(base[None], self._vector[None])[0])

    def _weighed(self, costs: np.ndarray) -> np.ndarray:
        """Weights of the episodes; their weighed mean cost is the plain one."""
        if not self._options.relative:
            return np.ones(len(costs))
        weights = (costs + np.median(costs) + 1e-12) ** -self._options.relative_power
        return weights * costs.sum() / max((weights * costs).sum(), 1e-12)

    def _network(self, vector: np.ndarray) -> Mlp:
        return self._layout.network(vector)

    def _flat(self, sailed: np.ndarray) -> np.ndarray:
        """Weighed residuals of all episodes, shape (candidates, R)."""
        assert self._weights is not None
        share = np.sqrt(self._weights / sailed.shape[1]).astype(np.float32)
        return (sailed * share[:, None]).reshape(len(sailed), -1)

    def _sail(self, vectors: np.ndarray) -> np.ndarray:
        networks = [self._network(vector) for vector in vectors]
        return self._flat(self._voyages.sail(networks, self._scales()))

    def _costs(self, residuals: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        squares = np.array([np.square(row, dtype=np.float64).sum() for row in residuals])
        return squares + self._options.ridge * (vectors * vectors).sum(axis=1)

    def _slopes(self, base: np.ndarray, tick: Callable[[], None]) -> np.ndarray | None:
        """Slopes of the residuals, shape (P, R); None where the budget has ended."""
        size, nudge = self._layout.size, self._options.step
        found = np.empty((size, len(base)), dtype=np.float32)
        for first in range(0, size, self._options.candidates):
            own = slice(first, first + self._options.candidates)
            moved = self._vector + nudge * np.eye(size)[own]
            found[own] = (self._sail(moved) - base) / nudge
            tick()
            if self._run.budget.used(self.samples) >= 1.0:
                return None
        return found
