"""Findings of Stern et al. (2021), each tried with our turns: met, or a gap as it is recorded.

The ranges come from the source (`reproduce.stern_findings`). When a closure changes, a finding may
pass from one to the other: ``python scripts/reproduce.py stern --record`` writes the table again.
"""

import pytest

from reproduce.stern_findings import FINDINGS, GAP, RECORD, record, recorded
from reproduce.stern_turns import OPEN_WATER, Pair, thrust_identity, turns
from ship_gym.csv_file import read_csv

KNOWN = recorded()


@pytest.mark.parametrize("finding", FINDINGS, ids=lambda f: f"{f.key} {f.froude:g}")
def test_finding_is_met_or_a_gap_of_the_recorded_size(finding):
    value = finding.value(turns(finding.froude))
    size, verdict = KNOWN[finding.key, finding.froude]
    assert finding.verdict(value) == verdict, (finding.says, value)
    if verdict == GAP:
        assert value == pytest.approx(size, rel=0.01), finding.says


def test_record_has_each_finding_once_and_no_other():
    keys = [(f.key, f.froude) for f in FINDINGS]
    assert len(set(keys)) == len(keys)
    assert set(KNOWN) == set(keys)


def test_record_is_written_as_it_is_read(tmp_path):
    rows = [
        {"key": k, "froude": fn, "ours": ours, "verdict": v} for (k, fn), (ours, v) in KNOWN.items()
    ]
    record(rows, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == RECORD.read_text()


@pytest.mark.parametrize("froude", [0.157, 0.26])
def test_balance_closes(froude):
    """Their errors of balance are "reasonably small"; ours is a steady state of the model."""
    for turn in turns(froude).turns.values():
        for axis, parts in turn.forces.items():
            assert parts["sum"] == pytest.approx(0.0, abs=1e-5 * turn.scale(axis))


def test_percent_is_of_the_mean_as_table_6_has_it():
    """Table 6: 0.3724 and 0.3514 differ by 5.81 % of their mean."""
    assert Pair.percent(0.3514, 0.3724) == pytest.approx(5.81, abs=0.02)
    assert Pair.percent(0.3200, 0.3480) == pytest.approx(8.21, abs=0.2)  # printed with more digits
    assert Pair.percent(0.3362, 0.3693) == pytest.approx(9.38, abs=0.02)


def test_thrust_identity_gives_the_wake_back():
    """At the printed K_T of an open-water point 1 - w is its J over the ship's."""
    ship = turns(0.157).ship
    points = read_csv(OPEN_WATER).columns
    n, speed, D = 10.0, 0.9, ship.propeller.D
    thrust = points["K_T"][8] * ship.rho * n**2 * D**4
    found = thrust_identity(ship, thrust, speed, n)
    assert found == pytest.approx(points["J"][8] * n * D / speed, rel=1e-12)


def test_printed_rudder_force_is_larger_to_port_by_the_steady_speed_only():
    """HU, Table 1: this is why the primes here are by the steady speed."""
    force, speed = {"port": 2.589, "starboard": 2.922}, {"port": 0.382, "starboard": 0.410}
    by_speed = {side: force[side] / speed[side] ** 2 for side in force}
    assert force["port"] < force["starboard"] and by_speed["port"] > by_speed["starboard"]
    assert by_speed["port"] / by_speed["starboard"] == pytest.approx(4.415 / 4.325, rel=2e-3)
