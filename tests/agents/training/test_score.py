import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.training.final import (
    BETTER,
    NO_VALUES,
    OPEN,
    WORSE,
    compared,
    judge,
    references,
)
from ship_gym_agents.training.score import Score, Validation, score_of, validate

from ship_gym.evaluation.splits import JUDGING_SEED, SPLITS, VALIDATION_SEED
from ship_gym.scenarios import load_scenario

LOWER = Score("J_steady", "deg2", "lower")


def found(value, success=1.0, travel=900.0, total=0.0):
    return {"J_steady": value, "success": success, "rudder_travel": travel, "return": total}


def test_failures_come_first_then_the_score():
    best, good, short, failed = found(3.0), found(5.0), found(None), found(1.0, success=0.9)
    assert sorted([failed, short, good, best], key=LOWER.key) == [best, good, short, failed]
    higher = Score("J_steady", "-", "higher")
    assert min((found(3.0), found(5.0)), key=higher.key) == found(5.0)


def test_travel_above_the_limit_comes_behind_all_below_it():
    limited = LOWER._replace(limit=1000.0)
    below, above = found(5.0, travel=990.0), found(3.0, travel=1010.0)
    assert min((above, below), key=limited.key) == below
    assert "rudder travel up to 1000 deg/h" in limited.text and "lower is better" in limited.text


def test_wear_may_count():
    worn = LOWER._replace(wear=0.01)
    calm, near = found(5.0, travel=500.0), found(3.0, travel=900.0)
    assert min((near, calm), key=worn.key) == calm and min((near, calm), key=LOWER.key) == near
    assert "J_steady [deg2] + 0.01 rudder travel [deg/h], lower" in worn.text
    assert "energy - 0.01" in Score("energy", "-", "higher", wear=0.01).text


def test_the_return_decides_where_episodes_are_too_short():
    assert min((found(None, total=1.0), found(None, total=2.0)), key=LOWER.key)["return"] == 2.0


def test_validation_means_are_those_of_the_metrics():
    scenario = load_scenario(overrides={"duration": 200.0})
    sailed = validate(make_controller("pid"), scenario, [VALIDATION_SEED, VALIDATION_SEED + 1])
    assert sailed.means["J_steady"] == pytest.approx(np.mean(sailed.each["J_steady"]))
    assert sailed.means["success"] == 1.0 and sailed.seconds > 0.0


def of(values, name="J_steady"):
    return Validation({}, {name: list(values)}, 0.0)


def test_a_verdict_needs_an_interval_without_zero():
    noise = np.random.default_rng(0).normal(0.0, 0.1, 32)
    base = np.linspace(1.0, 2.0, 32)
    assert compared(of(base - 0.5 + noise), of(base), LOWER)["verdict"] == BETTER
    assert compared(of(base + 0.5 + noise), of(base), LOWER)["verdict"] == WORSE
    higher = Score("x", "-", "higher")
    assert compared(of(base + 0.5 + noise, "x"), of(base, "x"), higher)["verdict"] == BETTER
    open_ = compared(of(base + noise - noise.mean()), of(base), LOWER)
    assert open_["verdict"] == OPEN and open_["low"] < 0.0 < open_["high"]


def test_episodes_without_a_value_are_left_out_in_pairs():
    difference = compared(of([1.0, None, 3.0]), of([0.0, 5.0, 2.0]), LOWER)
    assert difference["value"] == 1.0
    assert compared(of([None, 1.0]), of([1.0, None]), LOWER) == {"verdict": NO_VALUES}


def test_references_are_those_that_can_steer():
    assert references(load_scenario("heading_keeping")) == ["pid", "adaptive"]
    assert references(load_scenario("track_following")) == ["drift_los"]
    assert references(load_scenario("track_economy")) == ["drift_los", "just_in_time"]
    assert references(load_scenario("course_changing"), base="lqg")[-1] == "lqg"


def test_the_judgement_says_what_it_found():
    scenario = load_scenario(overrides={"duration": 200.0})
    score = score_of(scenario)
    same = judge(make_controller("pid"), scenario, score, 4)
    assert same["seeds"] == [JUDGING_SEED, JUDGING_SEED + 3]
    assert all(seed in SPLITS["validation"] for seed in same["seeds"])
    against = same["references"]["pid"]["difference"]
    assert (against["value"], against["verdict"]) == (0.0, OPEN)
    assert "no difference shown from pid" in same["text"]
    assert "rudder travel +0 [+0, +0] deg/h" in same["text"]
    nothing = judge(make_controller("constant"), scenario, score, 24)
    assert nothing["references"]["pid"]["difference"]["verdict"] == WORSE
    assert "worse than pid" in nothing["text"] and "success" in nothing["text"]


def test_voyage_at_free_speed_is_judged_by_its_energy():
    economy = load_scenario("track_economy")
    assert score_of(economy).name == "voyage_energy" and score_of(economy).better == "lower"
    assert score_of(load_scenario("track_following")).name == "rms_route"


def test_ships_of_a_fleet_take_turns():
    scenario = load_scenario(overrides={"duration": 200.0})
    seeds = [VALIDATION_SEED, VALIDATION_SEED + 1, VALIDATION_SEED + 2]
    both = validate(make_controller("pid@kcs"), scenario, seeds, ships=("kcs", "onrt"))
    alone = [
        validate(make_controller("pid@kcs"), scenario, own, ships=(ship,)).each["J_steady"]
        for own, ship in ((seeds[::2], "kcs"), (seeds[1:2], "onrt"))
    ]
    assert both.each["J_steady"] == pytest.approx([alone[0][0], alone[1][0], alone[0][1]])
    assert both.means["J_steady"] == pytest.approx(np.mean(both.each["J_steady"]))
