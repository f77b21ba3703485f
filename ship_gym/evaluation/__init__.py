"""Evaluation: controllers, rollouts, metrics and their statistics."""

from ship_gym.evaluation.comparison import compare, table
from ship_gym.evaluation.metrics import all_metrics, metrics, metrics_of
from ship_gym.evaluation.rollout import Rollout, rollout
from ship_gym.evaluation.splits import SPLITS, evaluation_seeds, seeds_of

__all__ = [
    "SPLITS",
    "Rollout",
    "all_metrics",
    "compare",
    "evaluation_seeds",
    "metrics",
    "metrics_of",
    "rollout",
    "seeds_of",
    "table",
]
