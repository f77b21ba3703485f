"""Metrics of one episode (``ship_gym.tasks.metrics``), under the name by which users know them."""

from ship_gym.tasks.metrics import all_metrics, metrics, metrics_of

__all__ = ["all_metrics", "metrics", "metrics_of"]
