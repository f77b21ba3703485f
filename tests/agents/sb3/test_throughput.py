"""Training throughput: what it counts."""

from __future__ import annotations

import pytest

pytest.importorskip("stable_baselines3", reason="extra 'rl' not installed")

from ship_gym_agents.sb3 import overlapped
from ship_gym_agents.sb3.throughput import throughput

SMALL = {"envs": 8, "scenario": "heading_calm"}


@pytest.fixture(autouse=True)
def one_core(monkeypatch):
    monkeypatch.setattr(overlapped, "cores", lambda: 1)


def test_counts_whole_rollouts_after_the_first():
    found = throughput(2, 1, **SMALL)
    assert found["samples"] == 2 * 8 * 64 and found["plain"]["samples"] == 8 * 64
    assert found["envs"] == 8 and found["algorithm"] == "ppo" and not found["side_by_side"]
    for each in (found, found["plain"]):
        assert each["samples_per_second"] > 0.0
        assert each["sailing_percent"] + each["learning_percent"] == pytest.approx(100.0, abs=10.0)
    rates = found["samples_per_second"], found["plain"]["samples_per_second"]
    assert found["plain"]["ratio"] == pytest.approx(rates[0] / rates[1])


def test_nothing_beside():
    assert throughput(1, 0, **SMALL)["plain"] == {}
