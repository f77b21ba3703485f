"""Evaluation: controllers, rollouts, metrics and their statistics."""

from ship_gym.evaluation.metrics import all_metrics, metrics, metrics_of
from ship_gym.evaluation.rollout import Rollout, evaluation_seeds, rollout
from ship_gym.evaluation.statistics import compare, table

__all__ = [
    "Rollout",
    "all_metrics",
    "compare",
    "evaluation_seeds",
    "metrics",
    "metrics_of",
    "rollout",
    "table",
]
