"""Infos are built when they are looked at, and nobody can tell."""

import copy
import json
import pickle
from types import MappingProxyType

import gymnasium as gym
import numpy as np
import pytest

from ship_gym.envs.env import ShipEnv
from ship_gym.envs.info import Info, side_by_side
from ship_gym.envs.vector_env import ShipVectorEnv

NAMES = ("a", "b", "c")
WHOLE = {"a": [1], "b": [2], "c": [3]}


@pytest.fixture
def built():
    return []


@pytest.fixture
def info(built):
    def build(name):
        built.append(name)
        return [NAMES.index(name) + 1]

    return Info(NAMES, build)


def test_only_what_is_asked_for_is_built_and_only_once(info, built):
    assert isinstance(info, dict) and not built
    assert info["b"] == [2] and info["b"] is info.get("b") and "c" in info and "x" not in info
    assert info.get("x") is None and info.get("x", 5) == 5
    with pytest.raises(KeyError, match="x"):
        info["x"]
    assert built == ["b"]
    assert info.setdefault("c", 7) == [3] and info.setdefault("d", 7) == 7 and built == ["b", "c"]
    assert info == WHOLE | {"d": 7} and built == ["b", "c", "a"]


WAYS = {
    "keys": lambda i: {k: i[k] for k in i.keys()},
    "items": lambda i: dict(i.items()),
    "values": lambda i: dict(zip(NAMES, i.values(), strict=True)),
    "iter": lambda i: {k: i[k] for k in i},
    "reversed": lambda i: {k: i[k] for k in reversed(i)},
    "dict": dict,
    "unpacked": lambda i: {**i},
    "arguments": lambda i: dict(**i),
    "update": lambda i: (d := {}).update(i) or d,
    "copy": lambda i: i.copy(),
    "copy.copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda i: pickle.loads(pickle.dumps(i)),
    "old pickle": lambda i: pickle.loads(pickle.dumps(i, protocol=0)),
    "or": lambda i: i | {},
    "ror": lambda i: {} | i,
    "ior": lambda i: (d := {}).__ior__(i) or d,
    "ior of it": lambda i: i.__ior__({}),
    "or of two": lambda i: i | i,
    "repr": lambda i: eval(repr(i)),
    "str": lambda i: eval(f"{i}"),
    "json": lambda i: json.loads(json.dumps(i)),
    "pops": lambda i: {k: i.pop(k) for k in NAMES},
    "popitem": lambda i: dict(i.popitem() for _ in NAMES),
    "proxy": lambda i: dict(MappingProxyType(i)),
    "itself": lambda i: i,
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("looked", [(), ("b",)])
def test_every_way_to_look_sees_everything(info, way, looked):
    for name in looked:
        assert info[name]
    found = WAYS[way](info)
    assert found == WHOLE and list(found) in (list(NAMES), list(reversed(NAMES)))


def test_lengths_and_comparisons(info):
    fresh = Info(NAMES, lambda name: WHOLE[name])
    assert len(info) == 3 and bool(info) and info == fresh and fresh == WHOLE and fresh == info
    assert not (info != WHOLE) and info != {} and WHOLE == info
    with pytest.raises(TypeError):
        hash(info)


def test_it_may_be_written_to(info, built):
    info["b"], info["d"] = 8, 9
    info.update(e=1)
    info |= {"f": 2}
    assert built == [] and type(info) is Info
    assert info == WHOLE | {"b": 8, "d": 9, "e": 1, "f": 2}
    assert list(info) == ["a", "b", "c", "d", "e", "f"]


def test_what_is_deleted_is_gone(info):
    del info["b"]
    assert "b" not in info and info.get("b") is None and len(info) == 2
    with pytest.raises(KeyError):
        info["b"]
    assert info.pop("b", None) is None
    info.clear()
    assert not info and list(info) == [] and "a" not in info


def test_copies_do_not_share(info):
    info["own"] = [0]
    deep, flat = copy.deepcopy(info), copy.copy(info)
    deep["a"].append(5)
    deep["own"].append(5)
    assert info["a"] == [1] and info["own"] == [0] and flat == WHOLE | {"own": [0]}
    assert type(flat) is dict and type(pickle.loads(pickle.dumps(info))) is dict


def test_arrays_side_by_side_keep_their_values_and_do_not_touch():
    given = {"x": np.arange(5.0), "y": np.ones((2, 3), np.int64), "z": np.zeros(0), "w": np.ones(1)}
    buffer, views = side_by_side(given)
    for name, array in given.items():
        assert views[name].dtype == array.dtype and (views[name] == array).all()
    views["x"][:] = -1.0
    assert (views["y"] == 1).all() and views["w"] == 1.0
    assert all(view.ctypes.data % 8 == 0 for view in views.values())
    assert not np.shares_memory(buffer, given["x"])


def test_an_info_stays_what_it_was():
    env = ShipEnv(scenario="track_following")
    env.reset(seed=1)
    seen = []
    for k in range(3):
        info = env.step(np.ones(1))[-1]
        seen.append((info, copy.deepcopy(info), info["time"], k))
    for info, deep, time, k in seen:
        assert info["time"] == deep["time"] == time == k + 1.0
        assert str(info) == str(deep)
    assert seen[0][0]["flow"] != seen[1][0]["flow"]


@pytest.mark.parametrize("vector", [False, True])
def test_without_copies_arrays_are_those_of_the_environment(vector):
    make = ShipVectorEnv if vector else ShipEnv
    env, kept = make(copy=False), make()
    observations, info = env.reset(seed=1)
    kept.reset(seed=1)
    action = np.full(env.action_space.shape, 0.5, np.float32)
    before = observations.copy()
    for _ in range(3):
        after, reward, *_, info = env.step(action)
        expected = kept.step(action)
        assert np.shares_memory(after, observations) and (after == observations).all()
        assert (after == expected[0]).all() and reward == expected[1]
        assert info["energy"] == expected[-1]["energy"]
        assert np.shares_memory(after, env.unwrapped.episodes.observations)
    assert (before != observations).any()
    late = info
    env.step(action)
    assert late["time"] == 4.0  # looked at after the next step


def test_a_reward_outlives_the_reset_of_the_same_step():
    kwargs = {"num_envs": 3, "autoreset_mode": "SameStep", "overrides": {"duration": 3.0}}
    env, kept = ShipVectorEnv(copy=False, **kwargs), ShipVectorEnv(**kwargs)
    env.reset(seed=1), kept.reset(seed=1)
    for _ in range(7):
        found, expected = (e.step(np.ones((3, 1), np.float32)) for e in (env, kept))
        for a, b in zip(found[:4], expected[:4], strict=True):
            assert (a == b).all()
        assert ("final_info" in found[-1]) == ("final_info" in expected[-1])
        if "final_info" in found[-1]:
            assert (found[-1]["final_info"]["energy"] == expected[-1]["final_info"]["energy"]).all()
            assert (found[-1]["final_info"]["time"] == 3.0).all()


def test_after_copies_of_the_environment_infos_are_of_its_own_arrays():
    env = ShipEnv()
    env.reset(seed=1)
    env.step(np.ones(1))
    for twin in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        twin.step(-np.ones(1))
        twin.step(-np.ones(1))
        assert twin.step(-np.ones(1))[-1]["time"] == 4.0
    assert env.step(np.ones(1))[-1]["time"] == 2.0


def test_wrappers_write_into_it():
    env = gym.wrappers.RecordEpisodeStatistics(ShipEnv(overrides={"duration": 2.0}))
    env.reset(seed=0)
    env.step(np.zeros(1, np.float32))
    *_, truncated, info = env.step(np.zeros(1, np.float32))
    assert truncated and info["episode"]["l"] == 2 and info["time"] == 2.0
    envs = gym.wrappers.vector.DictInfoToList(ShipVectorEnv(2))
    _, infos = envs.reset(seed=0)
    assert [one["time"] for one in infos] == [0.0, 0.0] and len(infos[0]["forces"]) == 6
