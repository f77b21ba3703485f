"""FMPy sails a ship's FMU of FMI 3.0: states bit for bit, refused steps with status error."""

import math

import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy")
pytest.importorskip("pythonfmu3")

from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi3 import FMU3Slave  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

from ship_gym.cosim import write_fmu  # noqa: E402
from ship_gym.cosim.variables import STATES  # noqa: E402
from ship_gym.sea.state import load_sea  # noqa: E402
from ship_gym.simulation import ShipSim  # noqa: E402


@pytest.fixture(scope="module")
def kcs(tmp_path_factory):
    path = tmp_path_factory.mktemp("kcs") / "kcs.fmu"
    write_fmu("kcs", path, 3, seed=7)  # or "3", as the command has it
    return path


@pytest.fixture
def ship(kcs, tmp_path):
    description = fmpy.read_model_description(str(kcs))
    fmpy.extract(str(kcs), unzipdir=str(tmp_path))
    made = FMU3Slave(
        guid=description.instantiationToken,
        unzipDirectory=str(tmp_path),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="ship",
    )
    made.instantiate(loggingOn=True)
    made.references = {v.name: v.valueReference for v in description.modelVariables}
    yield made
    made.terminate()
    made.freeInstance()


def begin(ship, sea):
    ship.setString([ship.references["sea.name"]], [sea])
    ship.enterInitializationMode(startTime=10.0)
    ship.exitInitializationMode()


def states(ship):
    return ship.getFloat64([ship.references[v.name] for v in STATES])


def order(ship, rudder):
    ship.setFloat64([ship.references["rudder.command"]], [rudder])


def test_the_description_is_valid(kcs):
    assert validate_fmu(str(kcs)) == []
    description = fmpy.read_model_description(str(kcs))
    assert description.fmiVersion == "3.0"
    units = {v.name: v.unit for v in description.modelVariables}
    assert units["rudder.command"] == "rad" and units["hull_forces.yaw"] == "N.m"


def test_its_states_are_those_of_the_simulation_bit_for_bit(ship):
    begin(ship, "ss5")
    sim = ShipSim("kcs", sea=load_sea("ss5"))
    sim.reset(7)
    n, t, stored = float(sim.state[0, 7]), 10.0, None
    for k, interval in enumerate(np.random.default_rng(1).uniform(0.1, 2.0, 200).tolist()):
        rudder = 0.3 * np.sin(k / 20.0)
        order(ship, rudder)
        ship.doStep(t, interval)
        sim.step([[rudder, n]], interval)
        assert states(ship) == sim.state[0].tolist()
        t += interval
        if k == 100:
            stored = ship.serializeFMUState(ship.getFMUState()), t, states(ship)
    assert ship.getFloat64([ship.references["time"]])[0] == pytest.approx(t)
    ship.setFMUState(ship.deserializeFMUState(stored[0]))
    assert states(ship) == stored[2]
    ship.doStep(stored[1], 1.0)


def test_what_cannot_be_is_an_error_and_the_ship_stays(ship):
    begin(ship, "calm")
    ship.doStep(8.0, 2.0)  # pythonfmu3 hands on no time of the start: it is where this begins
    for t, interval, rudder in ((5.0, 1.0, 0.0), (10.0, 0.0, 0.0), (10.0, 1.0, 35.0)):
        order(ship, rudder)
        with pytest.raises(FMICallException, match="error"):
            ship.doStep(t, interval)
        assert all(math.isnan(value) for value in states(ship))
    order(ship, 0.1)
    ship.doStep(10.0, 1.0)
    assert all(math.isfinite(value) for value in states(ship))
    ship.reset()
    begin(ship, "ss9")
    with pytest.raises(FMICallException, match="error"):
        ship.doStep(10.0, 1.0)
