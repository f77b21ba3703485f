"""Ships: particulars with sources, scaling, and the records that the kernels read."""

from ship_gym.ships.files import DATA, available_ships
from ship_gym.ships.loader import available_surrogates, available_variants, load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.scaling import scaled

__all__ = [
    "DATA",
    "Ship",
    "available_ships",
    "available_surrogates",
    "available_variants",
    "load_ship",
    "scaled",
]
