import dataclasses
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ship_gym.config import ConfigError
from ship_gym.conventions import KNOT, NU_SEA
from ship_gym.manoeuvres import turning_circle
from ship_gym.ships import load_ship, scaled
from ship_gym.ships.particulars import Engine, Hull, Propeller, Rudder, SteeringGear, Surrogate
from ship_gym.ships.scaling import _POWERS, ittc57, scaled_wake, viscous_resistance
from ship_gym.simulation import self_propulsion


def test_every_unit_of_a_particular_scales():
    for cls in (Hull, Propeller, Rudder, SteeringGear, Engine, Surrogate):
        for field in dataclasses.fields(cls):
            assert field.metadata["unit"] in _POWERS, f"{cls.__name__}.{field.name}"


def test_ittc57_textbook_value():
    # 0.075 / (log10(1e9) - 2)^2 = 0.075 / 49
    assert ittc57(1e9) == pytest.approx(0.075 / 49.0)


@pytest.mark.slow
@settings(max_examples=4)
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


def test_full_scale_kcs_at_24_knots_beside_the_ship_point():
    """99.1 rpm with friction and wake corrected, NMRI 100.8; 94.4 with the wake of the model."""
    assert 60.0 * self_propulsion(load_ship("kcs"), 24.0 * KNOT) == pytest.approx(99.1, abs=0.1)
    kept = scaled("kcs_model", 230.0, wake_correction=False)
    assert 60.0 * self_propulsion(kept, 24.0 * KNOT) == pytest.approx(94.4, abs=0.1)


def test_wake_of_kvlcc2_from_the_model_to_the_ship_beside_hmri():
    """Printed: 0.428 and t = 0.233 of the model at 1.170 m/s (1/46.426), 0.347 of the ship."""
    model = load_ship("kvlcc2_model")
    tested = scaled(model, 320.0 / 46.426, rho=model.rho, nu=model.nu)
    old = viscous_resistance(tested.hull, 1.170, model.nu, 320.0)
    new = viscous_resistance(scaled(model, 320.0).hull, 15.5 * KNOT, NU_SEA, 320.0)
    assert scaled_wake(0.428, 0.233, new / old) == pytest.approx(0.347, abs=0.004)
    # the paper's own pair, 0.40 and 0.35, would be 0.330
    assert scaled(model, 320.0).propeller.w_P0 == pytest.approx(0.330, abs=5e-4)


def test_wake_goes_by_its_viscous_part():
    # potential part 0.178 + 0.04, of the other 0.135 half is left
    assert scaled_wake(0.353, 0.178, 0.5) == pytest.approx(0.218 + 0.0675)
    assert scaled_wake(0.353, 0.178, 1.0) == pytest.approx(0.353)
    assert scaled_wake(0.15, 0.178, 0.5) == 0.15  # no viscous part
    assert scaled_wake(-0.153, 0.077, 0.5) == -0.153


def test_wake_of_a_scaled_ship_is_named_as_estimated_or_kept():
    model, ship = load_ship("kcs_model"), load_ship("kcs")
    h = ship.hull
    ratio = (h.form_factor * ittc57(ship.speed * h.L / ship.nu) + h.C_A) / (
        h.form_factor * ittc57(model.speed * model.hull.L / model.nu)
    )
    assert ship.propeller.w_P0 == pytest.approx(0.218 + 0.135 * ratio) and ratio < 0.5
    assert "0.353 of kcs_model scaled by ITTC-78" in ship.estimated["propeller.w_P0"]
    assert "ITTC-78" in ship.sources["propeller.w_P0"]
    for kept in (scaled(model, 230.0, wake_correction=False), load_ship("onrt")):
        assert kept.propeller.w_P0 in (0.353, -0.153)
        assert "scaled" not in kept.estimated.get("propeller.w_P0", "")
    froude = scaled(model, 230.0, friction_correction=False)
    assert froude.propeller.w_P0 == 0.353  # similar to the model, wake and all
    printed = load_ship("kvlcc2")  # her file names the printed one, which stands
    assert printed.propeller.w_P0 == 0.35 and "propeller.w_P0" not in printed.estimated


def test_scaling_down_with_friction_is_the_way_back():
    ship = load_ship("kcs_model")
    there = scaled(ship, 230.0)
    back = scaled(there, ship.hull.L, rho=ship.rho, nu=ship.nu)
    assert back.hull.R_0 == pytest.approx(ship.hull.R_0, rel=1e-9)  # C_A is taken off again
    assert back.propeller.w_P0 == pytest.approx(ship.propeller.w_P0, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [("wake_correction = 1", "allowed is true or false"), ("wake = false", "wake_correction")],
)
def test_wake_correction_of_a_ship_file(tmp_path, text, words):
    path = tmp_path / "other.toml"
    lines = 'scaled_from = "kcs_model"\nlength = { value = 230.0, unit = "m" }\n'
    path.write_text(lines + "wake_correction = false\n")
    assert load_ship(path).propeller.w_P0 == 0.353
    path.write_text(lines + text + "\n")
    with pytest.raises(ConfigError, match=words):
        load_ship(path)


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
