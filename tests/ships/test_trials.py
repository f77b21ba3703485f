"""Trials of a ship file: what is allowed, and the scale they are stated at."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.manoeuvres import trial_sea
from ship_gym.ships.loader import load_ship
from ship_gym.ships.trials import Trial, scaled_trial
from ship_gym.surrogates.samples import DATA

PLAIN = Trial("turning_circle", "a source", 35.0, 1.0, {"advance": 3.0})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wave_height": 0.1}, "wavelength = 0.0"),
        ({"wavelength": 1.0}, "wave_height = 0.0"),
        ({"wave_height": -0.1, "wavelength": 1.0}, "wave_height = -0.1"),
        ({"wave_from_deg": 400.0}, "wave_from_deg = 400"),
        ({"facilities": 0}, "facilities = 0"),
        ({"deviation": {"advance": 1.5}}, r"deviation.advance = 1.5"),
        ({"deviation": {"transfer": 0.1}}, "no transfer"),
        ({"length": 0.0}, "length = 0"),
        ({"movable_factor": 2.2}, "movable_factor = 2.2"),
        ({"measures": {"movable_rudder_force": 2.0}}, "movable_factor: missing"),
    ],
)
def test_bad_trials_are_refused(changes, words):
    with pytest.raises(ConfigError, match=words):
        dataclasses.replace(PLAIN, **changes)


def test_trial_of_a_larger_model_is_at_the_scale_of_the_ship():
    """MARIN's 6.07 m model at 2.006 m/s is the ship's 3.057 m at Fn 0.26; forces go by L^3."""
    ship = load_ship("kcs_model")
    trial = next(t for t in ship.trials if t.length == 6.0702)
    ratio = 3.057 / 6.0702
    assert trial.speed == pytest.approx(2.006 * math.sqrt(ratio))
    assert ship.froude(trial.speed) == pytest.approx(0.26, abs=5e-4)
    assert trial.measures["movable_rudder_force"] == pytest.approx(40.0 * ratio**3)
    assert trial.measures["steady_speed_ratio"] == 0.394


def test_printed_coefficients_of_the_rudder_force_are_by_the_movable_area():
    """Stern et al. (2021) Table 1: F_N over 1/2 rho U0^2 C_F is 0.0080 m2 at 3.057 m for all."""
    printed = [  # F_N [N], C_F, U0 [m/s], L [m]
        (2.589, 0.876, 0.860, 3.057),
        (2.922, 0.988, 0.860, 3.057),
        (40.0, 0.627, 2.006, 6.0702),
        (1.328, 0.649, 0.808, 2.7),
        (1.502, 0.734, 0.808, 2.7),
        (4.188, 0.746, 1.338, 2.7),
    ]
    for force, coefficient, speed, length in printed:
        area = force / (0.5 * 1000.0 * speed**2 * coefficient)
        assert area * (3.057 / length) ** 2 == pytest.approx(0.0080, rel=0.015)


def test_force_of_the_movable_part_over_that_of_the_whole_rudder():
    """Knight (2021), KCS in the measured turn: Table 3.15 over Tables A.9 to A.11.

    Tables 3.13 and 3.14 print thrust and torque of three models with printed coefficients in one
    state: six numbers for the propeller speed, J and drift at the propeller.
    """
    printed = {  # T [N], Q [N m], F_N of the movable part [N]
        "G2 SA": (4.920, 0.0821, 2.618),
        "G2 SST": (5.143, 0.0844, 2.287),
        "G3 SA": (4.876, 0.0810, 2.738),
    }
    rho, D, S_R, yaw_rate, stock = 1000.0, 0.105, 0.0096, 0.10, 1.482 - 1.428
    table = read_csv(DATA / "kcs_regression_coefficients.csv")

    def value(model: str, name: str, J: float, beta: float) -> float:
        features = np.array([1.0, J, J**2, beta, beta**2, J * beta])
        return float(table.where(model=model).columns[name] @ features)

    def residuals(state):
        n, J, beta = state
        for model, (T, Q, _) in printed.items():
            yield value(model, "K_T", J, beta) * rho * n**2 * D**4 / T - 1.0
            yield 0.1 * value(model, "10K_Q", J, beta) * rho * n**2 * D**5 / Q - 1.0

    found = least_squares(lambda state: list(residuals(state)), (10.4, 0.35, 0.6))
    assert np.sqrt(np.mean(found.fun**2)) < 3e-4
    n, J, beta = found.x
    u = n * J * D
    v_R = u * math.tan(beta) + stock * yaw_rate  # drift at the propeller to drift at the stock
    ratios = []
    for model, (_, _, movable) in printed.items():
        u_R2 = u**2 * (1.0 + 8.0 * value(model, "K_T", J, beta) / (math.pi * J**2)) + v_R**2
        x, y = (value(model, name, J, math.atan2(v_R, u)) for name in ("C_Fx", "C_Fy"))
        whole = -x * math.sin(math.radians(35.0)) + y * math.cos(math.radians(35.0))
        ratios.append(movable / (0.5 * rho * u_R2 * S_R * whole))
    assert ratios == pytest.approx([1.078, 1.039, 1.088], abs=0.003)
    factors = {t.movable_factor for t in load_ship("kcs_model").trials} - {None}
    assert list(factors) == pytest.approx([np.mean(ratios)], abs=0.005)


def test_waves_of_a_trial():
    ship = load_ship("kcs_model")
    trial = dataclasses.replace(PLAIN, wave_height=0.06, wavelength=1.0, wave_from_deg=30.0)
    sea = trial_sea(ship, trial)
    assert sea.regular.amplitude == pytest.approx(0.03)
    assert 2.0 * math.pi * 9.80665 / sea.regular.omega**2 == pytest.approx(ship.hull.L)
    assert math.sin(sea.wave_direction_to) == pytest.approx(-0.5)
    assert math.cos(sea.wave_direction_to) == pytest.approx(-math.sqrt(0.75))
    assert trial_sea(ship, PLAIN).regular is None
    assert scaled_trial(trial, 2.0).wave_height == pytest.approx(0.12)


def test_scatter_and_others_go_with_their_measures():
    """A full-scale ship keeps no force of its model."""
    trial = dataclasses.replace(
        PLAIN,
        measures={"advance": 3.0, "steady_thrust": 5.0},
        deviation={"advance": 0.1, "steady_thrust": 0.2},
        others={"CFD": {"advance": 2.9, "steady_thrust": 4.0}},
        n=10.0,
    )
    ship = scaled_trial(trial, 4.0, model="model trial of x")
    assert ship.measures == {"advance": 3.0} and ship.deviation == {"advance": 0.1}
    assert ship.others == {"CFD": {"advance": 2.9}} and ship.n is None
    model = scaled_trial(trial, 4.0, 1.1)
    assert model.measures["steady_thrust"] == pytest.approx(5.0 * 64.0 * 1.1)
    assert model.others["CFD"]["steady_thrust"] == pytest.approx(4.0 * 64.0 * 1.1)
    assert model.n == pytest.approx(5.0)
