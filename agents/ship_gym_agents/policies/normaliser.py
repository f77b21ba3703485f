"""Frozen scaling of features before a network sees them."""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.config import LARGEST, SMALLEST, ConfigError


@dataclasses.dataclass(frozen=True, eq=False)
class Normaliser:
    """``clip((features - mean) / scale, -limit, limit)``.

    Attributes
    ----------
    mean, scale : numpy.ndarray
        Of each feature, shape (n_features,).
    limit : float

    Raises
    ------
    ConfigError
        Shapes that differ, a number that is not finite, or a scale that is not positive.
    """

    mean: np.ndarray
    scale: np.ndarray
    limit: float = 10.0

    def __post_init__(self):
        for name in ("mean", "scale"):
            array = np.asarray(getattr(self, name))
            if array.dtype.kind not in "fiu":
                raise ConfigError(f"normaliser: {name} is of type {array.dtype}: allowed: numbers")
            object.__setattr__(self, name, array.astype(np.float64))
        if self.mean.ndim != 1 or self.mean.shape != self.scale.shape:
            raise ConfigError(
                f"normaliser: mean of shape {self.mean.shape}, scale of shape {self.scale.shape}"
            )
        if not np.isfinite([*self.mean, *self.scale, self.limit]).all():
            raise ConfigError("normaliser: a number is not finite")
        if np.any(self.scale <= 0.0) or self.limit <= 0.0:
            raise ConfigError("normaliser: scales and limit must be positive")
        sizes = np.concatenate([np.abs(self.mean), self.scale, [self.limit]])
        if sizes.max() > LARGEST or self.scale.min(initial=1.0) < SMALLEST:
            raise ConfigError(
                f"normaliser: means, scales and limit are at most {LARGEST:g}, scales at least "
                f"{SMALLEST:g}"
            )

    def __call__(self, features: np.ndarray) -> np.ndarray:
        """Scaled features, shape (count, n_features)."""
        return np.clip((features - self.mean) / self.scale, -self.limit, self.limit)


def no_scaling(n_features: int, limit: float = 10.0) -> Normaliser:
    """A normaliser that leaves features as they are, up to its limit."""
    return Normaliser(np.zeros(n_features), np.ones(n_features), limit)
