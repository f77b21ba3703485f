"""`ShipUnit` is ``ShipSim`` behind names: same states, any step, states to go back to."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import FLOW_OF_UNITS, FORCE_AXES, FORCE_COMPONENTS, STATE_NAMES
from ship_gym.cosim import ShipUnit
from ship_gym.cosim.osp import osp_description
from ship_gym.cosim.values import sea_of, start_values
from ship_gym.cosim.variables import FLOW, FLOW_OF_TWO, LOADS, OUTPUT, STATES, UNIT_DEFINITIONS
from ship_gym.physics.waves import WAVE_NAMES
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import irregular_sea, load_sea, regular_sea
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import ShipSim

NOWHERE = Path("none")


def unit_of(ship="kcs", **given):
    values = start_values(ship, **given)
    return ShipUnit(values, load_ship(ship).propellers, NOWHERE)


def test_values_are_those_of_the_simulation_at_every_step():
    unit = unit_of(sea__name="ss5", seed=3, start__heading=0.5)
    unit.start()
    sim = ShipSim("kcs", sea=load_sea("ss5"))
    sim.reset(3, psi=0.5)
    n = float(sim.state[0, STATE_NAMES.index("n")])
    assert unit.get("propeller.command") == n
    t = 0.0
    for k, interval in enumerate([0.5, 1.7, 0.013, 3.0, 1.1]):
        at = sim.state[0, 3], sim.state[0, 4]
        assert unit.get("wave_elevation.midship") == sim.elevation(*at) != 0.0
        forces, flow = sim.loads_now(np.array([0])) if k else (None, None)
        assert [unit.get(v.name) for v in STATES] == sim.state[0].tolist()
        for name in ("sway", "sway_velocity", "roll", "yaw", "yaw_rate"):
            assert unit.get(f"wave_motion.{name}") == sim.waves[0, WAVE_NAMES.index(name)]
        if k:
            assert [[unit.get(v.name) for v in row] for row in LOADS] == forces[0].tolist()
            assert [unit.get(v.name) for v in FLOW] == flow[0].tolist()
        rudder = 0.2 * (-1) ** k
        unit.set("rudder.command", rudder)
        assert unit.step(t, interval) == ""
        sim.step([[rudder, n]], interval)
        t += interval
    assert t == pytest.approx(sim.time[0]) and unit.get("wave_motion.roll") != 0.0


def test_loads_at_the_start_are_those_of_the_first_step():
    unit = unit_of(sea__name="ss4", seed=1)
    unit.start()
    first = [[unit.get(v.name) for v in row] for row in LOADS]
    sim = ShipSim("kcs", sea=load_sea("ss4"))
    sim.reset(1)
    sim.step([[0.0, sim.state[0, 7]]], float(sim.longest[0]))
    assert first == sim.forces[0].tolist()


def test_names_of_loads_flow_and_states_stand_in_the_order_of_the_conventions():
    short = {"surge": "X", "sway": "Y", "yaw": "N"}
    for component, row in zip(FORCE_COMPONENTS, LOADS, strict=True):
        names = [variable.name.split("_forces.") for variable in row]
        assert [(a, short[b]) for a, b in names] == [(component, axis) for axis in FORCE_AXES]
    flows = [variable.name.removeprefix("flow.") for variable in (*FLOW, *FLOW_OF_TWO)]
    assert tuple(flows) == FLOW_OF_UNITS
    assert {v.unit for v in unit_of().variables.values()} <= {"", *UNIT_DEFINITIONS}


def test_two_propellers_have_the_flow_of_each():
    unit = unit_of("onrt_model")
    unit.start()
    assert unit.get("flow.thrust_starboard") + unit.get("flow.thrust_port") == pytest.approx(
        unit.get("flow.thrust")
    )
    assert "flow.thrust_port" not in unit_of("kcs").variables
    fresh = unit_of("onrt_model")
    fresh.set("ship.name", "kcs")
    with pytest.raises(ConfigError, match=r"ship\.name = 'kcs': has 1 propellers"):
        fresh.start()


@pytest.mark.parametrize(
    ("given", "sea"),
    [
        ({"sea.name": "disturbed_current"}, load_sea("disturbed_current")),
        (
            {"sea.wave_height": 3.0, "sea.wave_period": 9.0, "sea.wave_direction_from": 1.0},
            irregular_sea(3.0, 9.0, direction_from=1.0),
        ),
        (
            {"sea.wave_height": 3.0, "sea.wave_period": 9.0, "sea.spreading": 4.0},
            irregular_sea(3.0, 9.0, spreading=4.0),
        ),
        (
            {"sea.wave_height": 4.0, "sea.wave_period": 12.0, "sea.regular": True},
            regular_sea(2.0, omega=2.0 * math.pi / 12.0),
        ),
        (
            {"sea.wind_speed": 9.0, "sea.wind_direction_from": 2.0, "sea.gusts": True},
            dataclasses.replace(
                load_sea("calm"), wind_speed=9.0, wind_direction_from=2.0, gusts=True
            ),
        ),
        (
            {"sea.name": "ss3", "sea.current_speed": 0.7, "sea.current_direction_to": -1.0},
            dataclasses.replace(load_sea("ss3"), current_speed=0.7, current_direction_to=-1.0),
        ),
        (
            {
                "sea.wave_height": 2.0,
                "sea.wave_period": 7.0,
                "sea.wave_direction_from": 1.0,
                "sea.swell_height": 1.5,
                "sea.swell_direction_from": 3.0,
                "sea.swell_spreading": 8.0,
            },
            dataclasses.replace(
                irregular_sea(2.0, 7.0, direction_from=1.0),
                waves=(
                    WaveSystem(height=2.0, peak_period=7.0),
                    WaveSystem(height=1.5, peak_period=14.0, direction=2.0, spreading=8.0),
                ),
            ),
        ),
        (
            {
                "sea.name": "current",
                "sea.current_variation": 0.3,
                "sea.current_period": 600.0,
            },
            dataclasses.replace(load_sea("current"), current_variation=0.3, current_period=600.0),
        ),
    ],
)
def test_seas_of_the_parameters(given, sea):
    assert sea_of(start_values("kcs", **given), load_ship("kcs")) == sea


def test_named_seas_are_turned_and_of_the_scale_of_the_ship():
    ship = load_ship("kcs_model")
    values = start_values(
        "kcs_model", **{"sea.name": "ss5", "sea.wave_direction_from": math.pi / 2}
    )
    found = sea_of(values, ship)
    assert found.waves == load_sea("ss5").scaled(ship.scale).waves
    assert found.wave_direction_to == pytest.approx(-math.pi / 2)


def test_a_longest_step_inside_is_kept():
    short, plain = unit_of(integration__interval=0.1), unit_of()
    sim = ShipSim("kcs")
    sim.reset(0)
    sim.longest[:] = 0.1
    for unit in (short, plain):
        unit.set("rudder.command", 0.3)
        unit.start()
        unit.step(0.0, 1.0)
    sim.step([[0.3, short.get("propeller.command")]], 1.0)
    assert [short.get(v.name) for v in STATES] == sim.state[0].tolist()
    assert short.get("body_velocity.yaw") != plain.get("body_velocity.yaw")
    assert short.get("body_velocity.yaw") == pytest.approx(plain.get("body_velocity.yaw"), rel=1e-3)


def test_a_state_in_json_goes_on_bit_for_bit_in_another_unit():
    given = {"sea.current_variation": 0.5, "sea.swell_height": 2.0}
    given |= {"sea.name": "disturbed_current", "sea.gusts": True, "sea.wind_speed": 8.0, "seed": 11}
    first, other = unit_of(**given), unit_of()
    first.start()
    first.set("rudder.command", -0.2)
    for k in range(20):
        first.step(1.5 * k, 1.5)
    stored = json.loads(json.dumps(first.stored()))
    with pytest.raises(ConfigError, match="is fixed while the unit runs"):
        first.set("start.speed", 1.0)

    def sailed(unit):
        for k in range(20):
            assert unit.step(30.0 + 0.7 * k, 0.7) == ""
        return [unit.get(name) for name, v in unit.variables.items() if v.causality == OUTPUT]

    there = sailed(first)
    first.restore(stored)
    other.restore(stored)
    assert sailed(first) == there and sailed(other) == there
    for wrong in ({}, {"format": 1, "values": {}}, stored | {"format": 2}):
        with pytest.raises(ConfigError, match="no state of this unit"):
            first.restore(wrong)
    arrays = stored["arrays"] | {"state": [0.0]}
    with pytest.raises(ConfigError, match="another ship"):
        first.restore(stored | {"arrays": arrays})


def test_a_refused_step_leaves_the_unit_as_it_was():
    unit = unit_of(sea__name="ss4")
    unit.start_time = 100.0
    unit.start()
    assert unit.step(100.0, 2.0) == ""
    before = unit.stored()
    for time, interval, words in (
        (100.0, 1.0, "a step from t = 100 s, but the unit is at 102 s"),
        (102.0, 0.0, "dt = 0.0: must be positive"),
        (102.0, math.inf, "must be positive and finite"),
        (math.nan, 1.0, "a step from t = nan s"),
    ):
        assert words in unit.step(time, interval)
        assert unit.stored() == before
    unit.set("rudder.command", 35.0)
    assert "looks like degrees" in unit.step(102.0, 1.0)
    unit.set("rudder.command", 0.0)
    spun = unit.stored()
    spun["arrays"]["state"][STATE_NAMES.index("r")] = 5.0
    unit.restore(spun)
    told = unit.step(102.0, 1.0)
    assert told.startswith("ship 0 (kcs) diverged at t = ") and unit.stored() == spun
    unit.restore(before)
    assert unit.step(102.0, 1.0) == ""


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"ship.name": "kcz"}, "unknown ship 'kcz'; did you mean 'kcs'"),
        ({"ship.name": "none.toml"}, "no such file"),
        ({"sea.name": "ss9"}, "unknown sea 'ss9'"),
        ({"sea.wave_height": -1.0}, "sea.wave_height = -1.0: allowed is 0 to 30 [m]"),
        ({"sea.wave_height": 5.0, "sea.wave_period": 3.0}, "a wave breaks"),
        ({"sea.wave_direction_from": 45.0}, "looks like degrees"),
        ({"sea.wave_direction_from": 0.5}, "means nothing without waves"),
        ({"sea.regular": True}, "sea.regular = True: means nothing without sea.wave_height"),
        ({"sea.swell_direction_from": 0.5}, "means nothing without sea.swell_height"),
        ({"sea.current_variation": 0.5}, "means nothing without a current"),
        (
            {"sea.wave_height": 1.0, "sea.regular": True, "sea.swell_height": 2.0},
            "sea.swell_height = 2: not beside a regular wave",
        ),
        ({"sea.current_direction_to": 0.5}, "means nothing without sea.current_speed"),
        ({"sea.gusts": True}, "sea.gusts with wind_speed"),
        ({"start.speed": math.nan}, "start.speed"),
        ({"start.speed": 60.0}, "kcs: speed = 60.0: allowed is"),
        ({"start.self_propulsion": False, "start.propeller_speed": 9.0}, "n = 9.0: allowed is"),
        ({"seed": -1}, "seed = -1"),
        ({"integration.interval": -1.0}, "integration.interval = -1.0"),
    ],
)
def test_bad_parameters_are_a_line(given, words):
    unit = unit_of()
    for name, value in given.items():
        unit.set(name, value)
    with pytest.raises(ConfigError) as refused:
        unit.start()
    assert words in str(refused.value) and len(str(refused.value)) < 300
    assert not unit.running


def test_a_parameter_that_is_none_is_refused():
    with pytest.raises(ConfigError, match="of a unit"):
        start_values("kcs", sea__hight=1.0)
    with pytest.raises(ConfigError, match="must be a switch"):
        start_values("kcs", sea__gusts="yes")
    with pytest.raises(ConfigError, match="must be a whole number"):
        start_values("kcs", seed=1.5)


def test_a_start_with_a_place_gives_latitude_and_longitude():
    pytest.importorskip("pyproj")
    from geographiclib.geodesic import Geodesic

    unit = unit_of(**{"start.latitude": 57.7, "start.longitude": 11.85, "start.heading": 1.0})
    unit.start()
    assert unit.get("position.latitude") == pytest.approx(57.7, abs=1e-9)
    for k in range(30):
        unit.step(60.0 * k, 60.0)
    north, east = unit.get("ned_position.north"), unit.get("ned_position.east")
    expected = Geodesic.WGS84.Direct(
        57.7, 11.85, math.degrees(math.atan2(east, north)), math.hypot(north, east)
    )
    assert unit.get("position.latitude") == pytest.approx(expected["lat2"], abs=1e-8)
    assert unit.get("position.longitude") == pytest.approx(expected["lon2"], abs=1e-8)


def test_groups_of_osp_are_in_the_order_of_its_schema_and_name_variables():
    unit = unit_of()
    root = osp_description(unit)
    assert root.get("version") == "1.0"
    groups = list(root.find("VariableGroups"))
    order = ["Generic", "Force", "Torque", "LinearVelocity", "AngularVelocity"]
    order += ["LinearDisplacement", "AngularDisplacement", "ShaftSpeed"]
    kinds = [group.tag for group in groups]
    assert kinds == sorted(kinds, key=order.index)
    names = [group.get("name") for group in groups]
    assert len(set(names)) == len(names)
    units = {"Force": "N", "Torque": "N.m", "LinearVelocity": "m/s", "AngularVelocity": "rad/s"}
    units |= {"LinearDisplacement": "m", "AngularDisplacement": "rad", "ShaftSpeed": "rev/s"}
    for group in groups:
        members = [unit.variables[variable.get("ref")] for variable in group]
        assert members and len({v.causality for v in members}) == 1
        if group.tag in units:
            assert {v.unit for v in members} == {units[group.tag]} and len(members) <= 3
