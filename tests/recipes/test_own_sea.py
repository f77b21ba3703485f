from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

import ship_gym

HEADING = "ShipGym/HeadingKeeping-v0"


def test_the_recipe(recipe, sail):
    names = recipe("a sea")
    sail(names["env"])
    sea = names["env"].unwrapped.scenario.sea
    assert (sea.states, sea.wave_height, sea.peak_period, sea.gusts) == ((), 2.5, 11.0, False)
    calm = ship_gym.manoeuvres.turning_circle("kcs")
    # the current of 1 m/s to the east moves the circle there: 1 m/s over the time of half a turn
    path = names["circle"].trajectory.columns, calm.trajectory.columns
    moved = path[0]["y"][-1] - path[1]["y"][-1]
    assert moved == pytest.approx(path[0]["t"][-1], rel=0.05)
    sim = names["sim"]
    sim.reset(0)
    state = sim.step(np.zeros((8, 2)), 1.0)
    assert state.shape == (8, 8) and np.isfinite(state).all()


def test_the_sea_section_of_a_scenario_file(tmp_path, monkeypatch, sail):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(
        'base = "heading_keeping"\n[sea]\nstates = ["ss4"]\ncurrent_speed = 0.5\n'
    )
    for scenario in ("mine.toml", Path("mine.toml")):
        env = sail(gym.make(HEADING, scenario=scenario))
        assert env.unwrapped.scenario.sea.states == ("ss4",)
