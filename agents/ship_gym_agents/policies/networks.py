"""Networks of policies in NumPy: scaled features in, decisions in [-1, 1] out.

Weights are kept as they are in a file, rounded to float32; everything is computed in float64.
A network has ``start(count)``, its state for that many episodes (None if it has no memory), and
``step(features, state)``, which gives decisions and the next state.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known, shown

ACTIVATIONS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "tanh": np.tanh,
    "relu": lambda x: np.maximum(x, 0.0),
}
# How the last layer becomes a decision; argmax: its largest value names one of `levels`.
OUTPUTS = ("clip", "tanh", "argmax")


@dataclasses.dataclass(frozen=True, eq=False)
class Mirror:
    """What changes sign where port and starboard are exchanged.

    Attributes
    ----------
    features, decisions : numpy.ndarray
        +1 or -1 of each feature and each decision.
    """

    features: np.ndarray
    decisions: np.ndarray

    def __post_init__(self):
        for name in ("features", "decisions"):
            signs = np.asarray(getattr(self, name), dtype=np.float64)
            if signs.ndim != 1 or not np.all(np.abs(signs) == 1.0):
                raise ConfigError(f"mirror signs of {name}: allowed are +1 and -1")
            object.__setattr__(self, name, signs)


@dataclasses.dataclass(frozen=True, eq=False)
class Mlp:
    """Multilayer perceptron; one layer alone is a linear law.

    Attributes
    ----------
    weights, biases : tuple of numpy.ndarray
        Of each layer, shapes (outputs, inputs) and (outputs,).
    activation : str
        Key of `ACTIVATIONS`, after each layer but the last.
    output : str
        One of `OUTPUTS`.
    mirror : Mirror, optional
        Then the network is symmetric: a mirrored situation gets the mirrored decision exactly,
        ``(f(x) + d f(s x)) / 2`` before the output, s and d the signs.
    levels : numpy.ndarray, optional
        Decisions to choose from, shape (n_levels, n_decisions); needed by argmax.

    Raises
    ------
    ConfigError
        Shapes that do not fit, weights that are not finite, unknown activation or output.
    """

    weights: tuple[np.ndarray, ...]
    biases: tuple[np.ndarray, ...]
    activation: str = "tanh"
    output: str = "clip"
    mirror: Mirror | None = None
    levels: np.ndarray | None = None

    def __post_init__(self):
        check_known("activation", self.activation, ACTIVATIONS)
        check_known("output", self.output, OUTPUTS)
        for name in ("weights", "biases"):
            rounded = tuple(_single(array) for array in getattr(self, name))
            object.__setattr__(self, name, rounded)
        if self.levels is not None:
            object.__setattr__(self, "levels", _single(self.levels))
        self._check_layers()
        self._check_output()
        _check_finite(self.tensors())

    @property
    def n_features(self) -> int:
        """Number of features."""
        return self.weights[0].shape[1]

    @property
    def n_decisions(self) -> int:
        """Number of decisions."""
        return len(self.biases[-1]) if self.levels is None else self.levels.shape[1]

    def __call__(self, scaled: np.ndarray) -> np.ndarray:
        """Decisions (count, n_decisions) for scaled features (count, n_features)."""
        found = self._layers(scaled)
        if self.mirror is not None:
            other = self._layers(scaled * self.mirror.features)
            found = 0.5 * (found + other * self.mirror.decisions)
        if self.output == "argmax":
            assert self.levels is not None
            return self.levels[np.argmax(found, axis=1)]
        return np.tanh(found) if self.output == "tanh" else np.clip(found, -1.0, 1.0)

    def start(self, count: int) -> None:
        """No memory."""

    def step(self, scaled: np.ndarray, state: np.ndarray | None) -> tuple[np.ndarray, None]:
        """Decisions and the state, which is none."""
        return self(scaled), None

    def tensors(self) -> dict[str, np.ndarray]:
        """All numbers by name, as they are in a file."""
        found = {f"weight_{k}": w for k, w in enumerate(self.weights)}
        found |= {f"bias_{k}": b for k, b in enumerate(self.biases)}
        if self.mirror is not None:
            signs = {"mirror_features": self.mirror.features}
            found |= signs | {"mirror_decisions": self.mirror.decisions}
        return found | ({} if self.levels is None else {"levels": self.levels})

    def about(self) -> dict[str, Any]:
        """What is no number: kind, layers, functions."""
        hidden = [len(bias) for bias in self.biases[:-1]]
        found = {"kind": "mlp", "hidden": hidden, "activation": self.activation}
        return {**found, "output": self.output, "symmetric": self.mirror is not None}

    @property
    def in_words(self) -> str:
        """Kind, sizes of the hidden layers, functions: one phrase."""
        hidden = " x ".join(str(len(bias)) for bias in self.biases[:-1])
        functions = f", {self.activation}, {self.output}" if hidden else f", {self.output}"
        symmetric = ", symmetric" if self.mirror is not None else ""
        return f"{f'mlp {hidden}' if hidden else 'linear'}{functions}{symmetric}"

    def _layers(self, values: np.ndarray) -> np.ndarray:
        activation, last = ACTIVATIONS[self.activation], len(self.weights) - 1
        for k, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            values = _times(values, weight) + bias
            values = activation(values) if k < last else values
        return values

    def _check_layers(self) -> None:
        if not self.weights or len(self.weights) != len(self.biases):
            raise ConfigError(
                f"network: {len(self.weights)} weights and {len(self.biases)} biases of layers"
            )
        if any(weight.ndim != 2 or 0 in weight.shape for weight in self.weights):
            raise ConfigError("network: weights of a layer must have shape (outputs, inputs)")
        for k, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            _check_shape(f"bias_{k}", bias, weight.shape[:1])
            if k > 0:
                _check_shape(f"weight_{k}", weight, (len(bias), len(self.biases[k - 1])))

    def _check_output(self) -> None:
        if (self.output == "argmax") != (self.levels is not None):
            raise ConfigError("network: output argmax needs levels, the others have none")
        if self.levels is not None:
            if self.levels.ndim != 2 or len(self.levels) != len(self.biases[-1]):
                raise ConfigError(
                    f"network: levels of shape {self.levels.shape} for {len(self.biases[-1])} "
                    "values to choose from"
                )
            if self.mirror is not None:
                raise ConfigError("network: output argmax cannot be symmetric")
        if self.mirror is not None:
            _check_shape("mirror_features", self.mirror.features, (self.n_features,))
            _check_shape("mirror_decisions", self.mirror.decisions, (self.n_decisions,))


@dataclasses.dataclass(frozen=True, eq=False)
class Lstm:
    """One layer of long short-term memory, then a perceptron on its hidden values.

    The gates lie one above the other in the order of torch: input, forget, cell, output.

    Attributes
    ----------
    input_weight, hidden_weight, gate_bias : numpy.ndarray
        Shapes (4 n_hidden, n_features), (4 n_hidden, n_hidden), (4 n_hidden,).
    head : Mlp
        Takes n_hidden values; not symmetric.
    """

    input_weight: np.ndarray
    hidden_weight: np.ndarray
    gate_bias: np.ndarray
    head: Mlp

    def __post_init__(self):
        for name in ("input_weight", "hidden_weight", "gate_bias"):
            object.__setattr__(self, name, _single(getattr(self, name)))
        n_hidden = self.head.n_features
        _check_shape("hidden_weight", self.hidden_weight, (4 * n_hidden, n_hidden))
        _check_shape("gate_bias", self.gate_bias, (4 * n_hidden,))
        if self.input_weight.ndim != 2 or len(self.input_weight) != 4 * n_hidden:
            raise ConfigError(
                f"network: input_weight of shape {self.input_weight.shape} for {n_hidden} hidden "
                "values"
            )
        if self.head.mirror is not None:
            raise ConfigError("network: a recurrent network cannot be symmetric")
        _check_finite(self.tensors())

    @property
    def n_features(self) -> int:
        """Number of features."""
        return self.input_weight.shape[1]

    @property
    def n_decisions(self) -> int:
        """Number of decisions."""
        return self.head.n_decisions

    @property
    def n_hidden(self) -> int:
        """Number of hidden values, and of cells."""
        return self.head.n_features

    def start(self, count: int) -> np.ndarray:
        """Hidden values and cells of episodes that begin, shape (2, count, n_hidden)."""
        return np.zeros((2, count, self.n_hidden))

    def step(self, scaled: np.ndarray, state: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Decisions (count, n_decisions) and the next state."""
        assert state is not None
        hidden, cell = state
        gates = _times(scaled, self.input_weight) + _times(hidden, self.hidden_weight)
        gates += self.gate_bias
        enter, forget, new, leave = np.split(gates, 4, axis=1)
        cell = _sigmoid(forget) * cell + _sigmoid(enter) * np.tanh(new)
        hidden = _sigmoid(leave) * np.tanh(cell)
        return self.head(hidden), np.stack((hidden, cell))

    def tensors(self) -> dict[str, np.ndarray]:
        """All numbers by name, as they are in a file."""
        names = ("input_weight", "hidden_weight", "gate_bias")
        return {**self.head.tensors(), **{name: getattr(self, name) for name in names}}

    def about(self) -> dict[str, Any]:
        """What is no number: kind, layers, functions."""
        return {**self.head.about(), "kind": "lstm", "memory": self.n_hidden}

    @property
    def in_words(self) -> str:
        """Kind, size of the memory, the perceptron behind it."""
        return f"lstm {self.n_hidden}, {self.head.in_words}"


Network = Mlp | Lstm
KINDS = ("mlp", "lstm")


def network_from(about: Mapping[str, Any], tensors: Mapping[str, np.ndarray]) -> Network:
    """The network of what ``about()`` and ``tensors()`` gave.

    Raises
    ------
    ConfigError
        Unknown kind, or numbers that do not make such a network.
    KeyError
        Something is missing.
    """
    kind, layers = check_known("kind of network", about["kind"], KINDS), len(about["hidden"]) + 1
    _check_numbers(tensors)
    mirror = None
    if about["symmetric"]:
        mirror = Mirror(tensors["mirror_features"], tensors["mirror_decisions"])
    mlp = Mlp(
        tuple(tensors[f"weight_{k}"] for k in range(layers)),
        tuple(tensors[f"bias_{k}"] for k in range(layers)),
        about["activation"],
        about["output"],
        mirror,
        tensors["levels"] if about["output"] == "argmax" else None,
    )
    sizes = [len(bias) for bias in mlp.biases[:-1]]
    if sizes != list(about["hidden"]):
        raise ConfigError(f"network: hidden = {shown(about['hidden'])}: its layers have {sizes}")
    if kind == "mlp":
        return mlp
    return Lstm(tensors["input_weight"], tensors["hidden_weight"], tensors["gate_bias"], mlp)


def _single(array: np.ndarray) -> np.ndarray:
    """Float64 numbers that float32 holds without loss."""
    with np.errstate(over="ignore"):  # what float32 cannot hold is refused as not finite
        return np.asarray(array, dtype=np.float32).astype(np.float64)


def _times(rows: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """``rows @ weight.T``, each row by itself: a product of the whole would round otherwise.

    So an episode is the same, bit for bit, in a batch of any size.
    """
    return np.matmul(rows[:, None, :], weight.T)[:, 0, :]


def _sigmoid(x: np.ndarray) -> np.ndarray:
    """Logistic function; by tanh, which does not overflow."""
    return 0.5 * (1.0 + np.tanh(0.5 * x))


def _check_numbers(tensors: Mapping[str, np.ndarray]) -> None:
    wrong = [name for name, array in tensors.items() if array.dtype.kind not in "fiu"]
    if wrong:
        raise ConfigError(
            f"network: {shown(wrong[0])} is of type {tensors[wrong[0]].dtype}: allowed are numbers"
        )


def _check_shape(name: str, array: np.ndarray, wanted: tuple[int, ...]) -> None:
    if array.shape != wanted:
        raise ConfigError(f"network: {name} has shape {array.shape}; it must be {wanted}")


def _check_finite(tensors: Mapping[str, np.ndarray]) -> None:
    wrong = [name for name, array in tensors.items() if not np.isfinite(array).all()]
    if wrong:
        raise ConfigError(f"network: {wrong[0]} is not finite")
