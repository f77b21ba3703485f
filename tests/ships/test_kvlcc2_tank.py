"""KVLCC2 in two tanks: the rudder's neutral angle, and its flow straightening at small drift.

MARIN's free-running tests (SIMMAN 2008) and HMRI's captive tests (SIMMAN 2014); both count rudder
angles to port positive.
"""

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.physics.rudder import axial_inflow
from ship_gym.ships import load_ship
from ship_gym.simulation import straight_forces
from tests.conftest import tables_of

# not in the package: beside a checkout
FOLDER = Path(__file__).resolve().parents[3] / "shared" / "reference" / "kvlcc2"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the tank's files are not here")


def columns(name):
    """Columns of a tank's file by their order, remarks and names left out."""
    lines = (FOLDER / name).read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    return np.loadtxt(lines[start + 1 :], delimiter=",", unpack=True)


def held_before_the_first_order(name):
    """Mean rudder angle [deg] of a free-running test until it moves, to starboard positive."""
    delta = columns(name)[9]
    moved = int(np.argmax(np.abs(delta - delta[0]) > 0.1))
    return -float(delta[:moved].mean())


def test_neutral_rudder_is_the_mean_of_the_approaches():
    names = sorted(path.name for path in FOLDER.glob("marin_free_*.csv"))
    held = [held_before_the_first_order(name) for name in names]
    assert len(held) == 6
    assert np.mean(held) == pytest.approx(0.55, abs=0.01)
    assert (min(held), max(held)) == pytest.approx((-0.18, 1.16), abs=0.01)
    assert load_ship("kvlcc2_model").rudder.neutral == pytest.approx(math.radians(0.55))


@pytest.fixture(scope="module")
def without_force():
    """Drift [deg] to the rudder angle [deg] without force there, less that at zero drift."""
    _, delta, speed, _, _, _, _, _, force, _ = columns("hmri_static_rudder_test.csv")
    small = (speed > 1.17) & (np.abs(delta) <= 10.0)
    slope, bias = np.polyfit(delta[small], force[small], 1)
    _, beta, delta, _, _, _, _, _, _, force, _ = columns("hmri_static_drift_rudder_test.csv")
    lines = {b: np.polyfit(delta[beta == b], force[beta == b], 1) for b in np.unique(beta)}
    return {float(b): bias / slope - line[1] / line[0] for b, line in lines.items()}


def test_flow_straightening_is_one_sides_own_from_small_drift_on(without_force):
    """tan of that angle times u_R / (U beta): beside 0.640 and 0.395 of Yasukawa & Yoshimura.

    So five degrees for the passage from one side to the other are enough, and a smaller gamma_R at
    small inflow, which would make the overshoots larger, has no ground here.
    """
    U, ship = 1.1702, load_ship("kvlcc2_model")
    thrust = straight_forces(ship, U, 9.9)[1].thrust
    u_R = axial_inflow(U, (thrust, 1.0 - ship.propeller.w_P0, 0.0), tables_of(ship)[0])

    def gamma_R(beta):
        angle = math.radians(-without_force[beta])
        return math.tan(angle) * u_R / (U * math.radians(beta))

    def mean(low, high):
        return np.mean([gamma_R(b) for b in without_force if low <= b <= high])

    k = ship.rudder
    assert mean(4.0, 30.0) == pytest.approx(k.gamma_R_p, rel=0.10)  # 0.70
    assert mean(-30.0, -4.0) == pytest.approx(k.gamma_R_n, rel=0.10)  # 0.40
    assert mean(4.0, 12.0) > k.gamma_R_p and mean(-12.0, -4.0) > k.gamma_R_n  # 0.77, 0.41
