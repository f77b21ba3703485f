"""Evaluation: controllers, rollouts, metrics and their statistics."""

from ship_gym.evaluation.benchmark import benchmark
from ship_gym.evaluation.comparison import compare, table
from ship_gym.evaluation.episodes_table import Results, read_results
from ship_gym.evaluation.metrics import all_metrics, metrics, metrics_of
from ship_gym.evaluation.rollout import Rollout, rollout
from ship_gym.evaluation.splits import SPLITS, evaluation_seeds, seeds_of

__all__ = [
    "Results",
    "SPLITS",
    "Rollout",
    "all_metrics",
    "benchmark",
    "compare",
    "evaluation_seeds",
    "metrics",
    "metrics_of",
    "read_results",
    "rollout",
    "seeds_of",
    "table",
]
