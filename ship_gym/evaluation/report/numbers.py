"""INTERIM: what evaluation/score.py and statistics.py of branch `scores` will provide."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

LEAST = 1.05
_RESAMPLES = 5000


def normalised(x: float, nothing: float, reference: float) -> float | None:
    """Score 100 ln(nothing / x) / ln(nothing / reference)."""
    if min(x, nothing, reference) <= 0.0 or nothing / reference < LEAST:
        return None
    return 100.0 * math.log(nothing / x) / math.log(nothing / reference)


def read_references(path: Path | None = None) -> dict[str, dict]:
    """Cells of shipbench_1.json; empty without the file."""
    path = path or Path(__file__).parents[1] / "shipbench_1.json"
    return json.loads(path.read_text())["cells"] if path.exists() else {}


def holm(p: Sequence[float]) -> list[float]:
    """Adjusted p."""
    p = np.asarray(p, float)
    order = np.argsort(p)
    adjusted = np.maximum.accumulate((len(p) - np.arange(len(p))) * p[order]).clip(max=1.0)
    out = np.empty(len(p))
    out[order] = adjusted
    return out.tolist()


def sign_flip(differences: np.ndarray) -> float:
    """Two-sided p of the mean of paired differences."""
    rng = np.random.default_rng(0)
    signs = rng.choice([-1.0, 1.0], size=(_RESAMPLES, len(differences)))
    drawn = np.abs((signs * differences).mean(axis=1))
    return float(
        (1 + np.count_nonzero(drawn >= abs(differences.mean()) - 1e-15)) / (_RESAMPLES + 1)
    )


def resampled_middles(values: np.ndarray, seed: int) -> np.ndarray:
    """Interquartile means of resamples, shape (resamples,)."""
    rng = np.random.default_rng(seed)
    n = len(values)
    drawn = np.sort(values[rng.integers(0, n, (_RESAMPLES, n))], axis=1)
    return drawn[:, n // 4 : n - n // 4].mean(axis=1)
