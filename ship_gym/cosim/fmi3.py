"""What the script inside an FMU of FMI 3.0 needs: its unit, variables and model description."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from ship_gym.cosim.card import opened, state_from_bytes
from ship_gym.cosim.description import complete_variable, part, unit_definitions
from ship_gym.cosim.guarded import GuardedUnit
from ship_gym.cosim.registration import Library, register
from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.variables import REAL, WHOLE

__all__ = ["completed", "open_unit", "state_from_bytes", "step_result"]

_KINDS = {REAL: "Float64", WHOLE: "Int32"}  # the others have the same names
_TIME = "time"


def open_unit(slave: Any, resources: Path) -> GuardedUnit:
    """The unit of the resources of an FMU; its variables are registered with pythonfmu3's slave.

    Parameters
    ----------
    slave : pythonfmu3.Fmi3Slave
    resources : Path

    Raises
    ------
    ConfigError
        The card in them is of another version, or damaged.
    """
    guarded, card = opened(resources, lambda line: slave.log(line, Fmi3Status.error))
    from pythonfmu3 import DefaultExperiment
    from pythonfmu3 import variables as kinds
    from pythonfmu3.enums import Fmi3Causality, Fmi3Initial, Fmi3Status, Fmi3Variability

    register(
        slave,
        guarded,
        card,
        Library(
            DefaultExperiment,
            lambda kind: getattr(kinds, _KINDS.get(kind, kind)),
            Fmi3Causality,
            Fmi3Initial,
            Fmi3Variability,
        ),
    )
    slave.register_variable(
        kinds.Float64(
            _TIME,
            causality=Fmi3Causality.independent,
            variability=Fmi3Variability.continuous,
            getter=guarded.time,
        )
    )
    return guarded


def step_result(done: bool) -> Any:
    """What a step gives back to pythonfmu3."""
    from pythonfmu3 import Fmi3Status, Fmi3StepResult

    return Fmi3StepResult(Fmi3Status.ok if done else Fmi3Status.error)


def completed(root: Element, unit: ShipUnit) -> Element:
    """A model description of pythonfmu3 with units, limits, exact starts and dependencies.

    Parameters
    ----------
    root : Element
        ``fmiModelDescription``; changed in place.
    unit : ShipUnit

    Returns
    -------
    Element
        `root`.
    """
    root.insert(1, unit_definitions())  # behind CoSimulation
    for element in part(root, "ModelVariables"):
        if (name := element.attrib["name"]) != _TIME:
            complete_variable(element, unit.variables[name], unit.values)
    for output in part(root, "ModelStructure").iter("Output"):
        output.set("dependencies", "")  # no output depends on an input of the same instant
    return root
