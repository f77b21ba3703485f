import contextlib
import dataclasses
import os

import pytest

from ship_gym.physics import dynamics
from ship_gym.physics.quantities import Tables
from ship_gym.ships import available_ships, load_ship
from ship_gym.ships.records import fleet

# One compiled version of the kernels for all ships: hundreds of tests sail a little. That the
# version of one kind of ship has the same bits is tested in tests/physics/test_blocks.py.
os.environ.setdefault("SHIP_GYM_ONE_VERSION", "1")

# A test says what is right, not how fast: one example may compile a kernel, or meet a busy machine.
with contextlib.suppress(ImportError):  # scripts/test_clients.sh and test_rllib.sh go without it
    from hypothesis import settings

    settings.register_profile("ship_gym", deadline=None)
    settings.load_profile("ship_gym")

SHIPS = available_ships()


@pytest.fixture
def own_versions(monkeypatch):
    """Each kind of ship has a compiled version of its own, as for users."""
    monkeypatch.delenv("SHIP_GYM_ONE_VERSION")


def tables_of(ship):
    """Record and tables of one ship, as the kernels take them."""
    made = fleet([ship])
    return made.records[0], Tables(made.open_water[0], made.deflected[0])


def forces(motion, controls, record, tables):
    """Hull, propeller and rudder force, and the flow, of ``physics.dynamics.forces``."""
    own, flow = dynamics.forces(motion, controls, record, tables)
    return *own, flow


def symmetric(ship):
    """The same ship without difference between turns to starboard and to port."""
    if ship.propellers == 2:  # its two sides are each other's mirror image already
        return ship
    rudder = dataclasses.replace(ship.rudder, gamma_R_n=ship.rudder.gamma_R_p, neutral=0.0)
    propeller = dataclasses.replace(ship.propeller, wake_C2_n=ship.propeller.wake_C2_p)
    return dataclasses.replace(ship, rudder=rudder, propeller=propeller)


@pytest.fixture(scope="session", params=SHIPS)
def ship(request):
    return load_ship(request.param)


@pytest.fixture(scope="session")
def kcs_model():
    return load_ship("kcs_model")
