"""One-hidden-layer sigmoid network of Knight & Maki (2020), with early stopping, as an ensemble.

Ten sigmoid neurons, a sigmoid output layer, loss 1/2 |y - yhat|^2 averaged over the snapshots. The
inputs are the monomials of J and the angle in rad, as they stand: high powers of a small angle stay
small and do not run away outside the training set; standardised ones are an option. The source
descends by the gradient, in open water of one snapshot after the other, and stops at a tolerance of
the training loss that a validation case chose. Ours: the weights start normal with standard
deviation 1/sqrt(inputs) (it prints no start), Adam over the whole set finds them, and those of the
least validation loss are kept.
Torch trains; `network_outputs` needs numpy only.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.surrogates.regression import FEATURES, features

NEURONS = 10
OUTPUT_RANGE = (0.1, 0.9)  # of a scaled quantity in training: room for the sigmoid on both sides


@dataclasses.dataclass(frozen=True)
class Training:
    """A trained set of networks and how its losses went.

    Attributes
    ----------
    weights : dict
        Plain lists, for `network_outputs`.
    training_squares, validation_squares : numpy.ndarray
        Mean squared error of each output, shape (iterations, members, outputs); row k is before
        the k-th step.
    stopped_at : numpy.ndarray
        Shape (members,): iteration of the least validation loss, whose weights are kept.
    """

    weights: dict[str, Any]
    training_squares: np.ndarray
    validation_squares: np.ndarray
    stopped_at: np.ndarray

    @property
    def training_loss(self) -> np.ndarray:
        """1/2 |y - yhat|^2 averaged over the training set, shape (iterations, members)."""
        return 0.5 * self.training_squares.sum(axis=2)

    @property
    def validation_loss(self) -> np.ndarray:
        """The same over the validation set."""
        return 0.5 * self.validation_squares.sum(axis=2)

    def member(self, k: int) -> Training:
        """Member k as if it had been trained alone."""
        one = slice(k, k + 1)
        layers = {name: self.weights[name][one] for name in ("hidden", "output")}
        squares = self.training_squares[:, one], self.validation_squares[:, one]
        return Training({**self.weights, **layers}, *squares, self.stopped_at[one])


def network_outputs(weights: dict[str, Any], X: np.ndarray) -> np.ndarray:
    """Outputs in (0, 1) of every member, with numpy only.

    Parameters
    ----------
    weights : dict
        ``features`` (name of the set, whose 1 is the bias of the neurons), ``hidden`` (members,
        inputs, neurons), ``output`` (members, neurons + 1, outputs), whose last row is the bias.
    X : numpy.ndarray
        Shape (n, 2): J [-], angle [rad].

    Returns
    -------
    numpy.ndarray
        Shape (members, n, outputs).
    """
    output = np.asarray(weights["output"])
    hidden = _sigmoid(features(X, weights["features"]) @ np.asarray(weights["hidden"]))
    return _sigmoid(hidden @ output[:, :-1] + output[:, -1:])


def _sigmoid(x: np.ndarray) -> np.ndarray:
    return 0.5 * (1.0 + np.tanh(0.5 * x))  # never overflows


def train_network(
    X: np.ndarray,
    Y: np.ndarray,
    X_val: np.ndarray,
    Y_val: np.ndarray,
    *,
    order: str = "network",
    members: int = 1,
    seed: int = 0,
    iterations: int = 5000,
    learning_rate: float = 0.01,
    standardise: bool = False,
) -> Training:
    """Train networks on one set and stop each where its loss on another set is least.

    Parameters
    ----------
    X, Y : numpy.ndarray
        Training inputs (n, 2), J [-] and angle [rad], and outputs (n, outputs) within (0, 1).
    X_val, Y_val : numpy.ndarray
        Validation set, likewise.
    order : str
        Feature set of the inputs, one of `FEATURES`.
    members : int
        Networks that differ in their initial weights.
    seed : int
        The same seed gives the same bits.
    standardise : bool
        Train on inputs of mean 0 and standard deviation 1. The weights in the result are always
        those for the inputs as they stand.
    """
    shares = _two_sets(members, len(X), len(X_val))
    both = np.concatenate([X, X_val]), np.concatenate([Y, Y_val])
    return _train(*both, shares, order, [seed], iterations, learning_rate, standardise)


def train_networks(
    X: np.ndarray,
    Y: np.ndarray,
    X_val: np.ndarray,
    Y_val: np.ndarray,
    seeds: Sequence[int],
    *,
    order: str = "network",
    iterations: int = 5000,
    learning_rate: float = 0.01,
) -> Training:
    """Train a network for each seed at once, each on outputs of its own at the same inputs.

    Member k is what `train_network` gives for ``Y[k]``, ``Y_val[k]`` and ``seeds[k]``, but for the
    rounding of sums.

    Parameters
    ----------
    X, X_val : numpy.ndarray
        Inputs as in `train_network`.
    Y, Y_val : numpy.ndarray
        Outputs within (0, 1), shapes (seeds, n, outputs) and (seeds, n_val, outputs).
    seeds : sequence of int
    order, iterations, learning_rate
        As in `train_network`.
    """
    shares = _two_sets(len(seeds), len(X), len(X_val))
    both = np.concatenate([X, X_val]), np.concatenate([Y, Y_val], axis=1)
    return _train(*both, shares, order, seeds, iterations, learning_rate, standardise=False)


def _two_sets(members: int, n: int, n_val: int) -> np.ndarray:
    """Shares of the points in the losses of training and validation, (2, members, n + n_val)."""
    shares = np.zeros((2, members, n + n_val))
    shares[0, :, :n], shares[1, :, n:] = 1.0 / n, 1.0 / n_val
    return shares


def _train(X, Y, shares, order, seeds, iterations, learning_rate, standardise) -> Training:
    """All members at once; ``shares[0]`` and ``shares[1]`` weigh the points in the two losses.

    One of the `seeds` is for all members together, more are one for each; so are outputs `Y` of
    shape (n, outputs) and (members, n, outputs).
    """
    _check_training(X, Y, shares[0].any(axis=0), order, iterations)
    matrix = features(X, order)
    shift, scale = np.zeros(matrix.shape[1]), np.ones(matrix.shape[1])
    if standardise:  # all but the first feature, 1
        shift[1:], scale[1:] = matrix[:, 1:].mean(axis=0), matrix[:, 1:].std(axis=0)
        scale[scale < 1e-12] = 1.0
    each = shares.shape[1] // len(seeds)
    starts = [_start(each, matrix.shape[1], Y.shape[-1], seed) for seed in seeds]
    layers = _joined(starts)
    layers, squares, stopped_at = _descend(
        (matrix - shift) / scale, Y, shares, layers, iterations, learning_rate
    )
    hidden = layers[0].numpy() / scale[:, None]
    hidden[:, 0] -= shift @ hidden
    weights = {"features": order, "hidden": hidden.tolist(), "output": layers[1].tolist()}
    training, validation = squares.numpy()
    return Training(weights, training, validation, stopped_at.numpy())


def _start(members: int, inputs: int, outputs: int, seed: int) -> list:
    """Weights of both layers before training, from a generator of their own."""
    import torch

    random = torch.Generator().manual_seed(seed)
    layers = []
    for rows, columns in ((inputs, NEURONS), (NEURONS + 1, outputs)):
        normal = torch.randn(members, rows, columns, generator=random, dtype=torch.float64)
        layers.append(normal / math.sqrt(rows))
    return layers


def _joined(starts: list[list]) -> list:
    """Layers of all members, ready to be trained."""
    import torch

    return [torch.cat(layers).requires_grad_() for layers in zip(*starts, strict=True)]


def _descend(matrix, Y, shares, layers, iterations, learning_rate) -> tuple:
    """Adam; the layers of least validation loss, mean squares by iteration, and where that was."""
    import torch

    inputs, targets = torch.from_numpy(matrix), torch.from_numpy(Y)
    weights = torch.from_numpy(shares)[..., None]
    hidden, output = layers
    optimiser = torch.optim.Adam(layers, lr=learning_rate)
    kept = [layer.detach().clone() for layer in layers]
    members, outputs = hidden.shape[0], Y.shape[-1]
    least = torch.full((members,), math.inf, dtype=torch.float64)
    stopped_at = torch.zeros(members, dtype=torch.long)
    history = torch.zeros(2, iterations, members, outputs, dtype=torch.float64)
    for k in range(iterations):
        neurons = torch.sigmoid(inputs @ hidden)
        found = torch.sigmoid(neurons @ output[:, :-1] + output[:, -1:])
        mean_squares = (weights * (found - targets) ** 2).sum(dim=2)
        history[:, k] = mean_squares.detach()
        validation = 0.5 * history[1, k].sum(dim=1)
        better = validation < least
        least, stopped_at[better] = torch.minimum(least, validation), k
        for old, layer in zip(kept, layers, strict=True):
            old[better] = layer.detach()[better]
        optimiser.zero_grad()
        (0.5 * mean_squares[0].sum()).backward()
        optimiser.step()
    return kept, history, stopped_at


def _check_training(X, Y, trained, order, iterations) -> None:
    check_known("network feature set", order, FEATURES)
    if iterations < 1:
        raise ConfigError(f"iterations = {iterations}: allowed is 1 or more")
    if not (np.isfinite(X).all() and np.isfinite(Y).all()):
        raise ConfigError("network training set: J, angle and outputs must be finite numbers")
    low, high = Y[..., trained, :].min(), Y[..., trained, :].max()
    if low <= 0.0 or high >= 1.0:
        raise ConfigError(
            f"network outputs range from {low:g} to {high:g} in training: allowed is within "
            "(0, 1), the reach of a sigmoid; scale them"
        )


def left_out(points: int, members: int, share: float, seed: int) -> np.ndarray:
    """Which points each member leaves out for its early stopping, shape (members, points), bool.

    The points are shuffled and dealt out in turn, so that each is left out about equally often.
    """
    size = max(1, round(share * points))
    if points - size < 1:
        raise ConfigError(f"{points} points: a network needs 2 or more to leave one out")
    rng = np.random.default_rng(seed)
    dealt: list[int] = []
    mask = np.zeros((members, points), dtype=bool)
    for row in mask:
        while row.sum() < size:
            if not dealt:
                dealt = rng.permutation(points).tolist()
            row[dealt.pop()] = True
    return mask


class NeuralNetwork:
    """Ensemble of networks for one quantity behind the surrogate protocol.

    Each member starts from other weights. Without a validation set each leaves another part of
    the training points out for its early stopping, so no other point is ever seen. The quantity
    is scaled so that the training data fill [0.1, 0.9]; a prediction can never leave the range
    that this gives the sigmoid, one eighth of the data's range beyond its ends.

    The defaults were chosen by leave-one-out on the eight KCS points 5-12, without points 1-4. It
    hardly tells one setting from another: 16 to 22 % of a quantity's range for every one tried,
    against 13 % for the second-order regression.

    Attributes
    ----------
    weights : dict
        After `fit`: plain lists, see `network_outputs`, with ``low`` and ``high``, the least and
        largest training value.
    training : Training
        Losses by iteration, after `fit`.
    """

    def __init__(
        self,
        order: str = "network",
        members: int = 16,
        seed: int = 0,
        iterations: int = 1000,
        learning_rate: float = 0.03,
        left_out_share: float = 0.125,
        standardise: bool = True,
        weights: dict[str, Any] | None = None,
    ):
        self.order = order
        self.members = members
        self.seed = seed
        self.iterations = iterations
        self.learning_rate = learning_rate
        self.left_out_share = left_out_share
        self.standardise = standardise
        self.weights = weights
        self.training: Training | None = None

    def fit(self, X, y, X_val=None, y_val=None) -> NeuralNetwork:
        """Fit to X (n, 2) and y (n,); stop on a validation set, or on points left out.

        Raises
        ------
        ConfigError
            Fewer than 2 points, numbers that are not finite, or an unknown feature set.
        """
        X, y = np.atleast_2d(np.asarray(X, dtype=float)), np.asarray(y, dtype=float)
        low, high = float(y.min()), float(y.max())
        if X_val is None:
            out = left_out(len(y), self.members, self.left_out_share, self.seed)
        else:
            out = np.tile(np.arange(len(y) + len(y_val)) >= len(y), (self.members, 1))
            X, y = np.concatenate([X, X_val]), np.concatenate([y, y_val])
        if high == low:
            raise ConfigError(f"all training values are {low:g}: nothing to train a network on")
        masks = np.stack([~out, out])
        shares = masks / masks.sum(axis=2, keepdims=True)
        scaled = OUTPUT_RANGE[0] + (OUTPUT_RANGE[1] - OUTPUT_RANGE[0]) * (y - low) / (high - low)
        options = (self.order, [self.seed], self.iterations, self.learning_rate, self.standardise)
        self.training = _train(X, scaled[:, None], shares, *options)
        self.weights = {**self.training.weights, "low": low, "high": high}
        return self

    def predict(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation of the members at X (n, 2), each of shape (n,)."""
        if self.weights is None:
            raise RuntimeError("NeuralNetwork.predict before fit")
        scaled = network_outputs(self.weights, X)[:, :, 0]
        span = (self.weights["high"] - self.weights["low"]) / (OUTPUT_RANGE[1] - OUTPUT_RANGE[0])
        values = self.weights["low"] + span * (scaled - OUTPUT_RANGE[0])
        return values.mean(axis=0), values.std(axis=0)

    def describe(self) -> dict[str, Any]:
        """What was fitted, as plain data for the card of a table; the weights rebuild it."""
        if self.weights is None:
            raise RuntimeError("NeuralNetwork.describe before fit")
        return {
            "family": "neural network",
            "members": len(self.weights["hidden"]),
            "neurons": NEURONS,
            "iterations": self.iterations,
            "learning_rate": self.learning_rate,
            "left_out_share": self.left_out_share,
            "seed": self.seed,
            "weights": self.weights,
        }
