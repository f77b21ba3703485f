"""Where to compute the next samples: where the model is least sure, and where nothing is yet."""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist, pdist
from scipy.stats import qmc

from ship_gym.surrogates.fit import Fit

GRID = 61  # points along J and along beta on which the largest standard deviation is sought
DRAWS = 200  # Latin hypercubes of which the best is kept


def box_grid(box: tuple[float, float, float, float], count: int = GRID) -> np.ndarray:
    """Points of a regular grid over a box (J from, to; beta from, to [rad]), shape (count^2, 2)."""
    J, beta = np.linspace(*box[:2], count), np.linspace(*box[2:], count)
    return np.stack(np.meshgrid(J, beta, indexing="ij"), axis=-1).reshape(-1, 2)


def relative_std(fit: Fit, side: str, X: np.ndarray) -> dict[str, np.ndarray]:
    """Standard deviation of each quantity over the range of its training values, shapes (n,).

    A model that does not know its own (printed coefficients) is left out, and so is a quantity that
    does not vary.
    """
    found = {}
    for name, values in fit.training[side].values.items():
        std = fit.models[side][name].predict(X)[1]
        if np.isfinite(std).all() and np.ptp(values) > 0.0:
            found[name] = std / np.ptp(values)
    return found


def least_sure(fit: Fit) -> list[dict[str, object]]:
    """Place of the largest standard deviation of every quantity inside the box.

    Returns
    -------
    list of dict
        ``side``, ``quantity``, ``J`` [-], ``beta`` [rad] and ``share``, the standard deviation
        there over the range of the training values; ``quantity`` is ``mean`` for the mean share of
        all quantities of a side. Empty if the models know no standard deviation.
    """
    X = box_grid(fit.data.box)
    found = []
    for side in fit.models:
        shares = relative_std(fit, side, X)
        if shares:
            shares["mean"] = np.mean(list(shares.values()), axis=0)
        for name, share in shares.items():
            k = int(share.argmax())
            place = {"J": float(X[k, 0]), "beta": float(X[k, 1])}
            found.append({"side": side, "quantity": name, **place, "share": float(share[k])})
    return found


def space_filling(
    X: np.ndarray, box: tuple[float, float, float, float], count: int = 4, seed: int = 0
) -> np.ndarray:
    """New points far from each other and from those that are there.

    Of `DRAWS` Latin hypercubes the one whose least distance is largest, with both sides of the box
    scaled to 1 (maximin). Every new point has its own stripe of J and of beta.

    Parameters
    ----------
    X : numpy.ndarray
        Points that are there, J [-] and beta [rad], shape (n, 2).
    box : tuple of float
        J from, to; beta from, to [rad].
    count : int
        Number of new points, 2 or more.
    seed : int
        The same seed gives the same points.

    Returns
    -------
    numpy.ndarray
        J [-] and beta [rad], shape (count, 2), by rising J.
    """
    low, high = np.array(box[0::2]), np.array(box[1::2])
    there = (np.asarray(X, dtype=float) - low) / (high - low)
    rng = np.random.default_rng(seed)
    best, gap = np.empty((0, 2)), -1.0
    for _ in range(DRAWS):
        new = qmc.LatinHypercube(d=2, rng=rng).random(count)
        distance = min(pdist(new).min(), cdist(new, there).min())
        if distance > gap:
            best, gap = new, distance
    return (low + best * (high - low))[best[:, 0].argsort()]


def proposals(fit: Fit, count: int = 4, seed: int = 0) -> dict[str, list[dict[str, object]]]:
    """Where to sample next, as plain data: ``least_sure`` and ``space_filling`` (J, beta [rad])."""
    both = (*fit.training.values(), *fit.validation.values())
    there = np.concatenate([samples.X[:, :2] for samples in both])
    new = space_filling(there, fit.data.box, count, seed)
    return {
        "least_sure": least_sure(fit),
        "space_filling": [{"J": float(J), "beta": float(beta)} for J, beta in new],
    }
