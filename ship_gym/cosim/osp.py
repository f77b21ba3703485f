"""Groups of variables for the Open Simulation Platform: ``MODEL_OspModelDescription.xml``.

By the schema of OspModelDescription 1.0.1 of OSP-IS: what belongs together has a kind and a unit,
so that libcosim connects groups and refuses those that do not fit. libcosim looks for the file
beside the FMU, by the name of its model.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import Element, ElementTree, SubElement, indent

from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.variables import PROPELLER, RUDDER

_NAMESPACE = "https://open-simulation-platform.com/OspModelDescription/1.0.1"
# kinds in the order of the schema; each group with its variables, apart by their last name
_LOADS = ("hull", "propeller", "rudder", "wave", "wind", "disturbance")
_GROUPS: tuple[tuple[str, str, tuple[tuple[str, str], ...]], ...] = (
    *(
        ("Force", f"{load}_force", ((f"{load}_forces.surge", "x"), (f"{load}_forces.sway", "y")))
        for load in _LOADS
    ),
    *(("Torque", f"{load}_moment", ((f"{load}_forces.yaw", "z"),)) for load in _LOADS),
    (
        "LinearVelocity",
        "body_velocity",
        (("body_velocity.surge", "x"), ("body_velocity.sway", "y")),
    ),
    ("LinearVelocity", "current", (("current.north", "x"), ("current.east", "y"))),
    ("AngularVelocity", "yaw_rate", (("body_velocity.yaw", "z"),)),
    ("LinearDisplacement", "position", (("ned_position.north", "x"), ("ned_position.east", "y"))),
    ("AngularDisplacement", "heading", (("ned_position.yaw", "z"),)),
    ("AngularDisplacement", "rudder_command", ((RUDDER, ""),)),
    ("AngularDisplacement", "rudder_angle", (("rudder.angle", ""),)),
    ("ShaftSpeed", "propeller_command", ((PROPELLER, ""),)),
    ("ShaftSpeed", "propeller_speed", (("propeller.speed", ""),)),
)


def osp_description(unit: ShipUnit) -> Element:
    """``OspModelDescription`` of a unit; units are those of its FMI description."""
    root = Element("OspModelDescription", xmlns=_NAMESPACE, version="1.0")
    groups = SubElement(root, "VariableGroups")
    generic = SubElement(groups, "Generic", name="wave_motion")
    _variables(generic, ((name, "") for name in unit.variables if name.startswith("wave_motion.")))
    for kind, name, members in _GROUPS:
        _variables(SubElement(groups, kind, name=name), members)
    return root


def _variables(group: Element, members: Iterable[tuple[str, str]]) -> None:
    for name, axis in members:
        SubElement(group, "Variable", {"ref": name} | ({"axis": axis} if axis else {}))


def write_osp(unit: ShipUnit, path: Path) -> None:
    """Write the description of a unit."""
    root = osp_description(unit)
    indent(root)
    ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
