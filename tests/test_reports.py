"""Reports: the balance closes, trials are matched as they should be, forces are scaled."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.reports import manoeuvre as report
from ship_gym.reports.balance import steady_balance
from ship_gym.reports.case import sail, sail_trial, trials
from ship_gym.reports.measures import Row, difference_text, rows
from ship_gym.ships.loader import load_ship
from ship_gym.simulation import self_propulsion


@pytest.fixture(scope="module")
def circle():
    return sail(load_ship("kcs_model"))


def test_steady_forces_and_inertia_cancel(circle):
    balance = steady_balance(circle.ship, circle.result.trajectory)
    scale = np.abs(list(balance.values())).max(axis=0)
    assert np.abs(balance["sum"]) == pytest.approx(0.0, abs=1e-5 * scale.max())


@pytest.mark.slow
def test_matching_trial_decides_the_propeller_speed(circle):
    assert circle.n == 10.2
    assert circle.trial is circle.ship.trials[0]
    assert sail(circle.ship, n=10.3).trial is circle.trial
    assert sail(circle.ship, n=11.0).trial is None  # another propeller speed
    assert sail(circle.ship, speed=0.9).trial is None
    assert sail(circle.ship, delta_deg=34.0).trial is None
    assert sail(circle.ship, sea="current").trial is None


def test_rows_compare_with_trial_and_imo(circle):
    found = {row.name: row for row in rows(circle)}
    assert found["steady_speed_ratio"].measured == 0.477
    ours = circle.result.steady_speed_ratio
    assert found["steady_speed_ratio"].difference == pytest.approx(100.0 * (ours / 0.477 - 1.0))
    assert found["advance"].limit == 4.5
    assert found["advance"].passes
    assert found["transfer"].limit is None
    assert "drift_distance" not in found  # calm water
    assert not dataclasses.replace(found["advance"], computed=4.6).passes


def test_force_of_the_movable_rudder_is_compared_with_the_measured_one(circle):
    """The trial measured the movable part (Knight 2021); its factor: tests/ships/test_trials.py."""
    found = {row.name: row for row in rows(circle)}
    assert found["rudder_normal_force"].measured is None
    movable = found["movable_rudder_force"]
    assert movable.measured == 2.923
    assert movable.computed == pytest.approx(circle.result.rudder_normal_force * 1.07)
    without = dataclasses.replace(circle, trial=None)
    assert "movable_rudder_force" not in {row.name for row in rows(without)}


def test_scatter_of_the_facilities_is_an_error_bar():
    """Fn 0.157 to starboard, Stern et al. (2021): tactical diameter 3.2 L, 5.9 % of scatter."""
    ship = load_ship("kcs_model")
    case = sail_trial(ship, ship.trials[2])
    row = {row.name: row for row in rows(case)}["tactical_diameter"]
    assert row.deviation == pytest.approx(0.059 * 3.2)
    assert row.deviations == pytest.approx((row.computed - 3.2) / (0.059 * 3.2))
    assert "3.20 ± 0.19" in report.as_text(case)
    data = report.as_dict(case)
    assert data["difference_in_deviations"]["tactical_diameter"] == row.deviations
    assert dataclasses.replace(row, deviation=None).deviations is None


@pytest.mark.parametrize(
    ("computed", "difference"), [(100.0, 6.7), (-100.0, 166.7), (-80.0, -173.3), (93.3, 0.0)]
)
def test_difference_of_a_direction_is_an_angle(computed, difference):
    row = Row("drift_direction", computed, 93.3)
    assert row.difference == pytest.approx(difference)
    assert difference_text(row).endswith(" deg")


def test_what_others_computed_is_beside():
    """Knight (2021) Table 4.3: his CFD with the same regression."""
    ship = load_ship("kcs_model")
    case = sail_trial(ship, ship.trials[0])
    row = {row.name: row for row in rows(case)}["max_transfer"]
    assert row.others == {"CFD, G2": 3.13, "CFD, G2 SST": 3.35, "CFD, G3": 3.00}
    assert "computed by others" in report.as_text(case)


def test_smaller_rudder_has_no_imo_limit():
    case = sail(load_ship("kcs_model"), delta_deg=20.0)
    assert "no limit" in report.as_text(case)


def test_zigzag_angles_default_to_each_other():
    ship = load_ship("kvlcc2_model")
    case = sail(ship, "zigzag", psi_deg=-20.0)
    assert (case.delta, case.psi) == (pytest.approx(np.radians(-20)), pytest.approx(case.delta))
    assert case.trial.measures["overshoots_deg"] == [15.1, 13.2]
    assert {r.name for r in rows(case) if r.limit} == {"overshoot_1"}


def test_full_scale_ship_is_compared_with_the_model_trial_by_name_without_forces():
    ship = load_ship("kcs")
    case = sail_trial(ship, trials(ship)[0])
    measured = {row.name for row in rows(case) if row.difference is not None}
    assert measured == {"max_advance", "max_transfer", "steady_diameter", "steady_speed_ratio"}
    assert case.n == self_propulsion(ship, ship.speed)
    text = report.as_text(case)
    assert "[kN]" in text and "model trial of kcs_model" in text


def test_ship_without_trials_and_unknown_measure_are_refused(circle):
    ship = dataclasses.replace(circle.ship, trials=())
    with pytest.raises(ConfigError, match="no trial"):
        trials(ship)
    odd = dataclasses.replace(circle.trial, measures={"max_advence": 3.0}, deviation={})
    with pytest.raises(ConfigError, match="max_advance"):
        rows(dataclasses.replace(circle, trial=odd))
