import dataclasses

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.sea import CALM, Sea, available_seas, load_sea
from ship_gym.ships import load_ship
from ship_gym.simulation import ShipSim, SimulationDiverged, self_propulsion, straight_forces
from tests.conftest import symmetric


def test_self_propulsion_balances_surge(ship):
    n = self_propulsion(ship, ship.speed)
    (hull, propeller, rudder), _ = straight_forces(ship, ship.speed, n)
    assert hull[0] + propeller[0] + rudder[0] == pytest.approx(0.0, abs=1e-6 * -hull[0])
    assert self_propulsion(ship, 0.0) == 0.0


def test_kcs_model_self_propulsion_beside_the_tank(kcs_model):
    # tank 10.2 rps (Knight 2021), CFD 10.4 (White 2020)
    assert self_propulsion(kcs_model, 0.860) == pytest.approx(10.2, rel=0.02)


def test_speed_beyond_the_engine(kcs_model):
    with pytest.raises(ConfigError, match=r"cannot hold 3 m/s.*20 rev/s"):
        self_propulsion(kcs_model, 3.0)


def test_a_straight_course_stays_straight(ship):
    """With the rudder amidships, but for the bias of a single screw."""
    sim = ShipSim(symmetric(ship), 1)
    sim.reset(0)
    for _ in range(50):
        sim.step([[0.0, sim.state[0, 7]]], 1.0 / ship.time_unit)
    u, v, r, x, y, psi, delta, _ = sim.state[0]
    assert u == pytest.approx(ship.speed, rel=1e-9)
    assert v == r == y == psi == delta == 0.0
    assert x == pytest.approx(50.0 * ship.speed / ship.time_unit)


def test_positive_rudder_turns_to_starboard(ship):
    sim = ShipSim(ship, 1)
    sim.reset(0)
    for _ in range(60):
        sim.step([[0.3, sim.state[0, 7]]], 1.0 / ship.time_unit)
    u, v, r, _, y, psi, delta, _ = sim.state[0]
    assert r > 0.0 and psi > 0.0 and y != 0.0 and v < 0.0 < u and delta == 0.3


def test_reset_is_deterministic_and_each_ship_has_its_own_stream(kcs_model):
    sea = load_sea("disturbed")

    def phases(n, seed):
        sim = ShipSim(kcs_model, n, sea)
        sim.reset(seed)
        return sim.water.harmonics[:, 2].copy()

    assert (phases(3, 7) == phases(3, 7)).all()
    assert (phases(3, 7)[2] == phases(1, 9)[0]).all()
    assert not (phases(3, 7)[0] == phases(3, 7)[1]).any()


def test_mixed_fleet_sails_like_its_ships_alone():
    ships = [load_ship("kcs"), load_ship("kcs", surrogate="G3_SA"), load_ship("kcs")]
    command = np.array([[0.4, 1.1]] * 3)
    together = ShipSim(ships, 3)
    together.reset(0)
    together.step(command, 1.0)
    for i, ship in enumerate(ships):
        alone = ShipSim(ship, 1)
        alone.reset(0)
        assert (alone.step(command[:1], 1.0)[0] == together.state[i]).all()


def test_divergence_is_reported_with_ship_state_and_command(kcs_model):
    sim = ShipSim(kcs_model, 3)
    sim.reset(0)
    sim.records["hull"]["N_r"][1] = np.nan
    with pytest.raises(SimulationDiverged) as error:
        sim.step([[0.1, 10.0]] * 3, 0.1)
    for word in ("ship 1 (kcs_model)", "t = 0.1", "r=nan", "delta_command=0.1", "hull="):
        assert word in str(error.value)


def test_bad_input(kcs_model):
    with pytest.raises(ConfigError, match=r"n = 0: allowed is 1"):
        ShipSim(kcs_model, 0)
    with pytest.raises(ConfigError, match="2 ships given for n = 3"):
        ShipSim([kcs_model, kcs_model], 3)
    with pytest.raises(ConfigError, match="2 seas given for 3 ships"):
        ShipSim(kcs_model, 3, [CALM, CALM])
    with pytest.raises(ConfigError, match=r"psi = 90.*looks like degrees"):
        ShipSim(kcs_model).reset(psi=90.0)
    with pytest.raises(ConfigError, match="did you mean 'calm'"):
        load_sea("clam")
    with pytest.raises(ConfigError, match=r"current_speed = -1"):
        Sea(current_speed=-1.0)
    with pytest.raises(ConfigError, match=r"current_direction_to.*looks like degrees"):
        Sea(current_direction_to=270.0)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda sim: sim.step([[35.0, 10.0]] * 2, 0.1), "looks like degrees"),
        (lambda sim: sim.step([[0.1, np.nan]] * 2, 0.1), r"commands[0] = [0.1, nan]"),
        (lambda sim: sim.step([0.1, 10.0], 0.1), "shape (2,), allowed is (2, 2)"),
        (lambda sim: sim.step([[0.1, 10.0]] * 2, np.nan), "dt = nan: must be positive"),
        (lambda sim: sim.step([[0.1, 10.0]] * 2, -1.0), "dt = -1.0"),
        (lambda sim: sim.step([[0.1, 10.0]] * 2, [0.1, 0.0]), "dt = [0.1, 0.0]"),
        (lambda sim: sim.reset(speed=np.nan), "speed = nan"),
        (lambda sim: sim.reset(n=-50.0), "n = -50"),
    ],
)
def test_bad_input_is_refused_before_any_work(kcs_model, call, word):
    sim = ShipSim(kcs_model, 2)
    sim.reset(0)
    before = sim.state.copy()
    with pytest.raises(ConfigError) as error:
        call(sim)
    assert word in str(error.value)
    assert (sim.state == before).all()


def test_a_changed_interval_is_noticed(kcs_model):
    sim = ShipSim(kcs_model, 1)
    sim.reset(0)
    dt = np.array([0.1])
    sim.step([[0.1, 10.0]], dt)
    dt *= 10.0
    sim.step([[0.1, 10.0]], dt)
    assert sim.time[0] == pytest.approx(1.1)


def test_every_named_sea_loads():
    assert {"calm", "current", "disturbed"} <= set(available_seas())
    assert all(isinstance(load_sea(name), Sea) for name in available_seas())
    assert load_sea("calm") == CALM


def test_torque_limit_slows_the_propeller():
    ship = load_ship("kcs")
    weak = dataclasses.replace(ship, engine=dataclasses.replace(ship.engine, torque_max=1e6))
    speeds = {}
    for name, s in (("strong", ship), ("weak", weak)):
        sim = ShipSim(s, 1)
        sim.reset(0)
        for _ in range(300):
            sim.step([[0.0, 1.5]], 1.0)
        speeds[name] = sim.state[0, 7]
        torque = sim.flow[0, 4]
    assert speeds["strong"] == pytest.approx(1.5, abs=1e-6)
    assert speeds["weak"] < 1.2 and torque < 1.05e6
