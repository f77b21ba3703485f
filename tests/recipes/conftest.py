"""The recipes of docs/own.md, run word for word in an empty folder."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "own.md"


@pytest.fixture
def recipe(tmp_path, monkeypatch):
    """Run the block that begins with ``# title``; gives the names that it leaves."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(# .*?)```", PAGE.read_text("utf-8"), flags=re.DOTALL)

    def run(title):
        (block,) = (b for b in blocks if b.partition("\n")[0] == f"# {title}")
        names = {}
        exec(compile(block, f"own.md, {title}", "exec"), names)
        return names

    return run


@pytest.fixture
def sail():
    """Sail some steps of an environment; all that comes must be finite."""

    def steps(env, count=3):
        observation, _ = env.reset(seed=0)
        for _ in range(count):
            assert env.observation_space.contains(observation)
            observation, reward, *_ = env.step(env.action_space.sample())
            assert abs(reward) < 10.0
        return env

    return steps
