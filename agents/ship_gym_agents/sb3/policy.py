"""SB3Policy: a trained policy as a controller, in one file, run with NumPy alone.

The file is a zip archive of ``card.json`` (what it is and how it was made), ``normaliser.npz`` and
``actor.npz`` (weights of the mean action). It holds arrays and text only, so reading one that
somebody else trained runs none of their code, and needs neither torch nor stable-baselines3.
"""

from __future__ import annotations

import dataclasses
import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.provenance import atomic_path
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import ACTIONS, action_columns, observation_columns

POLICY_FILE = "policy.zip"
FORMAT = 1
ACTIVATIONS = {"tanh": np.tanh, "relu": lambda x: np.maximum(x, 0.0)}
OUTPUTS = {"clip": lambda x: np.clip(x, -1.0, 1.0), "tanh": np.tanh}


@dataclasses.dataclass(frozen=True, eq=False)
class Normaliser:
    """Frozen scaling of observations: ``clip((o - mean) / scale, -limit, limit)``.

    Attributes
    ----------
    mean, scale : numpy.ndarray
        Of each observation, shape (n_observations,).
    limit : float
    """

    mean: np.ndarray
    scale: np.ndarray
    limit: float

    def __call__(self, observations: np.ndarray) -> np.ndarray:
        """Scaled observations, shape (count, n_observations)."""
        return np.clip((observations - self.mean) / self.scale, -self.limit, self.limit)


@dataclasses.dataclass(frozen=True, eq=False)
class Actor:
    """Multilayer perceptron that gives the mean action.

    Attributes
    ----------
    weights, biases : tuple of numpy.ndarray
        Of each layer, shapes (outputs, inputs) and (outputs,).
    activation : str
        Key of `ACTIVATIONS`, after each layer but the last.
    output : str
        Key of `OUTPUTS`: how the last layer becomes an action in [-1, 1].
    """

    weights: tuple[np.ndarray, ...]
    biases: tuple[np.ndarray, ...]
    activation: str
    output: str

    def __call__(self, scaled: np.ndarray) -> np.ndarray:
        """Actions (count, n_actions) for scaled observations (count, n_observations)."""
        activation, last = ACTIVATIONS[self.activation], len(self.weights) - 1
        for k, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            scaled = scaled @ weight.T + bias
            scaled = activation(scaled) if k < last else OUTPUTS[self.output](scaled)
        return scaled


class SB3Policy:
    """A trained policy: mean action, normaliser frozen. Implements ``Controller``.

    Parameters
    ----------
    actor : Actor
    normaliser : Normaliser
    card : mapping
        Where it comes from; ``card["name"]`` is shown in tables.
    """

    def __init__(self, actor: Actor, normaliser: Normaliser, card: Mapping[str, Any]):
        self.actor, self.normaliser, self.card = actor, normaliser, dict(card)
        self.name = str(card["name"])

    @property
    def n_actions(self) -> int:
        """Size of an action."""
        return len(self.actor.biases[-1])

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Check that the policy can steer `scenario`; it has no memory to clear.

        Raises
        ------
        ConfigError
            The scenario has other actions or observations than the policy.
        """
        if len(action_columns(scenario)) != self.n_actions:
            fitting = [name for name, held in ACTIONS.items() if len(held) == self.n_actions]
            raise ConfigError(
                f"policy {self.name} gives {self.n_actions} action(s), control = "
                f"{scenario.control!r} takes {len(action_columns(scenario))}; it was trained for "
                f"control = {fitting[0]!r}"
            )
        names = list(observation_columns(scenario))
        if self.card.get("observations", names) != names:
            raise ConfigError(
                f"policy {self.name}: trained on {self.card['config']['scenario']['task']!r} with "
                f"{len(self.card['observations'])} observations; task {scenario.task!r}, "
                f"privileged = {scenario.privileged}, has {len(names)}"
            )

    def act(self, observations: np.ndarray) -> np.ndarray:
        """Actions in [-1, 1], shape (count, n_actions), for (count, n_observations)."""
        return self.actor(self.normaliser(np.asarray(observations, dtype=np.float64)))


def save_policy(policy: SB3Policy, path: str | Path) -> None:
    """Write a policy as one file, whole or not at all."""
    actor, normaliser = policy.actor, policy.normaliser
    layers = {f"weight_{k}": w for k, w in enumerate(actor.weights)}
    layers |= {f"bias_{k}": b for k, b in enumerate(actor.biases)}
    network = {"layers": len(actor.weights), "activation": actor.activation, "output": actor.output}
    card = {**policy.card, "format": FORMAT, "network": network}
    scaling = {"mean": normaliser.mean, "scale": normaliser.scale, "limit": normaliser.limit}
    with atomic_path(path) as temporary, zipfile.ZipFile(temporary, "w") as archive:
        archive.writestr("card.json", json.dumps(card, indent=1))
        archive.writestr("normaliser.npz", _npz(scaling))
        archive.writestr("actor.npz", _npz(layers))


def load_policy(path: str | Path) -> SB3Policy:
    """Read a trained policy.

    Parameters
    ----------
    path : str or path
        The folder of a run or its ``policy.zip``.

    Raises
    ------
    ConfigError
        No such file, not a policy, damaged, or made for other observations.
    """
    path = Path(path)
    file = path / POLICY_FILE if path.is_dir() else path
    if not file.is_file():
        raise ConfigError(f"{file}: no such policy; train one with: ship-gym train")
    try:
        with zipfile.ZipFile(file) as archive:
            card = json.loads(archive.read("card.json"))
            layers = _arrays(archive.read("actor.npz"))
            scaling = _arrays(archive.read("normaliser.npz"))
        policy = SB3Policy(_actor(card, layers), _normaliser(scaling), card)
    except (zipfile.BadZipFile, KeyError, ValueError, EOFError, OSError) as error:
        raise ConfigError(f"{file}: not a policy, or damaged: {error}") from error
    _check(policy, file)
    return policy


def _actor(card: dict[str, Any], layers: dict[str, np.ndarray]) -> Actor:
    network = card["network"]
    check_known("activation", network["activation"], ACTIVATIONS)
    check_known("output", network["output"], OUTPUTS)
    order = range(network["layers"])
    return Actor(
        tuple(layers[f"weight_{k}"] for k in order),
        tuple(layers[f"bias_{k}"] for k in order),
        network["activation"],
        network["output"],
    )


def _normaliser(scaling: dict[str, np.ndarray]) -> Normaliser:
    return Normaliser(scaling["mean"], scaling["scale"], float(scaling["limit"]))


def _check(policy: SB3Policy, file: Path) -> None:
    if policy.card["format"] != FORMAT:
        raise ConfigError(
            f"{file}: made for format {policy.card['format']}; this version has format {FORMAT}"
        )
    names, width = policy.card["observations"], policy.actor.weights[0].shape[1]
    if len(names) != width or policy.normaliser.mean.shape != (width,):
        raise ConfigError(
            f"{file}: not a policy, or damaged: {len(names)} observations for {width} inputs"
        )
    arrays = (*policy.actor.weights, *policy.actor.biases, policy.normaliser.scale)
    if not all(np.isfinite(a).all() for a in arrays):
        raise ConfigError(f"{file}: not a policy, or damaged: weights are not finite")


def _npz(arrays: Mapping[str, Any]) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **{name: np.asarray(a, dtype=np.float64) for name, a in arrays.items()})
    return buffer.getvalue()


def _arrays(data: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(data), allow_pickle=False) as found:
        return {name: found[name] for name in found.files}
