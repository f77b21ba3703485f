"""What ``estimate = true`` in the section ``hull`` of a ship file fills up."""

from __future__ import annotations

from ship_gym.ships.estimators import (
    ESTIMATED,
    block_coefficient,
    estimated_hull,
    wetted_surface,
)

# Form factor and resistance are left, of which nothing here has a regression, and C_A, which is
# that of the full-scale ship
FILLED = (*ESTIMATED, "S", "k_zz", "C_D")
_C_D = 0.9665


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

    Raises
    ------
    ConfigError
        As ``estimators.estimated_hull``.
    """
    found = {key: (x, "-", why) for key, (x, why) in estimated_hull(L, B, d, volume, x_G).items()}
    S = wetted_surface(L, B, d, block_coefficient(L, B, d, volume))
    return found | {
        "S": (S, "m2", "Denny-Mumford, L (1.7 d + C_b B), bare hull"),
        "k_zz": (0.25 * L, "m", "0.25 L; the ships of the package have 0.24 to 0.251"),
        "C_D": (_C_D, "-", "that of the Esso Osaka in sway; only beyond 30 deg of drift"),
    }
