"""Variables of a unit, registered with the slave of pythonfmu or pythonfmu3, which are alike."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

from ship_gym.cosim.guarded import GuardedUnit
from ship_gym.cosim.variables import OUTPUT, PARAMETER
from ship_gym.keys import Keys


class Library(NamedTuple):
    """What of a library is named by its version of FMI."""

    experiment: Any  # DefaultExperiment
    kind: Callable[[str], Any]  # class of the variables of a kind of ours
    causality: Any
    initial: Any
    variability: Any


def register(slave: Any, guarded: GuardedUnit, card: Keys, library: Library) -> None:
    """Give a slave the names and the step of its model, and its variables."""
    for name in ("guid", "modelName", "description", "version"):
        setattr(slave, name, card.text(name))
    slave.default_experiment = library.experiment(start_time=0.0, step_size=card.number("step"))
    initials = {OUTPUT: library.initial.calculated, PARAMETER: library.initial.exact}
    for variable in guarded.unit.variables.values():
        fixed = variable.causality == PARAMETER
        varies = library.variability.fixed if fixed else library.variability.continuous
        slave.register_variable(
            library.kind(variable.kind)(
                variable.name,
                causality=library.causality[variable.causality],
                description=variable.meaning,
                initial=initials.get(variable.causality),
                variability=varies,
                getter=functools.partial(guarded.get, variable),
                setter=functools.partial(guarded.set, variable),
            )
        )
