"""Observations of a voyage that nobody sailed, for tests of what remembers them."""

import numpy as np

from ship_gym.tasks.columns import observation_columns


def measurements(scenario, count, length, seed):
    """Noise with steps of the order in it and a way-point ahead, shape (length, count, columns)."""
    rng, names = np.random.default_rng(seed), list(observation_columns(scenario))
    made = rng.uniform(-0.3, 0.3, (length, count, len(names)))
    column = {name: made[:, :, k] for k, name in enumerate(names)}
    psi = np.cumsum(rng.normal(0.0, 0.01, (length, count)), axis=0)
    psi = psi + rng.choice([0.0, 0.5], (length, count), p=[0.9, 0.1])
    column["sin_error"][:], column["cos_error"][:] = np.sin(psi), np.cos(psi)
    column["surge"][:] += 0.9
    column["propeller"][:] = rng.uniform(0.2, 0.8, (length, count))
    if "to_go" in column:
        column["to_go"][:] = np.linspace(6.0, -0.5, length)[:, None]
    return made
