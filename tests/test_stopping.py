"""Crash stop, coasting, acceleration: geometry, energy, printed or independent values, refusals."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.conventions import KNOT
from ship_gym.manoeuvres import imo_limits
from ship_gym.sea import Sea
from ship_gym.ships import load_ship
from ship_gym.ships.plausible import checked
from ship_gym.ships.powering import powering
from ship_gym.ships.scaling import scaled
from ship_gym.simulation import ShipSim, longest_step, self_propulsion, straight_forces
from ship_gym.stability import spiral
from ship_gym.stopping import acceleration, coasting, stopping


@pytest.fixture(scope="module")
def stop():
    return stopping("kcs")


def test_stop_ends_at_rest_and_its_measures_are_geometry(stop):
    t, L = stop.trajectory, load_ship("kcs").hull.L
    assert t["u"][-1] <= 0.0 < t["u"][-2]
    assert stop.head_reach == pytest.approx(t["x"].max() / L, abs=1e-3)
    assert stop.track_reach == pytest.approx(np.trapezoid(t["u"], t["t"]) / L, rel=1e-4)
    assert stop.lateral_deviation == 0.0 and stop.heading_change == 0.0
    assert stop.time == t["t"][-1] and 0.0 < stop.reversal < stop.time
    assert t["n"][t["t"] < stop.reversal].min() >= 0.0


def test_work_of_the_forces_is_the_energy_lost(stop):
    t, b = stop.trajectory, load_ship("kcs").inertia
    X = sum(t[f"X_{name}"] for name in ("hull", "propeller", "rudder"))
    work = np.trapezoid(X * t["u"], t["t"])
    assert work == pytest.approx(-0.5 * b.m_u * t["u"][0] ** 2, rel=1e-3)


def test_less_astern_and_more_speed_go_further(stop):
    ship = load_ship("kcs")
    gentle = stopping(ship, order=-0.5 * ship.engine.n_astern)
    fast = stopping(ship, speed=1.5 * ship.speed)
    assert gentle.track_reach > 1.2 * stop.track_reach
    assert fast.track_reach > 1.2 * stop.track_reach
    assert coasting(ship).track_reach > 3.0 * stop.track_reach


@pytest.mark.parametrize("name", ["kcs", "kvlcc2", "dtc", "onrt", "s175"])
def test_stopping_distance_is_of_the_order_of_imos_limit(name):
    """Container ships and the frigate stop within 15 L; the tanker misses 20 L, and it is said."""
    ship = load_ship(name)
    reach = stopping(ship).track_reach
    assert imo_limits(ship, ship.speed)["track_reach"] == 15.0
    if name == "kvlcc2":
        assert reach == pytest.approx(24.1, abs=0.1)
    else:
        assert reach < 15.0


@pytest.mark.parametrize("name", ["kcs_model", "kvlcc2_model", "dtc_model", "s175", "onrt_model"])
def test_engine_of_a_ship_that_is_not_scaled_is_what_her_file_says(name):
    ship = load_ship(name)
    engine, point = ship.engine, powering(ship)
    torque = point.torque / ship.propellers * (engine.n_max / point.n) ** 2
    assert engine.torque_max == pytest.approx(torque, rel=1e-3)
    assert engine.torque_brake == pytest.approx(0.2 * engine.torque_max, rel=1e-3)
    assert engine.n_astern == pytest.approx(0.6 * engine.n_max)
    assert engine.shaft_inertia == pytest.approx(0.01 * ship.rho * ship.propeller.D**5, rel=1e-3)


@pytest.mark.parametrize("name", ["kcs", "kvlcc2", "dtc"])
def test_torque_limit_is_that_of_the_ship_not_of_her_model(name):
    """Of a scaled ship 1.3 times the torque at service speed, braking a fifth of it."""
    ship = load_ship(name)
    knots = {"kcs": 24.0, "kvlcc2": 15.5, "dtc": 24.0}[name]
    engine, torque = ship.engine, powering(ship, knots * KNOT).torque
    assert engine.torque_max == pytest.approx(1.3 * torque, rel=0.02)
    assert engine.torque_brake == pytest.approx(0.2 * engine.torque_max)


@pytest.mark.parametrize(("deduction", "reach"), [(0.0, 27.0), (None, 28.8)])
def test_kcs_coasts_with_a_locked_propeller(deduction, reach):
    """27 L to 10 % of 14.5 kn in a wake of 0.353: an independent integration, whole thrust.

    With t_P on it too, as assumed here, 28.8 L; without the propeller's drag it was 47 L.
    """
    ship = load_ship("kcs")
    t_P = ship.propeller.t_P if deduction is None else deduction
    propeller = dataclasses.replace(ship.propeller, w_P0=0.353, t_P=t_P)
    ship = dataclasses.replace(ship, propeller=propeller)
    sim = ShipSim(ship, 1)
    sim.reset(0, n=0.0)
    while sim.state[0, 0] > 0.1 * ship.speed:
        sim.step(np.zeros((1, 2)), longest_step(ship))
    assert sim.state[0, 3] / ship.hull.L == pytest.approx(reach, abs=0.5)


def test_coasting_by_hand():
    """Resistance and drag go with u^2: u = U0 / (1 + t / tau), x = tau U0 ln(U0 / u)."""
    ship = load_ship("kvlcc2")
    engine = dataclasses.replace(ship.engine, rate=1e6, time_constant=0.0, torque_max=math.inf)
    ship = checked(dataclasses.replace(ship, engine=engine, strict=False))
    sim = ShipSim(ship, 1)
    sim.reset(0, n=0.0)
    sim.step(np.zeros((1, 2)), 1e-3)
    tau = ship.inertia.m_u * ship.speed / -sim.forces[0, :, 0].sum()
    expected = tau * ship.speed * math.log(10.0) / ship.hull.L
    found = coasting(ship)
    assert found.track_reach == pytest.approx(expected, rel=0.01)
    assert found.time == pytest.approx(9.0 * tau, rel=0.01)
    assert found.final_n == 0.0 and math.isnan(found.reversal)


def test_an_unstable_ship_with_a_neutral_angle_stays_on_her_course():
    """KVLCC2's rudder is held where it has no force; amidships she would turn away."""
    ship = load_ship("kvlcc2")
    assert ship.rudder.neutral != 0.0
    held, amidships = stopping(ship), stopping(ship, delta=0.0)
    assert abs(held.heading_change) < 1e-9 and held.trajectory["delta"][0] != 0.0
    assert abs(amidships.heading_change) > 1e-6


def test_acceleration_ends_at_its_share_of_the_speed():
    ship = load_ship("kcs_model")
    found, half = acceleration(ship), acceleration(ship, share=0.5)
    assert found.speed_ratio == pytest.approx(0.9, abs=2e-3)
    assert found.final_n == pytest.approx(self_propulsion(ship, ship.speed), rel=1e-3)
    assert 0.0 < half.time < found.time and found.trajectory["u"][0] == 0.0
    assert found.trajectory["n"][0] == 0.0 and found.largest_astern_thrust == 0.0


def test_froude_scale_of_a_stop():
    ship = load_ship("kvlcc2_model")
    big = scaled(ship, 40.0 * ship.hull.L, rho=ship.rho, nu=ship.nu, friction_correction=False)
    one, other = stopping(ship), stopping(big)
    assert other.track_reach == pytest.approx(one.track_reach, rel=1e-4)
    assert other.time == pytest.approx(math.sqrt(40.0) * one.time, rel=1e-4)
    assert other.largest_astern_thrust == pytest.approx(40.0**3 * one.largest_astern_thrust, 1e-4)


def test_a_stop_with_the_rudder_over_turns_and_a_current_carries_it():
    turned = stopping("kvlcc2", delta=math.radians(35.0))
    assert turned.heading_change > 0.3 and turned.lateral_deviation > 0.5
    assert turned.head_reach < turned.track_reach
    current = Sea(current_speed=0.5, current_direction_to=math.pi / 2)
    still, carried = stopping("kcs"), stopping("kcs", sea=current)
    drift = 0.5 * carried.time / load_ship("kcs").hull.L
    assert carried.lateral_deviation == pytest.approx(drift, rel=0.02)
    assert carried.head_reach == pytest.approx(still.head_reach, rel=0.01)


PAGE = Path(__file__).parents[1] / "docs" / "stopping.md"
ROWS = [line.split("|")[1:-1] for line in PAGE.read_text().splitlines() if line.startswith("| `")]


@pytest.mark.slow
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row[0].strip()} {row[1].strip()} kn")
def test_table_of_the_page(row):
    name, knots, *printed = (cell.strip() for cell in row)
    ship = load_ship(name.strip("`"))
    speed = ship.speed if abs(ship.speed / KNOT - float(knots)) < 0.05 else float(knots) * KNOT
    n = self_propulsion(ship, speed)
    resistance = -straight_forces(ship, speed, n)[0].hull.X
    found = [straight_forces(ship, speed, k * n)[1].thrust / resistance for k in (0.0, 0.3, -0.5)]
    stop, coast = stopping(ship, speed=speed), coasting(ship, speed=speed)
    found += [stop.track_reach, stop.time, stop.reversal, coast.track_reach]
    found += [acceleration(ship, speed=speed).track_reach]
    found += [math.degrees(spiral(ship, speed=speed).loop_width)]
    digits = [len(text.partition(".")[2]) for text in printed]
    shown = [f"{value:.{k}f}" for value, k in zip(found, digits, strict=True)]
    assert shown == printed


def test_reruns_from_its_meta(stop):
    config = stop.trajectory.meta["config"]
    again = stopping("kcs", config["delta"], config["speed"], config["n"], config["order"])
    for name in stop.trajectory.names:
        assert (again.trajectory[name] == stop.trajectory[name]).all()


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda s: stopping(s, order=3.0), "order = 3"),
        (lambda s: stopping(s, order=-99.0), "order = -99"),
        (lambda s: stopping(s, delta=35.0), "looks like degrees"),
        (lambda s: stopping(s, order=0.0), "does not stop"),
        (lambda s: coasting(s, share=1.5), "share = 1.5"),
        (lambda s: acceleration(s, n=1.0), "does not reach"),
        (lambda s: acceleration(s, speed=-1.0), "speed = -1"),
    ],
)
def test_bad_input(kcs_model, call, word):
    with pytest.raises(ConfigError) as error:
        call(kcs_model)
    assert word in str(error.value)


def test_an_engine_that_cannot_reverse_is_refused(kcs_model):
    engine = dataclasses.replace(kcs_model.engine, n_astern=0.0)
    with pytest.raises(ConfigError, match="cannot reverse"):
        stopping(dataclasses.replace(kcs_model, engine=engine))
