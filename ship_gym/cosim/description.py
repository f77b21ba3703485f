"""What pythonfmu leaves out of a model description, the same in FMI 2.0 and 3.0."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ship_gym.cosim.variables import REAL, UNIT_DEFINITIONS, Variable


def unit_definitions() -> Element:
    """``UnitDefinitions``."""
    made = Element("UnitDefinitions")
    for name, unit in UNIT_DEFINITIONS.items():
        one = SubElement(made, "Unit", name=name)
        exponents = {base: str(power) for base, power in unit.exponents.items()}
        SubElement(one, "BaseUnit", exponents, factor=repr(unit.factor))
        for label, factor in unit.display:
            SubElement(one, "DisplayUnit", name=label, factor=repr(factor))
    return made


def part(element: Element, name: str) -> Element:
    """The part of a name, which every description has."""
    found = element.find(name)
    assert found is not None, name
    return found


def complete_variable(kind: Element, variable: Variable, values: Mapping[str, Any]) -> None:
    """Unit, limits and start of one variable; pythonfmu writes no unit and 16 digits."""
    if variable.kind == REAL and variable.unit:
        kind.set("unit", variable.unit)
        if display := UNIT_DEFINITIONS[variable.unit].display:
            kind.set("displayUnit", display[0][0])
    for key, limit in (("min", variable.low), ("max", variable.high)):
        if limit is not None:
            kind.set(key, repr(float(limit)) if variable.kind == REAL else str(limit))
    if variable.kind == REAL and variable.name in values:
        kind.set("start", repr(float(values[variable.name])))
