"""Numbers as text."""

import pytest

from ship_gym.evaluation.report import words
from ship_gym.evaluation.statistics import Estimate


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (12345.6, "12346"), (0.001234, "0.00123"), (-2.5, "-2.50"), (None, "-"),
     (float("nan"), "-")],
)  # fmt: skip
def test_numbers_have_three_digits_and_no_exponent(value, text):
    assert words.number(value) == text


def test_intervals_scores_and_shares():
    found = Estimate(101.4, 95.6, 107.2)
    assert words.interval(found) == "101 [95.6, 107]"
    assert words.score_interval(found) == "101 [96, 107]"
    assert words.score_interval(Estimate(50.4, None, None)) == "50" and words.score(None) == "-"
    assert words.interval(None) == words.score_interval(None) == "-"
    assert words.share(0.344) == "34 %" and words.signed_share(-0.0534) == "-5.3 %"
    assert words.signed_share(603.5) == "604 times"
    assert words.p_value(2e-9) == "< 0.001" and words.p_value(0.0541) == "0.054"
    assert words.plural(1, "cell") == "1 cell" and words.plural(0, "cell") == "0 cells"
