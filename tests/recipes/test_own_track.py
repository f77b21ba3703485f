import json
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

TRACK = "ShipGym/TrackFollowing-v0"
POINTS = [[0, 0], [3000, 0], [5000, 2000]]


def sailed(env):
    """Way-points of the episode."""
    return env.unwrapped.scenario.track


def test_the_recipe(recipe, sail):
    env = sail(recipe("a track")["env"])
    points = gym.make(TRACK, overrides={"track.kind": "points", "track.points": POINTS})
    assert (env.reset(seed=3)[0] == points.reset(seed=3)[0]).all()
    for _ in range(5):
        action = np.array([0.3], dtype=np.float32)
        a, b = env.step(action), points.step(action)
        assert (a[0] == b[0]).all() and a[1] == b[1]


def test_a_scenario_file_with_a_chart_beside_it(tmp_path, monkeypatch, sail):
    pytest.importorskip("pyproj")
    (tmp_path / "far").mkdir()
    line = {"type": "LineString", "coordinates": [[10.0, 54.0], [10.05, 54.02], [10.1, 54.0]]}
    (tmp_path / "far" / "fjord.geojson").write_text(json.dumps(line))
    (tmp_path / "far" / "mine.toml").write_text(
        'base = "track_following"\n[track]\nkind = "points"\nfile = "fjord.geojson"\n'
    )
    monkeypatch.chdir(tmp_path)
    for scenario in ("far/mine.toml", Path("far/mine.toml")):
        sail(gym.make(TRACK, scenario=scenario))
