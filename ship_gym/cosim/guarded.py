"""`GuardedUnit`: a unit whose errors are lines of a log, never exceptions.

pythonfmu gives up an instance from which an exception comes, and a master that calls it once more
ends with a crash. Nor can its functions but ``doStep`` say that something was refused. So a line
is logged, and from then on every step is refused with it until the unit is reset. pythonfmu3, for
FMI 3.0, is the same.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ship_gym.config import cut
from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.variables import REAL, Variable


class GuardedUnit:
    """A `ShipUnit` behind functions that do not raise.

    Parameters
    ----------
    unit : ShipUnit
    log : callable
        Takes a line, as an error.

    Attributes
    ----------
    broken : str
        Why no step is made until the unit is reset; empty: nothing is wrong.
    refused : bool
        Whether the last step was refused. Then outputs are nan until one is made: a master that
        passes over the status must not take the ship of before for that of now.
    """

    def __init__(self, unit: ShipUnit, log: Callable[[str], None]):
        self.unit, self._log, self.broken, self.refused = unit, log, "", False

    @contextlib.contextmanager
    def _kept(self) -> Iterator[None]:
        """Log an exception as a line, and refuse all steps from now on."""
        try:
            yield
        except Exception as error:  # whatever it is, it would end the master
            known = str(error) if isinstance(error, ValueError) else repr(error)
            self.broken = one_line(known)
            self._log(self.broken)

    def get(self, variable: Variable) -> Any:
        """Value of a variable; nan of an output that cannot be had."""
        if (self.broken or self.refused) and variable.name not in self.unit.values:
            return math.nan
        with self._kept():
            return self.unit.get(variable.name)
        return math.nan if variable.kind == REAL else 0

    def set(self, variable: Variable, value: Any) -> None:
        """Set an input, or a parameter before the unit runs."""
        with self._kept():
            self.unit.set(variable.name, value)

    def start(self) -> None:
        """Put the ship at the start."""
        self.refused = False
        if not self.broken:
            with self._kept():
                self.unit.start()

    def step(self, time: float, interval: float) -> bool:
        """Sail one communication step; False, and a line in the log, if she stays where she is."""
        refused = self.broken
        if not refused:
            with self._kept():
                refused = self.unit.step(time, interval)
            if self.broken:
                return False
        self.refused = bool(refused)
        if refused:
            self._log(one_line(refused))
        return not refused

    def time(self) -> float:
        """Time now [s]."""
        with self._kept():
            return self.unit.time()
        return math.nan

    def stored(self) -> dict[str, Any]:
        """As `ShipUnit.stored`; empty if there is nothing to store."""
        with self._kept():
            return self.unit.stored()
        return {}

    def restore(self, state: Mapping[str, Any]) -> None:
        """As `ShipUnit.restore`."""
        with self._kept():
            self.unit.restore(state)
            self.broken, self.refused = "", False


def one_line(text: str) -> str:
    """A line for a logger of FMI, which may read it as a format of C."""
    return cut(" ".join(text.split()).replace("%", " percent"))
