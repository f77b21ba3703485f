"""The seas of n episodes: every weather that a scenario may draw is made once, then picked from."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ship_gym.physics.angles import north_east
from ship_gym.scenarios.sea_range import SeaRange
from ship_gym.sea.gusts import turbulence_intensity
from ship_gym.sea.records import Waters, waters
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import numbered

N_CURRENT = 2  # uniform numbers for the current
N_WEATHER = 4  # and, where there are waves or wind, for state, height, wind speed and direction
N_SWELL = 2  # and, where there is a swell, for its height and direction


class Weathers:
    """Draws current, waves and wind of episodes into the arrays of their simulation.

    Parameters
    ----------
    sea : SeaRange
    ships : list of Ship
        One for each episode; episodes of the same one share its tables.

    Attributes
    ----------
    water : sea.records.Waters
        Of the n episodes, for ``ShipSim.set_water``.
    """

    def __init__(self, sea: SeaRange, ships: list[Ship]):
        self.sea = sea
        self._choices = sea.weathers()
        different, numbers = numbered(ships)
        pairs = [
            (ship, choice.sea.scaled(ship.scale)) for ship in different for choice in self._choices
        ]
        # rows of the templates: ship by choice
        self._unit = np.array([ship.time_unit for ship, _ in pairs])
        self._scale = np.array([ship.scale for ship, _ in pairs])
        self._swell = sea.swell_height > 0.0
        self._templates = waters(
            [ship for ship, _ in pairs], [s for _, s in pairs], apart=self._swell
        )
        self._row = np.array(numbers) * len(self._choices)
        self.water: Waters = self._templates.for_ships(self._row)
        seas = [c.sea for c in self._choices]
        self.changes = seas[0].has_waves or any(s.wind_speed > 0.0 for s in seas)
        # of the first system alone, where there is a swell beside it
        firsts = [dataclasses.replace(s, waves=s.waves[:1]) for s in seas]
        self._T_p = np.array([s.period for s in firsts])
        self._H_s = np.array([s.height for s in firsts])
        self._height_min = np.array([c.height_min for c in self._choices])
        self._wind_min = np.array([c.wind_min for c in self._choices])
        self._wind_max = np.array([c.wind_max for c in self._choices])

    @property
    def n_draws(self) -> int:
        """Uniform numbers for one episode, without the phases."""
        weather = (N_WEATHER if self.changes else 0) + (N_SWELL if self._swell else 0)
        return N_CURRENT + weather

    def draw(self, which: np.ndarray, uniform: np.ndarray, psi: np.ndarray, tasks: np.ndarray):
        """Set current, wave amplitudes and wind of some episodes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices, shape (m,).
        uniform : numpy.ndarray
            Numbers in [0, 1), shape (m, n_draws).
        psi : numpy.ndarray
            Ordered heading or bearing of the first leg [rad], shape (m,): what encounter angles
            are counted from.
        tasks : numpy.ndarray
            ``wave_height``, ``wave_period`` and ``wave_to`` are written.

        Returns
        -------
        numpy.ndarray
            Where the waves go to [rad], shape (m,).
        """
        waves_to = np.zeros(len(which))
        records = self.water.records[which]
        if self.changes:
            state, height, wind, towards = uniform[:, N_CURRENT : N_CURRENT + N_WEATHER].T
            pick = (state * len(self._choices)).astype(int)  # state is below 1
            records = self._templates.records[self._row[which] + pick]
            waves_to = self._waves_to(pick, psi, towards)
            self._set_waves(records, which, pick, height, waves_to, tasks)
            if self._swell:
                self._set_swell(records, which, pick, uniform[:, -N_SWELL:], psi, tasks)
            self._set_wind(records, which, pick, wind, waves_to, psi)
        self._set_current(records, which, uniform, psi)
        self.water.records[which] = records
        return waves_to

    @staticmethod
    def _direction(encounter_deg: float | None, psi: np.ndarray, uniform: np.ndarray) -> np.ndarray:
        """Direction to which something goes: any, or at an encounter angle."""
        if encounter_deg is None:
            return math.pi * (2.0 * uniform - 1.0)
        return psi - math.radians(encounter_deg)

    def _set_waves(self, records, which, pick, height, waves_to, tasks) -> None:
        share = self._height_min[pick] + (1.0 - self._height_min[pick]) * height
        records["wave_share"] = share
        tasks["wave_height"][which] = share * self._H_s[pick] / self._scale[self._row[which]]
        tasks["wave_period"][which] = self._T_p[pick] / self._unit[self._row[which]]
        tasks["wave_to"][which] = waves_to

    def _waves_to(self, pick: np.ndarray, psi: np.ndarray, uniform: np.ndarray) -> np.ndarray:
        """Where the waves go to; of a measured spectrum as in the file, if it says so."""
        if self.sea.spectrum_north:
            spectra = [c.sea.spectrum for c in self._choices]
            return np.array([s.mean_direction for s in spectra if s is not None])[pick]
        return self._direction(self.sea.wave_encounter_deg, psi, uniform)

    def _set_swell(self, records, which, pick, uniform, psi, tasks) -> None:
        """Height and direction of the swell; the episode's own are those of all waves together.

        Energies add up; period and direction are those of the higher system.
        """
        sea, row = self.sea, self._row[which]
        low = np.array([c.swell_min for c in self._choices])[pick]
        records["wind_sea"], records["wave_share"] = records["wave_share"], 1.0
        records["swell"] = low + (1.0 - low) * uniform[:, 0]
        towards = self._direction(sea.swell_encounter_deg, psi, uniform[:, 1])
        records["swell_to"] = towards
        one = np.ones(len(which))
        north_east(one, towards, records["swell_north"], records["swell_east"])
        height = records["swell"] * sea.swell_height / self._scale[row]
        period = sea.swell_period / self._unit[row]
        others = tasks["wave_height"][which]
        higher = height > others
        tasks["wave_height"][which] = np.hypot(others, height)
        tasks["wave_period"][which] = np.where(higher, period, tasks["wave_period"][which])
        tasks["wave_to"][which] = np.where(higher, towards, tasks["wave_to"][which])

    def _set_wind(self, records, which, pick, uniform, waves_to, psi) -> None:
        """Wind within its range; of a model slower by the square root of the scale (Froude).

        The templates have the gusts of the largest wind; a smaller one gets its own turbulence
        intensity at the frequencies of the largest.
        """
        low, high = self._wind_min[pick], self._wind_max[pick]
        full = low + (high - low) * uniform
        records["gust_scale"] *= turbulence_intensity(full) / turbulence_intensity(high)
        speed = full / self._unit[self._row[which]]
        towards = waves_to
        if self.sea.wind_encounter_deg is not None:
            towards = self._direction(self.sea.wind_encounter_deg, psi, uniform)
        north_east(speed, towards, records["wind_north"], records["wind_east"])

    def _set_current(self, records, which, uniform, psi) -> None:
        sea = self.sea
        span = sea.current_speed - sea.current_speed_min
        speed = (sea.current_speed_min + span * uniform[:, 0]) / self._unit[self._row[which]]
        towards = self._direction(sea.current_encounter_deg, psi, uniform[:, 1])
        north_east(speed, towards, records["mean_north"], records["mean_east"])
        records["V_north"], records["V_east"] = records["mean_north"], records["mean_east"]
