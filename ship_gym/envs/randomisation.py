"""Domain randomisation: another ship for each episode, by writes to columns of its record."""

from __future__ import annotations

import math

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.scenarios.sections import Randomisation
from ship_gym.ships.particulars import Ship

# What is drawn of a ship's surrogate, and the fields that each draw sets: thrust and torque err
# together, by the wake.
SURROGATE_DRAWS = {
    "propeller": ("z_T", "z_Q"),
    "side": ("z_S",),
    "rudder": ("z_N",),
    "chord": ("z_A",),
}
HULL = (
    *("R_0", "X_vv", "X_vr", "X_rr", "X_vvvv"),
    *("Y_v", "Y_r", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr"),
    *("N_v", "N_r", "N_vvv", "N_vvr", "N_vrr", "N_rrr"),
)
# name -> section and fields that one draw multiplies
INTERACTION = {
    "wake": ("propeller", ("w_P0",)),
    "thrust_deduction": ("propeller", ("t_P",)),
    "a_H": ("rudder", ("a_H",)),
    "gamma_R": ("rudder", ("gamma_R_p", "gamma_R_n")),
}
_LOADING = (("hull", ("d",)), ("inertia", ("m_u", "m_v", "m_xG", "I_r")))
_MOST = 0.95  # of wake fraction and thrust deduction drawn: below 1, where nothing is driven
_CUT = 3.0  # to which normal draws are limited, in standard deviations


class ShipDraws:
    """The ships of n episodes; what a distribution of the scenario leaves alone is not drawn.

    Parameters
    ----------
    spread : Randomisation
    records : numpy.ndarray
        Ships of the simulation, shape (n,), which `draw` writes to.
    period : int
        Ships i and i + period are the same one.

    Attributes
    ----------
    names : tuple of str
        What is drawn, ``section.quantity``; one uniform number each.
    values : numpy.ndarray
        What was drawn, shape (n, len(names)): surrogate in standard deviations, all else as a
        factor.
    """

    def __init__(self, spread: Randomisation, records: np.ndarray, period: int):
        self._spread, self._records = spread, records
        self._nominal, self._period = records[:period].copy(), period
        names: list[str] = []
        if spread.surrogate_std > 0.0:
            names += [f"surrogate.{name}" for name in SURROGATE_DRAWS]
        if spread.hull_std > 0.0:
            names += [f"hull.{name}" for name in HULL]
        if spread.interaction_std > 0.0:
            names += [f"interaction.{name}" for name in INTERACTION]
        names += [k for k in ("loading", "gear", "sensors") if getattr(spread, k) > 0.0]
        self.names = tuple(names)
        self.values = np.ones((len(records), len(names)))

    def draw(self, which: np.ndarray, uniform: np.ndarray) -> None:
        """Make other ships of some episodes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices, shape (m,).
        uniform : numpy.ndarray
            Numbers in [0, 1), shape (m, len(names)).
        """
        if not self.names:
            return
        self._records[which] = self._nominal[which % self._period]
        for k, name in enumerate(self.names):
            section, _, quantity = name.partition(".")
            value = self._value(section, uniform[:, k])
            self.values[which, k] = value
            if section == "surrogate":
                for field in SURROGATE_DRAWS[quantity]:
                    self._records["surrogate"][field][which] = value
            else:
                for part, fields in _columns(section, quantity):
                    for field in fields:
                        self._records[part][field][which] *= value

    def _value(self, section: str, uniform: np.ndarray) -> np.ndarray:
        if section in ("loading", "gear", "sensors"):
            return 1.0 + getattr(self._spread, section) * (2.0 * uniform - 1.0)
        from scipy.special import ndtri  # late: a quarter of a second

        z = np.clip(ndtri(uniform), -_CUT, _CUT) * getattr(self._spread, f"{section}_std")
        return z if section == "surrogate" else 1.0 + z

    def sensor_factor(self, which: np.ndarray) -> np.ndarray:
        """Factor of the sensors' noise of some episodes, where it is drawn."""
        return self.values[which, self.names.index("sensors")]

    def set_rudder_rate(self, which: np.ndarray) -> None:
        """Give some ships the rudder rate that they have with everything in order."""
        rate = self._nominal["gear"]["rate"][which % self._period]
        if "gear" in self.names:
            rate = rate * self.values[which, self.names.index("gear")]
        self._records["gear"]["rate"][which] = rate

    def drawn(self) -> dict[str, np.ndarray]:
        """What was drawn by name, arrays of shape (n,)."""
        return {name: self.values[:, k].copy() for k, name in enumerate(self.names)}


def _columns(section: str, quantity: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Sections and fields of a ship's record that one factor multiplies."""
    if section == "hull":
        return (("hull", (quantity,)),)
    if section == "interaction":
        return (INTERACTION[quantity],)
    return {"loading": _LOADING, "gear": (("gear", ("rate",)),), "sensors": ()}[section]


def check_draws(spread: Randomisation, ship: Ship) -> None:
    """Refuse draws of a wake fraction or thrust deduction that no ship has.

    Raises
    ------
    ConfigError
        The largest draw reaches `_MOST`; the message says what the ship allows.
    """
    for name in ("w_P0", "t_P") if spread.interaction_std > 0.0 else ():
        value = getattr(ship.propeller, name)
        if value * (1.0 + _CUT * spread.interaction_std) > _MOST:
            allowed = max((_MOST / value - 1.0) / _CUT, 0.0)
            raise ConfigError(
                f"randomisation.interaction_std = {spread.interaction_std:g}: propeller.{name} = "
                f"{value:g} of {ship.name} would be drawn up to "
                f"{value * (1.0 + _CUT * spread.interaction_std):.2f}; allowed is 0 to "
                f"{math.floor(100.0 * allowed) / 100.0:g}"
            )


def check_has_std(ship: Ship) -> None:
    """Refuse to draw from a surrogate that has no standard deviation.

    Raises
    ------
    ConfigError
        The ship has no surrogate, or one made of printed coefficients.
    """
    table = ship.surrogate
    spread = 0.0
    if table is not None:
        columns = [i for i, name in enumerate(table.names) if "_std" in name]
        spread = float(np.abs(table.values[..., columns]).max())
    if spread == 0.0:
        raise ConfigError(
            f"randomisation.surrogate_std: surrogate {ship.surrogate_name!r} of {ship.name} has no "
            "standard deviation; allowed is 0, or a fitted surrogate such as 'gp'"
        )
