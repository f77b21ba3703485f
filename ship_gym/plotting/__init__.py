"""Still pictures (PNG); the only room that imports matplotlib, and never its global state."""

from __future__ import annotations

try:
    import matplotlib  # noqa: F401  asked for first, to say what to install
except ModuleNotFoundError as error:
    raise ImportError('pictures need matplotlib: pip install "ship-gym[plot]"') from error

from ship_gym.plotting.manoeuvre import plot_manoeuvre, plot_turning_circle, plot_zigzag
from ship_gym.plotting.surrogate import plot_surrogate

__all__ = ["plot_manoeuvre", "plot_surrogate", "plot_turning_circle", "plot_zigzag"]
