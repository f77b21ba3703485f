"""Evaluation: controllers, rollouts, metrics and their statistics."""

from ship_gym.evaluation.metrics import METRICS, metrics
from ship_gym.evaluation.rollout import Rollout, evaluation_seeds, rollout
from ship_gym.evaluation.statistics import compare, table

__all__ = ["METRICS", "Rollout", "compare", "evaluation_seeds", "metrics", "rollout", "table"]
