"""What a training run records: the worst episode of every so many validations."""

import warnings

import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training import recordings
from ship_gym_agents.training.recordings import FOLDER, KEPT, Recordings
from ship_gym_agents.training.score import score_of, validate
from ship_gym_agents.training.train import train

from ship_gym.config import ConfigError
from ship_gym.evaluation import metrics
from ship_gym.evaluation.splits import VALIDATION_SEED
from ship_gym.recording import Trajectory, trajectory
from ship_gym.recording.card import again
from ship_gym.scenarios import load_scenario

pytest.importorskip("rerun")


def test_the_worst_validation_episode_is_one_of_the_batch():
    scenario = load_scenario(overrides={"duration": 200.0})
    seeds = list(range(VALIDATION_SEED, VALIDATION_SEED + 5))
    pid = make_controller("pid@kcs")
    found = validate(pid, scenario, seeds, ships=("kcs", "onrt"), worst=True)
    at = found.each["J_steady"].index(max(found.each["J_steady"]))
    assert found.worst.meta["seed"] == seeds[at]
    assert found.worst.meta["ship"]["name"] == ("kcs", "onrt")[at % 2]
    assert metrics(found.worst)["J_steady"] == found.each["J_steady"][at]
    assert validate(pid, scenario, seeds[:1]).worst is None


def test_failed_ones_are_worse_and_short_ones_go_by_the_return():
    seeds = list(range(VALIDATION_SEED, VALIDATION_SEED + 4))
    constant = make_controller("constant")
    lost = validate(constant, load_scenario(), seeds, worst=True)
    assert min(lost.each["success"]) == 0.0 and lost.worst.meta["failed"]
    scenario = load_scenario(overrides={"duration": 20.0})
    short = validate(constant, scenario, seeds, score_of(scenario), worst=True)
    at = short.each["return"].index(min(short.each["return"]))
    assert short.each["J_steady"] == [None] * 4 and short.worst.meta["seed"] == seeds[at]


@pytest.mark.parametrize("algorithm", ["ppo", "gauss_newton"])
def test_runs_record_into_their_folder(tiny, tmp_path, algorithm):
    if algorithm == "ppo":
        config, steps = tiny(more={"training": {**_TINY, "record": 2}}), 512
    else:
        config, steps = _gauss_newton(), 10**9
    card = train(config, tmp_path / "run", steps=steps, final=False)
    files = sorted((tmp_path / "run" / FOLDER).iterdir())
    numbers = range(2, len(card["validations"]) + 1, 2)
    assert [file.name for file in files] == [f"validation_{k:04d}.rrd" for k in numbers] != []
    first, last = card["validation_seeds"]
    for k, file in zip(numbers, files, strict=True):
        kept = Trajectory.from_rrd(file)
        assert first <= kept.meta["seed"] <= last and kept.meta["controller"] == card["name"]
        # the worst of its validation: no better than the mean
        assert metrics(kept)["return"] <= card["validations"][k - 1]["return"]


def test_none_are_recorded_without_the_option_or_the_library(tiny, tmp_path, monkeypatch):
    config = tiny(more={"training": {**_TINY, "record": 0}})
    train(config, tmp_path / "none", steps=256, final=False)
    assert not (tmp_path / "none" / FOLDER).exists()

    def missing():
        raise ImportError('recordings need rerun: pip install "ship-gym[rerun]"')

    monkeypatch.setattr(trajectory, "import_rerun_export", missing)
    config = tiny(more={"training": {**_TINY, "record": 1}})
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        card = train(config, tmp_path / "missing", steps=256, final=False)
    told = [str(one.message) for one in told if "recordings" in str(one.message)]
    assert len(told) == 1 and told[0].startswith("training goes on without recordings: ")
    assert card["status"] == "complete" and len(card["validations"]) > 1


def test_a_run_is_worth_more_than_its_recordings(tmp_path):
    (tmp_path / FOLDER).write_text("a file where the folder should be")
    kept = Recordings(tmp_path, 1)
    assert kept.due(1)
    with pytest.warns(UserWarning, match="goes on without"):
        kept.keep(1, short_run())
    assert not kept.due(2)


def test_few_are_kept_and_only_those_are_removed(tmp_path, monkeypatch):
    kept, one = Recordings(tmp_path, 3), short_run()
    assert [number for number in range(1, 10) if kept.due(number)] == [3, 6, 9]
    monkeypatch.setattr(recordings.Trajectory, "to_rrd", touched)
    for number in range(3, 3 * (KEPT + 3), 3):
        kept.keep(number, one)
    (tmp_path / FOLDER / "mine.rrd").write_text("")
    names = sorted(file.name for file in (tmp_path / FOLDER).glob("v*"))
    assert names == [f"validation_{k:04d}.rrd" for k in range(9, 3 * (KEPT + 3), 3)]
    kept.keep(99, None)
    kept.keep_first(20)  # a kill has undone the later ones
    names = sorted(file.name for file in (tmp_path / FOLDER).iterdir())
    assert names == ["mine.rrd", *(f"validation_{k:04d}.rrd" for k in (9, 12, 15, 18))]
    kept.keep_first(0)
    assert [file.name for file in (tmp_path / FOLDER).iterdir()] == ["mine.rrd"]


def test_no_command_is_told_that_would_need_weights_that_are_gone(tmp_path):
    config = {"task": "heading_keeping", "ship": "kcs", "control": "rudder"}
    about = {"scenario": "heading_keeping", "controller": "ppo-run", "seed": 1, "config": config}
    Recordings(tmp_path, 1).keep(4, Trajectory(short_run().columns, about))
    kept = Trajectory.from_rrd(tmp_path / FOLDER / "validation_0004.rrd")
    assert kept.meta["validation"] == 4 and again(kept.meta) == ""
    assert again(about) != ""  # without that there would be one


def test_how_often_is_checked(tiny):
    with pytest.raises(ConfigError, match=r"training\.record"):
        tiny(more={"training": {**_TINY, "record": -1}})


_TINY = {"envs": 8, "validations": 4, "episode": 20.0, "threads": 1}


def _gauss_newton():
    hyper = {
        "training": {"envs": 2, "validations": 50, "record": 2},
        "network": {"hidden": []},
        "algorithm": {"iterations": 1},
        "form": {"base": "pid", "features": ["observer"]},
    }
    return run_config("gauss_newton", overrides={"duration": 20.0}, hyperparameters=hyper)


def short_run():
    return Trajectory({"t": [0.0, 1.0]})


def touched(self, path):
    path.parent.mkdir(exist_ok=True)
    path.write_text("")
