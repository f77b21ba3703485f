"""TorchRL over the native vector environment, against stepping it ourselves."""

import gymnasium as gym
import numpy as np
import pytest

torchrl_envs = pytest.importorskip("torchrl.envs")
torch = pytest.importorskip("torch")

HEADING = "ShipGym/HeadingKeeping-v0"
N, STEPS = 3, 9


def made(mode, info="flat"):
    return gym.make_vec(
        HEADING, num_envs=N, autoreset_mode=mode, info=info, overrides={"duration": 4.0}
    )


def one_anew(env):
    """Begin the episode of ship 0 anew, so that the ships end at different times."""
    return env.reset(options={"reset_mask": np.arange(N) == 0})


def own_step(env, mode, actions):
    """End and start of the next interval, as TorchRL has them: info, observation, ..."""
    seen, rewards, terminated, truncated, info = env.step(actions)
    ended = terminated | truncated
    last, end = seen.copy(), {name: info[name].copy() for name in ("time", "forces.hull")}
    if mode == "SameStep" and ended.any():
        for i in np.flatnonzero(ended):
            last[i] = info["final_obs"][i]
            for name, values in end.items():
                values[i] = info["final_info"][name][i]
    elif ended.any():
        seen, _ = env.reset(options={"reset_mask": ended})
    return last, rewards, ended, end, seen


@pytest.mark.parametrize("mode", ["SameStep", "Disabled"])
def test_a_rollout_is_that_of_our_own_loop(mode):
    own, env = made(mode), torchrl_envs.GymWrapper(made(mode))
    if mode == "Disabled":  # in SameStep TorchRL reads the infos unasked
        env = env.auto_register_info_dict()
    torchrl_envs.check_env_specs(env)
    env.set_seed(7)
    own.reset(seed=7)
    now = env.reset()
    seen, _ = own.reset()
    np.testing.assert_array_equal(now["observation"], seen)
    actions = torch.linspace(-1.0, 1.0, STEPS * N).reshape(STEPS, N, 1)
    for k in range(STEPS):
        if k == 2:
            for each in (own, (env.base_env if mode == "SameStep" else env)._env):
                one_anew(each)
        now["action"] = actions[k]
        now, following = env.step_and_maybe_reset(now)
        last, rewards, ended, end, start = own_step(own, mode, actions[k].numpy())
        found = now["next"]
        np.testing.assert_array_equal(found["observation"], last)
        np.testing.assert_array_equal(found["reward"][:, 0], rewards.astype(np.float32))
        np.testing.assert_array_equal(found["done"][:, 0], ended)
        for name, values in end.items():
            np.testing.assert_array_equal(found[name], values)
        np.testing.assert_array_equal(following["observation"], start)
        assert not ended.all()  # where all end at once, TorchRL resets once more
        now = following
    assert following["time"].tolist() != [following["time"][0].item()] * N


def test_single_ships_are_reset_by_a_mask():
    env = torchrl_envs.GymWrapper(made("Disabled")).auto_register_info_dict()
    now = env.reset()
    for _ in range(2):
        now = env.rand_action(now)
        now = env.step(now)["next"]
    before = now["observation"].clone()
    now["_reset"] = torch.tensor([[True], [False], [True]])
    after = env.reset(now)
    assert after["time"].tolist() == [0.0, 2.0, 0.0]
    changed = (after["observation"] != before).any(dim=1)
    assert changed.tolist() == [True, False, True]


def test_without_infos_one_argument_is_enough():
    env = torchrl_envs.GymWrapper(made("Disabled", info="nested"))
    assert env.rollout(3).batch_size == (N, 3)


def test_one_ship():
    env = torchrl_envs.GymEnv(HEADING, info="flat").auto_register_info_dict()
    sailed = env.rollout(3)
    assert sailed["next", "time"].tolist() == [1.0, 2.0, 3.0]
    assert sailed["next", "forces.hull"].shape == (3, 3)
