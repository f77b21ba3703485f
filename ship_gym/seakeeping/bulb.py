"""The bulbous bow of a drawn hull: half an ellipsoid ahead of the forward perpendicular.

Its numbers are those in which bulbs are described (Kracht 1978): length ahead of the perpendicular,
sectional area and breadth there, height of the foremost point. At a distance of t times its length
ahead of the perpendicular the section is an ellipse

    area = a (1 - t^2),  breadth = b sqrt(1 - t^2),  middle = z + (z_nose - z) t^2,

and behind the perpendicular it fades into the hull like an ellipsoid three times as long.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.ships.particulars import Ship

_BEHIND = 3.0  # lengths of the bulb in which it fades behind the perpendicular; of our own choice


@dataclasses.dataclass(frozen=True)
class Bulb:
    """Bulb of a ship [m], x forward of midship, z down from the waterline.

    Attributes
    ----------
    x : float
        Forward perpendicular.
    length : float
        Ahead of it.
    half_breadth, half_height, z : float
        Half axes and middle of the ellipse at the perpendicular.
    z_nose : float
        Foremost point.
    """

    x: float
    length: float
    half_breadth: float
    half_height: float
    z: float
    z_nose: float

    @property
    def area(self) -> float:
        """Sectional area at the perpendicular [m2]."""
        return np.pi * self.half_breadth * self.half_height

    @property
    def volume(self) -> float:
        """Volume ahead of the perpendicular [m3]."""
        return self.area * self.length * 2.0 / 3.0

    @property
    def centre(self) -> float:
        """Centre of that volume, x [m]."""
        return self.x + 0.375 * self.length

    def size(self, x: np.ndarray | float) -> np.ndarray:
        """Area by that at the perpendicular, shape of x [m]."""
        t = (np.asarray(x) - self.x) / self.length
        t = np.where(t < 0.0, t / _BEHIND, t)
        return np.clip(1.0 - t**2, 0.0, 1.0)

    def middle(self, x: float) -> float:
        """Depth of the middle of the section at x [m]."""
        t = max(x - self.x, 0.0) / self.length
        return self.z + (self.z_nose - self.z) * t**2

    def bottom(self, x: float) -> float:
        """Depth of the lowest point of the section at x [m]."""
        return self.middle(x) + self.half_height * float(np.sqrt(self.size(x)))

    def half_breadths(self, x: float, z: np.ndarray) -> np.ndarray:
        """Half breadth of the section at x at depths z [m], 0 above and below it."""
        scale = float(np.sqrt(self.size(x)))
        if scale == 0.0:
            return np.zeros_like(z)
        r = (z - self.middle(x)) / (scale * self.half_height)
        return scale * self.half_breadth * np.sqrt(np.clip(1.0 - r**2, 0.0, 1.0))

    def outline(self, x: float, count: int = 100) -> np.ndarray:
        """Section ahead of the perpendicular from its lowest to its highest point, y, z [m]."""
        scale = float(np.sqrt(self.size(x)))
        angle = np.linspace(0.0, np.pi, count)
        y = scale * self.half_breadth * np.sin(angle)
        z = self.middle(x) + scale * self.half_height * np.cos(angle)
        y[[0, -1]] = 0.0
        return np.stack([y, z], axis=-1)


def ship_bulb(ship: Ship) -> Bulb | None:
    """The bulb of a ship by the section ``form`` of its file; None if it has none.

    Raises
    ------
    ConfigError
        It would reach out of the water or below the keel.
    """
    form, hull = ship.form, ship.hull
    if form is None or form.l_bulb == 0.0:
        return None
    area, half_breadth = form.a_bulb * form.C_m * hull.B * hull.d, 0.5 * form.b_bulb * hull.B
    half_height = area / (np.pi * half_breadth)
    bulb = Bulb(
        x=0.5 * hull.L,
        length=form.l_bulb,
        half_breadth=half_breadth,
        half_height=half_height,
        z=hull.d * (1.0 - form.z_bulb),
        z_nose=hull.d * (1.0 - form.z_nose),
    )
    share = half_height / hull.d
    if not share <= form.z_bulb <= 1.0 - share:
        raise ConfigError(
            f"{ship.name}: form.z_bulb = {form.z_bulb}: the bulb is {2.0 * share:.3f} d high (area "
            f"by breadth): allowed is {share:.3f} to {1.0 - share:.3f}; or change a_bulb, b_bulb"
        )
    return bulb
