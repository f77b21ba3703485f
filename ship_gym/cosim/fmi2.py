"""What the script inside an FMU of FMI 2.0 needs: its unit, variables and model description."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ship_gym.cosim.card import opened, state_from_bytes
from ship_gym.cosim.description import complete_variable, part, unit_definitions
from ship_gym.cosim.guarded import GuardedUnit
from ship_gym.cosim.registration import Library, register
from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.variables import OUTPUT

__all__ = ["completed", "open_unit", "state_from_bytes"]


def open_unit(slave: Any, resources: Path) -> GuardedUnit:
    """The unit of the resources of an FMU; its variables are registered with pythonfmu's slave.

    Parameters
    ----------
    slave : pythonfmu.Fmi2Slave
    resources : Path

    Raises
    ------
    ConfigError
        The card in them is of another version, or damaged.
    """
    guarded, card = opened(resources, lambda line: slave.log(line, Fmi2Status.error))
    from pythonfmu import DefaultExperiment
    from pythonfmu import variables as kinds
    from pythonfmu.enums import Fmi2Causality, Fmi2Initial, Fmi2Status, Fmi2Variability

    register(
        slave,
        guarded,
        card,
        Library(
            DefaultExperiment,
            lambda kind: getattr(kinds, kind),
            Fmi2Causality,
            Fmi2Initial,
            Fmi2Variability,
        ),
    )
    return guarded


def completed(root: Element, unit: ShipUnit) -> Element:
    """A model description of pythonfmu with units, limits, exact starts and initial unknowns.

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
        variable = unit.variables[element.attrib["name"]]
        complete_variable(part(element, variable.kind), variable, unit.values)
    structure = part(root, "ModelStructure")
    for unknown in part(structure, "Outputs"):
        unknown.set("dependencies", "")  # no output depends on an input of the same instant
    unknowns = SubElement(structure, "InitialUnknowns")
    for k, variable in enumerate(unit.variables.values()):
        if variable.causality == OUTPUT:
            SubElement(unknowns, "Unknown", index=str(k + 1))
    return root
