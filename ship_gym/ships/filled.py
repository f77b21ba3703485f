"""What ``estimate = true`` in the section ``hull`` of a ship file fills up."""

from __future__ import annotations

from ship_gym.ships.estimators import (
    ESTIMATED,
    block_coefficient,
    estimated_hull,
    wetted_surface,
)
from ship_gym.ships.ranges import HULL

# Form factor and resistance are left, of which nothing here has a regression, and C_A, which is
# that of the full-scale ship
FILLED = (*ESTIMATED, "S", "k_zz", "C_D")
_C_D = 0.9665


def _of_a_ship(key: str, value: float, why: str) -> tuple[float, str, str]:
    """An estimate, its unit and why; where no ship has it, the nearest published number."""
    allowed = HULL[key]
    if allowed.low <= value <= allowed.high or allowed.published is None:
        return value, "-", why
    low, high = allowed.published
    nearest = min(max(value, low), high)
    return nearest, "-", f"nearest of the ships of the package; {why} has {value:.3g}, of no ship"


def filled_hull(
    L: float, B: float, d: float, volume: float, x_G: float
) -> dict[str, tuple[float, str, str]]:
    """Estimates of everything in `FILLED`.

    Parameters
    ----------
    L, B, d, volume, x_G : float
        As in ``estimators.estimated_hull``.

    Returns
    -------
    dict
        Field of ``particulars.Hull`` to its value, its unit and why it is an estimate.

    A regression that leaves the range of ships is the nearest number of the ships of the package:
    X_vv of short and broad hulls, as of a tug, would drive her when she drifts.

    Raises
    ------
    ConfigError
        As ``estimators.estimated_hull``.
    """
    regressions = estimated_hull(L, B, d, volume, x_G)
    found = {key: _of_a_ship(key, x, why) for key, (x, why) in regressions.items()}
    S = wetted_surface(L, B, d, block_coefficient(L, B, d, volume))
    return found | {
        "S": (S, "m2", "Denny-Mumford, L (1.7 d + C_b B), bare hull"),
        "k_zz": (0.25 * L, "m", "0.25 L; the ships of the package have 0.24 to 0.251"),
        "C_D": (_C_D, "-", "that of the Esso Osaka in sway; only beyond 30 deg of drift"),
    }
