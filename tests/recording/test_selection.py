"""Runs are chosen by conditions and ordered by any of their values."""

from __future__ import annotations

import pytest

from ship_gym.config import ConfigError
from ship_gym.recording.library import Run
from ship_gym.recording.selection import chosen, condition, ordered


def run(name, **values):
    """A run of which only columns and metrics matter."""
    own = {key: values.pop(key) for key in ("controller", "seed", "outcome") if key in values}
    return Run(name, {"metrics": values, **own}, 4.0, True)


RUNS = [
    run("a", J_1=5.0, controller="pid", seed=3, outcome="end of time"),
    run("b", J_1=150.0, controller="lqg", seed=1, outcome="heading limit"),
    run("c", J_1=None, controller="pid", seed=2, outcome="heading limit"),
    run("d", J_1=100.0, controller="mpc", seed=4, outcome="end of time"),
    Run("e", error="damaged"),
]


@pytest.mark.parametrize(
    ("conditions", "expected"),
    [
        ([], "abcde"),
        (["J_1>100"], "b"),
        (["J_1 >= 1e2"], "bd"),
        (["J_1<100"], "a"),
        (["J_1<=100"], "ad"),
        (["J_1==5"], "a"),
        (["J_1!=5"], "bd"),
        (["controller==pid"], "ac"),
        (["outcome!=end of time"], "bc"),
        (['outcome=="heading limit"', "seed<2"], "b"),
        (["state==unreadable"], "e"),
        (["duration>10"], ""),
    ],
)
def test_conditions_choose(conditions, expected):
    assert "".join(one.path for one in chosen(RUNS, conditions)) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("J_1", "condition 'J_1': must be FIELD OPERATOR VALUE"),
        ("J_1=3", "operators: <= >= == != < >"),
        ("J_1>>3", "'>3' is not a number"),
        ("J_1>high", "'high' is not a number"),
        ("J1>3", "unknown field 'J1'; did you mean 'J_1'"),
        ("controler==pid", "did you mean 'controller'"),
        ("ship>kcs", "ship is text: allowed are == and !="),
        ("__import__('os')>1", "unknown field"),
    ],
)
def test_conditions_that_are_none_say_what_is_allowed(text, words):
    with pytest.raises(ConfigError) as refused:
        condition(text, ["J_1"])
    assert words in str(refused.value)


def test_order_puts_what_lacks_a_value_last():
    names = ["".join(one.path for one in ordered(RUNS, "J_1", back)) for back in (False, True)]
    assert names == ["adbce", "bdace"]
    assert next(one.path for one in ordered(RUNS, "seed")) == "b"
    with pytest.raises(ConfigError, match="unknown field to sort by 'J_2'"):
        ordered(RUNS, "J_2")
