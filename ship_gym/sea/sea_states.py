"""Named sea states 0 to 8: wave height, peak period and wind of the NATO North Atlantic table."""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path

from ship_gym.config import ConfigError, shown
from ship_gym.csv_file import read_csv
from ship_gym.sea.spectra import WaveSystem

_TABLE = Path(__file__).with_name("sea_states.csv")


@dataclasses.dataclass(frozen=True)
class SeaState:
    """One row of ``sea_states.csv``, in SI.

    Attributes
    ----------
    height, height_min, height_max : float
        Significant wave height: mean and range [m].
    wind, wind_min, wind_max : float
        Sustained wind speed at 19.5 m above the sea: mean and range [m/s].
    peak_period, period_min, period_max : float
        Most probable T_p and its 5 and 95 percentiles [s]; 0 where the table has none.
    """

    number: int
    height: float
    height_min: float
    height_max: float
    wind: float
    wind_min: float
    wind_max: float
    peak_period: float
    period_min: float
    period_max: float

    def wind_speed(self, height: float = 10.0) -> float:
        """Mean wind [m/s] at a height above the sea [m], by the table's own 1/7 power law."""
        return self.wind * (height / 19.5) ** (1.0 / 7.0)

    def waves(self, spectrum: str = "bretschneider", spreading: float = 0.0) -> WaveSystem:
        """Waves of mean height and most probable period; sea states 0 and 1 have no period."""
        if self.peak_period == 0.0:
            raise ConfigError(
                f"sea_state = {self.number}: the table prints no wave period; waves from 2 to 8"
            )
        return WaveSystem(spectrum, self.height, self.peak_period, spreading=spreading)


@functools.lru_cache(maxsize=1)
def sea_states() -> dict[int, SeaState]:
    """All sea states by number."""
    table = read_csv(_TABLE)
    names = [f.name for f in dataclasses.fields(SeaState) if f.name != "number"]
    columns = [table.si(name) for name in names]
    numbers = table.si("sea_state")
    return {
        int(number): SeaState(int(number), *(float(column[i]) for column in columns))
        for i, number in enumerate(numbers)
    }


def sea_state(number: int) -> SeaState:
    """Sea state 0 to 8; anything else is a ConfigError."""
    known = sea_states()
    if isinstance(number, bool) or number not in known:
        raise ConfigError(f"sea_state = {shown(number)}: allowed is {min(known)} to {max(known)}")
    return known[number]
