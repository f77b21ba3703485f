"""Response of a ship to waves of given frequencies, from its wave table, as kernels read it."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import G
from ship_gym.sea.components import WaveComponents
from ship_gym.sea.wave_hull import differences
from ship_gym.sea.wave_table import MODES, WaveTable
from ship_gym.ships.files import Named, available_ships
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship

SPEED_STEP = 0.05  # of the Froude number


@functools.lru_cache(maxsize=16)
def _table(path: str, state: tuple[int, ...]) -> WaveTable:
    """The table of a file, read again if its `state` is another one."""
    return WaveTable.load(path)


def wave_table_of(ship: Ship) -> WaveTable:
    """Wave table of a ship at any scale.

    Raises
    ------
    ConfigError
        The ship has none, or that of another hull (``wave_hull.differences``).
    """
    if not ship.wave_table:
        raise ConfigError(
            f"{ship.name} has no wave table, which a sea with waves needs; {_remedy(ship)}"
        )
    table = _table(ship.wave_table, ship.wave_state)
    if apart := _apart(ship):
        raise ConfigError(
            f"{ship.wave_table} was made for {table.card['ship']} with {apart}; {_remedy(ship)}"
        )
    return table


@functools.lru_cache(maxsize=64)  # asked for each sea of each episode
def _apart(ship: Ship) -> str:
    return next(differences(_table(ship.wave_table, ship.wave_state).card, ship), "")


def _remedy(ship: Ship) -> str:
    named = ship.name if ship.name in available_ships() else "SHIP_FILE"
    return (
        f"compute it: ship-gym build-wave-table --ship {named}, or sail without waves, as "
        "in scenario 'heading_slow_disturbance' or by overrides={'sea.states': [], "
        "'sea.gusts': False}"
    )


@dataclasses.dataclass(frozen=True)
class ShipWaves:
    """The wave table of a ship, asked in the ship's own units.

    Attributes
    ----------
    table : WaveTable
        Non-dimensional, for every scale.
    L : float
        Length of the ship [m].
    """

    table: WaveTable
    L: float

    def drift(self, omega, heading, speed, model: str = "blend") -> np.ndarray:
        """Drift coefficients CX, CY, CN (``sea.wave_table``), clamped to the table.

        Parameters
        ----------
        omega : array_like
            True frequency of the waves [rad/s]; broadcast with the next two.
        heading : array_like
            Mu = psi - wave_direction_to [rad], pi in a head sea.
        speed : array_like
            Surge velocity through the water [m/s].
        model : str
            Surge by ``bem``, ``snnm`` or their ``blend``.

        Returns
        -------
        numpy.ndarray
            Shape (*broadcast shape, 3).
        """
        froude, heading, omega = self._scaled(omega, heading, speed)
        return self.table.drift(froude, heading, omega, model)

    def raos(self, omega, heading, speed) -> np.ndarray:
        """Complex motions by A or k A, order of ``sea.wave_table.MODES``; arguments as `drift`."""
        return self.table.rao(*self._scaled(omega, heading, speed))

    def _scaled(self, omega, heading, speed):
        """Froude number, heading and omega sqrt(L/g)."""
        froude = np.asarray(speed, dtype=float) / math.sqrt(G * self.L)
        return froude, heading, np.asarray(omega, dtype=float) * math.sqrt(self.L / G)


def load_wave_table(ship: Named | Ship) -> ShipWaves:
    """Wave table of a ship, by name, ship file or `Ship`: ``load_wave_table("kcs").drift(...)``."""
    found = load_ship(ship)
    return ShipWaves(wave_table_of(found), found.hull.L)


def energy_outside(ship: Ship, waves: WaveComponents) -> float:
    """Share of the waves' energy at frequencies outside the ship's table."""
    omega = waves.omega * math.sqrt(ship.hull.L / G)
    axis = wave_table_of(ship).omega
    outside = (omega < axis[0] * (1.0 - 1e-9)) | (omega > axis[-1] * (1.0 + 1e-9))
    energy = waves.amplitude**2
    return float(energy[outside].sum() / energy.sum()) if energy.any() else 0.0


def wave_response(ship: Ship, omega: np.ndarray, surge_model: str) -> np.ndarray:
    """Drift and motion of a ship in waves of unit amplitude, dimensional.

    Parameters
    ----------
    ship : Ship
    omega : numpy.ndarray
        True frequencies [rad/s], shape (N,). Outside the table its ends hold.
    surge_model : str
        As in ``Sea``.

    Returns
    -------
    numpy.ndarray
        Shape (speeds, headings, 9, N), Froude number every `SPEED_STEP` from 0, headings mu from 0
        to pi: X, Y [N/m2], N about midship [N m/m2]; real and imaginary part of sway [m/m], roll
        and yaw [rad/m].
    """
    table, h = wave_table_of(ship), ship.hull
    k = omega**2 / G
    force = ship.rho * G
    X = force * h.B**2 / h.L * _at(table, table.surge(surge_model), omega, h.L)
    Y = 0.5 * force * h.L * _at(table, table.CY, omega, h.L)
    N = 0.5 * force * h.L**2 * _at(table, table.CN, omega, h.L) + h.x_G * Y
    parts = [X, Y, N]
    for mode, factor in (("sway", 1.0), ("roll", k), ("yaw", k)):
        motion = factor * _at(table, table.motions[..., MODES.index(mode)], omega, h.L)
        parts += [motion.real, motion.imag]
    return np.ascontiguousarray(np.stack(parts, axis=-2), dtype=np.float64)


def _at(table: WaveTable, values: np.ndarray, omega: np.ndarray, L: float) -> np.ndarray:
    """Values (f, h, w) at frequencies [rad/s] and at Froude numbers of equal step, linear."""
    wide = np.promote_types(values.dtype, np.float64)
    values = values.astype(wide)
    x = np.clip(omega * math.sqrt(L / G), table.omega[0], table.omega[-1])
    i = np.clip(np.searchsorted(table.omega, x) - 1, 0, len(table.omega) - 2)
    w = (x - table.omega[i]) / (table.omega[i + 1] - table.omega[i])
    values = (1.0 - w) * values[..., i] + w * values[..., i + 1]
    # the last one at or beyond the table's end, by the slope of its last piece: exact up to the end
    speeds = np.arange(0.0, table.froude[-1] + SPEED_STEP - 1e-9, SPEED_STEP)
    j = np.clip(np.searchsorted(table.froude, speeds) - 1, 0, len(table.froude) - 2)
    q = (speeds - table.froude[j]) / (table.froude[j + 1] - table.froude[j])
    q = q[:, None, None]
    return (1.0 - q) * values[j] + q * values[j + 1]
