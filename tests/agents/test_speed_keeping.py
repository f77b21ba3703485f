"""Just in time: the energy of a voyage with a deadline, against the propeller left alone."""

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.los import ILOS
from ship_gym_agents.speed_keeping import MARGIN, JustInTime

from ship_gym.config import ConfigError
from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.rollout import tuning_seeds
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.ships import load_ship

STILL = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0}


def voyages(controller, ship="kcs", n=4, **overrides):
    return rollout(
        controller, "track_economy", seeds=tuning_seeds(n), ship=ship, overrides=overrides
    )


# kvlcc2 needs the whole voyage to slow down, and to go first fast and then slowly takes more:
# 1.36 times the square
@pytest.mark.parametrize(("ship", "more"), [("kcs", 1.05), ("kvlcc2", 1.4), ("onrt", 1.05)])
def test_in_calm_water_she_arrives_with_the_margin_and_saves_what_the_square_says(ship, more):
    """At 7500 m / (0.97 1300 s) instead of U0 the energy goes about with the square."""
    energy, times = [], []
    for controller in (ILOS(), JustInTime()):
        found = [metrics(t) for t in voyages(controller, ship, **STILL).episodes]
        energy.append(np.mean([row["voyage_energy"] for row in found]))
        times.append(np.mean([row["voyage_time"] for row in found]))
    assert times[1] == pytest.approx(1300.0 * (1.0 - MARGIN), abs=20.0)  # kvlcc2 is slow to follow
    square = (times[0] / times[1]) ** 2
    assert square < energy[1] / energy[0] < more * square


@pytest.mark.parametrize("current", [0.0, 180.0])
def test_she_is_in_time_with_and_against_a_current(current):
    overrides = STILL | {
        "sea.current_speed": 1.0, "sea.current_speed_min": 1.0, "sea.current_encounter_deg": current
    }  # fmt: skip
    for t in voyages(JustInTime(), n=2, **overrides).episodes:
        assert t.meta["outcome"] == "arrived"
        assert metrics(t)["voyage_time"] == pytest.approx(1300.0 * (1.0 - MARGIN), abs=12.0)


def test_in_the_sea_of_the_scenario_she_arrives_with_less():
    plain, rule = (
        [metrics(t) for t in voyages(make_controller(name), n=8).episodes]
        for name in ("ilos", "just_in_time")
    )
    assert all(row["success"] == 1.0 for row in rule)
    less = [b["voyage_energy"] / a["voyage_energy"] for a, b in zip(plain, rule, strict=True)]
    assert np.mean(less) < 0.85 and np.median(less) < 0.85


def test_a_row_depends_on_its_own_observations():
    scenario = load_scenario("track_economy")
    one, many = JustInTime(), JustInTime()
    rng = np.random.default_rng(1)
    columns = rng.uniform(0.1, 0.9, (20, 3, 15)).astype(np.float32)
    one.reset(1, load_ship("kcs"), scenario)
    many.reset(3, load_ship("kcs"), scenario)
    for seen in columns:
        np.testing.assert_array_equal(many.act(seen)[1], one.act(seen[1:2])[0])


def test_what_it_cannot_sail_is_told():
    ship = load_ship("kcs")
    with pytest.raises(ConfigError, match="just_in_time: needs control = 'rudder\\+rpm'"):
        JustInTime().reset(1, ship, load_scenario("track_economy", {"control": "rudder"}))
    with pytest.raises(ConfigError, match="one leg only"):
        JustInTime().reset(1, ship, load_scenario("track_following", {"control": "rudder+rpm"}))
    with pytest.raises(ConfigError, match="just_in_time"):
        JustInTime().reset(1, ship, load_scenario("heading_keeping", {"control": "rudder+rpm"}))
