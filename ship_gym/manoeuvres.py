"""Standard manoeuvres and their measures: turning circle and zig-zag, with the IMO limits.

Those with the engine are in ``stopping``, those of course stability in ``stability``.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_angle, check_number
from ship_gym.conventions import PSI
from ship_gym.provenance import provenance
from ship_gym.recording.about import ship_meta
from ship_gym.recording.thinning import thinned
from ship_gym.recording.trajectory import Trajectory
from ship_gym.sea.records import current_at
from ship_gym.sea.state import CALM, Sea, regular_sea
from ship_gym.sea.surface import wave_entries
from ship_gym.ships.files import Named
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Ship
from ship_gym.ships.trials import Trial
from ship_gym.simulation import ShipSim, history_columns, self_propulsion, through_water

_SAMPLE = 1.0 / 400.0  # output step in L / U0: 0.08 s for KCS at 14.5 kn
# Rows of a recording per L / U0: 1.5 s for KCS at 14.5 kn, some ten while the rudder goes over and
# four to six in the period at which she meets waves of half her length to her length.
_RECORDED = 20.0
_LISTED = 8  # most values of a measure that become metrics of their own, as overshoots do
# Units of the measures of all manoeuvres; the others are ratios.
_UNITS = {
    **dict.fromkeys(("advance", "transfer", "tactical_diameter", "max_advance"), "L"),
    **dict.fromkeys(("max_transfer", "steady_diameter", "drift_distance", "initial_turning"), "L"),
    **dict.fromkeys(("head_reach", "lateral_deviation", "track_reach"), "L"),
    **dict.fromkeys(("steady_drift", "drift_direction", "overshoots", "heading_change"), "rad"),
    **dict.fromkeys(("loop_width", "neutral_angle", "delta"), "rad"),
    **dict.fromkeys(("execute_times", "period", "time", "reversal", "half_time"), "s"),
    **dict.fromkeys(("steady_thrust", "rudder_normal_force", "largest_astern_thrust"), "N"),
    "steady_torque": "N m",
    "final_n": "rev/s",
    "slope": "1/rad",
}
_TURNS = 2.5  # turns sailed in a turning circle; the last one is the steady part


@dataclasses.dataclass(frozen=True)
class TurningCircle:
    """Measures of a turning circle; lengths in L, from the point of rudder execution.

    Attributes
    ----------
    advance, transfer : float
        At 90 deg change of heading, along and across the approach course.
    tactical_diameter : float
        Transfer at 180 deg.
    max_advance, max_transfer : float
        Largest of the first turn.
    steady_diameter : float
        2 U / abs(r) of the last turn.
    steady_speed_ratio : float
        U / U0 of the last turn.
    steady_drift : float
        Drift angle of the last turn [rad].
    steady_yaw_rate : float
        r' = r L / U of the last turn, positive to starboard.
    steady_thrust, steady_torque : float
        [N], [N m].
    rudder_normal_force : float
        On the whole rudder, steady [N].
    steady_J : float
        Advance ratio u / (n D).
    drift_distance : float
        From the position at 180 deg to that at 540 deg change of heading.
    drift_direction : float
        Direction of that displacement from north [rad].
    """

    advance: float
    transfer: float
    tactical_diameter: float
    max_advance: float
    max_transfer: float
    steady_diameter: float
    steady_speed_ratio: float
    steady_drift: float
    steady_yaw_rate: float
    steady_thrust: float
    steady_torque: float
    rudder_normal_force: float
    steady_J: float
    drift_distance: float
    drift_direction: float
    trajectory: Trajectory

    def measures(self) -> dict[str, float]:
        """All measures by name, without the trajectory."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)[:-1]}


@dataclasses.dataclass(frozen=True)
class ZigZag:
    """Measures of a zig-zag manoeuvre.

    Attributes
    ----------
    overshoots : tuple of float
        Heading past +-psi after each reversal of the rudder [rad], in order.
    execute_times : tuple of float
        Times of the reversals [s].
    initial_turning : float
        Distance sailed along the approach course at the first reversal [L].
    period : float
        Time from the first to the third reversal [s]; nan if not reached.
    """

    overshoots: tuple[float, ...]
    execute_times: tuple[float, ...]
    initial_turning: float
    period: float
    trajectory: Trajectory

    def measures(self) -> dict[str, Any]:
        """All measures by name, without the trajectory."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)[:-1]}


def turning_circle(
    ship: Named | Ship,
    delta: float = math.radians(35.0),
    speed: float | None = None,
    n: float | None = None,
    sea: Sea | None = None,
) -> TurningCircle:
    """Turning circle from a straight course to the north, rudder executed at the origin at t = 0.

    Parameters
    ----------
    ship : str, path or Ship
    delta : float
        Rudder angle [rad], positive to starboard.
    speed : float, optional
        Approach speed through the water [m/s]; the ship's nominal speed if omitted.
    n : float, optional
        Constant propeller speed [rev/s]; self-propulsion at `speed` if omitted.
    sea : Sea, optional
        Calm water if omitted.

    Raises
    ------
    ConfigError
        Rudder beyond the gear's limit or in degrees, or a ship that does not turn.
    """
    ship = load_ship(ship)
    U0, n = approach(ship, delta, speed, n)
    if delta == 0.0:
        raise ConfigError("delta = 0: a turning circle needs a rudder angle")
    run = Run(ship, U0, n, sea)
    limit = _TURNS * 2.0 * math.pi
    run.until(lambda sim, t: abs(sim.state[0, PSI]) >= limit, delta, 120.0 * ship.hull.L / U0)
    turned, time = run.sim.state[0, PSI], run.sim.time[0]
    if abs(turned) < limit:
        raise ConfigError(
            f"{ship.name}: {math.degrees(turned):.0f} deg of heading after {time:.4g} s at "
            f"delta = {math.degrees(delta):.3g} deg: no turning circle"
        )
    columns = run.columns()
    config = {"manoeuvre": "turning_circle", "delta": delta, "speed": U0, "n": n}
    return _circle_measures(ship, U0, columns, run.trajectory(columns, config))


def _circle_measures(ship: Ship, U0: float, c: dict, trajectory: Trajectory) -> TurningCircle:
    L, side = ship.hull.L, math.copysign(1.0, c["psi"][-1])
    turned = side * c["psi"]

    def at(angle: float, name: str) -> float:
        return float(np.interp(math.radians(angle), turned, c[name]))

    first = turned <= 2.0 * math.pi
    last = turned >= turned[-1] - 2.0 * math.pi
    water_u, water_v = through_water(c)
    U = np.hypot(water_u, water_v)

    def steady(values: np.ndarray) -> float:
        return float(np.mean(values[last]))

    F_N = abs(steady(c["rudder_normal_force"]))
    dx, dy = (at(540, k) - at(180, k) for k in ("x", "y"))
    return TurningCircle(
        advance=at(90, "x") / L,
        transfer=side * at(90, "y") / L,
        tactical_diameter=side * at(180, "y") / L,
        max_advance=float(c["x"][first].max()) / L,
        max_transfer=float((side * c["y"])[first].max()) / L,
        steady_diameter=2.0 * steady(U) / abs(steady(c["r"])) / L,
        steady_speed_ratio=steady(U) / U0,
        steady_drift=steady(np.arctan2(-water_v, water_u)),
        steady_yaw_rate=steady(c["r"]) * L / steady(U),
        steady_thrust=steady(c["thrust"]),
        steady_torque=steady(c["torque"]),
        rudder_normal_force=F_N,
        steady_J=steady(c["J"]),
        drift_distance=math.hypot(dx, dy) / L,
        drift_direction=math.atan2(dy, dx),
        trajectory=trajectory,
    )


def zigzag(
    ship: Named | Ship,
    delta: float = math.radians(10.0),
    psi: float = math.radians(10.0),
    speed: float | None = None,
    n: float | None = None,
    sea: Sea | None = None,
    overshoots: int = 4,
) -> ZigZag:
    """Zig-zag manoeuvre; negative `delta` and `psi` turn to port first.

    Parameters
    ----------
    ship : str, path or Ship
    delta, psi : float
        Rudder angle and heading of the reversals [rad], of one sign.
    speed, n, sea
        As in `turning_circle`.
    overshoots : int
        Number of overshoots to sail.

    Raises
    ------
    ConfigError
        Angles of different sign or in degrees, rudder beyond the gear's limit, or a heading that is
        not reached.
    """
    ship = load_ship(ship)
    U0, n = approach(ship, delta, speed, n)
    check_angle("psi", psi, math.pi / 2)
    if delta * psi <= 0.0:
        raise ConfigError(f"delta = {delta:.4g}, psi = {psi:.4g} rad: must have one sign, not zero")
    run = Run(ship, U0, n, sea)
    side = math.copysign(1.0, delta)
    reversals, found = [], []
    target = abs(psi)
    for k in range(overshoots + 1):
        towards = side if k % 2 == 0 else -side
        start = run.rows
        run.until(
            lambda sim, t, s=towards: s * sim.state[0, PSI] >= target,
            towards * abs(delta),
            60.0 * ship.hull.L / U0,
        )
        if towards * run.sim.state[0, PSI] < target:
            degrees = math.degrees(psi)
            raise ConfigError(f"{ship.name}: heading {degrees:.4g} deg not reached: no zig-zag")
        reversals.append(float(run.sim.time[0]))
        if k > 0:
            found.append(run.overshoot(start, -towards, target))
    columns = run.columns()
    config = {"manoeuvre": "zigzag", "delta": delta, "psi": psi, "speed": U0, "n": n}
    return ZigZag(
        overshoots=tuple(found),
        execute_times=tuple(reversals),
        initial_turning=float(np.interp(reversals[0], columns["t"], columns["x"])) / ship.hull.L,
        period=reversals[2] - reversals[0] if len(reversals) > 2 else math.nan,
        trajectory=run.trajectory(columns, config),
    )


def approach(ship: Ship, delta: float, speed: float | None, n: float | None) -> Any:
    """Checked approach speed [m/s] and propeller speed [rev/s]."""
    check_angle("delta", delta, ship.gear.delta_max)
    U0 = check_number("speed", ship.speed if speed is None else speed, 1e-6, 100.0, "m/s")
    n = self_propulsion(ship, U0) if n is None else n
    return U0, check_number("n", n, 0.0, ship.engine.n_max, "rev/s")


class Run:
    """One ship sailing under changing commands, every step kept.

    Parameters
    ----------
    ship : Ship
    U0, n : float
        Approach speed [m/s] and propeller speed [rev/s].
    sea : Sea or None
    sample : float
        Output step [L / U0].
    at_rest : bool
        Start from rest with the propeller stopped.

    Attributes
    ----------
    n : float
        Ordered propeller speed [rev/s]; may be changed under way.
    """

    def __init__(
        self,
        ship: Ship,
        U0: float,
        n: float,
        sea: Sea | None,
        sample: float = _SAMPLE,
        at_rest: bool = False,
    ):
        self.ship, self.n, self.sea = ship, n, CALM if sea is None else sea
        self.sim = ShipSim(ship, 1, self.sea)
        self.sim.reset(0, speed=0.0 if at_rest else U0, n=0.0 if at_rest else n)
        self.dt = sample * ship.hull.L / U0
        self._kept: list[tuple[np.ndarray, ...]] = []

    @property
    def rows(self) -> int:
        """Number of rows kept."""
        return len(self._kept)

    def until(self, reached: Any, delta: float, longest: float) -> None:
        """Sail with rudder command `delta` [rad] until `reached(sim, time)` or `longest` [s]."""
        sim, end = self.sim, self.sim.time[0] + longest
        now, then = (sim.state[0], sim.waves[0]), (sim.commands[0], sim.forces[0], sim.flow[0])
        command = np.array([[delta, self.n]])
        sail: Callable[[], Any] = functools.partial(sim.step, command, self.dt)
        while sim.time[0] < end and not reached(sim, sim.time[0]):
            time, state, waves = sim.time[0], *(part.copy() for part in now)
            sail()
            sail = sim.advance  # on under the same commands, which need no second look
            self._kept.append((time, state, *(part.copy() for part in then), waves))

    def overshoot(self, start: int, side: float, target: float) -> float:
        """Largest heading past `target` [rad] on one side since row `start`."""
        heading = np.array([row[1][PSI] for row in self._kept[start:]])
        return float(np.max(side * heading) - target)

    def columns(self) -> dict[str, np.ndarray]:
        """The history as recording columns."""
        parts = [np.array(part) for part in zip(*self._kept, strict=True)]
        columns = history_columns(*parts)
        columns["current_speed"] = np.full(self.rows, self.sea.current_speed)
        if self.sea.current_variation > 0.0:
            sea = self.sim.seas[0]
            vary = (sea["variation"], sea["variation_omega"], sea["variation_phase"])
            columns["current_speed"] *= current_at(*vary, columns["t"])
        columns["current_direction_to"] = np.full(self.rows, self.sea.current_direction_to)
        if self.sea.wind_speed > 0.0:
            columns["wind_speed"] = np.full(self.rows, self.sea.wind_speed)
            columns["wind_direction_from"] = np.full(self.rows, self.sea.wind_direction_from)
        return columns

    def trajectory(self, columns: dict[str, np.ndarray], config: dict[str, Any]) -> Trajectory:
        """The history with what is needed to sail it again."""
        meta = {
            "task": config["manoeuvre"],
            "config": {**config, "sea": dataclasses.asdict(self.sea), "dt": self.dt},
            "seed": 0,
            "ship": ship_meta(self.ship),
            "waves": wave_entries(self.sim.water.waves_of(0)),
            **provenance(),
        }
        return Trajectory(columns, meta)


def recording(result: Any) -> Trajectory:
    """What a file keeps of a manoeuvre: fewer rows, and the measures from all of them.

    Parameters
    ----------
    result : TurningCircle, ZigZag, stopping.SpeedChange, stability.PullOut or stability.Spiral

    Returns
    -------
    Trajectory
        With ``metrics`` (numbers, angles in rad; None: not reached), their ``units`` and
        ``curves`` (a spiral's measures of many values) in its meta.
    """
    full = result.trajectory
    metrics: dict[str, Any] = {}
    units: dict[str, str] = {}
    curves: dict[str, Any] = {}
    for name, value in result.measures().items():
        if not isinstance(value, tuple):
            found = {name: value if math.isfinite(value) else None}
        elif len(value) <= _LISTED:
            one = name.removesuffix("s")  # overshoot_1 of overshoots
            found = {f"{one}_{k}": v for k, v in enumerate(value, start=1)}
        else:
            found, curves[name] = {}, list(value)
        metrics |= found
        units |= dict.fromkeys(found, _UNITS.get(name, "-"))
    meta = {"kind": "manoeuvre", "metrics": metrics, "units": units}
    meta |= {"curves": curves} if curves else {}
    unit = full.meta["ship"]["L"] / full.meta["config"]["speed"]
    return thinned(Trajectory(full.columns, full.meta | meta), unit / _RECORDED)


def run_trial(ship: Named | Ship, trial: Trial) -> TurningCircle | ZigZag:
    """Sail a measured manoeuvre of a ship file, in its waves."""
    ship = load_ship(ship)
    delta, sea = math.radians(trial.delta_deg), trial_sea(ship, trial)
    if trial.manoeuvre == "turning_circle":
        return turning_circle(ship, delta, trial.speed, trial.n, sea)
    if trial.manoeuvre == "zigzag":
        return zigzag(ship, delta, math.radians(trial.psi_deg), trial.speed, trial.n, sea)
    raise ConfigError(
        f"trial of {ship.name}: unknown manoeuvre {trial.manoeuvre!r}; "
        "known: turning_circle, zigzag"
    )


def trial_sea(ship: Ship, trial: Trial) -> Sea:
    """The sea of a trial, for an approach to the north."""
    if not trial.waves:
        return CALM
    return regular_sea(
        0.5 * trial.wave_height,
        wavelength=trial.wavelength * ship.hull.L,
        direction_from=math.radians(trial.wave_from_deg),
    )


def imo_limits(ship: Named | Ship, speed: float) -> dict[str, float]:
    """Limits of IMO MSC.137(76) for a ship at an approach speed [m/s].

    Returns
    -------
    dict
        advance, tactical_diameter and the track reach of a stop from full ahead [L] (up to 20 for
        large ships, by the Administration), first and second 10/10 overshoot and first 20/20
        overshoot [rad]; L/V in full-scale seconds.
    """
    ship = load_ship(ship)
    t = ship.hull.L / speed * ship.time_unit
    first = 10.0 if t < 10.0 else 20.0 if t >= 30.0 else 5.0 + 0.5 * t
    second = 25.0 if t < 10.0 else 40.0 if t >= 30.0 else 17.5 + 0.75 * t
    return {
        "advance": 4.5,
        "tactical_diameter": 5.0,
        "track_reach": 15.0,
        "initial_turning": 2.5,
        "overshoot_10_10_first": math.radians(first),
        "overshoot_10_10_second": math.radians(second),
        "overshoot_20_20_first": math.radians(25.0),
    }
