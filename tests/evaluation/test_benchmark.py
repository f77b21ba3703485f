import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from ship_gym_agents.entrants import entrant

from ship_gym.config import ConfigError
from ship_gym.evaluation import benchmark, read_results
from ship_gym.evaluation.plan import plan
from ship_gym.evaluation.run_folder import RunFolder
from ship_gym.evaluation.suite import load_suite
from tests.evaluation.benchmarking import SUITE, own, without_times, write_suite

pytest.importorskip("pyarrow")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def run(tmp_path):
    """Benchmark the small suite: 4 units of constant and good, 20 seeds."""
    suite = write_suite(tmp_path)

    def call(out="run", **options):
        return benchmark(suite, entrant, out=tmp_path / out, **({"seeds": 17} | options))

    return call


def stopped_after(n):
    """A progress bar that is interrupted after n units."""

    def progress(iterable, description, total):
        for k, item in enumerate(iterable):
            if description == "sailing" and k == n:
                raise KeyboardInterrupt
            yield item

    return progress


def test_two_runs_give_the_same_rows(run, tmp_path):
    first, second = run(), run("again", command="ship-gym benchmark")
    assert without_times(first).equals(without_times(second))
    assert len(first.table) == 2 * 2 * 17 and first.about["units"] == 8
    read = read_results(tmp_path / "run")
    assert read.table.equals(first.table) and read.about == json.loads(json.dumps(first.about))
    assert read.about["suites"]["small"]["scenarios"] == [
        str(tmp_path / "short.toml"),
        "heading_calm",
    ]
    assert read.about["seeds"][0] == 2_000_000 and second.about["command"]
    assert {row["measure"] for row in read.rows() if row["scenario"] == "heading_calm"} == {"J_1"}


def test_an_interrupted_run_goes_on_and_gives_what_an_undisturbed_one_does(run, tmp_path):
    whole = run("whole")
    with pytest.raises(KeyboardInterrupt, match=r"interrupted: 3 of 8 units are kept in .*run"):
        run(progress=stopped_after(3))
    assert not (tmp_path / "run" / "episodes.parquet").exists()
    (tmp_path / "run" / "units" / "00001.json").write_text('{"rows": [')  # as a full disk leaves it
    done = run()
    assert without_times(done).equals(without_times(whole))
    assert done.about["units_kept"] == 2
    again = run()
    assert again.about["units_kept"] == 8 and again.table.equals(done.table)
    assert run(fresh=True).about["units_kept"] == 0


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"seeds": 3}, "holds a run with other seeds: "),
        ({"patience": 2.0}, "with other patience: 1.0 there, 2.0 asked for"),
        ({"controllers": ["pid"]}, "with other controllers: own.py"),
        ({"ships": ["kvlcc2"]}, "with other ships: small: "),
    ],
)
def test_a_folder_keeps_to_its_settings(run, changed, words):
    run(seeds=2)
    with pytest.raises(ConfigError) as caught:
        run(**({"seeds": 2} | changed))
    message = str(caught.value)
    assert words.replace("own.py", "") in message and "--fresh" in message and "\n" not in message


def test_an_edited_controller_is_another_run(run, tmp_path):
    run(seeds=2)
    file = tmp_path / "own.py"
    file.write_text(file.read_text().replace("-2.0", "-1.0"))
    with pytest.raises(ConfigError, match="with other controllers: good: sha256: "):
        run(seeds=2)


def test_two_processes_do_not_share_a_folder(run, tmp_path):
    with RunFolder(tmp_path / "run").locked():
        with pytest.raises(
            ConfigError, match=r"another process \(pid \d+\) benchmarks into this folder"
        ):
            run(seeds=1)
        run("other", seeds=1)
    run(seeds=1)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"ships": ["kcz"]}, "did you mean 'kcs'"),
        ({"controllers": ["pdi"]}, "unknown controller 'pdi'; did you mean 'pid'"),
        ({"controllers": ["pid", "constant", "own"]}, "unknown controller 'own'"),
        ({"seeds": 0}, "episodes = 0"),
        ({"seeds": [3, 3]}, "each once"),
        ({"seeds": []}, "at least one is needed"),
        ({"engine": "dask"}, "unknown engine 'dask'"),
        ({"jobs": 0}, "jobs = 0"),
        ({"patience": 0.0}, "patience = 0.0"),
        ({"address": "auto"}, "only the engine 'ray' has one"),
    ],
)
def test_what_cannot_be_sailed_is_refused_before_any_work(run, tmp_path, options, words):
    with pytest.raises(ConfigError) as caught:
        run(**options)
    assert words in str(caught.value) and not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"heading_calm"', '"heading_clam"', "scenario heading_clam: unknown scenario"),
        ('"J_1"', '"J_2"', "scenario heading_calm: unknown measure 'J_2'"),
        ('"J_1"', '"J_1"\ncontrol = "ruder"', "did you mean 'rudder'"),
    ],
)
def test_a_suite_that_cannot_be_sailed_is_refused(tmp_path, old, new, words):
    suite = write_suite(tmp_path, SUITE.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        benchmark(suite, entrant, out=tmp_path / "run", seeds=1)
    assert str(caught.value).startswith("suite small, scenario ") and words in str(caught.value)


def test_a_suite_of_manoeuvres_has_no_episodes(tmp_path):
    text = SUITE.partition("controllers")[0] + 'kind = "manoeuvres"\n'
    text += '\n[[manoeuvre]]\nkind = "spiral"\n'
    with pytest.raises(ConfigError, match="suite small: kind 'manoeuvres' has no episodes to sail"):
        plan(write_suite(tmp_path, text), entrant, seeds=1)
    assert load_suite(tmp_path / "small.toml").scenario == ()


def test_two_controllers_of_one_name_are_refused(run, tmp_path):
    copy = tmp_path / "copy.py"
    copy.write_text((tmp_path / "own.py").read_text())
    with pytest.raises(ConfigError, match="two controllers are named 'good'"):
        run(controllers=[*own(tmp_path, "Good"), f"{copy}:Good"])


TRACK = """
[[scenario]]
name = "track_calm"
controllers = ["ilos"]
"""


def test_a_controller_sails_what_it_does_not_refuse(tmp_path):
    suite = write_suite(tmp_path, SUITE + TRACK)
    found = plan(suite, entrant, seeds=1)
    steering = {cell.entry.name: cell.controllers for cell in found.cells}
    assert steering["track_calm"] == ("constant", "ilos") and not found.refused
    assert steering["heading_calm"] == ("constant", f"{tmp_path / 'own.py'}:Good")
    found = plan(suite, entrant, seeds=1, controllers=["pid", "ppo_kcs"])
    steering = {cell.entry.name: cell.controllers for cell in found.cells}
    assert steering["track_calm"] == ("constant", "pid")
    assert steering["heading_calm"] == ("constant", "pid", "ppo_kcs")
    assert [(one["controller"], one["scenario"]) for one in found.refused] == [
        ("ppo_kcs", "track_calm")
    ]
    assert "trained on 'heading_keeping'" in found.refused[0]["why"]
    only = SUITE.partition("[[scenario]]")[0] + TRACK
    with pytest.raises(ConfigError, match="controller ppo_kcs sails nothing here: policy ppo_kcs"):
        plan(write_suite(tmp_path, only), entrant, seeds=1, controllers=["ppo_kcs"])


def test_ray_that_is_not_installed_is_told_with_its_extra(run, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(ImportError, match=r'pip install "ship-gym\[ray\]"'):
        run(engine="ray")
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_rows_do_not_depend_on_jobs_and_engine(run, tmp_path):
    pytest.importorskip("ray")
    names = own(tmp_path, "Good", "Raises", "NotANumber", "Shape", "Reset")
    options = {"controllers": ["pid", *names], "seeds": 20}
    here = without_times(run("here", **options))
    assert without_times(run("processes", jobs=2, **options)).equals(here)
    assert without_times(run("ray", jobs=2, engine="ray", **options)).equals(here)


@pytest.mark.slow
def test_a_controller_that_ends_its_process_loses_only_its_own_episodes(run, tmp_path):
    options = {"controllers": own(tmp_path, "Good", "Ends"), "seeds": 4, "jobs": 2}
    rows = run(**options).rows()
    for row in rows:
        ended = row["controller"] == "ends"
        assert row["error"] == ("reset: the process of the controller ended" if ended else "")
        assert (row["J_1"] is None) == ended
    assert {row["controller"] for row in rows} == {"constant", "good", "ends"}


CODE = """
import sys
from ship_gym.evaluation import benchmark
from ship_gym_agents.entrants import entrant
if __name__ == "__main__":
    benchmark(sys.argv[1], entrant, out=sys.argv[2], seeds=64, jobs=int(sys.argv[3]))
"""


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_a_killed_run_goes_on_and_gives_what_an_undisturbed_one_does(run, tmp_path, jobs):
    (tmp_path / "code.py").write_text(CODE)
    arguments = [sys.executable, tmp_path / "code.py", tmp_path / "small.toml", tmp_path / "run"]
    paths = os.pathsep.join([str(ROOT), str(ROOT / "agents")])
    process = subprocess.Popen([*arguments, str(jobs)], env=os.environ | {"PYTHONPATH": paths})
    kept = tmp_path / "run" / "units"
    end = time.monotonic() + 300.0
    while len(list(kept.glob("0*.json"))) < 3 and time.monotonic() < end:
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    there = len(list(kept.glob("0*.json")))
    assert 3 <= there < 16 and not (tmp_path / "run" / "episodes.parquet").exists()
    done = run(seeds=64)  # the lock is free
    assert done.about["units_kept"] >= there
    assert without_times(done).equals(without_times(run("whole", seeds=64)))
