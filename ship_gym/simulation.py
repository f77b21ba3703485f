"""ShipSim: n ships in a sea, stepped together; no Gymnasium."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ship_gym.behaviour import check_behaviour
from ship_gym.config import ConfigError, check_angle, check_number
from ship_gym.conventions import (
    COMMAND_NAMES,
    FLOW_OF_UNITS,
    FORCE_AXES,
    FORCE_COMPONENTS,
    N_COMMANDS,
    N_FLOW,
    N_FORCES,
    N_STATES,
    PSI,
    STATE_NAMES,
    N,
    U,
)
from ship_gym.physics._kernel import direct
from ship_gym.physics._threads import in_parts, usable_cores
from ship_gym.physics.dynamics import forces as ship_forces
from ship_gym.physics.dynamics import over_ground, total
from ship_gym.physics.parameters import traits_of
from ship_gym.physics.quantities import Tables
from ship_gym.physics.scratch import scratch_for
from ship_gym.physics.step import Fleet, sail_rows, see_waves
from ship_gym.physics.waves import N_WAVE_STATE, WAVE_NAMES, set_direction
from ship_gym.roots import root
from ship_gym.sea.phases import uniform_of
from ship_gym.sea.records import Waters, set_phases, waters
from ship_gym.sea.state import CALM, Sea
from ship_gym.sea.surface import sum_of
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship, load_ships
from ship_gym.ships.particulars import Ship
from ship_gym.ships.records import fleet, numbered

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory

PARALLEL_FROM = (
    1024  # ships; below it waiting for threads costs more than it saves where cores are busy
)


_MADE = ("fleet", "_sail")  # of the arrays, at the first step
# arrays of a fleet with a row for each ship, beside those of the water
_OF_SHIPS = (
    *("state", "commands", "time", "clock", "limits", "lost", "ships", "seas", "forces", "flow"),
    "met",
)
# Beyond these a state is none of a ship: speed through the water over U0, r L / U0, of the nominal
# speed of her file. In 100 million steps the ships of the package reach 2.40 U0 (kcs_model drawn
# with little resistance, full ahead) and r L / U0 = 2.08 (docs/soak.md).
FASTEST, FASTEST_TURN = 2.5, 3.0
_OF_FULL_AHEAD = 1.25  # of the speed full ahead, where the nominal one of a file is so low


class SimulationDiverged(RuntimeError):
    """A state is none of a ship any more: not finite, or beyond `FASTEST`.

    The message carries ship, time, state, command and forces.
    """


class ShipSim:
    """n ships, each in its own water, advanced by the compiled step.

    Parameters
    ----------
    ship : str, path or Ship, or a sequence of these
        One ship for all, or n ships.
    n : int
        Number of ships.
    sea : Sea or sequence of Sea
        One sea for all, or one each.
    parallel : bool or None
        Threads or not; None: from 1024 ships on. The numbers are the same bit for bit.

    Attributes
    ----------
    state : numpy.ndarray
        Shape (n, 8), order of ``conventions.STATE_NAMES``.
    time : numpy.ndarray
        Time since reset of each ship [s], shape (n,).
    forces : numpy.ndarray
        X, Y [N], N [N m] by component, shape (n, N_FORCES, 3), ``conventions.FORCE_COMPONENTS`` by
        ``FORCE_AXES``: the ship's own at the start of the last step, loads from outside as they are
        held during it.
    flow : numpy.ndarray
        Diagnostics at the start of the last step, shape (n, 7), ``conventions.FLOW_NAMES``; where
        a ship has two propellers (n, 19), ``conventions.FLOW_OF_UNITS``. Those of a single
        propeller stand there as the starboard one's, the port one's are zero.
    waves : numpy.ndarray
        Wave drift and wave-frequency motion now, at the end of the last step, shape (n, 10),
        ``physics.waves.WAVE_NAMES``. The motion is what sensors see on top of the state.
    water : sea.records.Waters
        Seas of the ships; `set_sea` draws their phases.
    limits : numpy.ndarray
        Speed through the water [m/s] and yaw rate [rad/s] beyond which a ship is none, (n, 2).
    lost : numpy.ndarray
        Whether she was so in the last step, or is not finite, bool (n,).
    longest : numpy.ndarray
        Longest integration step of each ship [s], (n,), `longest_step`; may be written before
        `set_interval`.
    """

    def __init__(
        self,
        ship: Named | Ship | Sequence[Named | Ship],
        n: int = 1,
        sea: Sea | Sequence[Sea] | None = None,
        parallel: bool | None = None,
    ):
        self.n = int(check_number("n", n, 1, 10**7))
        self.ships = load_ships(ship, self.n)
        if len(self.ships) != self.n:
            raise ConfigError(f"{len(self.ships)} ships given for n = {self.n}")
        self._check_ships()
        made = fleet(self.ships)
        self._records = made.records
        self._expected: tuple[str, ...] = ()
        self._tables = Tables(made.open_water, made.deflected)
        sea = CALM if sea is None else sea
        self.water = waters(self.ships, sea if isinstance(sea, Sea) else list(sea))
        self.seas = self.water.records
        given = [sea] * self.n if isinstance(sea, Sea) else list(sea)
        self._waves_to = np.array([s.wave_direction_to for s in given])
        self.waves = np.zeros((self.n, N_WAVE_STATE))
        self.parallel = self.n >= PARALLEL_FROM if parallel is None else bool(parallel)
        self.state = np.zeros((self.n, N_STATES))
        self.time = np.zeros(self.n)
        self.commands = np.zeros((self.n, N_COMMANDS))
        self.forces = np.zeros((self.n, N_FORCES, len(FORCE_AXES)))
        two = any(ship.propellers == 2 for ship in self.ships)
        self.flow = np.zeros((self.n, len(FLOW_OF_UNITS) if two else N_FLOW))
        self._clock = np.zeros((self.n, 2))
        different, numbers = numbered(self.ships)
        self.limits = np.array([limits_of(ship) for ship in different])[numbers]
        self.lost = np.zeros(self.n, dtype=np.bool_)
        self.longest = np.array([longest_step(s) for s in self.ships])

    def _check_ships(self) -> None:
        """Refuse ships of own files that do what no ship does (``behaviour``), looked at once."""
        for ship in numbered(self.ships)[0]:
            check_behaviour(ship, _Trial)

    def reset(
        self,
        seed: int | None = None,
        *,
        speed: float | np.ndarray | None = None,
        n: float | np.ndarray | None = None,
        psi: float | np.ndarray = 0.0,
    ) -> np.ndarray:
        """Put every ship at the origin on a straight course.

        Parameters
        ----------
        seed : int, optional
            Seeds the phases of the disturbance; ship i uses the stream seed + i.
        speed : float or array, optional
            Speed through the water [m/s]; the ship's nominal speed if omitted.
        n : float or array, optional
            Propeller speed [rev/s], negative astern; self-propulsion at `speed` if omitted.
        psi : float or array
            Heading [rad].

        Returns
        -------
        numpy.ndarray
            The state, shape (n, 8).
        """
        for angle in np.atleast_1d(psi):
            check_angle("psi", angle)
        for value in () if speed is None else np.ravel(speed).tolist():
            check_number("speed", value, -100.0, 100.0, "m/s")
        for value in () if n is None else np.ravel(n).tolist():
            low = -max(s.engine.n_astern for s in self.ships)
            check_number("n", value, low, max(s.engine.n_max for s in self.ships), "rev/s")
        speeds = np.array([s.speed for s in self.ships]) if speed is None else speed
        self._check_speeds(np.broadcast_to(speeds, (self.n,)))
        self.state[:] = 0.0
        self.state[:, PSI] = psi
        self.state[:, U] = speeds
        self.state[:, N] = self.self_propulsion(self.state[:, U]) if n is None else n
        for now, mean in (("V_north", "mean_north"), ("V_east", "mean_east")):
            self.seas[now] = self.seas[mean]  # not the current at the end of the last run
        over_ground(self.state, self.seas)
        self.time[:] = 0.0
        seeds = [None if seed is None else seed + i for i in range(self.n)]
        uniform = np.stack([uniform_of(one, self.water.n_phases) for one in seeds])
        self.set_sea(np.arange(self.n), uniform, self._waves_to)
        return self.state

    def _check_speeds(self, speeds: np.ndarray) -> None:
        """Refuse a speed at the start that no ship has."""
        beyond = np.abs(speeds) > self.limits[:, 0]
        if beyond.any():
            i = int(beyond.argmax())
            limit = self.limits[i, 0]
            check_number(f"{self.ships[i].name}: speed", float(speeds[i]), -limit, limit, "m/s")

    def set_sea(self, which: np.ndarray, uniform: np.ndarray, waves_to: np.ndarray) -> None:
        """Draw the seas of some ships anew; their states and times must be set before.

        Parameters
        ----------
        which : numpy.ndarray
            Indices, shape (m,).
        uniform : numpy.ndarray
            Uniform numbers in [0, 1), shape (m, ``water.n_phases``).
        waves_to : numpy.ndarray
            Where the waves go to, from north [rad], shape (m,).
        """
        set_direction(which, self.seas, waves_to)
        set_phases(self.water, which, uniform)
        self.see_waves(which)

    def see_waves(self, which: np.ndarray) -> None:
        """Refresh ``self.waves`` of some ships, shape (m,), from their states and times."""
        if self.water.n_waves:
            see_waves(which, self.fleet)

    def elevation(self, x: Any, y: Any, t: Any = None, ship: int = 0) -> np.ndarray:
        """Elevation of the surface of a ship's sea above still water [m], positive up.

        Parameters
        ----------
        x, y : array_like
            North and east [m].
        t : array_like, optional
            Time since the reset of that ship [s], of a shape that goes with x and y; now if
            omitted.
        ship : int
            Whose sea: each has its own phases.

        Returns
        -------
        numpy.ndarray
            Of the shape to which x, y and t broadcast; zero without waves.
        """
        which = int(check_number("ship", ship, 0, self.n - 1))
        time = self.time[which] if t is None else t
        return sum_of(self.water.waves_of(which), x, y, time)

    def set_water(self, water: Waters) -> None:
        """Replace the seas of all ships, as ``sea.records.waters`` makes them; then `set_sea`."""
        self.water = water
        self.replace(seas=water.records)

    def replace(self, **arrays: np.ndarray) -> None:
        """Use other arrays of the same shapes and types instead of attributes of these names."""
        self.__dict__.update(arrays)
        self._make_anew()

    def _make_anew(self) -> None:
        """Forget what is made of the arrays."""
        for made in _MADE:
            self.__dict__.pop(made, None)

    @property
    def records(self) -> np.ndarray:
        """Parameters of each ship, shape (n,); writing a column randomises it.

        Take it anew for every change: what the ships have in common is then found again.
        """
        self._make_anew()
        return self._records

    def expect(self, *traits: str) -> None:
        """Prepare for what the records will get while sailing, so that nothing is compiled then.

        Parameters
        ----------
        *traits : str
            Of ``physics.parameters.Traits``: ``each``, ships that differ; ``spread``, draws of the
            surrogate.
        """
        self._expected = traits
        self._make_anew()

    def self_propulsion(self, speed: np.ndarray) -> np.ndarray:
        """Propeller speed [rev/s] of each ship that holds a speed [m/s] on a straight course."""
        found: dict[tuple[int, float], float] = {}
        speeds = []
        different, numbers = numbered(self.ships)
        for key in zip(numbers, np.broadcast_to(speed, (self.n,)).tolist(), strict=True):
            if key not in found:
                found[key] = self_propulsion(different[key[0]], key[1])
            speeds.append(found[key])
        return np.array(speeds)

    def step(self, commands: ArrayLike, dt: float | np.ndarray) -> np.ndarray:
        """Hold commands for one interval.

        Parameters
        ----------
        commands : array_like
            Shape (n, 2): rudder [rad], propeller speed [rev/s]; limited by gear and engine.
        dt : float or array
            Interval [s], one for all or one each; split into integration steps.

        Returns
        -------
        numpy.ndarray
            The state, shape (n, 8), updated in place.

        Raises
        ------
        ConfigError
            Wrong shape, a command that is not finite or looks like degrees, an interval that is
            not positive.
        SimulationDiverged
            A state is none of a ship any more (`limits`).
        """
        commands = np.asarray(commands, dtype=np.float64)
        if commands.shape != self.commands.shape:
            raise ConfigError(
                f"commands have shape {commands.shape}, allowed is {self.commands.shape}"
            )
        if not np.isfinite(commands).all():
            i = int(np.flatnonzero(~np.isfinite(commands).all(axis=1))[0])
            raise ConfigError(f"commands[{i}] = {commands[i].tolist()}: must be finite")
        check_angle("rudder command", commands[np.abs(commands[:, 0]).argmax(), 0])
        self.commands[:] = commands
        self.set_interval(dt)
        return self.advance()

    def set_interval(self, dt: float | np.ndarray) -> None:
        """Set the interval [s] of `advance`, one for all or one each; n integration steps each."""
        dt = np.asarray(dt, dtype=np.float64)
        if dt.shape not in ((), (self.n,)) or not (np.isfinite(dt) & (dt > 0.0)).all():
            raise ConfigError(f"dt = {dt.tolist()}: must be positive and finite, one or n of them")
        self._clock[:, 1] = np.maximum(np.ceil(dt / self.longest - 1e-9), 1.0)
        self._clock[:, 0] = dt / self._clock[:, 1]

    def advance(self) -> np.ndarray:
        """Sail the interval of `set_interval` under ``self.commands``, both unchecked.

        Raises
        ------
        SimulationDiverged
            A state is none of a ship any more (`limits`).
        """
        if self.sail() < self.n:
            self._report_divergence()
        return self.state

    def sail(self) -> int:
        """As `advance`, but a ship that is none any more is no error; returns how many are."""
        return sum(in_parts(self._sail, self.n, self.threads))

    def loads_now(self, which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces and flow of some ships as they are now, at the start of the next interval.

        That interval is sailed by copies of them; nothing of this simulation changes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices, shape (m,).

        Returns
        -------
        forces, flow : numpy.ndarray
            Shapes (m, N_FORCES, 3) and (m, 7 or 19), bit for bit what `sail` would leave in the
            attributes of these names.
        """
        fleet = self.fleet
        rows = {name: getattr(fleet, name)[which] for name in _OF_SHIPS}
        water = fleet.water
        waves = water.waves._replace(phases=water.waves.phases[which])
        water = water._replace(
            waves=waves, gust_phases=water.gust_phases[which], harmonics=water.harmonics[which]
        )
        copied = fleet._replace(water=water, **rows)
        sail_rows(0, len(which), copied)
        return copied.forces, copied.flow

    @property
    def threads(self) -> int:
        """Number of threads that sail the batch: there is a scratch for each."""
        return len(self.fleet.scratch)

    @functools.cached_property
    def fleet(self) -> Fleet:
        """All arrays of the step, which stay the same ones from the first step on."""
        return Fleet(
            state=self.state,
            commands=self.commands,
            time=self.time,
            clock=self._clock,
            limits=self.limits,
            lost=self.lost,
            ships=self._records,
            seas=self.seas,
            forces=self.forces,
            flow=self.flow,
            met=self.waves,
            tables=self._tables,
            traits=traits_of(self._records, self._expected),
            water=self.water.arrays,
            scratch=scratch_for(max(usable_cores(), 2) if self.parallel else 1),
        )

    @functools.cached_property
    def _sail(self) -> Callable[[int, int], int]:
        """The compiled step of a part of the batch."""
        fleet = self.fleet
        run = direct(sail_rows, (0, 0, fleet))
        return lambda first, last: run(first, last, fleet)

    def __getstate__(self) -> dict[str, Any]:
        """Without what is made of the arrays: a copy makes its own."""
        return {k: v for k, v in self.__dict__.items() if k not in _MADE}

    def _report_divergence(self) -> None:
        i = int(self.lost.argmax())
        state = ", ".join(f"{k}={x:.6g}" for k, x in zip(STATE_NAMES, self.state[i], strict=True))
        command = ", ".join(
            f"{k}={x:.6g}" for k, x in zip(COMMAND_NAMES, self.commands[i], strict=True)
        )
        forces = ", ".join(
            f"{k}={x}" for k, x in zip(FORCE_COMPONENTS, self.forces[i].tolist(), strict=True)
        )
        fastest, turn = self.limits[i]
        why = (
            f"beyond {fastest:.4g} m/s through the water or {turn:.4g} rad/s, where none is a ship"
        )
        if not np.isfinite(self.state[i]).all():
            why = "not finite"
        raise SimulationDiverged(
            f"ship {i} ({self.ships[i].name}) diverged at t = {self.time[i]:.6g} s, {why}: "
            f"state {state}; "
            f"command {command}; forces at the start of the step {forces}"
        )


class _Trial(ShipSim):
    """Ships whose behaviour is being looked at."""

    def _check_ships(self) -> None:
        """They may do what no ship does."""


def limits_of(ship: Ship) -> tuple[float, float]:
    """Speed through the water [m/s] and yaw rate [rad/s] beyond which a ship is none.

    `FASTEST` and `FASTEST_TURN`, of the nominal speed of her file; higher by one factor if that
    speed is so low that her propeller alone drives her faster in calm water.
    """
    nominal = FASTEST * ship.file_speed
    fastest = _fastest(ship, nominal)
    return fastest, FASTEST_TURN * ship.file_speed / ship.hull.L * (fastest / nominal)


def _fastest(ship: Ship, least: float) -> float:
    """`least` [m/s], or `_OF_FULL_AHEAD` of her speed full ahead, torque unlimited, if more."""
    made = fleet([ship])
    record, tables = made.records[0], Tables(made.open_water[0], made.deflected[0])

    def surge(speed: float) -> float:
        own, _ = ship_forces((speed, 0.0, 0.0), (0.0, ship.engine.n_max), record, tables)
        return total(own).X

    low, high = least, 2.0 * least
    if not surge(low) > 0.0:
        return least
    while surge(high) > 0.0 and high < 8.0 * least:  # by more, she is none
        low, high = high, 2.0 * high
    return _OF_FULL_AHEAD * root(surge, low, high, 1e-6) if surge(high) < 0.0 else least


def longest_step(ship: Ship) -> float:
    """Longest integration step [s], L / (28 U0): 1.1 s for KCS at 14.5 kn.

    At it the heading in a 35 deg turn is within 1e-4 rad of the converged one (tests/physics). A
    ship whose nominal speed is less than her file's can still go ahead as fast as that.
    """
    return ship.hull.L / (28.0 * max(ship.speed, ship.file_speed))


def straight_forces(ship: Ship, speed: float, n: float) -> Any:
    """Forces on a straight course with the rudder amidships, as ``physics.dynamics.forces``."""
    made = fleet([ship])
    tables = Tables(made.open_water[0], made.deflected[0])
    return ship_forces((speed, 0.0, 0.0), (0.0, n), made.records[0], tables)


def self_propulsion(ship: Named | Ship, speed: float) -> float:
    """Propeller speed [rev/s] at which thrust (1 - t_P) balances resistance at `speed` [m/s].

    Parameters
    ----------
    ship : str, path or Ship
    speed : float
        Through the water [m/s].

    Raises
    ------
    ConfigError
        The engine cannot reach the speed.
    """
    check_number("speed", speed, 0.0, 100.0, "m/s")
    if speed == 0.0:
        return 0.0
    ship = load_ship(ship)
    made = fleet([ship])
    record, tables = made.records[0], Tables(made.open_water[0], made.deflected[0])

    def surge(n: float) -> float:
        own, _ = ship_forces((speed, 0.0, 0.0), (0.0, n), record, tables)
        return total(own).X

    if not surge(0.0) < 0.0:
        raise ConfigError(
            f"{ship.name} has no resistance: at {speed:.4g} m/s with the propeller stopped the "
            f"force ahead is {surge(0.0):.4g} N; allowed is below 0"
        )

    if surge(ship.engine.n_max) < 0.0:
        raise ConfigError(
            f"{ship.name} cannot hold {speed:.4g} m/s: at its largest propeller speed "
            f"{ship.engine.n_max:.4g} rev/s resistance exceeds thrust"
        )
    return root(surge, 0.0, ship.engine.n_max, 1e-12)


def history_columns(
    time: np.ndarray,
    state: np.ndarray,
    command: np.ndarray,
    forces: np.ndarray,
    flow: np.ndarray,
    waves: np.ndarray,
) -> dict[str, np.ndarray]:
    """Columns of a recording of one ship.

    Parameters
    ----------
    time, state, command, forces, flow, waves : numpy.ndarray
        Shapes (T,), (T, 8), (T, 2), (T, N_FORCES, 3), (T, 7) or (T, 19), (T, 10): row k holds the
        state at ``time[k]``, the command given then and the forces, flow and waves at that instant.

    Returns
    -------
    dict
        ``t``, the state and command names, ``X_hull`` ... ``N_disturbance``, the flow names and
        ``wave_sway`` [m], ``wave_roll``, ``wave_yaw`` [rad], ``wave_yaw_rate`` [rad/s].
    """
    columns = {"t": time}
    columns.update({name: state[:, i] for i, name in enumerate(STATE_NAMES)})
    columns.update({name: command[:, i] for i, name in enumerate(COMMAND_NAMES)})
    for i, component in enumerate(FORCE_COMPONENTS):
        for k, axis in enumerate(FORCE_AXES):
            columns[f"{axis}_{component}"] = forces[:, i, k]
    columns.update({name: flow[:, i] for i, name in enumerate(FLOW_OF_UNITS[: flow.shape[1]])})
    for name in ("sway", "roll", "yaw", "yaw_rate"):
        columns[f"wave_{name}"] = waves[:, WAVE_NAMES.index(name)]
    return {name: np.array(values, dtype=np.float64) for name, values in columns.items()}


def through_water(columns: Mapping[str, np.ndarray] | Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Surge and sway velocity through the water [m/s] of a recording, shapes (T,).

    Parameters
    ----------
    columns : mapping or Trajectory
        With ``u``, ``v``, ``psi``, ``current_speed`` [m/s] and ``current_direction_to`` [rad].
    """
    angle = columns["current_direction_to"] - columns["psi"]
    speed = columns["current_speed"]
    return columns["u"] - speed * np.cos(angle), columns["v"] - speed * np.sin(angle)
