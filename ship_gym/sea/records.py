"""Seas as numpy records and arrays, the form the kernels read.

The disturbance is a random low-frequency sway force and yaw moment. Its spectrum is that of a
first-order low-pass process, one-sided,

    S(omega) = (2 / pi) T / (1 + (omega T)^2),

with the time T = `correlation_time` L / U0. It is sampled by `N_HARMONICS` harmonics k omega_1 of
omega_1 = 0.4 / T, with amplitudes sqrt(2 S(k omega_1) omega_1) scaled to unit variance and phases
drawn at reset. It repeats after 15.7 T (about 970 s for KCS at 14.5 kn), more than an episode.
Standard deviations are given non-dimensional, by 1/2 rho L d U0^2 and 1/2 rho L^2 d U0^2.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import G
from ship_gym.physics.disturbance import draw_disturbance
from ship_gym.physics.quantities import record_type
from ship_gym.physics.scratch import GUST_COLUMNS, N_GUSTS, in_lines
from ship_gym.physics.step import Water
from ship_gym.physics.waves import EIGHT_WAVES, Waves
from ship_gym.sea.components import WaveComponents
from ship_gym.sea.gusts import gust_harmonics
from ship_gym.sea.phases import BEFORE_WAVES, N_DISTURBANCE, N_HARMONICS
from ship_gym.sea.state import CALM, Sea
from ship_gym.sea.wave_response import (
    SPEED_STEP,
    energy_outside,
    wave_response,
    wave_table_of,
)
from ship_gym.sea.wind_coefficients import wind_table
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import numbered

_FIRST = 0.4  # omega_1 T: 90 % of the spectrum's variance lies below the last harmonic

SEA_DTYPE = record_type(
    [
        # what every step reads stands together, in the first cache lines
        ("V_north", np.float64),  # current now, and its mean and slow variation
        ("V_east", np.float64),
        ("disturbed", np.int64),
        ("wavy", np.int64),
        ("windy", np.int64),
        ("variation", np.float64),
        ("response", np.int64),
        ("wind_table", np.int64),
        ("omega_1", np.float64),
        ("Y_std", np.float64),
        ("N_std", np.float64),
        ("mean_north", np.float64),
        ("mean_east", np.float64),
        ("variation_omega", np.float64),
        ("variation_phase", np.float64),
        ("drift", np.float64),  # 1 with drift, 0 without
        ("mean_drift", np.int64),
        ("speed_step", np.float64),  # of the response table, and its largest [m/s]
        ("speed_max", np.float64),
        ("waves_outside", np.float64),  # share of the waves' energy outside the table
        ("A_F", np.float64),  # areas and length that the wind sees [m2], [m]
        ("A_L", np.float64),
        ("L_oa", np.float64),
        ("wind_north", np.float64),  # mean wind velocity [m/s]
        ("wind_east", np.float64),
        ("gust_scale", np.float64),  # of the shares of the gusts' harmonics
        ("wave_share", np.float64),  # height of the waves by that of their components
        ("wave_to", np.float64),  # where they go to, from north [rad],
        ("wave_north", np.float64),  # and its cosine and sine: set_direction
        ("wave_east", np.float64),
        ("wind_sea", np.float64),  # height of the first system by that of its components,
        ("swell", np.float64),  # and of a swell apart, with where it goes to
        ("swell_to", np.float64),
        ("swell_north", np.float64),
        ("swell_east", np.float64),
    ]
)


@dataclasses.dataclass(frozen=True)
class Waters:
    """What surrounds n ships.

    What the seas of many ships have in common, such as the components of their waves, is there
    once for each different pair of ship and sea; `records` says which.

    Attributes
    ----------
    records : numpy.ndarray
        SEA_DTYPE, shape (n,).
    waves : physics.waves.Waves
    columns : numpy.ndarray
        Where the waves stand in the arrays of `waves`, the rest of which fills up: shape (N,).
    winds : numpy.ndarray
        Wind coefficients, shape (kinds, 181, 3).
    gusts, gust_phases : numpy.ndarray
        Share and frequency [rad/s] of the gusts' harmonics, shape (kinds, 2, K), and their phases
        [turns], shape (n, K); K = 0 where no ship has gusts.
    harmonics : numpy.ndarray
        Of the disturbance, shape (n, 4, H); H = 0 where there is none.
    """

    records: np.ndarray
    waves: Waves
    columns: np.ndarray
    winds: np.ndarray
    gusts: np.ndarray
    gust_phases: np.ndarray
    harmonics: np.ndarray

    @property
    def n_waves(self) -> int:
        """Number of waves."""
        return len(self.columns)

    @property
    def n_phases(self) -> int:
        """Uniform numbers for the phases of one ship: of the disturbance, then of the rest."""
        rest = self.n_waves or self.records["windy"].any() or self.records["variation"].any()
        return BEFORE_WAVES + self.n_waves if rest else N_DISTURBANCE

    @property
    def arrays(self) -> Water:
        """As the kernels take it."""
        return Water(self.waves, self.winds, self.gusts, self.gust_phases, self.harmonics)

    def waves_of(self, ship: int) -> np.ndarray:
        """The waves of one ship as they are, shape (5, N), rows of ``physics.waves``.

        Amplitude [m], frequency [rad/s], wave number [1/m], phase [turns] and the direction to
        which they go [rad].
        """
        record, waves = self.records[ship], self.waves
        amplitude, omega, number = waves.components[record["response"]]
        lanes = 8 * np.diff(waves.groups).astype(int)
        each, swell = np.repeat(waves.offsets, lanes), np.repeat(waves.swell, lanes)
        direction = np.where(swell, record["swell_to"], record["wave_to"]) + each
        share = record["wave_share"] * np.where(swell, record["swell"], record["wind_sea"])
        phase = waves.phases[ship]
        found = np.stack([share * amplitude, omega, number, phase, direction])
        return found[:, self.columns]

    def for_ships(self, rows: np.ndarray) -> Waters:
        """The seas of the given rows, one each; their phases are still to be drawn."""
        n = len(rows)
        return dataclasses.replace(
            self,
            records=self.records[rows],
            waves=self.waves._replace(phases=_no_phases(n, self.waves.phases.shape[1])),
            gust_phases=np.zeros((n, self.gust_phases.shape[1])),
            harmonics=np.zeros((n, *self.harmonics.shape[1:])),
        )


def current_at(variation: float, omega: float, phase: float, time: np.ndarray) -> np.ndarray:
    """Speed of a current by its mean at times [s], as ``physics.dynamics.vary_current`` has it.

    Parameters
    ----------
    variation, omega, phase : float
        Share of the mean speed, frequency [rad/s] and phase [turns].
    """
    return 1.0 + variation * np.cos(omega * time + 2.0 * math.pi * phase)


def disturbance_spectrum(omega, correlation_time: float):
    """One-sided spectral density [s] of unit variance at omega [rad/s]."""
    T = correlation_time
    return 2.0 / math.pi * T / (1.0 + (np.asarray(omega) * T) ** 2)


def disturbance_harmonics(correlation_time: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [rad/s] and amplitudes of a unit-variance disturbance, shapes (N_HARMONICS,).

    Parameters
    ----------
    correlation_time : float
        T [s].
    """
    omega = _FIRST / correlation_time * np.arange(1, N_HARMONICS + 1)
    energy = disturbance_spectrum(omega, correlation_time)
    return omega, np.sqrt(2.0 * energy / energy.sum())


DISTURBANCE_AMPLITUDE = disturbance_harmonics(1.0)[1]  # the same for every correlation time


def waters(ships: list[Ship], sea: Sea | list[Sea] = CALM, apart: bool = False) -> Waters:
    """Arrays of the seas of some ships; ``physics`` draws their phases.

    Parameters
    ----------
    ships : list of Ship
        The disturbance scales with each ship and its nominal speed.
    sea : Sea or list of Sea
        One for all, or one each, with the same number of waves and the same directions.
    apart : bool
        Whether all systems but the first, the swell, go their own way and have their own share of
        the height in each record (``swell_to``, ``swell``), instead of those of their sea.

    Raises
    ------
    ConfigError
        Another number of seas than ships, seas whose waves do not match, waves for a ship without a
        wave table, wind for one without wind areas.
    """
    seas = [sea] * len(ships) if isinstance(sea, Sea) else list(sea)
    if len(seas) != len(ships):
        raise ConfigError(f"{len(seas)} seas given for {len(ships)} ships")
    kinds, ship_numbers = numbered(ships)
    different, sea_numbers = numbered(seas)
    parts = [s.components(apart) for s in different]
    first, wind_sea = parts[0], different[0].first_count
    for s, other in zip(different, parts, strict=True):
        alike = np.array_equal(other.direction, first.direction)
        if not (alike and (not apart or s.first_count == wind_sea)):
            raise ConfigError("the seas of one simulation must have the same wave directions")
    records = np.zeros(len(ships), SEA_DTYPE)
    responses: list[np.ndarray] = []
    components: list[np.ndarray] = []
    winds: list[np.ndarray] = []
    gusts: list[np.ndarray] = []
    made: dict[tuple[int, int], int] = {}
    for i, key in enumerate(zip(ship_numbers, sea_numbers, strict=True)):
        if key in made:
            records[i] = records[made[key]]
            continue
        made[key] = i
        ship, s = kinds[key[0]], different[key[1]]
        _fill(records[i], ship, s)
        if s.wind_speed > 0.0:
            records[i]["wind_table"] = len(winds)
            winds.append(wind_table(ship.wind, ship.wind_type, ship.hull.B, s.wind_method).values)
            gusts.append(_gusts(ship, s))
        if len(first.omega):
            _fill_waves(records[i], ship, parts[key[1]], len(responses))
            omega = parts[key[1]].omega
            responses.append(wave_response(ship, omega, s.surge_model))
            components.append(np.stack([parts[key[1]].amplitude, omega, omega**2 / G]))
    n = len(ships)
    swell = np.arange(len(first.omega)) >= (wind_sea if apart else len(first.omega))
    offsets, groups, swell, columns = _in_eights(first.direction, swell)
    count = 8 * int(groups[-1])
    waves = Waves(
        components=_filled(np.array(components), columns, count)
        if components
        else np.zeros((1, 3, 0)),
        offsets=offsets,
        turns=np.stack([np.cos(offsets), np.sin(offsets)], axis=1),
        groups=groups,
        swell=swell,
        response=_eight_by_eight(_filled(_stacked(responses), columns, count))
        if responses
        else np.zeros((1, 2, 2, 0), EIGHT_WAVES),
        phases=_no_phases(n, count),
    )
    gusty = any(s.gusts for s in different)
    return Waters(
        records,
        waves,
        columns,
        winds=np.stack(winds) if winds else np.zeros((1, 2, 3)),
        gusts=np.stack(gusts) if gusty else np.zeros((max(len(gusts), 1), 2, 0)),
        gust_phases=np.zeros((n, GUST_COLUMNS if gusty else 0)),
        harmonics=np.zeros((n, 4, N_HARMONICS if records["disturbed"].any() else 0)),
    )


def set_phases(water: Waters, which: np.ndarray, uniform: np.ndarray) -> None:
    """Set all phases of some ships, in place.

    Parameters
    ----------
    water : Waters
    which : numpy.ndarray
        Indices of the ships, shape (m,).
    uniform : numpy.ndarray
        Numbers in [0, 1), shape (m, `Waters.n_phases`): phases of the disturbance, of the current,
        of the gusts and of the waves, as fractions of a turn.
    """
    if water.harmonics.shape[2]:
        draw_disturbance(which, water.harmonics, water.records, DISTURBANCE_AMPLITUDE, uniform)
    if uniform.shape[1] > N_DISTURBANCE:
        water.records["variation_phase"][which] = uniform[:, N_DISTURBANCE]
        if water.gust_phases.shape[1]:
            gusts = uniform[:, N_DISTURBANCE + 1 :][:, :N_GUSTS]
            water.gust_phases[which, :N_GUSTS] = gusts
        phases = uniform[:, BEFORE_WAVES:]
        water.waves.phases[np.ix_(which, water.columns)] = phases


def _in_eights(
    direction: np.ndarray, swell: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Different directions, the first eight of each, whether of a swell, and columns of all waves.

    Each direction begins with an eight of its own, as ``physics.waves.sum_waves`` needs it.
    """
    kinds, counts = np.unique(np.stack([swell, direction]), axis=1, return_counts=True)
    offsets = np.ascontiguousarray(kinds[1])
    groups = np.concatenate([[0], np.cumsum(-(-counts // 8))]).astype(np.uint64)
    starts = np.repeat(8 * groups[:-1].astype(np.int64), counts)
    within = np.concatenate([np.arange(c) for c in counts]) if len(counts) else np.zeros(0)
    return offsets, groups, kinds[0] > 0.0, starts + within.astype(np.int64)


def _no_phases(n: int, count: int) -> np.ndarray:
    """Phases of n ships; single precision, 4e-7 rad, is half the memory of an environment's sea."""
    return in_lines(np.zeros((n, count), np.float32))


def _filled(values: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray:
    """Values (..., N) in their columns of `count`, zero elsewhere."""
    found = in_lines(np.zeros((*values.shape[:-1], count)))
    found[..., columns] = values
    return found


def _eight_by_eight(response: np.ndarray) -> np.ndarray:
    """Response (..., 9, N) as ``physics.waves.EIGHT_WAVES`` (..., N / 8)."""
    *rest, channels, count = response.shape
    parts = response.reshape(*rest, channels, count // 8, 8)
    found = in_lines(np.zeros((*rest, count // 8), EIGHT_WAVES))
    found["of"] = np.swapaxes(parts, -3, -2)
    return found


def _stacked(responses: list[np.ndarray]) -> np.ndarray:
    """Responses with their last speed repeated up to the longest, as lookup beyond it does."""
    speeds = max(len(response) for response in responses)
    last = [np.repeat(r[-1:], speeds - len(r), axis=0) for r in responses]
    return np.stack([np.concatenate(pair) for pair in zip(responses, last, strict=True)])


def _fill(record: np.record, ship: Ship, sea: Sea) -> None:
    """Everything of a sea but its waves."""
    omega, _ = disturbance_harmonics(sea.correlation_time * ship.hull.L / ship.speed)
    force = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
    north = sea.current_speed * math.cos(sea.current_direction_to)
    east = sea.current_speed * math.sin(sea.current_direction_to)
    record["V_north"] = record["mean_north"] = north
    record["V_east"] = record["mean_east"] = east
    record["variation"] = sea.current_variation if sea.current_speed > 0.0 else 0.0
    record["variation_omega"] = 2.0 * math.pi / sea.current_period
    record["disturbed"] = sea.sway_disturbance > 0.0 or sea.yaw_disturbance > 0.0
    record["omega_1"] = omega[0]
    record["Y_std"] = sea.sway_disturbance * force
    record["N_std"] = sea.yaw_disturbance * force * ship.hull.L
    record["drift"], record["mean_drift"] = sea.drift != "none", sea.drift == "mean"
    if sea.wind_speed > 0.0:
        _fill_wind(record, ship, sea)


def _fill_wind(record: np.record, ship: Ship, sea: Sea) -> None:
    if ship.wind is None:
        raise ConfigError(
            f"wind_speed = {sea.wind_speed} m/s: {ship.name} has no section [wind] in its ship file"
        )
    record["windy"] = 1
    for name in ("A_F", "A_L", "L_oa"):
        record[name] = getattr(ship.wind, name)
    record["wind_north"] = -sea.wind_speed * math.cos(sea.wind_direction_from)
    record["wind_east"] = -sea.wind_speed * math.sin(sea.wind_direction_from)
    record["gust_scale"] = 1.0 if sea.gusts else 0.0


def _fill_waves(record: np.record, ship: Ship, waves: WaveComponents, kind: int) -> None:
    record["wavy"], record["response"], record["wave_share"] = 1, kind, 1.0
    record["wind_sea"] = record["swell"] = 1.0
    record["wave_north"] = record["swell_north"] = 1.0  # until they are set
    record["waves_outside"] = energy_outside(ship, waves)
    record["speed_step"] = SPEED_STEP * math.sqrt(G * ship.hull.L)
    record["speed_max"] = wave_table_of(ship).froude[-1] * math.sqrt(G * ship.hull.L)


def _gusts(ship: Ship, sea: Sea) -> np.ndarray:
    """Share and frequency [rad/s] of the gusts' harmonics, zero without and where they fill up."""
    assert ship.wind is not None  # else she has no wind table
    found = np.zeros((2, GUST_COLUMNS))
    if not sea.gusts:
        return found
    full = sea.wind_speed * ship.time_unit  # the spectrum is that of the full scale
    height = max(ship.wind.s_H * ship.scale, 1.0)
    omega, amplitude = gust_harmonics(full, height, N_GUSTS)
    found[:, :N_GUSTS] = amplitude / full, omega * ship.time_unit
    return found
