"""An exported ONNX model beside the policy it was made from."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ship_gym.reading import read_as, read_bytes
from ship_gym_agents.policies.networks import Lstm
from ship_gym_agents.policies.policy import Policy

_COUNT, _STEPS = 64, 20


def largest_difference(policy: Policy, path: str | Path, seed: int = 0) -> float | None:
    """Largest difference of their decisions over random features; None without onnxruntime.

    The features are drawn from the normaliser's distribution, twice as wide; a network with memory
    takes several steps. The differences are those between float32 and float64.
    """
    try:
        import onnxruntime
    except ModuleNotFoundError:
        return None
    data = read_bytes(path)
    with read_as(path, "an ONNX model"):
        session = onnxruntime.InferenceSession(data, providers=["CPUExecutionProvider"])
    generator = np.random.default_rng(seed)
    network, normaliser = policy.network, policy.normaliser
    state, apart = network.start(_COUNT), 0.0
    memory = {}
    if isinstance(network, Lstm):
        zeros = np.zeros((_COUNT, network.n_hidden), dtype=np.float32)
        memory = {"hidden": zeros, "cell": zeros}
    for _ in range(_STEPS):
        drawn = generator.normal(0.0, 2.0, (_COUNT, network.n_features))
        features = (normaliser.mean + normaliser.scale * drawn).astype(np.float32)
        decision, state = network.step(normaliser(features.astype(np.float64)), state)
        theirs, *rest = session.run(None, {"features": features, **memory})
        memory = dict(zip(memory, rest, strict=True))
        apart = max(apart, float(np.abs(theirs - decision).max()))
    return apart
