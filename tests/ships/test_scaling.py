import dataclasses
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ship_gym.conventions import KNOT
from ship_gym.manoeuvres import turning_circle
from ship_gym.ships import load_ship, scaled
from ship_gym.ships.particulars import Engine, Hull, Propeller, Rudder, SteeringGear, Surrogate
from ship_gym.ships.scaling import _POWERS, ittc57
from ship_gym.simulation import self_propulsion


def test_every_unit_of_a_particular_scales():
    for cls in (Hull, Propeller, Rudder, SteeringGear, Engine, Surrogate):
        for field in dataclasses.fields(cls):
            assert field.metadata["unit"] in _POWERS, f"{cls.__name__}.{field.name}"


def test_ittc57_textbook_value():
    # 0.075 / (log10(1e9) - 2)^2 = 0.075 / 49
    assert ittc57(1e9) == pytest.approx(0.075 / 49.0)


@settings(max_examples=4, deadline=None)
@given(st.floats(1.0, 400.0))
def test_froude_scaling_keeps_the_turning_circle(length):
    model = load_ship("kcs_model")
    other = scaled(model, length, rho=model.rho, friction_correction=False)
    a, b = turning_circle(model, n=10.2), None
    n = 10.2 * math.sqrt(model.hull.L / length)
    b = turning_circle(other, n=n)
    for name in ("advance", "tactical_diameter", "steady_speed_ratio", "steady_drift", "steady_J"):
        assert getattr(b, name) == pytest.approx(getattr(a, name), rel=1e-9)
    assert b.steady_thrust == pytest.approx(a.steady_thrust * (length / model.hull.L) ** 3)


def test_kcs_set_a_self_propulsion_at_24_knots():
    # published 115.5 rpm at 24 kn: the model's self-propulsion point at full scale, so R0' as it is
    model = load_ship("kcs_model", surrogate="none", variant="hull_a")
    ship = scaled(model, 230.0, friction_correction=False)
    assert 60.0 * self_propulsion(ship, 24.0 * KNOT) == pytest.approx(115.5, rel=0.005)


def test_friction_correction_lowers_resistance_by_its_formula():
    model = load_ship("kcs_model")
    ship = load_ship("kcs")
    h = ship.hull
    old = ittc57(model.speed * model.hull.L / model.nu)
    new = ittc57(ship.speed * h.L / ship.nu)
    change = (h.form_factor * (old - new) - h.C_A) * h.S / (h.L * h.d)
    assert model.hull.R_0 - h.R_0 == pytest.approx(change)
    assert 0.4 * model.hull.R_0 < h.R_0 < 0.6 * model.hull.R_0


def test_full_scale_kcs_at_24_knots_beside_the_published_rpm():
    """94.4 rpm with the friction correction; the published 115.5 is the model's own point."""
    assert 60.0 * self_propulsion(load_ship("kcs"), 24.0 * KNOT) == pytest.approx(94.4, abs=0.1)


def test_trials_of_a_corrected_ship_are_named_as_the_model_s():
    for name in ("kcs", "kvlcc2"):
        for trial in load_ship(name).trials:
            assert trial.n is None and trial.source.startswith("model trial of")
            forces = {"steady_thrust", "steady_torque", "movable_rudder_force"}
            assert not forces & set(trial.measures)
            assert all(not forces & set(values) for values in trial.others.values())
    same = scaled(load_ship("kcs_model"), 6.114, rho=999.103, friction_correction=False)
    assert same.trials[0].measures["steady_thrust"] == pytest.approx(5.14 * 8.0)
    assert same.trials[0].n == pytest.approx(10.2 / math.sqrt(2.0))
    waves = [trial for trial in same.trials if trial.waves]
    assert [t.wave_height for t in waves] == [pytest.approx(2.0 * 0.048)]
    assert waves[0].wavelength == 1.0
    assert waves[0].others["8 point G2"]["steady_thrust"] == pytest.approx(7.963 * 8.0)
    assert load_ship("kcs").trials[-1].wave_height == pytest.approx(0.048 * 230.0 / 3.057)


def test_scaling_down_again_gives_the_model_back():
    ship = load_ship("kcs")
    model = scaled(ship, 3.057, rho=999.103, friction_correction=False)
    assert model.propeller.D == pytest.approx(0.105)
    assert model.scale == pytest.approx(75.2371)
    assert model.surrogate.card["domain"]["S_R"] == pytest.approx(0.0096)


@pytest.mark.parametrize(("length", "rho", "limit"), [(6.114, 1000.0, 160.0), (6.114, 500.0, 80.0)])
def test_torque_limit_goes_with_length_to_the_fourth_and_density(length, rho, limit):
    """10 N m at 3.057 m in water of 1000 kg/m3: at twice the length 2^4 times as much."""
    model = load_ship("kcs_model")
    engine = dataclasses.replace(model.engine, torque_max=10.0)
    model = dataclasses.replace(model, engine=engine, rho=1000.0)
    other = scaled(model, length, rho=rho)
    assert other.engine.torque_max == pytest.approx(limit, rel=1e-12)


def test_particulars_of_a_ship_four_times_as_long():
    """Lengths 4, areas 16, volumes 64, times 2, speeds 2, rates in time 1/2 (rev/s2: 1/4)."""
    model = load_ship("kcs_model")
    other = scaled(model, 4.0 * model.hull.L, rho=model.rho, friction_correction=False)
    for section, name, factor in (
        ("hull", "B", 4.0),
        ("hull", "d", 4.0),
        ("hull", "x_G", 4.0),
        ("hull", "S", 16.0),
        ("hull", "volume", 64.0),
        ("hull", "Y_v", 1.0),
        ("propeller", "D", 4.0),
        ("propeller", "x_P", 4.0),
        ("rudder", "A_R", 16.0),
        ("rudder", "l_R", 4.0),
        ("gear", "delta_max", 1.0),
        ("gear", "rate", 0.5),
        ("engine", "n_max", 0.5),
        ("engine", "rate", 0.25),
        ("engine", "time_constant", 2.0),
    ):
        was, found = (getattr(getattr(ship, section), name) for ship in (model, other))
        assert found == pytest.approx(factor * was, rel=1e-12), f"{section}.{name}"
        assert was != 0.0 or name == "time_constant", f"{section}.{name}"
    assert other.speed == pytest.approx(2.0 * model.speed)
