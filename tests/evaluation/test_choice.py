"""Which episodes are the best, the median and the worst, with ties, gaps and failures."""

import math

import pytest

from ship_gym.config import ConfigError
from ship_gym.evaluation.choice import WHICH, chosen, extremes, ranked

VALUES = [3.0, None, 1.0, 2.0, 1.0, math.nan, 0.5, None]
FAILED = [False, False, False, False, False, False, True, True]


def test_failed_ones_are_the_worst_and_those_without_a_value_count_only_if_failed():
    assert ranked(VALUES, "lower", FAILED) == [2, 4, 3, 0, 6, 7]
    assert ranked(VALUES, "lower") == [6, 2, 4, 3, 0]


def test_higher_may_be_better():
    assert ranked(VALUES, "higher", FAILED) == [0, 3, 2, 4, 6, 7]


def test_of_equal_ones_the_earlier_is_the_better():
    assert ranked([1.0] * 3, "lower") == ranked([1.0] * 3, "higher") == [0, 1, 2]


@pytest.mark.parametrize(
    ("which", "count", "found"),
    [
        ("worst", 1, [7]),
        ("worst", 3, [7, 6, 0]),
        ("worst", 99, [7, 6, 0, 3, 4, 2]),
        ("best", 2, [2, 4]),
        ("median", 1, [3]),
        ("failed", 1, [6, 7]),
        ("all", 1, list(range(8))),
    ],
)
def test_chosen(which, count, found):
    assert chosen(which, VALUES, "lower", FAILED, count) == found


def test_nothing_to_choose_from():
    for which in set(WHICH) - {"all"}:
        assert chosen(which, [None, None], "lower", [False, False]) == []
    assert extremes([1, 2], [None, math.nan], "lower", [False, False]) == {}


def test_seeds_and_values():
    seeds = range(10, 18)
    assert extremes(seeds, VALUES, "lower", FAILED) == {
        "best": {"seed": 12, "value": 1.0},
        "median": {"seed": 13, "value": 2.0},
        "worst": {"seed": 17, "value": None},
    }


def test_unknown_words_are_refused():
    with pytest.raises(ConfigError, match="did you mean 'worst'"):
        chosen("wrost", [1.0], "lower", [False])
    with pytest.raises(ConfigError, match="better"):
        ranked([1.0], "less")
