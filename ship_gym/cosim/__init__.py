"""A ship in a sea as a unit of other simulators (FMI)."""
