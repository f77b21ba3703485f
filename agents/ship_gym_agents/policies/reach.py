"""How large the values in a network can become: weights from a file must not make it act nan."""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError
from ship_gym_agents.policies.networks import Mlp, Network

_LARGEST = 1e300  # of what a layer may reach: its sums stay finite


def check_reach(network: Network, limit: float) -> None:
    """Refuse weights so large that a decision could be no number.

    Parameters
    ----------
    network : Mlp or Lstm
    limit : float
        Largest size of a scaled feature.
    """
    if isinstance(network, Mlp):
        head = network
    else:
        _reach("input_weight", limit, network.input_weight, network.gate_bias)
        _reach("hidden_weight", 1.0, network.hidden_weight, network.gate_bias)
        head, limit = network.head, 1.0
    for k, (weight, bias) in enumerate(zip(head.weights, head.biases, strict=True)):
        limit = _reach(f"weight_{k}", limit, weight, bias)
        limit = 1.0 if head.activation == "tanh" else limit


def _reach(name: str, limit: float, weight: np.ndarray, bias: np.ndarray) -> float:
    """Largest size of what a layer gives for values of at most `limit`."""
    with np.errstate(over="ignore"):
        reached = float(np.max(limit * np.abs(weight).sum(axis=1) + np.abs(bias)))
    if reached > _LARGEST:
        raise ConfigError(
            f"network: {name} is so large that its layer can reach {reached:.3g}: allowed is "
            f"{_LARGEST:g}"
        )
    return reached
