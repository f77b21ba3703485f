"""Model predictive control: the cheapest rudder over a horizon within its limits of angle and rate.

Motion and rudder bias come from `Observer`, the prediction from its linear ship at the nominal
speed (``horizon``), the quadratic program of each ship is solved by OSQP (Stellato et al. 2020,
Mathematical Programming Computation 12:637-672) from her last plan on. On a track the plan sees
the next turn and the current ahead (``route_preview``); on a heading it needs no reference model,
because it knows what the rudder can do.
"""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csc_matrix

from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.autopilot import Autopilot, wrapped
from ship_gym_agents.horizon import Horizon
from ship_gym_agents.route_preview import Current, Path, drift_angle
from ship_gym_agents.rudder_effect import NEEDS, RudderEffect
from ship_gym_agents.wave_filter import Observer, check_gains

_TRACK = ("cross_track", "cross_track_rate", "to_go", "next_turn")
# Steps of OSQP by their number, not by the clock: a plan depends on what is known only.
_SOLVER = {
    "eps_abs": 1e-6,
    "eps_rel": 1e-6,
    "max_iter": 4000,
    "check_termination": 5,
    "adaptive_rho_interval": 50,
    "verbose": False,
}


@dataclasses.dataclass(frozen=True)
class TrackWeights:
    """What a plan on a track is made with; numbers, or arrays of shape (count,).

    Attributes
    ----------
    cross_track, rudder, rate : float
        Weights of the squares of the cross-track error in L, of the rudder angle beyond K_b times
        the bias and of d delta / dt', over that of the course error.
    turn_radius : float
        Of the turns into the next leg [L].
    drift_time : float
        Time constant of the estimated current [L / U0].
    """

    cross_track: float = 0.3
    rudder: float = 0.1
    rate: float = 2e-5
    turn_radius: float = 2.5
    drift_time: float = 3.0

    def __post_init__(self):
        check_gains("gains.track", self, positive=tuple(f.name for f in dataclasses.fields(self)))


@dataclasses.dataclass(frozen=True)
class MPCGains:
    """Weights of the plan and its filter; numbers, or arrays of shape (count,).

    Attributes
    ----------
    observer : Observer
        Its ship is the plan's too.
    rudder, rate : float
        On a heading: weights of the squares of the rudder angle beyond K_b times the bias and of
        d delta / dt', over that of the heading error.
    K_b : float
        Share of the estimated rudder bias that the plan counts on.
    schedule : float
        Exponent on the effect of the rudder by speed and propeller; 0: not scheduled.
    track : TrackWeights
    """

    observer: Observer
    rudder: float = 0.1
    rate: float = 2e-5
    K_b: float = 0.8
    schedule: float = 1.0
    track: TrackWeights = dataclasses.field(default_factory=TrackWeights)

    # the plan is its own reference model
    reference: ClassVar = None

    def __post_init__(self):
        check_gains("gains", self, signed=("K_b",), positive=("rudder", "rate"))

    @property
    def wave_filter(self) -> Observer:
        """The filter of the motion."""
        return self.observer


class MPC(Autopilot):
    """Linear model predictive control of headings and tracks, see the module.

    Needs osqp, the extra ``benchmark``.

    Parameters
    ----------
    gains : MPCGains, optional
        The tuned gains of the ship if omitted; without any, `first_gains`.
    name : str
    """

    KIND = "mpc"
    needs = (*Autopilot.needs, *NEEDS)
    # a solver goes on from its last plan: no row of it begins anew, and `restart` says so
    restart = None  # type: ignore[assignment]
    # one file has the gains of both: neither gets one of its own
    GENERAL: ClassVar[tuple[str, ...]] = ("heading_keeping", "track_following")
    TUNED: ClassVar = {
        "rudder": (0.01, 2.0, 0.1),
        "rate": (1e-6, 1e-2, 2e-5),
        "K_b": (-0.5, 2.0, 0.8),
        "schedule": (0.0, 1.5, 1.0),
        "observer.sway_noise": (0.02, 20.0, 0.5),
        "observer.yaw_noise": (0.05, 50.0, 2.0),
        "observer.bias_noise": (0.02, 20.0, 0.8),
        "track.cross_track": (0.01, 30.0, 0.3),
        "track.rudder": (0.01, 2.0, 0.1),
        "track.rate": (1e-6, 1e-2, 2e-5),
        "track.turn_radius": (0.5, 8.0, 2.5),
        "track.drift_time": (0.3, 30.0, 3.0),
    }

    def __init__(self, gains: MPCGains | None = None, name: str = "mpc"):
        super().__init__(gains, name)

    @classmethod
    def first_gains(cls, ship: Ship) -> MPCGains:
        """Weights of J_0.1, a filter with waves on the linearised ship."""
        return MPCGains(Observer.first(ship, waves=True))

    @classmethod
    def structures(cls, ship: Ship) -> dict[str, tuple[MPCGains, tuple[str, ...]]]:
        """Gains of headings, to tune on one, and of tracks, to tune on one after that."""
        gains = cls.gains_for(ship)
        track = tuple(name for name in cls.TUNED if name.startswith("track."))
        return {
            "heading": (gains, tuple(name for name in cls.TUNED if name not in track)),
            "track": (gains, track),
        }

    def reset(self, count: int, ship: Ship, scenario: Scenario) -> None:
        """Make the programs; `count` episodes of `scenario` with `ship` begin together.

        Raises
        ------
        ImportError
            osqp is not installed.
        ConfigError
            The observation lacks what the controller needs.
        """
        super().reset(count, ship, scenario)
        self._on_track = "cross_track" in self._columns
        if self._on_track:
            self._columns.require(_TRACK, f"controller {self.name} on a track")
        g, track = self._g, self._g.track
        weights = (track.rudder, track.rate) if self._on_track else (g.rudder, g.rate)
        rows = [np.broadcast_to(np.ravel(w), count) for w in (*weights, track.cross_track)]
        made: dict[tuple[float, ...], Horizon] = {}
        self._programs = [self._program(made, row) for row in zip(*rows, strict=True)]
        self._current = Current(count, self._step, track.drift_time)
        self._schedule = RudderEffect(ship, self._step)
        self._surge: np.ndarray | None = None
        self._jump = np.zeros(count)

    def _program(self, made: dict, weights: tuple[float, ...]) -> Program:
        """The program of an episode; those of the same weights share their matrices."""
        if weights not in made:
            rudder, rate, cross_track = map(float, weights)
            made[weights] = Horizon(
                self._g.observer.ship,
                self._step,
                self._stroke,
                rudder,
                rate,
                cross_track if self._on_track else None,
            )
        return Program(made[weights], self._limit)

    def _felt(self, seen: View, delta: np.ndarray) -> np.ndarray:
        """Rudder angle [rad] at which the nominal ship would turn as this one does."""
        self._effect = self._schedule(seen) ** self._g.schedule
        return delta * self._effect

    def _wanted(self, seen: View, jump: np.ndarray) -> np.ndarray:
        self._jump = jump
        return super()._wanted(seen, jump)

    def _rudder(self, seen: View, motion, wanted) -> np.ndarray:
        """Rudder angle [rad] at the end of the interval by the plans of all ships."""
        delta = seen.rudder * self._limit * self._effect
        counted = self._g.K_b * motion[3]
        x = np.stack([wrapped(motion[0]), motion[2], motion[1], delta - counted], axis=1)
        aside = None
        if self._on_track:
            path, aside = self._ahead(seen, motion)
            x = np.column_stack([path.error, x])
        asides = [None] * len(x) if aside is None else aside
        strokes = [
            program.first(*row)
            for program, *row in zip(
                self._programs, x, asides, delta, self._effect.tolist(), strict=True
            )
        ]
        return (delta + self._stroke * np.array(strokes)) / self._effect

    def _ahead(self, seen: View, motion) -> tuple[Path, np.ndarray]:
        """The path, and what it and the water add to e and psi at each interval, (count, N, 5)."""
        psi, sway = motion[0], motion[2]
        surge = np.array(seen.surge) if self._surge is None else self._surge
        self._surge = surge = surge + self._current.share * (seen.surge - surge)
        self._current(seen, psi, self._jump)
        path = Path(seen, self._g.track.turn_radius)
        N = self._programs[0].horizon.N
        along = np.maximum(surge + self._current.along, 0.1)
        ahead = along[:, None] * (self._step * np.arange(N + 1))
        bearings = path.bearings(ahead)
        drift = drift_angle(self._current, bearings, surge, sway)
        # psi + v' is the course error of the plan: what remains of the drift beside its own sway
        shift = drift - sway[:, None] - bearings
        aside = np.zeros((len(seen), N, 5))
        aside[:, :, 0] = self._step * np.cumsum(0.5 * (shift[:, 1:] + shift[:, :-1]), axis=1)
        aside[:, :, 1] = shift[:, 1:]
        return path, aside


class Program:
    """The quadratic program of one ship, solved again and again from its last plan on."""

    def __init__(self, horizon: Horizon, limit: float):
        self.horizon, self._limit = horizon, limit / horizon.stroke
        m = horizon.blocks
        self._one, self._last = np.ones(m), np.zeros(m)
        self._solver = _osqp().OSQP()
        limits = csc_matrix(np.vstack([np.eye(m), horizon.angles]))
        free = np.full(2 * m, np.inf)
        H = csc_matrix(np.triu(horizon.H))
        self._solver.setup(H, np.zeros(m), limits, -free, free, **_SOLVER)

    def first(
        self, x: np.ndarray, aside: np.ndarray | None, delta: float, effect: float = 1.0
    ) -> float:
        """Stroke of the rudder in the first interval, by the largest one.

        Parameters
        ----------
        x, aside
            As in `Horizon.slope`.
        delta : float
            Rudder angle now [rad], times its effect.
        effect : float
            Of the rudder, by the nominal: limits of angle and rate are those of a rudder that
            goes as much further or less far.
        """
        limit, one = self._limit * effect, self._one * effect
        now = min(max(delta / self.horizon.stroke, -limit), limit)
        low = np.concatenate([-one, np.full(len(one), -limit - now)])
        high = np.concatenate([one, np.full(len(one), limit - now)])
        self._solver.update(q=self.horizon.slope(np.array(x), aside), l=low, u=high)
        found = self._solver.solve(raise_error=False).x
        if found is not None and np.isfinite(found).all():
            self._last = found
        return float(min(max(self._last[0], -effect), effect))


def _osqp() -> Any:
    """The solver, the only import of it."""
    try:
        import osqp
    except ImportError as error:
        raise ImportError('the controller mpc needs osqp: pip install "ship-gym[benchmark]"') from (
            error
        )
    return osqp
