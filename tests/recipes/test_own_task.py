"""A task from outside the package: one file, everything that the package's own have."""

import dataclasses
import pickle
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import ship_gym
from ship_gym import load_task
from ship_gym.config import ConfigError
from ship_gym.evaluation import compare, metrics, rollout, table
from ship_gym.evaluation.controller import ConstantController
from ship_gym.recording.panels import steering_panels
from ship_gym.tasks import TASKS
from ship_gym.tasks.base import Metric, Row, Term
from ship_gym.tasks.columns import observation_columns

FILE = Path(__file__).with_name("hold_yaw_rate.py")
ID = "ShipGym/HoldYawRate-v0"


@pytest.fixture(scope="module")
def task():
    return load_task(FILE)


class Turner:
    """Rudder by the error of the yaw rate."""

    name = "turner"

    def reset(self, count, ship, scenario):
        self.columns = observation_columns(scenario).require(["rate_error", "rudder"], self.name)

    def act(self, observations):
        seen = self.columns.view(observations)
        return np.clip(seen.rudder - 0.3 * seen.rate_error, -1.0, 1.0)[:, None]


def test_it_is_an_environment_like_the_others(task):
    assert ship_gym.ENVIRONMENTS[ID] == "hold_yaw_rate" and "hold_yaw_rate" in TASKS
    assert "hold_yaw_rate" in ship_gym.available_scenarios()
    env = gym.make(ID)
    check_env(env.unwrapped, skip_render_check=True)
    assert env.observation_space.shape == (10,)
    assert type(env.unwrapped).__name__ == "HoldYawRate"
    assert "error of the yaw rate beyond 2 deg/s" in type(env.unwrapped).__doc__
    _, info = env.reset(seed=0)
    *_, info = env.step(np.zeros(1, np.float32))
    assert next(iter(info["reward_terms"])) == "rate_error"
    error = env.unwrapped.episodes.sim.state[0, 2] - np.radians(0.3)
    assert info["reward_terms"]["rate_error"] == pytest.approx(-1e4 * error**2, rel=1e-9)
    assert pickle.loads(pickle.dumps(env.unwrapped)).reset(seed=0)[0].shape == (10,)


def test_vector_is_scalar(task):
    envs = gym.make_vec(ID, num_envs=3)
    seen, _ = envs.reset(seed=4)
    for i in range(3):
        env = gym.make(ID)
        assert (env.reset(seed=4 + i)[0] == seen[i]).all()


def test_it_is_judged_by_its_own_metrics_and_recorded(task):
    sailed = [rollout(c, "hold_yaw_rate", seeds=[1, 2]) for c in (Turner(), ConstantController())]
    good, bad = (metrics(r.trajectory(0))["rms_rate_error"] for r in sailed)
    assert good < 0.12 and bad > 1.5 * good
    text = table(compare(sailed))
    assert "rms_rate_error" in text and "rudder_travel" in text and "J_0.1" not in text
    run = sailed[0].trajectory(0)
    assert run.meta["task"] == "hold_yaw_rate"
    assert run["rate_ordered"] == pytest.approx(np.radians(0.3))
    (panel,) = (p for p in steering_panels(run.columns, run.meta) if p.path == "plots/rate")
    assert panel.title == "Yaw rate [rad/s]"
    assert [series.label for series in panel.series] == ["r", "rate_ordered"]


def test_a_limit_of_its_own_ends_an_episode(task):
    tight = {"limits": {"error_deg_s": 0.2}}
    sailed = rollout(ConstantController(), "hold_yaw_rate", seeds=[1], overrides=tight)
    assert sailed.trajectory(0).meta["outcome"] == "yaw rate limit" and sailed.failed.all()


def test_sections_are_checked_as_strictly_as_the_package_s(task):
    with pytest.raises(ConfigError, match=r"yaw_rate.order_deg_s = 9.*-5 to 5"):
        gym.make(ID, overrides={"yaw_rate.order_deg_s": 9.0})
    with pytest.raises(ConfigError, match="did you mean 'order_deg_s'"):
        gym.make(ID, overrides={"yaw_rate.order_deg": 1.0})
    with pytest.raises(ConfigError, match="unknown key 'track'"):
        gym.make(ID, overrides={"track.legs": 1})


@pytest.mark.slow
def test_without_metrics_it_is_told_and_never_judged_as_another_task(task):
    bare = dataclasses.replace(task, name="bare_rate", metrics={}, measure=None, headline="return")
    ship_gym.register_task(bare)
    with pytest.raises(ConfigError, match="task 'bare_rate' has no metrics"):
        metrics(rollout(Turner(), "bare_rate", seeds=[1]).trajectory(0))
    from ship_gym_agents.sb3.config import run_config

    with pytest.raises(ConfigError, match="task 'bare_rate' has no metrics"):
        run_config(scenario="bare_rate")  # before a training begins


def test_wrong_tasks_are_refused_and_leave_nothing_behind(task):
    before = dict(ship_gym.ENVIRONMENTS)
    for changes, words in (
        ({"name": "heading_keeping"}, "one of the package"),
        ({"name": "Hold Rate"}, "small letters"),
        ({"scenario": None}, "default `scenario`"),
        ({"scenario": {"base": "heading_keping"}}, "did you mean 'heading_keeping'"),
        ({"scenario": {"base": "heading_keeping", "limits": {"x": 1}}}, "unknown key 'x'"),
        ({"name": "heading_calm"}, "a scenario of the package has that name"),
        ({"name": "hold__yaw_rate"}, "has the class name of 'hold_yaw_rate'"),
        ({"headline": "rms_rate"}, "did you mean 'rms_rate_error'"),
        ({"metrics": {"rms_rate_error": Metric("-", "", "small")}}, "Known: higher, lower"),
        ({"metrics": {"energy": Metric("-", "", "lower")}}, "metric 'energy': that is a metric of"),
        ({"terms": (Term("rudder", "x", "y"),)}, "term 'rudder': that is a cost term"),
        ({"fields": (("L", float),)}, "field 'L': that is a term or a common field"),
        ({"fields": (("rate_error", float),)}, "field 'rate_error': that is a term"),
        ({"sections": {"sea": dict}}, "section 'sea': that is a key of every scenario"),
        (
            {"observations": (Row("yaw_rate", "", "-", 0, 1, ""),)},
            "observation 'yaw_rate': that is a",
        ),
    ):
        with pytest.raises(ConfigError, match=words):
            ship_gym.register_task(dataclasses.replace(task, **{"name": "other_rate"} | changes))
    assert ship_gym.ENVIRONMENTS == before and "other_rate" not in TASKS


def test_what_is_no_task_is_refused():
    with pytest.raises(ConfigError, match=r"register_task\(3\): needs a"):
        ship_gym.register_task(3)


@pytest.mark.slow
@pytest.mark.compiled
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"terms": ()}, None),
        ({"terms": (Term("rate_error", "", ""), Term("more", "", ""))}, "writes 5 terms.*names 6"),
        ({"observations": ()}, "writes 10 rows of the observation; it names 9"),
        (
            {"observations": tuple(Row(k, k, "-", 0.0, 1.0, k) for k in ("one", "two"))},
            "writes 10 rows of the observation; it names 11",
        ),
    ],
)
def test_names_that_the_kernels_do_not_write_are_refused_before_anything_is_sailed(
    task, changes, words
):
    """They would shift the others, or be written beside the arrays."""
    if words is None:
        with pytest.raises(ConfigError, match="terms: at least one"):
            dataclasses.replace(task, name="odd_rate", **changes)
        return
    odd = dataclasses.replace(task, name="odd_rate", **changes)
    ship_gym.register_task(odd)
    with pytest.raises(ConfigError, match=f"task 'odd_rate': its kernel {words}"):
        gym.make("ShipGym/OddRate-v0").reset(seed=0)


@pytest.mark.slow
@pytest.mark.compiled
def test_an_outcome_without_a_name_is_refused(task):
    ship_gym.register_task(dataclasses.replace(task, name="nameless_rate", outcomes=()))
    env = gym.make("ShipGym/NamelessRate-v0", overrides={"limits.error_deg_s": 1e-9})
    with pytest.raises(ConfigError, match="gives outcome 2; named are 0 running, 1 diverged"):
        env.reset(seed=0)
    env = gym.make("ShipGym/NamelessRate-v0", overrides={"limits.error_deg_s": 0.5})
    env.reset(seed=0)
    with pytest.raises(ConfigError, match="gives outcome 2"):
        for _ in range(200):
            env.step(-np.ones(1, np.float32))


def test_its_class_is_a_name_of_the_package(task):
    assert ship_gym.HoldYawRate is type(gym.make(ID).unwrapped)


def test_files_in_a_section_count_from_the_scenario_file(task, tmp_path):
    """As `track.file` does; the section says which keys are files."""
    (tmp_path / "mine.geojson").write_text(
        '{"type": "LineString", "coordinates": [[0, 0], [0, 900], [500, 2000]]}'
    )
    file = tmp_path / "mine.toml"
    file.write_text('base = "track_following"\n[track]\nkind = "points"\nfile = "mine.geojson"\n')
    assert ship_gym.load_scenario(file).track.file == str(tmp_path / "mine.geojson")


def test_files_without_a_task_are_one_line(tmp_path):
    for text, words in (
        ("x = 1\n", "registers 0 tasks"),
        ("x = 1 +\n", "SyntaxError"),
        ("\n\nimport nothing_of_that_name\n", r"broken.py:3: ModuleNotFoundError"),
    ):
        file = tmp_path / "broken.py"
        file.write_text(text)
        with pytest.raises(ConfigError, match=words):
            load_task(file)
    with pytest.raises(ConfigError, match="no such file"):
        load_task(tmp_path / "nothing.py")
    with pytest.raises(ConfigError, match="did you mean 'heading_keeping'"):
        load_task("heading_keping")
    with pytest.raises(ConfigError, match="did you mean 'TASK'"):
        load_task(f"{FILE}:TSK")


def test_gymnasium_imports_the_module_of_an_id():
    code = (
        "import gymnasium as gym; env = gym.make('hold_yaw_rate:ShipGym/HoldYawRate-v0'); "
        "print(env.reset(seed=0)[0].shape)"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=FILE.parent, capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == "(10,)"


def test_its_recordings_name_its_file(task):
    load_task(FILE)
    (run,) = rollout(Turner(), task.name, seeds=[3], overrides={"duration": 20.0}).episodes
    assert run.meta["task_file"] == str(FILE)
    (other,) = rollout(
        ConstantController(), "heading_keeping", seeds=[3], overrides={"duration": 20.0}
    ).episodes
    assert "task_file" not in other.meta
