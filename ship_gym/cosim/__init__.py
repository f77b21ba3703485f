"""A ship in a sea as a unit of other simulators (FMI)."""

from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.write import write_fmu

__all__ = ["ShipUnit", "write_fmu"]
