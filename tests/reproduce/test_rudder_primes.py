"""Dimensionless rudder forces of Stern et al. (2021), Table 1, from the printed forces."""

import math

import pytest

from reproduce.rudder_primes import as_text, primes, speed_ratios


@pytest.mark.parametrize("cell", primes(), ids=lambda c: f"{c['row']} {c['column']}")
def test_prime_is_met_within_one_percent(cell):
    """The area and density they divide by are not told; Knight's movable area is within 1 %."""
    assert cell["computed"] == pytest.approx(cell["printed"], rel=0.012)


def test_beaufoy_in_primes_is_a_number():
    """58.8 g 1.15^2 sin 35 deg over rho/2 with 1000 kg/m3: 0.875 in every row."""
    cells = [c for c in primes() if c["column"] == "Beaufoy"]
    assert len(cells) == 5 and {c["printed"] for c in cells} == {0.875}
    by_hand = 58.8 * 9.80665 * 1.15**2 * math.sin(math.radians(35.0)) / 500.0
    for cell in cells:
        assert cell["computed"] == pytest.approx(by_hand, rel=1e-12)
        assert cell["computed"] == pytest.approx(0.875, abs=5e-4)


def test_primes_by_both_speeds_fit_the_printed_speeds():
    rows = speed_ratios()
    assert len(rows) == 5 and all(row["agrees"] for row in rows)


def test_text_counts_the_cells():
    text = as_text(primes())
    assert "of 21 cells within rounding" in text
    assert max(map(len, text.splitlines())) <= 100
