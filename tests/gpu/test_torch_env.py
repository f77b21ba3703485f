"""ShipTorchEnv on the CPU, and what it refuses."""

import numpy as np
import pytest

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.gpu import card
from tests.gpu.voyages import VOYAGES

torch = pytest.importorskip("torch")
SHORT = {"duration": 6.0}


@pytest.mark.parametrize("name", VOYAGES)
def test_on_the_cpu_it_is_the_vector_environment(name):
    """Same bits as in its mode SameStep, in which `final_obs` has the ends of episodes."""
    env = ship_gym.ShipTorchEnv(3, **VOYAGES[name])
    vector = ship_gym.ShipVectorEnv(
        3, autoreset_mode="SameStep", **{"scenario": None, **VOYAGES[name]}
    )
    generator = np.random.default_rng(3)
    seen, info = env.reset(seed=4)
    assert info == {}
    np.testing.assert_array_equal(seen, vector.reset(seed=4)[0])
    ends = 0
    for _ in range(14):
        actions = generator.uniform(-1.0, 1.0, env.action_space.shape).astype(np.float32)
        *ours, info = env.step(torch.from_numpy(actions))
        *theirs, expected = vector.step(actions)
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(a.numpy(), b, strict=True)
        assert ("final_obs" in info) == ("final_obs" in expected)
        for i in np.flatnonzero(expected.get("_final_obs", ())):
            np.testing.assert_array_equal(info["final_obs"][i], expected["final_obs"][i])
            ends += 1
    assert ends


def test_tensors_are_the_memory_of_the_episodes():
    env = ship_gym.ShipTorchEnv(3, overrides=SHORT)
    seen, _ = env.reset(seed=1)
    before = seen.clone()
    after, rewards, *_ = env.step(torch.ones(3, 1))
    assert after.data_ptr() == seen.data_ptr() and not torch.equal(seen, before)
    assert rewards.data_ptr() == env.tensor("reward").data_ptr()
    assert env.tensor("time").tolist() == [1.0, 1.0, 1.0]
    assert env.tensor("forces").shape == (3, 6, 3)


def test_without_autoreset_a_mask_says_who_begins_anew():
    env = ship_gym.ShipTorchEnv(3, overrides=SHORT, autoreset=False)
    with pytest.raises(ConfigError, match="reset first"):
        env.step(torch.zeros(3, 1))
    env.reset(seed=1)
    for _ in range(6):
        _, _, _, truncated, info = env.step(torch.zeros(3, 1))
    assert truncated.all() and info == {}
    env.reset(mask=torch.tensor([False, True, False]))
    assert env.tensor("elapsed").tolist() == [6, 0, 6]


@pytest.mark.parametrize(
    "actions, message",
    [
        (np.zeros((3, 1)), "must be a torch.Tensor"),
        (torch.zeros(3), r"have shape \(3,\), allowed is \(3, 1\)"),
        (torch.zeros(3, 1, dtype=torch.int64), "torch.int64, allowed are floats"),
        (torch.zeros(3, 1, device="meta"), "actions are on meta, the ships on cpu"),
        (torch.full((3, 1), torch.nan), "action 0 = .*must be finite"),
    ],
)
def test_bad_actions(actions, message):
    env = ship_gym.ShipTorchEnv(3, overrides=SHORT)
    env.reset(seed=1)
    with pytest.raises(ConfigError, match=message):
        env.step(actions)


def test_an_unknown_tensor_names_the_nearest():
    env = ship_gym.ShipTorchEnv(3, overrides=SHORT)
    env.reset(seed=1)
    with pytest.raises(ConfigError, match="did you mean 'energy'"):
        env.tensor("energi")


@pytest.mark.parametrize("device", ["gpu", "mps", "cuda:x"])
def test_other_devices(device):
    with pytest.raises(ConfigError, match=f"device = '{device}': allowed are 'cpu', 'cuda'"):
        ship_gym.ShipTorchEnv(2, device)


def installed(monkeypatch, *packages):
    monkeypatch.setattr(card, "_installed", lambda name: name in packages)


def test_without_torch(monkeypatch):
    installed(monkeypatch)
    with pytest.raises(ConfigError, match=r"needs torch.*pip install 'ship-gym\[gpu\]'"):
        ship_gym.ShipTorchEnv(2)


def test_without_numba_cuda(monkeypatch):
    installed(monkeypatch, "torch")
    with pytest.raises(ConfigError, match=r"'cuda'.*numba-cuda is not installed"):
        ship_gym.ShipTorchEnv(2, "cuda")


@pytest.mark.skipif(torch.version.cuda is not None, reason="this torch is built for CUDA")
def test_with_a_torch_for_the_cpu(monkeypatch):
    installed(monkeypatch, "torch", "numba_cuda")
    with pytest.raises(ConfigError, match="built without CUDA"):
        ship_gym.ShipTorchEnv(2, "cuda")


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a card")
def test_without_a_card(monkeypatch):
    installed(monkeypatch, "torch", "numba_cuda")
    monkeypatch.setattr(torch.version, "cuda", "13.0")
    with pytest.raises(ConfigError, match=r"no NVIDIA driver or no card.*use device = 'cpu'"):
        ship_gym.ShipTorchEnv(2, "cuda:0")
