"""FMPy, an independent client of FMI, sails a ship's FMU: the states of ``ShipSim`` bit for bit."""

import json
import math
import os
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy")
pytest.importorskip("pythonfmu")

from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi2 import (  # noqa: E402
    FMU2Slave,
    defaultCallbacks,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.validation import validate_fmu  # noqa: E402

from ship_gym.config import ConfigError  # noqa: E402
from ship_gym.cosim import write_fmu  # noqa: E402
from ship_gym.cosim.variables import STATES  # noqa: E402
from ship_gym.sea.state import CALM, load_sea  # noqa: E402
from ship_gym.ships.files import DATA  # noqa: E402
from ship_gym.simulation import ShipSim  # noqa: E402

YAW, RUDDER_ANGLE = 5, math.radians(20.0)


class Client:
    """One instance of an FMU in FMPy, with values by name."""

    def __init__(self, folder, name="one", **given):
        description = fmpy.read_model_description(str(folder))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.lines = []
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self.log)
        self.callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self.callbacks.freeMemory = defaultCallbacks.freeMemory
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=True)
        self.begin(**given)

    def log(self, environment, instance, status, category, message):
        self.lines.append((status, message.decode()))

    def begin(self, start=0.0, **given):
        for key, value in given.items():
            self.set(key.replace("__", "."), value)
        self.fmu.setupExperiment(startTime=start)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, name, value):
        reference = [self.references[name]]
        if isinstance(value, bool):
            self.fmu.setBoolean(reference, [value])
        elif isinstance(value, int):
            self.fmu.setInteger(reference, [value])
        elif isinstance(value, float):
            self.fmu.setReal(reference, [value])
        else:
            self.fmu.setString(reference, [value])

    def get(self, name):
        return self.fmu.getReal([self.references[name]])[0]

    def states(self):
        return self.fmu.getReal([self.references[v.name] for v in STATES])

    def step(self, t, interval):
        self.fmu.doStep(t, interval)

    def refused(self, t, interval):
        """The line of a step that is refused."""
        before = len(self.lines)
        with pytest.raises(FMICallException, match="discard"):
            self.step(t, interval)
        ((status, line),) = self.lines[before:]
        assert status == 3 and "\n" not in line  # fmi2Error
        return line

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def extracted(tmp_path, ship="kcs", name="unit", **given):
    write_fmu(ship, tmp_path / f"{name}.fmu", **given)
    folder = tmp_path / name
    fmpy.extract(str(tmp_path / f"{name}.fmu"), unzipdir=str(folder))
    return folder


@pytest.fixture(scope="module")
def kcs(tmp_path_factory):
    return extracted(tmp_path_factory.mktemp("kcs"))


@pytest.fixture
def client(kcs):
    made = []

    def make(**given):
        made.append(Client(kcs, f"ship{len(made)}", **given))
        return made[-1]

    yield make
    for one in made:
        one.close()


def zigzag(states, sail, intervals):
    """States at the end of each interval of a 20/20 zig-zag, the rudder first to starboard."""
    side, t, found = 1.0, 0.0, []
    for interval in intervals:
        if side * states()[YAW] >= RUDDER_ANGLE:
            side = -side
        sail(t, interval, side * RUDDER_ANGLE)
        t += interval
        found.append(list(states()))
    return np.array(found)


def by_fmu(client, intervals):
    def sail(t, interval, rudder):
        client.set("rudder.command", rudder)
        client.step(t, interval)

    return zigzag(client.states, sail, intervals)


def by_sim(ship, sea, seed, intervals, n=None):
    sim = ShipSim(ship, sea=sea)
    sim.reset(seed)
    n = float(sim.state[0, 7]) if n is None else n
    return zigzag(
        lambda: sim.state[0].tolist(),
        lambda t, interval, rudder: sim.step([[rudder, n]], interval),
        intervals,
    )


def test_the_description_is_valid(kcs):
    assert validate_fmu(str(kcs.with_suffix(".fmu"))) == []
    description = fmpy.read_model_description(str(kcs))
    assert description.fmiVersion == "2.0" and description.modelName == "unit"
    units = {v.name: v.unit for v in description.modelVariables}
    assert (units["rudder.command"], units["propeller.command"]) == ("rad", "rev/s")
    assert kcs.with_name("unit_OspModelDescription.xml").is_file()


@pytest.mark.parametrize(
    ("sea", "seed", "intervals"),
    [
        ("calm", 0, [0.5] * 1200),
        ("ss5", 7, [0.5] * 1200),
        ("disturbed_current", 2, list(np.random.default_rng(0).uniform(0.05, 3.0, 400))),
    ],
)
def test_a_zigzag_has_the_states_of_the_simulation_bit_for_bit(client, sea, seed, intervals):
    given = {"sea__name": sea, "seed": seed}
    found = by_fmu(client(**given), intervals)
    expected = by_sim("kcs", load_sea(sea), seed, intervals)
    assert np.array_equal(found, expected)
    assert np.degrees(np.abs(found[:, YAW])).max() > 20.0 and found[:, YAW].min() < 0.0


def test_fmpy_sails_it_by_itself(kcs):
    signals = np.array(
        [(0.0, 0.0), (10.0, 0.0), (10.0, 0.3), (60.0, 0.3)],
        dtype=[("time", float), ("rudder.command", float)],
    )
    found = fmpy.simulate_fmu(
        str(kcs.with_suffix(".fmu")),
        stop_time=60.0,
        output_interval=1.0,
        input=signals,
        output=["ned_position.yaw"],
        start_values={"sea.name": "ss4", "start.heading": 1.0},
    )
    assert found["time"][-1] == 60.0
    yaw = found["ned_position.yaw"]
    assert yaw[5] == pytest.approx(1.0, abs=1e-3) and yaw[-1] > 1.1


def test_two_at_once_know_nothing_of_each_other(client):
    one, two = client(sea__name="ss5", seed=1), client(sea__name="ss5", seed=2)
    both = []
    for k in range(100):
        for ship, rudder in ((one, 0.2), (two, -0.2)):
            ship.set("rudder.command", rudder)
            ship.step(1.0 * k, 1.0)
        both.append((one.states(), two.states()))
    for which, (seed, rudder) in enumerate(((1, 0.2), (2, -0.2))):
        sim = ShipSim("kcs", sea=load_sea("ss5"))
        sim.reset(seed)
        n = float(sim.state[0, 7])
        for states in both:
            sim.step([[rudder, n]], 1.0)
            assert states[which] == sim.state[0].tolist()


def test_after_a_reset_it_sails_the_same_again(client):
    ship = client(sea__name="ss4", seed=5)
    first = by_fmu(ship, [1.0] * 50)
    ship.fmu.reset()
    ship.begin(sea__name="ss4", seed=5)
    assert np.array_equal(by_fmu(ship, [1.0] * 50), first)
    ship.fmu.reset()
    ship.begin()  # parameters have their starts again
    assert np.array_equal(by_fmu(ship, [1.0] * 50), by_sim("kcs", CALM, 0, [1.0] * 50))


def test_a_state_is_gone_back_to_also_as_bytes_in_another_instance(client):
    ship, other = client(sea__name="ss5", seed=9, start=50.0), client()

    def on(one):
        one.set("rudder.command", -0.3)
        found = []
        for k in range(20):
            one.step(70.0 + 0.9 * k, 0.9)
            found.append(one.states())
        return found

    for k in range(20):
        ship.step(50.0 + k, 1.0)
    state = ship.fmu.getFMUstate()
    stored = ship.fmu.serializeFMUstate(state)
    expected = on(ship)
    ship.fmu.setFMUstate(state)
    assert on(ship) == expected
    there = other.fmu.deSerializeFMUstate(stored)
    other.fmu.setFMUstate(there)
    assert on(other) == expected
    ship.fmu.freeFMUstate(state)
    broken = other.fmu.deSerializeFMUstate(b"no state")
    other.fmu.setFMUstate(broken)
    assert "no state of this unit" in other.lines[-1][1]
    assert "no state of this unit" in other.refused(88.0, 1.0)


def test_steps_that_cannot_be_are_refused_and_the_ship_stays(client):
    ship, other = client(), client()
    for each in (ship, other):
        each.step(0.0, 2.0)
    assert "the unit is at 2 s" in ship.refused(0.0, 1.0)
    assert "must be positive" in ship.refused(2.0, 0.0)
    ship.set("rudder.command", 20.0)
    assert "looks like degrees" in ship.refused(2.0, 1.0)
    ship.set("rudder.command", math.nan)
    assert "must be finite" in ship.refused(2.0, 1.0)
    assert np.isnan(ship.states()).all()  # a master that passes over the status sees it
    for each in (ship, other):
        each.set("rudder.command", 0.3)
        each.step(2.0, 1.0)
    assert ship.states() == other.states()


def test_a_ship_that_diverges_is_a_line_and_no_crash(client):
    ship = client()
    ship.step(0.0, 1.0)
    stored = json.loads(ship.fmu.serializeFMUstate(ship.fmu.getFMUstate()))
    stored["arrays"]["state"][2] = 5.0  # r [rad/s]
    ship.fmu.setFMUstate(ship.fmu.deSerializeFMUstate(json.dumps(stored).encode()))
    for _ in range(2):
        assert "ship 0 (kcs) diverged at t = 2 s, beyond" in ship.refused(1.0, 1.0)
        assert math.isnan(ship.get("body_velocity.yaw"))
    ship.fmu.reset()
    ship.begin()
    ship.step(0.0, 1.0)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("sea.wave_height", -3.0, "sea.wave_height = -3.0: allowed is 0 to 30 [m]"),
        ("sea.name", "ss9", "unknown sea 'ss9'; did you mean"),
        ("ship.name", "kcz", "unknown ship 'kcz'; did you mean 'kcs'"),
        ("ship.name", "onrt_model", "has 2 propellers, the outputs of this unit are of 1"),
        ("seed", -1, "seed = -1: allowed is 0 to"),
        ("start.heading", 90.0, "looks like degrees"),
    ],
)
def test_a_bad_parameter_is_one_line_and_no_step_is_made(client, name, value, words):
    ship = client(**{name: value})
    (status, line), *_ = ship.lines
    assert status == 3 and words in line and len(line) <= 300 and "\n" not in line
    assert math.isnan(ship.get("ned_position.north"))
    assert words in ship.refused(0.0, 1.0)


def test_a_parameter_cannot_be_set_while_it_runs(client):
    ship = client()
    ship.step(0.0, 1.0)
    ship.set("start.speed", 3.0)
    assert "fixed while the unit runs" in ship.lines[-1][1]
    assert ship.get("start.speed") == ShipSim("kcs").ships[0].speed
    assert "fixed while the unit runs" in ship.refused(1.0, 1.0)


def test_an_own_ship_goes_into_the_fmu_with_its_tables(tmp_path):
    home = tmp_path / "home"
    shutil.copytree(DATA / "kcs_model", home / "base")
    mine = home / "mine" / "mine.toml"
    mine.parent.mkdir()
    mine.write_text(
        'scaled_from = "../base/ship.toml"\ntitle = "mine"\nlength = {value = 50.0, unit = "m"}\n'
    )
    given = {"sea.wave_height": 0.8, "sea.wave_period": 5.0, "seed": 4}
    folder = extracted(tmp_path, mine, **given)
    assert str(home) not in (folder / "resources" / "unit.json").read_text()
    packed = folder / "resources" / "ships"
    expected = ShipSim(str(packed / "mine" / "mine.toml"))
    names = {file.name for file in packed.rglob("*") if file.is_file()}
    assert {"mine.toml", "ship.toml", "waves.npz", "kp505_open_water.csv"} <= names
    shutil.rmtree(home)
    ship = Client(folder)
    from ship_gym.sea.state import irregular_sea

    sim = ShipSim(expected.ships[0], sea=irregular_sea(0.8, 5.0))
    sim.reset(4)
    n = float(sim.state[0, 7])
    for k in range(30):
        ship.set("rudder.command", 0.2)
        ship.step(float(k), 1.0)
        sim.step([[0.2, n]], 1.0)
    assert ship.states() == sim.state[0].tolist()
    ship.close()


def test_without_ship_gym_the_fmu_says_what_is_missing(kcs, tmp_path):
    away = tmp_path / "away" / "ship_gym"
    away.mkdir(parents=True)
    (away / "__init__.py").write_text("raise ImportError('No module named ship_gym')")
    code = f"""
import fmpy
from fmpy.fmi2 import FMU2Slave
d = fmpy.read_model_description({str(kcs)!r})
one = FMU2Slave(guid=d.guid, unzipDirectory={str(kcs)!r}, instanceName="one",
                modelIdentifier=d.coSimulation.modelIdentifier)
one.instantiate(loggingOn=True)
"""
    environment = os.environ | {"PYTHONPATH": str(away.parent)}
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        env=environment,
        cwd=tmp_path,
    )
    assert done.returncode == 1  # FMPy's exception, no crash
    assert "this FMU needs Ship Gym in the Python that runs it" in done.stdout + done.stderr


def test_the_file_says_the_same_every_time_and_its_name_is_the_models(tmp_path):
    for name in ("a", "b"):
        write_fmu("kcs", tmp_path / name / "kcs.fmu", seed=3)
    cards = []
    for name in ("a", "b"):
        with zipfile.ZipFile(tmp_path / name / "kcs.fmu") as archive:
            cards.append(archive.read("resources/unit.json"))
    assert cards[0] == cards[1]
    for name in ("1kcs.fmu", "my-kcs.fmu", "kcs.zip"):
        with pytest.raises(ConfigError, match="the name of an FMU is that of its model"):
            write_fmu("kcs", tmp_path / name)
    assert not list(tmp_path.glob("*.fmu"))
    before = list(sys.path), set(sys.modules)
    write_fmu("kcs", tmp_path / "kcs.fmu")
    assert sys.path == before[0]
    assert not [m for m in set(sys.modules) - before[1] if m.startswith("ship_gym_unit")]
