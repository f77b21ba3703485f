"""`ShipUnit`: a ship in a sea as a unit of other simulators, whatever standard wraps it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, shown
from ship_gym.conventions import FORCE_AXES
from ship_gym.cosim.values import check, sea_of, ship_of
from ship_gym.cosim.variables import (
    CURRENT,
    ELEVATION,
    FLOW,
    FLOW_OF_TWO,
    LOADS,
    MOTIONS,
    OUTPUT,
    PLACE,
    PROPELLER,
    RUDDER,
    STATES,
    variables,
)
from ship_gym.simulation import ShipSim, SimulationDiverged

_OFF, _ROUNDING = 1e-6, 1e-9  # a step may begin so far from the end of the last [s], share of t
_FORMAT = 1  # of a stored state
# what a step changes, beside the current of now
_ARRAYS = ("state", "time", "commands", "clock", "lost", "forces", "flow", "met")
_CURRENT = ("V_north", "V_east")


class ShipUnit:
    """One ship, stepped by a master: values by name, one ``ShipSim.step`` for each step.

    A communication step of any length is one interval of ``ShipSim``, which parts it into equal
    steps inside, none longer than ``integration.interval``: nothing is rounded to a grid of time.

    Parameters
    ----------
    values : mapping
        What inputs and parameters start with, as ``values.start_values`` gives it.
    propellers : int
        Number that the outputs are of.
    folder : Path
        Where own ship files are.

    Attributes
    ----------
    variables : dict
        `Variable` by name, in the order of the description.
    values : dict
        Of inputs and parameters now.
    running : bool
        Whether parameters are fixed.
    start_time : float or None
        [s]; None: where the first step begins.
    """

    def __init__(self, values: Mapping[str, Any], propellers: int, folder: Path):
        self.values, self.propellers, self.folder = dict(values), propellers, folder
        self._placed = "start.latitude" in self.values
        self.variables = {v.name: v for v in variables(propellers, self._placed)}
        self.running = False
        self.start_time: float | None = None
        self._sim: ShipSim | None = None
        self._loads: tuple[np.ndarray, np.ndarray] | None = None
        self._chart: Any = None

    # -- values -------------------------------------------------------------------------------

    def set(self, name: str, value: Any) -> None:
        """Set an input, or a parameter before the unit runs.

        Raises
        ------
        ConfigError
            A parameter of a unit that runs, or an output.
        """
        causality = self.variables[name].causality
        if causality == OUTPUT or (causality != "input" and self.running):
            why = "it is an output" if causality == OUTPUT else "it is fixed while the unit runs"
            raise ConfigError(f"{name} = {shown(value)}: {why}")
        if self.values[name] != value and causality != "input":
            self._sim = None
        self.values[name] = value

    def get(self, name: str) -> Any:
        """Value of a variable now; outputs of a unit not yet running are those of the start."""
        if name in self.values:
            return self.values[name]
        sim = self._made()
        if name in _STATE_OF:
            return float(sim.state[0, _STATE_OF[name]])
        if name in _MOTION_OF:
            return float(sim.waves[0, _MOTION_OF[name]])
        if name in _CURRENT_OF:
            return float(sim.seas[_CURRENT_OF[name]][0])
        if name == ELEVATION.name:
            return float(sim.elevation(*sim.state[0, [_NORTH, _EAST]]))
        if name in _PLACE_OF:
            return self._place()[_PLACE_OF[name]]
        forces, flow = self._loads_now()
        if name in _LOAD_OF:
            return float(forces[(0, *_LOAD_OF[name])])
        return float(flow[0, _FLOW_OF[name]])

    def _loads_now(self) -> tuple[np.ndarray, np.ndarray]:
        """Forces and flow at the end of the last step, which is the start of the next one."""
        if self._loads is None:
            sim = self._made()
            if not sim.fleet.clock[0, 1]:  # no step yet: as in one of the longest inside
                sim.set_interval(float(sim.longest[0]))
            self._loads = sim.loads_now(np.array([0]))
        return self._loads

    def _place(self) -> tuple[float, float]:
        """Latitude and longitude [deg]."""
        if self._chart is None:
            from ship_gym.charts.chart import Chart  # late: not every unit has a place

            start = self.values["start.latitude"], self.values["start.longitude"]
            self._chart = Chart.about(*start)
        north, east = (self._made().state[:1, k] for k in (_NORTH, _EAST))
        latitude, longitude = self._chart.place(north, east)
        return float(latitude[0]), float(longitude[0])

    # -- life ---------------------------------------------------------------------------------

    def start(self) -> None:
        """Put the ship at the start and fix the parameters.

        Raises
        ------
        ConfigError
            A parameter that is refused.
        """
        self._made()
        self.running = True

    def _made(self) -> ShipSim:
        if self._sim is None:
            self._sim = self._make()
            self._loads = self._chart = None
        return self._sim

    def _make(self) -> ShipSim:
        """The simulation at its start."""
        values = self.values
        check({name: v for name, v in values.items() if self.variables[name].causality != "input"})
        ship = ship_of(values, self.folder)
        if ship.propellers != self.propellers:
            raise ConfigError(
                f"ship.name = {shown(values['ship.name'])}: has {ship.propellers} propellers, the "
                f"outputs of this unit are of {self.propellers}; export one for her"
            )
        sim = ShipSim(ship, sea=sea_of(values, ship), parallel=False)
        if values["integration.interval"] > 0.0:
            sim.longest[:] = np.minimum(sim.longest, values["integration.interval"])
        n = None if values["start.self_propulsion"] else values["start.propeller_speed"]
        speed, heading = values["start.speed"], values["start.heading"]
        sim.reset(int(values["seed"]), speed=speed, n=n, psi=heading)
        return sim

    def time(self) -> float:
        """Where the unit is [s]."""
        return (self.start_time or 0.0) + (float(self._sim.time[0]) if self._sim else 0.0)

    def step(self, time: float, interval: float) -> str:
        """Hold the inputs for one communication step.

        Parameters
        ----------
        time, interval : float
            Where it begins, and its length [s].

        Returns
        -------
        str
            Empty; or why there was no step, in a line: the unit is then as before it.
        """
        sim = self._made()
        now = time if self.start_time is None else self.time()
        if not abs(time - now) <= _OFF + _ROUNDING * abs(now):
            return f"a step from t = {time:.9g} s, but the unit is at {now:.9g} s"
        before = self._kept()
        try:
            sim.step([[self.values[RUDDER], self.values[PROPELLER]]], interval)
        except (ConfigError, SimulationDiverged) as error:
            self._put_back(before)
            return " ".join(str(error).split())
        if self.start_time is None:
            self.start_time = time
        self._loads = None
        return ""

    # -- states -------------------------------------------------------------------------------

    def stored(self) -> dict[str, Any]:
        """All that is needed to go on from now, as plain values that JSON keeps bit for bit."""
        kept = self._kept() if self.running else {}
        return {
            "format": _FORMAT,
            "values": dict(self.values),
            "start_time": self.start_time,
            "running": self.running,
            "arrays": {name: array.ravel().tolist() for name, array in kept.items()},
        }

    def restore(self, stored: Mapping[str, Any]) -> None:
        """Go back to a state that `stored` gave, of this or of an equal unit.

        Raises
        ------
        ConfigError
            It is none of this unit.
        """
        values: Any = stored.get("values")
        if stored.get("format") != _FORMAT or values.keys() != self.values.keys():
            raise ConfigError("no state of this unit, or of another version of Ship Gym")
        fixed = {k for k in values if self.variables[k].causality != "input"}
        if any(values[name] != self.values[name] for name in fixed):
            self._sim = None
        self.values, self.start_time = dict(values), stored["start_time"]
        self.running = bool(stored["running"])
        if not self.running:
            self._sim = None
            return
        shapes = {name: array.shape for name, array in self._kept().items()}
        arrays = {k: np.array(v, dtype=np.float64) for k, v in stored["arrays"].items()}
        if {k: v.size for k, v in arrays.items()} != {k: math.prod(v) for k, v in shapes.items()}:
            raise ConfigError("a state of a unit with another ship")
        self._put_back({name: array.reshape(shapes[name]) for name, array in arrays.items()})

    def _kept(self) -> dict[str, np.ndarray]:
        sim = self._made()
        kept = {name: getattr(sim.fleet, name).copy() for name in _ARRAYS}
        return kept | {name: sim.seas[name].copy() for name in _CURRENT}

    def _put_back(self, kept: Mapping[str, np.ndarray]) -> None:
        sim = self._made()
        for name, array in kept.items():
            (sim.seas[name] if name in _CURRENT else getattr(sim.fleet, name))[...] = array
        self._loads = None


_STATE_OF = {variable.name: k for k, variable in enumerate(STATES)}
_NORTH, _EAST = _STATE_OF["ned_position.north"], _STATE_OF["ned_position.east"]
_MOTION_OF = {variable.name: k for k, variable in MOTIONS.items()}
_CURRENT_OF = {variable.name: name for variable, name in zip(CURRENT, _CURRENT, strict=True)}
_PLACE_OF = {variable.name: k for k, variable in enumerate(PLACE)}
_FLOW_OF = {variable.name: k for k, variable in enumerate((*FLOW, *FLOW_OF_TWO))}
_LOAD_OF = {
    component[axis].name: (row, axis)
    for row, component in enumerate(LOADS)
    for axis in range(len(FORCE_AXES))
}
