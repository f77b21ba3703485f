"""The report of the unsteady comparison."""

import pytest

from reproduce.unsteady import compare_seeds
from reproduce.unsteady_tables import as_dict, as_text


@pytest.fixture(scope="module")
def data():
    return as_dict(compare_seeds(range(1), iterations=100))


def test_printed_tables_stand_beside_ours(data):
    assert data["printed_orders"]["second"]["K_T"] == 5.0e-2
    assert data["printed_stopping"]["8.3e-05"]["loss"] == 2.58e-4
    assert set(data["orders"]) == set(data["printed_orders"])


def test_text_says_that_it_is_synthetic_and_shows_the_printed_numbers(data):
    text = as_text(data)
    assert text.startswith("SYNTHETIC") and "median of 1 seeds" in text
    assert "4.6e-01" in text and "7.7e-05" in text  # Table 4 last cell, Table 3 last row
    assert "7.3e-04" in text and "2.7e-03" in text  # test 3
    assert "6.6e-05" in text and "5.1e-05" in text  # open water
    assert "12 of 17" in text and "10 of 13" in text
    assert max(map(len, text.splitlines())) <= 120
