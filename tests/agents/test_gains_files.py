import dataclasses

import numpy as np
import pytest
from ship_gym_agents import gains_files, make_controller
from ship_gym_agents.controllers import controller_class
from ship_gym_agents.drift_los import DriftLOS
from ship_gym_agents.entrants import entrant
from ship_gym_agents.gains_files import GainsFile, gains_type, kind_of, load_gains, write_gains
from ship_gym_agents.los import ILOS
from ship_gym_agents.lqg import LQG
from ship_gym_agents.pid import PID, Gains, gains_of
from ship_gym_agents.reference import Guidance

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.evaluation.comparison import per_episode
from ship_gym.evaluation.rollout import rollout
from ship_gym.evaluation.splits import evaluation_seeds, split_of

MINE = """
import dataclasses
import numpy as np

@dataclasses.dataclass(frozen=True)
class Gains:
    K: float = 1.0

class P:
    KIND = "p"
    TUNED = {"K": (0.1, 10.0, 1.0)}

    def __init__(self, gains=None, name="p"):
        self.gains, self.name = gains or Gains(), name

    @classmethod
    def first_gains(cls, ship) -> Gains:
        return Gains()

    def reset(self, count, ship, scenario):
        pass

    def act(self, seen):
        return -np.asarray(self.gains.K)[..., None] * seen[:, :1]
"""


@pytest.mark.parametrize(("kind", "law"), [("pid", PID), ("ilos", ILOS), ("drift_los", DriftLOS)])
def test_a_file_makes_the_controller_that_it_is_of(tmp_path, kind, law):
    gains = Gains(2.0, -0.5, guidance=Guidance(look_ahead=2.0, reach=-0.3))
    made = GainsFile("kcs", gains, {"seed": [1, 2]}, {"ship-gym": "0"}, kind)
    path = write_gains(made, tmp_path / "mine.toml")
    assert kind_of(path) == kind and load_gains(path, law) == made
    controller = make_controller(path)
    assert type(controller) is law and controller.gains == gains and controller.name == "mine"


def test_gains_of_ones_own_class(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(MINE)
    mine = controller_class("mine.py:P")
    made = GainsFile("kcs", gains_type(mine)(K=3.0), {}, {}, "mine.py:P")
    path = write_gains(made, tmp_path / "p.toml")
    assert make_controller(path).gains.K == 3.0


def test_gains_of_another_ship():
    """``pid@kcs`` steers whatever ship with the gains of kcs."""
    foreign = make_controller("pid@kcs")
    assert foreign.name == "pid@kcs" and foreign.gains == gains_of(load_ship("kcs"))
    assert make_controller("drift_los@kvlcc2").gains == DriftLOS.gains_for(load_ship("kvlcc2"))
    with pytest.raises(ConfigError, match="did you mean 'kcs'"):
        make_controller("pid@kcz")
    with pytest.raises(ConfigError, match="'constant' has no gains; allowed are pid"):
        make_controller("constant@kcs")
    with pytest.raises(ConfigError, match="did you mean 'pid'"):
        make_controller("pidd@kcs")


def test_a_guidance_without_gains_of_its_own_takes_the_pid_s(monkeypatch, tmp_path):
    """A ship of one's own for which only the PID is tuned sails tracks too."""
    stranger = dataclasses.replace(load_ship("kcs"), name="stranger")
    monkeypatch.setattr(gains_files, "GAINS", tmp_path)
    write_gains(GainsFile("stranger", Gains(1.5, 0.5), {}, {}), tmp_path / "pid_stranger.toml")
    found = ILOS.gains_for(stranger)
    assert found.K_p == 1.5 and found.guidance == Guidance() and found.reference is not None
    own = dataclasses.replace(found, K_p=2.5)
    write_gains(GainsFile("stranger", own, {}, {}, "ilos"), tmp_path / "ilos_stranger.toml")
    assert ILOS.gains_for(stranger).K_p == 2.5
    assert gains_files.tuned_ships("ilos") == ["stranger"]


@pytest.fixture
def two_tasks(monkeypatch, tmp_path):
    """A package with general gains and gains of courses of the PID of kcs."""
    monkeypatch.setattr(gains_files, "GAINS", tmp_path)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    for task, K_p in ((None, 1.5), ("course_changing", 4.5)):
        path = gains_files.gains_path("kcs", "pid", task)
        write_gains(GainsFile("kcs", Gains(K_p, 0.5), {}, {}, task=task), path)
    return tmp_path


def reset(controller, task, ship="kcs"):
    controller.reset(1, load_ship(ship), dataclasses.replace(load_scenario(task), ship=ship))
    return controller


def test_gains_of_a_task_steer_that_task_only(two_tasks):
    pid, name = PID(), "pid_kcs.course_changing.toml"
    assert reset(pid, "course_changing")._g.K_p == 4.5 and pid.about()["gains"] == name
    assert reset(pid, "heading_keeping")._g.K_p == 1.5 and pid.about()["gains"] == "pid_kcs.toml"
    assert list(entrant("pid").about["gains_files"]) == [name, "pid_kcs.toml"]
    assert PID.gains_for(load_ship("kcs"), "course_changing").K_p == 4.5
    assert gains_of(load_ship("kcs")).K_p == ILOS.first_gains(load_ship("kcs")).K_p == 1.5
    assert gains_files.tuned_ships() == ["kcs"]
    assert gains_files.find_gains("kcs", task="track_following").name == "pid_kcs.toml"
    given = PID(Gains(9.0, 0.0))
    assert reset(given, "course_changing")._g.K_p == 9.0 and given.about()["gains"] == "given"


def test_gains_lent_by_another_ship_are_of_the_task_too(two_tasks):
    lent = make_controller("pid@kcs")
    assert reset(lent, "course_changing", "onrt")._g.K_p == 4.5
    assert lent.about()["gains"] == "pid_kcs.course_changing.toml"
    assert reset(lent, "heading_keeping", "onrt")._g.K_p == 1.5
    write_gains(GainsFile("kcs_model", Gains(1.0, 1.0), {}, {}), two_tasks / "pid_kcs_model.toml")
    files = entrant("pid@kcs").about["gains_files"]
    assert list(files) == ["pid_kcs.course_changing.toml", "pid_kcs.toml"]
    path = two_tasks / "pid_kcs.toml"
    assert "gains_files" not in entrant(path).about and entrant(path).about["sha256"]


def test_the_task_in_a_file_is_that_of_its_name(two_tasks):
    path = two_tasks / "pid_kcs.course_changing.toml"
    text = path.read_text()
    assert 'task = "course_changing"' in text and load_gains(path, PID).task == "course_changing"
    assert make_controller(path).gains.K_p == 4.5
    path.write_text(text.replace('task = "course_changing"\n', ""))
    with pytest.raises(ConfigError, match=r"task = None: .* allowed is 'course_changing'"):
        reset(PID(), "course_changing")
    (two_tasks / "pid_kcs.toml").write_text(text)
    with pytest.raises(ConfigError, match=r"task = 'course_changing': .* allowed is no such key"):
        gains_of(load_ship("kcs"))


def test_a_user_s_gains_of_a_task_do_not_change_a_ship_of_the_package(two_tasks):
    """An installed package keeps its meaning: a ship's gains are all from one place."""
    write_gains(GainsFile("kcs", Gains(9.0, 0.5), {}, {}, task="track_following"),
                gains_files.own_gains() / "pid_kcs.track_following.toml")  # fmt: skip
    assert gains_files.find_gains("kcs", task="track_following") == two_tasks / "pid_kcs.toml"
    with pytest.raises(ConfigError, match="comes with pid gains in the installed package"):
        gains_files.place_for_gains("kcs", "pid", "track_following")
    own = gains_files.place_for_gains("mine", "pid", "course_changing")
    assert own == gains_files.own_gains() / "pid_mine.course_changing.toml"


def test_a_kind_without_gains_says_how_to_tune():
    stranger = dataclasses.replace(load_ship("kcs"), name="stranger")
    with pytest.raises(ConfigError, match=r"no ilos gains.*tune --controllers ilos --ship"):
        gains_files.tuned_file(stranger, ILOS)


def test_numbers_of_numpy_are_refused(tmp_path):
    """A file holds plain numbers: an array of candidates is no result."""
    made = GainsFile("kcs", Gains(np.ones(3), np.ones(3)), {}, {})
    with pytest.raises(ConfigError, match="cannot write"):
        write_gains(made, tmp_path / "x.toml")
    assert not (tmp_path / "x.toml").exists()


@pytest.mark.parametrize("path", sorted(gains_files.GAINS.glob("*.toml")), ids=lambda p: p.stem)
def test_gains_of_the_package_say_where_they_are_from(path):
    """Tuned on tuning seeds, named after controller and ship, no gain at a bound of its range."""
    found = load_gains(path, controller_class(kind_of(path)))
    assert path == gains_files.gains_path(found.ship, found.controller, found.task)
    assert type(make_controller(path)).KIND == found.controller
    seeds = (*found.tuning["seeds_tuning"], *found.tuning["seeds_validation"])
    assert all(split_of(seed) == "tuning" for seed in seeds)
    assert found.tuning.get("at_bounds", []) == []
    if "gained" in found.tuning:
        assert found.tuning["gained"][1] <= 0.0  # no clear loss against what was there before


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2", "onrt"])
def test_tuned_guidance_keeps_the_route_better(ship):
    """Of a current that the default guidance was not chosen for; with as much rudder or so."""
    env = {"scenario": "track_crosscurrent", "ship": ship}
    for law in (ILOS, DriftLOS):
        tuned, first = (
            np.mean(per_episode(rollout(law(g), seeds=evaluation_seeds(6), **env))["rms_route"])
            for g in (law.gains_for(load_ship(ship)), law.first_gains(load_ship(ship)))
        )
        assert tuned < 0.85 * first


def test_lent_gains_may_come_without_the_model_of_the_ship_that_lends():
    lent, whole = make_controller("lqg@onrt+model"), make_controller("lqg@onrt")
    own = reset(lent, "heading_keeping", "kvlcc2")._g
    foreign = reset(whole, "heading_keeping", "kvlcc2")._g
    assert own.observer.ship == LQG.first_gains(load_ship("kvlcc2")).observer.ship
    assert foreign.observer.ship == LQG.gains_for(load_ship("onrt")).observer.ship
    assert dataclasses.replace(own, observer=foreign.observer) == foreign
    assert lent.name == "lqg@onrt+model"
    assert lent.about()["gains"] == "lqg_onrt.toml, on the linear model of kvlcc2"
    adaptive = reset(make_controller("adaptive@kcs+model"), "heading_keeping", "onrt")
    assert adaptive._g.observer.ship == LQG.first_gains(load_ship("onrt")).observer.ship


def test_gains_without_a_linear_model_cannot_get_another(two_tasks):
    with pytest.raises(ConfigError, match="no observer"):
        reset(make_controller("pid@kcs+model"), "heading_keeping", "onrt")
