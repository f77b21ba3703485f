"""What blocks of features and actions are made from: the sailing once, a look every interval."""

from __future__ import annotations

import copy
import dataclasses
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.columns import View
from ship_gym_agents.autopilot import Autopilot, Perceived
from ship_gym_agents.fresh import Fresh

if TYPE_CHECKING:
    from ship_gym_agents.forms.form import Form


@dataclasses.dataclass(frozen=True)
class Sailing:
    """What does not change while `count` ships of one kind sail a scenario.

    Attributes
    ----------
    form : Form
    count : int
    ship : Ship
    scenario : Scenario
        Without privileged observations.
    base : Autopilot or None
    step : float
        Control interval over L / U0.
    """

    form: Form
    count: int
    ship: Ship
    scenario: Scenario
    base: Autopilot | None
    step: float


class Look(NamedTuple):
    """What the ships see in one interval; arrays of shape (count,) or (count, columns).

    Attributes
    ----------
    observations : numpy.ndarray
        Without the privileged ones, float64.
    seen : View
        The same by name.
    base : Autopilot or None
    perceived : Perceived or None
        What the base makes of them; None without one.
    own : numpy.ndarray or None
        Action of the base; None without one, and with guidance, where it steers afterwards.
    followed : tuple or None
        Heading less ordered heading [rad] and r' that the base leads to; with guidance those of
        the interval before.
    """

    observations: np.ndarray
    seen: View
    base: Autopilot | None
    perceived: Perceived | None
    own: np.ndarray | None
    followed: tuple[np.ndarray, np.ndarray] | None

    @property
    def steers(self) -> tuple[Autopilot, Perceived]:
        """The base and what it perceives; asked only where there is a base."""
        assert self.base is not None and self.perceived is not None
        return self.base, self.perceived


def twin(thing: Any) -> Any:
    """A copy of something with a memory that can go on without changing the original.

    Memories are whatever has a `restart`; their arrays are replaced, never written into, when a
    measurement is taken, so the twins may share them until then.
    """
    if isinstance(thing, list):
        return [twin(one) for one in thing]
    if not (isinstance(thing, Fresh) or callable(getattr(thing, "restart", None))):
        return thing
    made = copy.copy(thing)
    for name, value in vars(thing).items():
        setattr(made, name, twin(value))
    return made
