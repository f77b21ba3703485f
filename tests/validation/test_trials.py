"""Against published trials, nothing tuned. What is only reported is printed by ``ship-gym trials``
and stands in docs/trials.md."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.manoeuvres import run_trial, turning_circle, zigzag
from ship_gym.reports.case import sail_trial
from ship_gym.reports.measures import rows
from ship_gym.reports.trials import comparisons, read_values
from ship_gym.ships import load_ship

BEFORE = Path(__file__).parents[2] / "docs" / "reproduce" / "data" / "trials_78d11f0.csv"


@pytest.fixture(scope="module")
def kcs_turn():
    return turning_circle(load_ship("kcs_model"), math.radians(35.0), 0.860, 10.2)


@pytest.mark.parametrize(
    ("measure", "trial", "tolerance"),
    [  # SIMMAN 2020 trial at Hiroshima University, Knight (2021) Tables 4.2, 4.3
        ("max_advance", 3.10, 0.06),
        ("max_transfer", 3.22, 0.05),
        ("steady_thrust", 5.140, 0.07),
    ],
)
def test_kcs_turning_circle(kcs_turn, measure, trial, tolerance):
    assert getattr(kcs_turn, measure) == pytest.approx(trial, rel=tolerance)


def test_gap_the_kcs_circle_is_too_wide(kcs_turn):
    """A gap of ours, not a bound: 2.602 L were measured, the rudder force of the samples is weak.

    docs/turning_circle_speed.md says why; what is written there must be what is computed.
    """
    assert kcs_turn.steady_diameter / 2.602 - 1.0 == pytest.approx(0.064, abs=0.003)


@pytest.mark.parametrize(
    ("trial", "name"),
    [(0, "steady_speed_ratio"), (0, "movable_rudder_force"), (1, "steady_speed_ratio")],
)
def test_kcs_steady_speed_and_rudder_force_are_no_further_off_than_at_78d11f0(trial, name):
    """What was not matched there, Hiroshima University at Fn 0.157; half a point is rounding."""
    ship = load_ship("kcs_model")
    before, _ = read_values(BEFORE)
    found = comparisons(sail_trial(ship, ship.trials[trial]), before)
    each = next(each for each in found if each.row.name == name)
    assert abs(each.row.difference) <= abs(each.before.difference) + 0.5


# Differences from the mean of the facilities that are over two standard deviations (SD), in SD:
# the circles of KCS are too wide (rudder force of the samples); at Fn 0.157 the port SD is 1.1 %.
# number of facilities, rudder angle [deg], measure
WIDE = {
    (3, -35.0, "steady_diameter"): 5.1,
    (6, 35.0, "advance"): 2.2,
    (6, 35.0, "steady_diameter"): 2.8,
    (6, -35.0, "tactical_diameter"): 2.3,
    (6, -35.0, "steady_diameter"): 4.2,
}


def test_kcs_circles_beside_the_scatter_of_the_facilities():
    """Stern et al. (2021), both speeds: within two SD, or a gap that `WIDE` names."""
    ship, outside = load_ship("kcs_model"), {}
    for trial in ship.trials:
        if trial.facilities > 1:
            for row in rows(sail_trial(ship, trial)):
                if row.deviations is not None and abs(row.deviations) > 2.0:
                    key = (trial.facilities, trial.delta_deg, row.name)
                    outside[key] = row.deviations
    assert outside == pytest.approx(WIDE, abs=0.1)


# What is more than 4 % off Knight's CFD: ours has the thrust of the tank's point straight ahead,
# his runs have the surrogate's own, so the propeller pushes more here and the circle is wider.
WIDER_THAN_CFD = {"G3_SA": {"max_transfer": 0.042, "steady_diameter": 0.042}}


@pytest.mark.parametrize(
    ("surrogate", "max_advance", "max_transfer", "steady_diameter"),
    [  # CFD turning circles with the same surrogates, Knight (2021) Table 4.3
        ("G2_SA", 3.07, 3.13, 2.70),
        ("G2_SST", 3.21, 3.35, 2.93),
        ("G3_SA", 2.93, 3.00, 2.60),
    ],
)
def test_kcs_surrogates_against_cfd_with_the_same_surrogates(
    surrogate, max_advance, max_transfer, steady_diameter
):
    tc = turning_circle(load_ship("kcs_model", surrogate=surrogate), speed=0.860, n=10.2)
    printed = {
        "max_advance": max_advance,
        "max_transfer": max_transfer,
        "steady_diameter": steady_diameter,
    }
    found = {name: getattr(tc, name) / value - 1.0 for name, value in printed.items()}
    wide = {name: gap for name, gap in found.items() if abs(gap) > 0.04}
    assert wide == pytest.approx(WIDER_THAN_CFD.get(surrogate, {}), abs=0.003)


def test_kcs_port_turn_is_tighter_and_slower_as_measured(kcs_turn):
    """Stern et al. (2021): tactical diameter 2.9 L to port, 3.2 L to starboard; U/U0 .444, .477."""
    port = turning_circle(load_ship("kcs_model"), -math.radians(35.0), 0.860, 10.2)
    measured = 2.9 / 3.2
    assert port.tactical_diameter / kcs_turn.tactical_diameter == pytest.approx(measured, abs=0.04)
    ratio = port.steady_speed_ratio / kcs_turn.steady_speed_ratio
    assert ratio == pytest.approx(0.444 / 0.477, abs=0.03)


# What is more than 8 % off MARIN's turn to port: with HMRI's resistance the propeller turns slower
# and its race gives the rudder less force. HMRI's captive tests find a fifth more rudder moment.
WIDE_TO_PORT = {"advance": 0.089, "transfer": 0.195}


@pytest.mark.parametrize("trial", [0, 1], ids=["starboard", "port"])
def test_kvlcc2_turning_circles(trial):
    """MARIN's free-running tests; the hull model is that of the 7 m model."""
    ship = load_ship("kvlcc2_model")
    measured = ship.trials[trial].measures
    found = run_trial(ship, ship.trials[trial])
    off = {name: getattr(found, name) / value - 1.0 for name, value in measured.items()}
    wide = {name: gap for name, gap in off.items() if abs(gap) > 0.08}
    assert wide == pytest.approx(WIDE_TO_PORT if trial == 1 else {}, abs=0.003)


@pytest.mark.parametrize(
    ("delta", "expected"),
    [  # an independent simulation with the same set, reference section 4 (its YY15 L7 row)
        (10.0, (5.0, 13.8)),
        (-10.0, (7.1, 8.9)),
        (20.0, (10.5, 15.7)),
        (-20.0, (13.8, 11.7)),
    ],
)
def test_kvlcc2_zigzag_against_an_independent_simulation(delta, expected):
    """With resistance, wake and thrust deduction as YY15 prints them, and no single-screw bias."""
    ship = load_ship("kvlcc2_model")
    ship = dataclasses.replace(
        ship,
        hull=dataclasses.replace(ship.hull, R_0=0.022),
        propeller=dataclasses.replace(ship.propeller, w_P0=0.40, t_P=0.220),
        rudder=dataclasses.replace(ship.rudder, neutral=0.0),
    )
    angle = math.radians(delta)
    found = np.degrees(zigzag(ship, angle, angle, ship.speed, overshoots=2).overshoots)
    np.testing.assert_allclose(found, expected, atol=0.4)


def test_kcs_set_a_against_an_independent_simulation():
    """Reference section 1.2: set A at n = 10.2 rps, U/U0 0.439, T 4.80 N, F_N 2.49 N.

    Set B is not compared: that simulation used another wake formula and thrust curve for it.
    """
    ship = load_ship("kcs_model", surrogate="none", variant="hull_a")
    tc = turning_circle(ship, speed=0.860, n=10.2)
    found = (tc.steady_speed_ratio, tc.steady_thrust, tc.rudder_normal_force)
    np.testing.assert_allclose(found, (0.439, 4.80, 2.49), rtol=0.06)
