"""Infos without dicts inside: what is in the nested ones, as arrays under dotted names."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv

from ship_gym import ShipEnv, ShipVectorEnv
from ship_gym.config import ConfigError

SHORT = {"duration": 3.0}


def stepped(env):
    env.reset(seed=3)
    for _ in range(3):
        *_, info = env.step(np.full(env.action_space.shape, 0.5, np.float32))
    return info


def entry(nested, name):
    """What a dotted name stands for in a nested info."""
    group, _, rest = name.partition(".")
    if not rest:
        return nested[name]
    masks = group.startswith("_")
    return nested[group[masks:]][f"_{rest}" if masks else rest]


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_a_flat_info_of_a_batch_has_every_entry_of_the_nested_one(mode):
    flat, nested = (
        stepped(ShipVectorEnv(2, autoreset_mode=mode, overrides=SHORT, info=form))
        for form in ("flat", "nested")
    )
    if mode == "SameStep":
        flat, nested = flat["final_info"], nested["final_info"]
    assert "forces.hull" in flat and "_forces.hull" in flat and "time" in flat
    assert {name.partition(".")[0] for name in flat} == set(nested)
    for name, value in flat.items():
        assert isinstance(value, np.ndarray) and len(value) == 2
        np.testing.assert_array_equal(value, entry(nested, name))


def test_a_flat_info_of_one_has_numpy_numbers():
    flat, nested = (stepped(ShipEnv(overrides=SHORT, info=form)) for form in ("flat", "nested"))
    assert type(flat) is dict and flat["forces.hull"].shape == (3,)
    assert isinstance(flat["time"], np.float64) and flat["is_success"].dtype == np.bool_
    for name, value in flat.items():
        np.testing.assert_array_equal(value, entry(nested, name))


def test_scalars_in_a_vector_environment_of_gymnasium_give_the_same_names():
    native = stepped(ShipVectorEnv(2, overrides=SHORT, info="flat"))
    sync = stepped(SyncVectorEnv([lambda: ShipEnv(overrides=SHORT, info="flat")] * 2))
    assert set(native) == set(sync)
    for name, value in native.items():
        np.testing.assert_array_equal(value, sync[name], strict=True)


def test_another_form_is_refused():
    for make in (gym.make, gym.make_vec):
        with pytest.raises(ConfigError, match="info 'flatt'; did you mean 'flat'"):
            make("ShipGym/HeadingKeeping-v0", info="flatt")
