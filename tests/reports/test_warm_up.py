"""What ``ship-gym warm-up`` compiles, and what later processes find."""

import json
import os
import subprocess
import sys

import pytest

from ship_gym import ShipSim, available_ships, load_sea
from ship_gym.config import ConfigError
from ship_gym.physics import _kernel
from ship_gym.physics.parameters import traits_of
from ship_gym.physics.step import sail_rows
from ship_gym.reports import warm_up
from ship_gym.reports.warm_up import PHYSICS, Done, Job
from ship_gym.ships.loader import load_ship
from ship_gym.ships.records import fleet

CHILD = """
import sys, gymnasium as gym, ship_gym
from ship_gym.physics import _compiler
env = gym.make("ShipGym/HeadingKeeping-v0", ship=sys.argv[1])
env.reset(seed=0)
env.step(env.action_space.sample())
print(len(_compiler.saved), "numba.np.arraymath" in sys.modules, "scipy.optimize" in sys.modules)
"""


@pytest.fixture
def kept(monkeypatch, tmp_path):
    """Code would be kept in `tmp_path`; nothing is compiled."""
    monkeypatch.setattr(_kernel, "code_folder", lambda: tmp_path / "ship_gym" / "key")
    monkeypatch.setattr(warm_up, "candidates", lambda: [tmp_path / "ship_gym"])
    monkeypatch.setattr(_kernel, "compiles", lambda: True)
    return tmp_path


def test_every_ship_is_in_the_set_of_its_traits(own_versions):
    sets = warm_up.sets_of(available_ships())
    assert sorted(name for names in sets for name in names) == sorted(available_ships())
    assert ("onrt", "onrt_model") in sets
    traits = [{traits_of(fleet([load_ship(n)]).records) for n in names} for names in sets]
    assert all(len(each) == 1 for each in traits)
    assert len(set().union(*traits)) == len(sets)


def test_jobs_are_physics_then_tasks(kept, own_versions):
    jobs = warm_up.jobs_of(["kcs", "kcs_model", "onrt"], ["heading_keeping"])
    pairs = [("kcs", "kcs_model"), ("onrt",)]
    parts = [(PHYSICS, pairs[0]), (PHYSICS, pairs[1])]
    parts += [("heading_keeping", pairs[0]), ("heading_keeping", pairs[1])]
    assert [(job.part, job.ships) for job in jobs] == parts
    mixed = warm_up.jobs_of(["kcs"], ["heading_keeping"], mixed=True)
    assert [job.mixed for job in mixed] == [False, True, False, True]
    everything = {job.part for job in warm_up.jobs_of()}
    assert everything == {PHYSICS, *warm_up.TASKS.own()}


@pytest.mark.parametrize(("ships", "tasks"), [(["kcz"], []), ([], ["heading_keping"])])
def test_unknown_names_are_refused_before_the_work(kept, ships, tasks):
    with pytest.raises(ConfigError, match="did you mean"):
        warm_up.jobs_of(ships, tasks)


def test_places_that_keep_nothing_are_refused(kept, monkeypatch):
    monkeypatch.setattr(_kernel, "compiles", lambda: False)
    with pytest.raises(ConfigError, match="NUMBA_DISABLE_JIT"):
        warm_up.jobs_of(["kcs"])
    monkeypatch.setattr(_kernel, "compiles", lambda: True)
    monkeypatch.setattr(warm_up, "candidates", list)
    with pytest.raises(ConfigError, match="NUMBA_CACHE_DIR"):
        warm_up.jobs_of(["kcs"])


def test_text_and_data(kept):
    done = [
        Done(Job(("kcs", "kcs_model"), PHYSICS), 7.25, ("sail_rows", "see_waves")),
        Done(Job(("onrt",), "heading_keeping", True), 0.5, ()),
    ]
    text = warm_up.as_text(done, 4.0)
    assert "kcs, kcs_model" in text and "onrt (different ones)" in text
    assert "compiled 2 functions: 4.0 s, of processors 7.8 s" in text
    assert f"kept in {kept}" in text
    assert "everything was there already" in warm_up.as_text(done[1:], 1.0)
    data = json.loads(json.dumps(warm_up.as_data(done, 4.0)))
    assert data["compiled"] == 2 and data["sets"][0]["ships"] == ["kcs", "kcs_model"]
    assert data["processor_s"] == 7.75 and data["sets"][1]["mixed"]


@pytest.mark.skipif(not hasattr(sail_rows, "signatures"), reason="nothing is compiled")
def test_one_version_serves_any_water_and_number():
    def step(n, sea, parallel=None):
        sim = ShipSim("kcs", n=n, sea=load_sea(sea), parallel=parallel)
        state = sim.reset(seed=0)
        commands = state[:, -2:] * 1.0
        sim.step(commands, 1.0)

    step(1, "calm")
    before = list(sail_rows.signatures)
    for n, sea, parallel in ((1, "ss5", None), (70, "calm", None), (130, "ss4", True)):
        step(n, sea, parallel)
    assert list(sail_rows.signatures) == before


def ship_gym(folder, *arguments):
    env = os.environ | {"NUMBA_CACHE_DIR": str(folder)}
    env.pop("NUMBA_DISABLE_JIT", None)
    code = "from ship_gym_agents.cli import main; main()"
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, env=env, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


@pytest.mark.slow
def test_after_it_nothing_is_compiled(tmp_path):
    words = ("warm-up", "--ship", "kcs", "onrt", "--task", "heading_keeping", "--jobs", "2")
    first = ship_gym(tmp_path, *words, "--json")
    assert first["compiled"] > 10 and first["folder"].startswith(str(tmp_path))
    before = os.times().children_user
    again = ship_gym(tmp_path, *words, "--json")
    assert again["compiled"] == 0
    assert os.times().children_user - before < 15.0  # 4 s of processors; compiling takes a minute
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    env.pop("NUMBA_DISABLE_JIT", None)
    for ship in ("kcs_model", "onrt_model"):
        command = [sys.executable, "-c", CHILD, ship]
        done = subprocess.run(command, env=env, check=True, capture_output=True, text=True)
        assert done.stdout.split() == ["0", "False", "False"]
