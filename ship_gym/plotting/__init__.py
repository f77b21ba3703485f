"""Still pictures (PNG); the only room that imports matplotlib, and never its global state."""

from __future__ import annotations

from ship_gym.plotting.manoeuvre import plot_manoeuvre, plot_turning_circle, plot_zigzag
from ship_gym.plotting.surrogate import plot_surrogate

__all__ = ["plot_manoeuvre", "plot_surrogate", "plot_turning_circle", "plot_zigzag"]
