"""What is timed: the clockwork, the walker over arrays, and the works themselves."""

from __future__ import annotations

import dataclasses
import functools
import json
import weakref
from types import MappingProxyType

import gymnasium as gym
import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.reports import speed, speed_against, speed_child
from ship_gym.reports.speed_child import Work, best_of, bytes_of_arrays
from ship_gym.sea.state import CALM
from ship_gym.ships.loader import load_ship


def test_best_of_prepares_when_due_and_divides_by_items():
    done: list[str] = []

    def call(k):
        done.append("call")
        sum(range(20_000))

    found = best_of(Work(call, 4.0, lambda: done.append("prepare"), longest=3), 2, 0.0)
    assert done == ["prepare", "call", "call", "call", "prepare", "call", "call"]
    one = best_of(Work(call, 1.0), 3, 0.01)
    assert 0.0 < found["processor"] < one["processor"]
    assert one["wall"] > 0.0 and one["spread_percent"] >= 0.0


class Holder:
    __slots__ = ("__weakref__", "array")

    def __init__(self, array):
        self.array = array


def test_each_memory_counts_once():
    base = np.zeros(100)
    objects = np.array([np.zeros(3), None], dtype=object)
    assert bytes_of_arrays(base) == 800
    assert bytes_of_arrays(base[::2], base[10:], [base], {"a": (base,)}) == 800
    assert bytes_of_arrays(Holder(base), MappingProxyType({"b": np.zeros(1)})) == 808
    assert bytes_of_arrays(objects) == objects.nbytes + 24
    assert bytes_of_arrays(lambda: base) == 800
    assert bytes_of_arrays(functools.partial(print, base).args) == 800
    loop: list = [np.zeros(2)]
    loop.append(loop)
    assert bytes_of_arrays(loop, np, Holder) == 16
    gone = Holder(base)
    assert bytes_of_arrays([weakref.proxy(Holder(base)), gone]) == 800  # what is gone is nothing


def test_memory_grows_by_what_each_environment_has():
    found = speed_child.memory(64)
    batch = found["batch"]
    assert 0 < found["simulation"] < batch < found["environment"] < 20_000
    assert speed_child.memory(128)["batch"] == pytest.approx(batch, rel=0.02)


@pytest.mark.parametrize("name", [n for n in speed_child.MEASURES if n != "heading, ends spread"])
def test_everything_that_is_measured_can_be(name):
    found = speed_child.measure(name, 3, repeats=1, seconds=0.0)
    assert found["seconds"] > 0.0
    assert found["seconds"] == found["wall" if name.endswith("threads") else "processor"]


@pytest.mark.slow
def test_episodes_end_at_every_step():
    work = speed_child.ending_one_by_one(1200)
    envs = work.call.__closure__
    envs = next(c.cell_contents for c in envs if isinstance(c.cell_contents, gym.vector.VectorEnv))
    ended = [int((t | s).sum()) for _, _, t, s, _ in (work.call(k) for k in range(5))]
    assert work.items == envs.num_envs == 1200
    assert all(1 <= count <= 30 for count in ended), ended


def test_info_is_read_to_the_last_entry():
    seen = []

    class Lazy(dict):
        def __getitem__(self, key):
            seen.append(key)
            return super().__getitem__(key)

    assert speed_child.read(Lazy(a=1.0, b=Lazy(c=np.zeros(3)), d=np.zeros(0))) == 2
    assert seen == ["a", "b", "c", "d"]


def test_pole_stays_up_for_all_steps_timed():
    env = gym.make(speed_child.YARDSTICK).unwrapped
    actions = speed_child.balancing(env)
    env.reset(seed=0)
    assert len(actions) == speed_child._SCALAR
    assert not any(env.step(action)[2] for action in actions)


def test_sea_has_the_waves_asked_for():
    assert len(speed_child.rough_sea(20).components().omega) == 20
    none = speed_child.rough_sea(0)
    assert len(none.components().omega) == 0 and none.gusts and none.current_speed == 1.0


def test_measured_speed_is_of_the_right_size():
    jobs = {(job.name, job.n): job for job in speed.jobs((64,), (), ())}
    found = speed.measure(jobs["HeadingKeeping, one core", 64], repeats=1, seconds=0.01)
    assert found["n"] == 64 and 1e-8 < found["seconds"] < 1e-3


def test_ship_without_wave_table_is_measured_in_calm_water(monkeypatch):
    both = list(speed.jobs((1,), (1,), (60,), ship="kcs"))
    bare = dataclasses.replace(load_ship("kcs"), wave_table="")
    assert list(speed._seas(bare)) == ["calm"]
    monkeypatch.setattr(speed, "_seas", lambda ship: {"calm": CALM})
    calm = list(speed.jobs((1,), (1,), (60,), ship="kcs"))
    lost = {(job.table, job.name) for job in both} - {(job.table, job.name) for job in calm}
    assert lost == {
        ("steps", "physics, waves, one core"),
        ("steps", "physics, waves, threads"),
        ("growth", "waves"),
        ("waves", "physics"),
    }


@pytest.mark.slow
def test_two_checkouts_in_turns():
    found = speed_against.against(
        speed_against.HERE, ["CartPole vector", "memory"], n=64, rounds=2, seconds=0.001
    )
    measures = found["measures"]
    assert next(iter(measures)) == "CartPole vector"
    assert measures["memory, batch"]["ratio"] == pytest.approx(1.0, rel=0.05)
    text = speed_against.as_text(found)
    assert "there / here" in text and "memory, batch" in text
    with pytest.raises(ConfigError, match="unknown --only"):
        speed_against.against(speed_against.HERE, ["clam"])


def test_gain_of_threads_and_ratio_are_there_by_here():
    measures = {
        "calm, threads": {"there": 2.0, "here": 1.0},
        "calm, one thread, wall": {"there": 3.0, "here": 1.8},
    }
    assert speed_against.gains(measures)[-1].endswith("there 1.50, here 1.80 times one thread")


def test_control_is_of_what_is_not_ours():
    measures = {"calm": {"ratio": 4.0}, "CartPole vector": {"ratio": 0.9}}
    assert "ratios from 0.90 to 0.90" in speed_against.control(measures)[-1]
    assert speed_against.control({"calm": {"ratio": 4.0}}) == []


def test_another_package_than_asked_for_is_refused(tmp_path):
    (tmp_path / "ship_gym").mkdir()
    with pytest.raises(ConfigError, match="must be a folder"):
        speed_against.check_checkout(tmp_path)


def test_error_in_the_child_is_told():
    child = speed_against.Child(speed_against.HERE)
    try:
        with pytest.raises(ConfigError, match="kcz"):
            child.ask(name="calm", n=1, ship="kcz")
        assert json.dumps(child.ask(name="where"))
    finally:
        child.close()
