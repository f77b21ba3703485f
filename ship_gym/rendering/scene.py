"""Scene: everything that one picture of a ship shows, in plain numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.conventions import (
    COMMAND_NAMES,
    N_COMMANDS,
    N_STATES,
    PSI,
    STATE_NAMES,
    U,
    V,
    X,
    Y,
    polar,
    wrap_angle,
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """One instant of one ship, with what it was told and what surrounds it.

    Parameters
    ----------
    task, ship : str
        Titles for the picture.
    L, B, U0 : float
        Length and breadth [m], nominal speed [m/s].
    delta_max, n_max : float
        Largest rudder angle [rad] and propeller speed [rev/s].
    scale : float
        Model scale, 1 for full scale.
    time : float
        Since reset [s].
    state, command : numpy.ndarray
        Shapes (8,) and (2,), in the order of ``ship_gym.conventions``.
    psi_ordered : float or None
        Ordered heading [rad]; None: there is none.
    heading_limit : float or None
        Heading error that ends the episode [rad]; None: none does.
    wake : numpy.ndarray
        Past positions north, east [m], oldest first, shape (k, 2).
    track : numpy.ndarray or None
        Way-points north, east [m], shape (W, 2), W >= 2; None: no track.
    active_leg : int
        Leg k of the track goes from way-point k to k + 1.
    cross_track : float
        Distance to the track [m], positive with the ship to starboard of the nearest leg.
    cross_track_limit : float or None
        Distance that ends the episode [m].
    corridor : float or None
        Distance that success allows [m].
    leg_limits : numpy.ndarray or None
        Corridor of each leg to port and to starboard [m], shape (W - 1, 2); None: `corridor`, on
        both sides of all. Where there is one, `corridor` and `cross_track_limit` are those beside
        the ship.
    leg_of : numpy.ndarray or None
        Of each leg the leg of the planned route that it is a piece of, shape (W - 1,); None: all
        are whole.
    current, wind : tuple of float
        Velocities north, east [m/s], where they go to.
    wave_height, wave_period, wave_direction_to : float
        Significant height [m] (0: no waves), peak period [s], direction [rad].
    wave_yaw, wave_roll : float
        Wave-frequency motion now [rad].
    reward : float
        Of the last interval.
    reward_terms : mapping of str to float
        Its terms.
    outcome : str
        How the episode ended, such as "heading limit" (a limit is shown in red) or "arrived"; ""
        while it goes on.

    Raises
    ------
    ConfigError
        A shape, a size or a leg that cannot be drawn, or a state that is not finite.
    """

    task: str
    ship: str
    L: float
    B: float
    U0: float
    delta_max: float
    n_max: float
    state: np.ndarray
    command: np.ndarray
    time: float = 0.0
    scale: float = 1.0
    psi_ordered: float | None = None
    heading_limit: float | None = None
    wake: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    track: np.ndarray | None = None
    active_leg: int = 0
    cross_track: float = 0.0
    cross_track_limit: float | None = None
    corridor: float | None = None
    leg_limits: np.ndarray | None = None
    leg_of: np.ndarray | None = None
    current: tuple[float, float] = (0.0, 0.0)
    wind: tuple[float, float] = (0.0, 0.0)
    wave_height: float = 0.0
    wave_period: float = 0.0
    wave_direction_to: float = 0.0
    wave_yaw: float = 0.0
    wave_roll: float = 0.0
    reward: float = 0.0
    reward_terms: Mapping[str, float] = field(default_factory=dict)
    outcome: str = ""

    def __post_init__(self) -> None:
        for name in ("L", "B", "U0", "delta_max", "n_max", "scale"):
            if not check_number(name, getattr(self, name), 0.0, 1e9) > 0.0:
                raise ConfigError(f"{name} = {getattr(self, name)}: must be above 0")
        _check_shape("state", self.state, (N_STATES,))
        _check_shape("command", self.command, (N_COMMANDS,))
        _check_shape("wake", self.wake, (len(self.wake), 2))
        if self.track is not None:
            self._check_track(self.track)

    def _check_track(self, track: np.ndarray) -> None:
        count = len(track)
        _check_shape("track", track, (count, 2))
        if count < 2:
            raise ConfigError(f"a track needs at least 2 way-points, it has {count}")
        if not 0 <= self.active_leg < count - 1:
            raise ConfigError(f"active_leg = {self.active_leg}: allowed is 0 to {count - 2}")
        if self.leg_limits is not None:
            _check_shape("leg_limits", self.leg_limits, (count - 1, 2))
        if self.leg_of is not None:
            _check_shape("leg_of", self.leg_of, (count - 1,))

    @property
    def turning_points(self) -> list[int]:
        """Way-points of the track at which a leg of the planned route begins, and the last one.

        Of a planned turn, which is several pieces, that in its middle.
        """
        assert self.track is not None
        count = len(self.track)
        if self.leg_of is None:
            return list(range(count))
        return [0, *(np.flatnonzero(np.diff(self.leg_of)) + 1).tolist(), count - 1]

    @property
    def position(self) -> np.ndarray:
        """North, east [m], shape (2,)."""
        return self.state[[X, Y]]

    @property
    def heading_error(self) -> float | None:
        """Psi - psi_ordered in [-pi, pi) [rad]; None without an order."""
        order = self.psi_ordered
        return None if order is None else float(wrap_angle(self.state[PSI] - order))

    @property
    def water_velocity(self) -> tuple[float, float]:
        """Surge and sway through the water [m/s]."""
        c, s = math.cos(self.state[PSI]), math.sin(self.state[PSI])
        north, east = self.current
        u = self.state[U] - (north * c + east * s)
        return float(u), float(self.state[V] - (east * c - north * s))

    def row(self) -> dict[str, float]:
        """The scene as one row of a recording, by the column names of ``recording.Trajectory``."""
        found = {"t": self.time, **dict(zip(STATE_NAMES, self.state.tolist(), strict=True))}
        found |= dict(zip(COMMAND_NAMES, np.asarray(self.command).tolist(), strict=True))
        if self.psi_ordered is not None:
            found |= {"psi_ordered": self.psi_ordered, "psi_error": self.heading_error}
        if self.track is not None:
            found["off_route"] = self.cross_track
        found["current_speed"], found["current_direction_to"] = map(float, polar(*self.current))
        found["wind_speed"], to = map(float, polar(*self.wind))
        found["wind_direction_from"] = (to + math.pi) % (2.0 * math.pi)
        found |= {"wave_yaw": self.wave_yaw, "wave_roll": self.wave_roll, "reward": self.reward}
        return found | {f"reward_{name}": value for name, value in self.reward_terms.items()}


def _check_shape(name: str, values: np.ndarray, shape: tuple[int, ...]) -> None:
    found = np.shape(values)
    if found != shape:
        raise ConfigError(f"{name} has shape {found}, allowed is {shape}")
    if not np.isfinite(values).all():
        raise ConfigError(f"{name} = {np.asarray(values).tolist()}: must be finite")
