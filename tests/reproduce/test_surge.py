"""Surge balance of a steady turn, term by term."""

import pytest

from reproduce.surge import surge_balance
from ship_gym.reports.balance import last_turn
from ship_gym.reports.case import sail
from ship_gym.ships.loader import load_ship


def test_surge_terms_sum_to_zero_and_to_the_hull_force():
    circle = sail(load_ship("kcs_model"))
    terms = surge_balance(circle.ship, circle.result.trajectory)
    assert sum(terms.values()) == pytest.approx(0.0, abs=1e-4)
    hull = sum(terms[k] for k in ("R_0", "X_vv", "X_vr", "X_rr", "X_vvvv"))
    assert hull == pytest.approx(last_turn(circle.result.trajectory)["X_hull"], rel=1e-6)
