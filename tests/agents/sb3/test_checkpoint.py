"""Checkpoints of runs: all comes back, bit for bit, and nothing in a file is run or acts nan."""

import io
import json
import pickle
import zipfile
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

torch = pytest.importorskip("torch")
buffers = pytest.importorskip("stable_baselines3.common.buffers")

from ship_gym_agents.sb3.algorithms import load_checkpoint, make_model, save_checkpoint  # noqa: E402
from ship_gym_agents.sb3.config import run_config  # noqa: E402
from ship_gym_agents.sb3.environments import make_env  # noqa: E402
from ship_gym_agents.sb3.replay_file import PICKLE, REPLAY_FILE, load_replay, save_replay  # noqa: E402

from ship_gym.config import ConfigError  # noqa: E402

ARRAYS = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")
ENVS, SIZE = 3, 7


def empty(actions=None, **options):
    seen = gym.spaces.Box(-np.inf, np.inf, (4,), np.float32)
    actions = actions or gym.spaces.Box(-1.0, 1.0, (2,), np.float32)
    return buffers.ReplayBuffer(SIZE * ENVS, seen, actions, "cpu", ENVS, **options)


def filled(steps, **options):
    buffer, rng = empty(**options), np.random.default_rng(steps)
    for _ in range(steps):
        action = np.array([buffer.action_space.sample() for _ in range(ENVS)])
        done, late = rng.random((2, ENVS)) < 0.3
        infos = [{"TimeLimit.truncated": bool(one)} for one in late]
        seen, then = rng.normal(size=(2, ENVS, 4))
        buffer.add(seen, then, action, rng.normal(size=ENVS), done, infos)
    return buffer


def same(one, other):
    for name in ARRAYS:
        if (a := getattr(one, name, None)) is not None:
            b = getattr(other, name)
            assert a.dtype == b.dtype and a.tobytes() == b.tobytes(), name
    assert (one.pos, one.full, one.size()) == (other.pos, other.full, other.size())


@pytest.mark.parametrize("steps", [0, 3, SIZE, SIZE + 2])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"actions": gym.spaces.Discrete(5)},
        {"handle_timeout_termination": False},
        {"handle_timeout_termination": False, "optimize_memory_usage": True},
    ],
)
def test_a_replay_buffer_comes_back_bit_for_bit(tmp_path, steps, options):
    buffer, again = filled(steps, **options), empty(**options)
    save_replay(buffer, tmp_path)
    assert load_replay(again, tmp_path)
    same(buffer, again)
    if steps:
        np.random.seed(1)  # noqa: NPY002
        drawn = buffer.sample(5)
        np.random.seed(1)  # noqa: NPY002
        assert all(torch.equal(a, b) for a, b in zip(drawn[:5], again.sample(5)[:5], strict=True))


def rewritten(folder, **changes):
    """The file with other arrays; None leaves one out."""
    file = folder / REPLAY_FILE
    arrays = dict(np.load(file)) | changes
    np.savez(file, **{k: v for k, v in arrays.items() if v is not None})


def of(shape, value=0.0, dtype=np.float32):
    return np.full(shape, value, dtype)


DAMAGE = {
    "shape": (
        {"actions": of((3, ENVS, 3))},
        "actions is float32 of shape (3, 3, 3): the",
    ),
    "type": ({"rewards": of((3, ENVS), dtype=np.float64)}, "rewards is float64"),
    "objects": ({"rewards": np.empty((3, ENVS), object)}, "rewards is object"),
    "nan": ({"rewards": of((3, ENVS), np.nan)}, "rewards reaches nan"),
    "size": ({"observations": of((3, ENVS, 4), 3e38)}, "allowed is -1e+30 to 1e+30"),
    "flags": ({"dones": of((3, ENVS), 2.0)}, "dones reaches 2 to 2: allowed is 0 to 1"),
    "no array": ({"timeouts": None}, "no \"There is no item named 'timeouts.npy'"),
    "place": ({"facts": np.array([SIZE, 0, 1, 0])}, "pos = 7: allowed is 0 to 6"),
    "full": ({"facts": np.array([3, 2, 1, 0])}, "full = 2: allowed is 0 to 1"),
    "ends by time": ({"facts": np.array([3, 0, 0, 0])}, "handle_timeout_termination = 0: the run"),
    "more rows": ({"facts": np.array([4, 0, 1, 0])}, "of shape (4, 3, 4)"),
    "columns": ({"observations": of((4, ENVS, 3)).T}, "of shape (3, 3, 4): the run needs"),
}


@pytest.mark.parametrize("case", DAMAGE)
def test_a_replay_buffer_that_does_not_fit_is_one_line(tmp_path, case):
    changes, words = DAMAGE[case]
    save_replay(filled(3), tmp_path)
    rewritten(tmp_path, **changes)
    buffer = empty()
    with pytest.raises(ConfigError) as error:
        load_replay(buffer, tmp_path)
    text = str(error.value)
    assert words in text and str(tmp_path / REPLAY_FILE) in text and "\n" not in text
    assert (buffer.pos, buffer.full) == (0, False)


def test_half_a_replay_buffer_is_one_line(tmp_path):
    save_replay(filled(SIZE), tmp_path)
    file = tmp_path / REPLAY_FILE
    whole = file.read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 3] ^= 1
    for part in (b"", b"text", whole[:100], whole[: len(whole) // 2], whole[:-30], bytes(flipped)):
        file.write_bytes(part)
        with pytest.raises(ConfigError, match=r"not a replay buffer, or damaged"):
            load_replay(empty(), tmp_path)


class Harmful:
    """Unpickled, it leaves a file behind."""

    def __init__(self, trace):
        self.trace = trace

    def __reduce__(self):
        return Path.touch, (self.trace,)


def test_a_pickled_buffer_is_not_read(tmp_path):
    (tmp_path / PICKLE).write_bytes(pickle.dumps(Harmful(tmp_path / "trace")))
    with pytest.raises(ConfigError, match=r"replay_buffer.pkl: a pickle .* remove it to go on"):
        load_replay(empty(), tmp_path)
    assert not (tmp_path / "trace").exists()
    (tmp_path / PICKLE).unlink()
    assert not load_replay(empty(), tmp_path)


# --- models --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def small():
    hyper = {
        "training": {"envs": 2, "episode": 20.0},
        "network": {"hidden": [4]},
        "algorithm": {"buffer_size": 64, "learning_starts": 8, "batch_size": 8},
    }
    overrides = {"duration": 20.0}
    config = run_config("sac", hyperparameters=hyper, overrides=overrides)

    def make():
        env = make_env(config)
        return make_model("sac", env, config.hyperparameters, 0, lambda _: 1e-3, None)

    return make


@pytest.fixture(scope="module")
def checkpoint(small, tmp_path_factory):
    folder = tmp_path_factory.mktemp("checkpoint")
    model = small()
    model.learn(32)
    save_checkpoint(model, folder, {})
    return folder, model


def test_a_checkpoint_comes_back(small, checkpoint):
    folder, model = checkpoint
    again = small()
    load_checkpoint(again, folder)
    same(model.replay_buffer, again.replay_buffer)
    for one, other in zip(model.policy.parameters(), again.policy.parameters(), strict=True):
        assert torch.equal(one, other)
    assert torch.equal(model.log_ent_coef, again.log_ent_coef)
    assert again.num_timesteps == model.num_timesteps == 32


def with_member(folder, to, name, change):
    """The checkpoint in another folder, one member of its model changed."""
    with zipfile.ZipFile(folder / "model.zip") as archive:
        parts = {part: archive.read(part) for part in archive.namelist()}
    parts[name] = change(parts[name])
    with zipfile.ZipFile(to / "model.zip", "w") as archive:
        for part, data in parts.items():
            archive.writestr(part, data)


def tensors(change):
    def of(data):
        found, out = torch.load(io.BytesIO(data), weights_only=True), io.BytesIO()
        change(found)
        torch.save(found, out)
        return out.getvalue()

    return of


def state(**changes):
    return lambda data: json.dumps(json.loads(data) | changes).encode()


def first_weight(value):
    def change(found):
        next(iter(found.values())).fill_(value)

    return tensors(change)


def moments(change):
    return tensors(lambda found: change(next(iter(found["state"].values()))))


CHANGES = {
    "nan": ("policy.pth", first_weight(float("nan")), "is not finite"),
    "moment": ("actor.optimizer.pth", moments(lambda m: m["exp_avg"].fill_(np.inf)), "not finite"),
    "shape of a moment": (
        "actor.optimizer.pth",
        moments(lambda m: m.update(exp_avg=torch.zeros(3))),
        "actor.optimizer: exp_avg has shape (3,)",
    ),
    "no weights": ("policy.pth", tensors(lambda found: found.clear()), "not a checkpoint"),
    "no tensors": ("policy.pth", lambda data: b"text", "not a checkpoint"),
    "entropy": (
        "pytorch_variables.pth",
        tensors(lambda found: found.update(log_ent_coef=torch.zeros(2))),
        "log_ent_coef has shape (2,)",
    ),
    "a list": ("state.json", lambda data: b"[1]", "state.json = [1]"),
    "no samples": ("state.json", lambda data: b"{}", "state.json has no"),
    "samples": ("state.json", state(samples=-1), "samples = -1: allowed"),
    "mean": (
        "state.json",
        state(obs_rms={"mean": [1], "var": [1], "count": 1}),
        "obs_rms.mean has",
    ),
    "text": ("state.json", state(ret_rms={"mean": "a", "var": 1, "count": 1}), "ret_rms.mean"),
    "price": ("state.json", state(price={"config": 1.0}), "price = {'config': 1.0}: needed are"),
    "a payload": ("policy.pth", None, "policy.pth holds more than numbers"),
}


@pytest.mark.parametrize("case", CHANGES)
def test_a_damaged_checkpoint_is_one_line(small, checkpoint, tmp_path, case):
    name, change, words = CHANGES[case]
    trace = tmp_path / "trace"
    if change is None:
        held = io.BytesIO()
        torch.save({"weight": Harmful(trace)}, held)
        torch.load(io.BytesIO(held.getvalue()), weights_only=False)
        assert trace.exists(), "the trap must work"
        trace.unlink()
        change = lambda data: held.getvalue()  # noqa: E731
    with_member(checkpoint[0], tmp_path, name, change)
    with pytest.raises(ConfigError) as error:
        load_checkpoint(small(), tmp_path)
    text = str(error.value)
    assert words in text and str(tmp_path / "model.zip") in text and "\n" not in text
    assert not trace.exists()
