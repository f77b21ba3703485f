"""Training throughput: what it counts."""

from __future__ import annotations

import pytest

pytest.importorskip("stable_baselines3", reason="extra 'rl' not installed")

from ship_gym_agents.sb3.throughput import throughput


def test_counts_whole_rollouts_after_the_first():
    found = throughput(2, envs=8, scenario="heading_calm")
    assert found["samples"] == 2 * 8 * 64
    assert found["envs"] == 8 and found["algorithm"] == "ppo"
    assert found["samples_per_second"] > 0.0 and 0.0 < found["learning_percent"] < 100.0
