"""Power on a straight course: the same point as the simulation's, and beside published ones."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import KNOT
from ship_gym.physics.propeller import shaft_power
from ship_gym.ships import load_ship, scaled
from ship_gym.ships.powering import compared, powering
from ship_gym.ships.scaling import ittc57
from ship_gym.simulation import self_propulsion, straight_forces

HMRI = Path(__file__).resolve().parents[3] / "shared" / "reference" / "kvlcc2"
RESISTANCE = HMRI / "hmri_resistance_test.csv"
OPEN_WATER = HMRI / "hmri_propeller_open_water_test.csv"
needs_hmri = pytest.mark.skipif(not RESISTANCE.exists(), reason="the measured tests are not here")


def test_powering_is_the_self_propulsion_of_the_simulation(ship):
    p = powering(ship)
    own, flow = straight_forces(ship, ship.speed, p.n)
    assert p.n == pytest.approx(self_propulsion(ship, ship.speed), rel=1e-6)
    assert p.resistance == pytest.approx(-own.hull.X, rel=1e-9)
    assert (p.thrust, p.torque) == pytest.approx((flow.thrust, flow.torque), rel=1e-6)
    assert p.delivered_power == pytest.approx(shaft_power(p.n, p.torque), rel=1e-12)
    assert 0.4 < p.efficiency < 0.8


# ship, number of its published point, what, ours beside theirs [%]: measured, none of it tuned
# here; "calibrated" in the ship file are dtc_model (pitch) and onrt_model (wake)
GAPS = [
    ("kvlcc2_model", 0, "n", 6.0),  # K_T of the paper is 10 % below HMRI's at this load
    ("kvlcc2_model", 0, "thrust", -2.1),
    ("kvlcc2_model", 1, "n", 0.8),
    ("kvlcc2", 0, "effective_power", 1.5),
    ("kcs_model", 0, "n", 0.3),
    ("kcs_model", 1, "n", -1.6),
    ("kcs", 0, "n", -1.7),
    ("dtc_model", 0, "n", 0.0),
    ("onrt_model", 0, "n", 0.0),
    ("s175", 0, "n", -0.4),
]


@pytest.mark.parametrize(("name", "number", "what", "percent"), GAPS)
def test_published_points(name, number, what, percent):
    ship = load_ship(name)
    ours, theirs = compared(ship, ship.propulsion[number])[what]
    assert 100.0 * (ours / theirs - 1.0) == pytest.approx(percent, abs=0.06)
    assert f"({100.0 * (ours / theirs - 1.0):+.1f} %)" in ship.describe()


def test_every_published_point_is_compared():
    names = {name for name, *_ in GAPS}
    listed = {(name, k, what) for name, k, what, _ in GAPS}
    for name in names:
        ship = load_ship(name)
        for k, point in enumerate(ship.propulsion):
            assert {(name, k, what) for what in compared(ship, point)} <= listed


def test_delivered_power_of_kvlcc2_at_service_speed():
    """48 MW with the resistance of a smaller model; 22 to 24 MW asks for 13.9 MW effective."""
    p = powering(load_ship("kvlcc2"), 15.5 * KNOT)
    assert 1e-6 * p.effective_power == pytest.approx(13.70, rel=0.02)  # HMRI, 18,627 PS
    assert 1e-6 * p.delivered_power == pytest.approx(23.7, abs=0.1)  # ours


def hmri_set():
    """KVLCC2 at 1/46.426 with resistance, wake and thrust deduction of HMRI, all three."""
    model = load_ship("kvlcc2_model")
    ship = scaled(model, 320.0 / 46.426, rho=model.rho, nu=model.nu, wake_correction=False)
    q = 0.5 * ship.rho * ship.hull.L * ship.hull.d * 1.170**2
    hull = dataclasses.replace(ship.hull, R_0=34.04 / q)
    propeller = dataclasses.replace(ship.propeller, w_P0=0.428, t_P=0.233)
    return dataclasses.replace(ship, hull=hull, propeller=propeller)


def test_kvlcc2_with_the_set_of_hmri():
    """44.4 N by definition; 10.5 rev/s with the K_T of the paper, 9.9 printed, others 10.2 to 10.3.

    The printed 9.9 is not a free model's: at it HMRI's captive tests push back with 2.6 N.
    """
    p = powering(hmri_set(), 1.170)
    assert p.thrust == pytest.approx(34.04 / (1.0 - 0.233), rel=1e-9)
    assert p.n / 9.9 == pytest.approx(1.058, abs=0.002)
    assert p.n == pytest.approx(10.25, rel=0.03)


@needs_hmri
def test_kvlcc2_with_the_set_and_the_propeller_of_hmri():
    """With their open-water test as well 10.1 rev/s, within 5 % of the printed 9.9."""
    lines = [line.split(",") for line in OPEN_WATER.read_text().splitlines() if line[:1].isdigit()]
    J, K_T = np.array(lines, float).T[:2]
    ship = hmri_set()
    D, U_A = ship.propeller.D, (1.0 - 0.428) * 1.170
    n = np.linspace(9.0, 12.0, 3001)
    thrust = ship.rho * n**2 * D**4 * np.interp(U_A / (n * D), J, 0.1 * K_T)
    found = float(np.interp(34.04 / (1.0 - 0.233), thrust, n))
    assert found == pytest.approx(9.9, rel=0.05)
    assert found == pytest.approx(9.95, abs=0.2)


@needs_hmri
def test_form_factor_of_kvlcc2_is_prohaska_s():
    """C_T / C_F over Fn^4 / C_F of the seven slowest runs; R0' from the run at 1.170 m/s."""
    rows = [line.split(",") for line in RESISTANCE.read_text().splitlines()]
    runs = [tuple(map(float, r)) for r in rows if len(r) == 2 and r[0].replace(".", "").isdigit()]
    U, R = np.array([run for run in runs if run[0] < 2.0]).T
    ship, L = load_ship("kvlcc2_model"), 320.0 / 46.426
    C_F = np.array([ittc57(u * L / ship.nu) for u in U])
    C_T = R / (0.5 * ship.rho * ship.hull.S * (L / 7.0) ** 2 * U**2)
    few = U <= 1.170
    line = np.polyfit((U**4 / (9.80665 * L) ** 2 / C_F)[few], (C_T / C_F)[few], 1)
    assert ship.hull.form_factor == pytest.approx(line[1], abs=1e-3)
    at = float(C_T[U == 1.170][0]) - 1.229 * (
        float(C_F[U == 1.170][0]) - ittc57(ship.speed * 7.0 / ship.nu)
    )
    assert ship.hull.R_0 == pytest.approx(at * ship.hull.S / (7.0 * ship.hull.d), rel=1e-3)


def test_powering_refuses_what_the_engine_cannot_hold(kcs_model):
    with pytest.raises(ConfigError, match="kcs_model cannot hold 3 m/s"):
        powering(kcs_model, 3.0)
    with pytest.raises(ConfigError, match="speed = 0"):
        powering(kcs_model, 0.0)
    slow = dataclasses.replace(kcs_model, engine=dataclasses.replace(kcs_model.engine, n_max=1.0))
    assert "power: kcs_model cannot hold" in slow.describe()


def test_published_points_are_read_strictly(tmp_path):
    path = tmp_path / "other.toml"
    text = 'scaled_from = "kcs_model"\nlength = { value = 230.0, unit = "m" }\n[[propulsion]]\n'
    path.write_text(text + 'source = "me"\nspeed = 12.0\npower = 2e7\n')
    with pytest.raises(ConfigError, match=r"propulsion.0.: unknown key 'power'"):
        load_ship(path)
    path.write_text(text + 'source = "me"\nspeed = 12.0\ndelivered_power = 2e7\n')
    ours, theirs = compared(load_ship(path), load_ship(path).propulsion[0])["delivered_power"]
    assert theirs == 2e7 and 1.0 < ours / theirs < 2.0


def test_points_go_by_froude_only_where_the_ship_is_her_model():
    model = load_ship("kvlcc2_model")
    same = scaled(model, 28.0, rho=model.rho, friction_correction=False).propulsion[0]
    assert same.n == pytest.approx(9.824 / 2.0) and same.speed == pytest.approx(2.0 * 1.179)
    assert same.thrust == pytest.approx(46.5 * 64.0) and same.effective_power is None
    assert scaled(model, 28.0).propulsion == ()
