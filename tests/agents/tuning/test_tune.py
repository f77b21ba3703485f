import sys
from typing import ClassVar

import numpy as np
import pytest
from ship_gym_agents import make_controller
from ship_gym_agents.adaptive import Adaptive
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.gains_files import GainsFile, load_gains, write_gains
from ship_gym_agents.los import ILOS
from ship_gym_agents.lqg import LQG
from ship_gym_agents.mpc import MPC
from ship_gym_agents.pid import PID, Gains
from ship_gym_agents.tuning import Size, gains_file, settings, tune
from ship_gym_agents.tuning.objective import episode_costs
from ship_gym_agents.tuning.ranges import leaf, with_leaves
from ship_gym_agents.tuning.structures import own_task_of, scenario_for, structures_of
from ship_gym_agents.tuning.tune import mean_costs

from ship_gym import load_ship
from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController

tuning = sys.modules["ship_gym_agents.tuning.tune"]  # the function has its name
SHORT = {"overrides": {"duration": 30.0}}
SMALL = Size(episodes=2, generations=1, candidates=4, polish=2)
KCS = load_ship("kcs")


@pytest.mark.parametrize("law", [PID, ILOS, DriftLOS])
def test_candidates_sail_the_same_episodes_as_one(law):
    """Every structure: m candidates in one batch cost what each costs alone."""
    env = {"scenario": scenario_for(law), "overrides": {"duration": 40.0}}
    for gains, free in structures_of(law, KCS).values():
        starts = {n: leaf(gains, n) or 0.5 for n in free}
        other = {name: 0.7 * value for name, value in starts.items()}
        both = mean_costs(law, gains, [starts, other], [5, 6], **env)
        for found, each in zip(both, (starts, other), strict=True):
            assert found == episode_costs(law(with_leaves(gains, each)), [5, 6], **env).mean()
        assert both[0] != both[1]


@pytest.mark.parametrize("law", [PID, LQG, Adaptive])
def test_courses_have_structures_of_their_own(law):
    """From the gains of headings on, turning by themselves or by a reference model."""
    env = {"scenario": "course_changing", "overrides": {"duration": 60.0}}
    turn, model = structures_of(law, KCS, "course_changing").items()
    assert (turn[0], model[0]) == ("turn", "turn by a reference model")
    for gains, free in (turn[1], model[1]):
        starts = {n: leaf(gains, n) for n in free}
        other = {n: 0.7 * value for n, value in starts.items()}
        both = mean_costs(law, gains, [starts, other], [5, 6], **env)
        assert both[0] == episode_costs(law(gains), [5, 6], **env).mean() != both[1]
    assert structures_of(law, KCS) == structures_of(law, KCS, "heading_keeping")
    assert "turn" not in structures_of(law, KCS)


def test_which_gains_are_of_a_task_only():
    assert own_task_of(PID, "heading_keeping") is own_task_of(ILOS, "track_following") is None
    assert own_task_of(PID, "course_changing") == "course_changing"
    assert own_task_of(MPC, "track_following") is None  # one file has both


def test_a_tuning_tells_what_it_gained_and_is_kept(tmp_path):
    pytest.importorskip("optuna")
    names = ("PD", "PD + sway, observer with waves")
    found = tune(PID, "kcs", SMALL, structures=names, **SHORT)
    assert [t.cost for t in found.ranking] == sorted(t.cost for t in found.ranking)
    seeds = range(500_002, 500_008)
    before = episode_costs(PID(PID.gains_for(KCS)), seeds, ship="kcs", **SHORT)
    after = episode_costs(PID(found.best.gains), seeds, ship="kcs", **SHORT)
    assert found.before.startswith("pid_kcs.toml, sha256 ")
    assert found.cost_before == pytest.approx(before.mean(), rel=1e-12)
    assert found.changed["J_0.1"] == found.gained
    assert found.best.cost == pytest.approx(after.mean(), rel=1e-12)
    assert found.gained.value == pytest.approx((after - before).mean())
    assert found.gained.low <= found.gained.value <= found.gained.high
    how = settings(SMALL, "heading_keeping", "heading_keeping", names)
    made = gains_file(found, how)
    path = write_gains(made, tmp_path / "my_pid.toml")
    assert load_gains(path, PID) == made
    controller = make_controller(path)
    assert controller.name == "my_pid" and controller.gains == found.best.gains
    assert set(made.tuning["validation_of"]) == set(names)
    assert made.tuning["seeds_validation"] == [500_002, 500_007]
    assert "rudder_reversals" in made.tuning["validation_of"]["PD"]


def test_a_tuning_begins_at_the_gains_that_there_are(monkeypatch, tmp_path):
    """So on the tuning seeds it is never worse, however little it searches."""
    pytest.importorskip("optuna")
    found = tune(PID, "kcs", SMALL, structures=["PD + sway, observer"], **SHORT)
    gains = with_leaves(found.best.gains, {"K_p": 2.7, "K_v": 99.0})
    path = write_gains(GainsFile("kcs", gains, {}, {}), tmp_path / "mine.toml")
    begun = []

    def search(costs, ranges, size, tick):
        begun.append({name: one.start for name, one in ranges.items()})
        return begun[-1], 1.0

    monkeypatch.setattr(tuning, "search", search)
    told = tune(PID, "kcs", SMALL, structures=["PD", "PID + sway"], begin_at=path, **SHORT)
    assert told.begun.startswith("mine.toml, sha256 ") and told.before.startswith("pid_kcs.toml")
    pd, sway = begun
    assert pd == {"K_p": 2.7, "K_d": found.best.gains.K_d}
    assert sway["K_v"] == PID.TUNED["K_v"][2]  # outside the range: as if there were none
    assert sway["K_i"] == 0.0


def test_a_tuning_can_be_repeated():
    pytest.importorskip("optuna")
    one, two = (tune(PID, "kcs", SMALL, structures=["PD"], **SHORT) for _ in range(2))
    assert one == two


class Proportional:
    """The least that can be tuned: one gain, one structure."""

    KIND = "proportional"
    TUNED: ClassVar = {"K_p": (0.1, 50.0, 1.0)}

    def __init__(self, gains=None, name="proportional"):
        self.gains, self.name = gains, name

    @classmethod
    def first_gains(cls, ship) -> Gains:
        return Gains(K_p=1.0, K_d=0.0)

    def reset(self, count, ship, scenario):
        pass

    def act(self, seen):
        return np.clip(-np.reshape(self.gains.K_p, (-1, 1)) * seen[:, :1], -1.0, 1.0)


def test_a_controller_of_ones_own_and_a_range_that_is_too_small(monkeypatch):
    """With so weak a rudder more is better: the optimum lies at the bound."""
    pytest.importorskip("optuna")
    monkeypatch.setattr(Proportional, "TUNED", {"K_p": (0.1, 0.5, 0.2)})
    size = Size(episodes=4, generations=6, candidates=6)
    found = tune(Proportional, "kcs", size, overrides={"duration": 90.0})
    assert found.controller == "proportional"
    assert found.before == "the gains that tuning begins at"
    assert found.best.at_bounds == {"K_p": 0.5}
    assert found.gained.high < 0.0


def test_a_bar_has_a_part_for_every_generation():
    pytest.importorskip("optuna")
    seen = []

    def progress(parts):
        for part in parts:
            seen.append((part, len(parts)))
            yield part

    tune(Proportional, "kcs", SMALL, progress=progress, **SHORT)
    assert seen == [(0, 3), (1, 3), (2, 3)]


def test_wrong_tunings_are_refused():
    with pytest.raises(ConfigError, match="did you mean 'kcs'"):
        tune(PID, "kcz")
    with pytest.raises(ConfigError, match="scenario 'heading_keping'"):
        tune(PID, "kcs", scenario="heading_keping")
    with pytest.raises(ConfigError, match=r"structure 'PDD'.*did you mean 'PD'"):
        tune(PID, "kcs", structures=["PDD"])
    words = "ConstantController cannot be tuned: it has no KIND, no TUNED, no first_gains"
    with pytest.raises(ConfigError, match=words):
        tune(ConstantController, "kcs")
