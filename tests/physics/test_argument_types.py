"""The types of a kernel's arguments are those that numba finds."""

import functools

import numba
import numpy as np
import pytest

from ship_gym.physics._kernel import _type_of
from ship_gym.simulation import ShipSim

KINDS = (
    "fleet", "arguments", "records", "read-only", "every second", "two dimensions",
    "Fortran's order", "other records", "aligned",
)  # fmt: skip


@functools.cache
def values():
    fleet = ShipSim("kcs_model", 2).fleet
    records, fields = fleet.ships, [("a", float), ("b", np.int8)]
    read_only, two = records.copy(), np.stack([records, records, records])
    read_only.flags.writeable = False
    made = (
        fleet, (0, 1.0, None, fleet.water), records, read_only, np.concatenate([records] * 2)[::2],
        two, np.asfortranarray(two), np.zeros(2, fields), np.zeros(2, np.dtype(fields, align=True)),
    )  # fmt: skip
    return dict(zip(KINDS, made, strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_types_are_numbas(kind):
    value = values()[kind]
    for _ in range(2):  # found, then remembered
        assert _type_of(value) == numba.typeof(value)


def test_kinds_of_arrays_are_told_apart():
    assert len({_type_of(value) for value in values().values()}) == len(KINDS)
