"""Claims of policies: what holds and what does not, on made-up metrics."""

from pathlib import Path

import numpy as np
import pytest

from pages import judgement
from pages.judgement import Claim
from ship_gym.config import ConfigError

CLAIMS = Path(__file__).parents[2] / "scripts" / "policy_claims.toml"
N = 128


def claim(**changes):
    given = {
        "name": "heading",
        "policy": "mine",
        "scenario": "heading_keeping",
        "ship": "kcs",
        "measure": "J_0.1",
        "against": ("pid", "lqg"),
        "lower": ("rudder_travel",),
        "within": 0.005,
    }
    return Claim(**(given | changes))


class Sailed:
    """Metrics instead of a Sailor: level of J and of the travel by controller."""

    seeds = range(3_000_000, 3_000_000 + N)

    def __init__(self, levels, spread=0.02):
        self.levels, self.spread = levels, spread

    def judged(self, skip):
        return self.seeds

    def sail(self, controller, scenario, ship, control, skip=0, seeds=None):
        own = np.random.default_rng(len(controller))
        sea = np.random.default_rng(1).uniform(5.0, 20.0, N)
        j, travel = self.levels[controller]
        return {
            "J_0.1": j * sea,
            "rudder_travel": travel * sea * (1.0 + self.spread * own.standard_normal(N)),
            "success": np.ones(N),
            "arrived": np.ones(N),
        }


def test_a_claim_holds_and_its_opponent_is_the_best_classical_controller():
    sailed = Sailed({"constant": (50, 0), "mine": (1.001, 90), "pid": (1.2, 80), "lqg": (1, 100)})
    found = judgement.judge([claim()], sailed)[0]
    assert {test["opponent"] for test in found["tests"]} == {"lqg"}
    assert [test["holds"] for test in found["tests"]] == [True, True]
    assert found["holds"]
    assert found["score"]["lqg"] == pytest.approx(100.0)


@pytest.mark.parametrize("mine", [(1.02, 90), (1.0, 100), (1.0, 110)])
def test_worse_by_two_percent_or_no_less_travel_does_not_hold(mine):
    sailed = Sailed({"constant": (50, 0), "mine": mine, "pid": (1.2, 80), "lqg": (1, 100)})
    assert not judgement.judge([claim()], sailed)[0]["holds"]


def test_every_opponent_is_tested_where_asked():
    sailed = Sailed({"constant": (50, 0), "mine": (0.9, 90), "pid": (1.2, 80), "lqg": (1, 100)})
    asked = claim(every=True, lower=("J_0.1",), within=0.0)
    found = judgement.judge([asked], sailed)[0]
    assert [test["opponent"] for test in found["tests"]] == ["pid", "lqg"]
    assert found["holds"]


def test_points_of_the_score():
    sailed = Sailed({"constant": (50, 0), "mine": (1.2, 90), "pid": (1.2, 80), "lqg": (1, 100)})
    near = judgement.judge([claim(lower=(), within=0.0, points=10.0)], sailed)[0]
    far = judgement.judge([claim(lower=(), within=0.0, points=2.0)], sailed)[0]
    assert near["score"]["mine"] == pytest.approx(100 * np.log(50 / 1.2) / np.log(50))
    assert near["holds"] and not far["holds"]


def test_holm_counts_all_tests_of_all_claims():
    sailed = Sailed({"constant": (50, 0), "mine": (1, 99.8), "pid": (1.2, 80), "lqg": (1, 100)})
    one = judgement.judge([claim()], sailed)[0]["tests"][0]
    many = judgement.judge([claim(name=f"c{k}") for k in range(9)], sailed)[0]["tests"][0]
    assert one["p"] == many["p"]
    assert many["p_holm"] > one["p_holm"]


def test_the_claims_of_the_package_are_read_and_an_unknown_measure_is_refused():
    assert judgement.read_claims(CLAIMS)
    with pytest.raises(ConfigError, match="heding"):
        judgement.read_claims(CLAIMS, ["heding"])
    with pytest.raises(ConfigError, match="rudder_travel"):
        claim(lower=("rudder_travl",))
