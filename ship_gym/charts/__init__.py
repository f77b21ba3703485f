"""The earth: lines of constant and of shortest course, and the plane that a route is sailed in."""

from ship_gym.charts.chart import Chart

__all__ = ["Chart"]
