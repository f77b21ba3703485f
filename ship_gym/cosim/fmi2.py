"""What the script inside an FMU of FMI 2.0 needs: its unit, variables and model description."""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ship_gym.cosim.guarded import GuardedUnit
from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.variables import OUTPUT, PARAMETER, REAL, UNIT_DEFINITIONS, Variable
from ship_gym.keys import read_keys

CARD = "unit.json"  # in the resources: what `write_fmu` was told
SHIPS = "ships"  # in the resources: own ship files
FORMAT = 1  # of the card


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
    card = read_keys(resources / CARD)
    card.whole("format", low=FORMAT, high=FORMAT)
    from pythonfmu import DefaultExperiment
    from pythonfmu import variables as kinds
    from pythonfmu.enums import Fmi2Causality, Fmi2Initial, Fmi2Status, Fmi2Variability

    unit = ShipUnit(card.table("values").values, card.whole("propellers", 1, 2), resources / SHIPS)
    guarded = GuardedUnit(unit, lambda line: slave.log(line, Fmi2Status.error))
    for name in ("guid", "modelName", "description", "version"):
        setattr(slave, name, card.text(name))
    slave.default_experiment = DefaultExperiment(start_time=0.0, step_size=card.number("step"))
    for variable in unit.variables.values():
        initial = Fmi2Initial.calculated if variable.causality == OUTPUT else None
        if variable.causality == PARAMETER:
            initial, variability = Fmi2Initial.exact, Fmi2Variability.fixed
        else:
            variability = Fmi2Variability.continuous
        slave.register_variable(
            getattr(kinds, variable.kind)(
                variable.name,
                causality=Fmi2Causality[variable.causality],
                description=variable.meaning,
                initial=initial,
                variability=variability,
                getter=functools.partial(guarded.get, variable),
                setter=functools.partial(guarded.set, variable),
            )
        )
    return guarded


def state_from_bytes(stored: bytes) -> dict[str, Any]:
    """A state that pythonfmu made bytes of; an empty one, which no unit takes, if it is none."""
    try:
        found = json.loads(stored)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


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
    for element in root.find("ModelVariables"):
        _complete(element, unit.variables[element.get("name")], unit.values)
    _add_unknowns(root, unit)
    return root


def unit_definitions() -> Element:
    """``UnitDefinitions`` of FMI 2.0."""
    made = Element("UnitDefinitions")
    for name, unit in UNIT_DEFINITIONS.items():
        one = SubElement(made, "Unit", name=name)
        exponents = {base: str(power) for base, power in unit.exponents.items()}
        SubElement(one, "BaseUnit", exponents, factor=repr(unit.factor))
        for label, factor in unit.display:
            SubElement(one, "DisplayUnit", name=label, factor=repr(factor))
    return made


def _complete(element: Element, variable: Variable, values: Mapping[str, Any]) -> None:
    """Unit, limits and start of one variable; pythonfmu writes no unit and 16 digits."""
    kind = element.find(variable.kind)
    if variable.kind == REAL and variable.unit:
        kind.set("unit", variable.unit)
        if display := UNIT_DEFINITIONS[variable.unit].display:
            kind.set("displayUnit", display[0][0])
    for key, limit in (("min", variable.low), ("max", variable.high)):
        if limit is not None:
            kind.set(key, str(limit))
    if variable.kind == REAL and variable.name in values:
        kind.set("start", repr(float(values[variable.name])))


def _add_unknowns(root: Element, unit: ShipUnit) -> None:
    """``InitialUnknowns``: all outputs. No output depends on an input of the same instant."""
    structure = root.find("ModelStructure")
    for unknown in structure.find("Outputs"):
        unknown.set("dependencies", "")
    unknowns = SubElement(structure, "InitialUnknowns")
    for k, variable in enumerate(unit.variables.values()):
        if variable.causality == OUTPUT:
            SubElement(unknowns, "Unknown", index=str(k + 1))
