"""The sea: current, waves, wind and a low-frequency disturbance."""

from ship_gym.sea.measured import MeasuredSpectrum
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.spectrum_files import read_spectrum
from ship_gym.sea.state import (
    CALM,
    RegularWave,
    Sea,
    available_seas,
    irregular_sea,
    load_sea,
    measured_sea,
    regular_sea,
)

__all__ = [
    "CALM",
    "MeasuredSpectrum",
    "RegularWave",
    "Sea",
    "WaveSystem",
    "available_seas",
    "irregular_sea",
    "load_sea",
    "measured_sea",
    "read_spectrum",
    "regular_sea",
]
