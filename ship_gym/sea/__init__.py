"""The sea: current, waves, wind and a low-frequency disturbance."""

from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import (
    CALM,
    RegularWave,
    Sea,
    available_seas,
    irregular_sea,
    load_sea,
    regular_sea,
)

__all__ = [
    "CALM",
    "RegularWave",
    "Sea",
    "WaveSystem",
    "available_seas",
    "irregular_sea",
    "load_sea",
    "regular_sea",
]
