"""Tiny runs of training, for tests that train for a second."""

import pytest
from ship_gym_agents.sb3.config import run_config

TINY = {
    "training": {"envs": 8, "validations": 2, "episode": 20.0, "threads": 1},
    "network": {"hidden": [8, 8]},
}
OPTIONS = {
    "ppo": {"n_steps": 16, "batch_size": 64, "n_epochs": 2},
    "sac": {"learning_starts": 32, "buffer_size": 500},
    "td3": {"learning_starts": 32, "buffer_size": 500},
}


@pytest.fixture
def tiny():
    """Make the config of a tiny run; arguments as `run_config`, `more` hyperparameters."""

    def make(algorithm="ppo", more=None, **arguments):
        hyper = {**TINY, "algorithm": OPTIONS[algorithm], **(more or {})}
        return run_config(
            algorithm, hyperparameters=hyper, **{"overrides": {"duration": 20.0}, **arguments}
        )

    return make


@pytest.fixture(autouse=True)
def one_thread_and_few_episodes(monkeypatch):
    """Threads of torch that wait for a busy core make tiny networks very slow."""
    torch = pytest.importorskip("torch")
    pytest.importorskip("stable_baselines3")
    from ship_gym_agents.training import run, train

    monkeypatch.setattr(run, "EPISODES", (4, 2))
    monkeypatch.setattr(train, "FEWEST_JUDGING", 2)
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)
