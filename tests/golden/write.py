"""Golden trajectories: observation and reward of each id under fixed actions, to notice changes."""

from pathlib import Path

import gymnasium as gym
import numpy as np

import ship_gym


def golden_rows(env_id):
    """Every tenth observation and reward of 100 steps, seed 2026, sinusoidal actions."""
    env = gym.make(env_id, control="rudder+rpm").unwrapped
    env.reset(seed=2026)
    rows = []
    for k in range(100):
        action = np.array([0.6 * np.sin(0.11 * k), 0.2 * np.cos(0.05 * k)])
        obs, reward, *_ = env.step(action)
        if k % 10 == 9:
            rows.append(np.append(obs.astype(float), reward))
    return np.array(rows)


if __name__ == "__main__":
    for name in ship_gym.ENVIRONMENTS:
        path = Path(__file__).parent / (name.replace("/", "_") + ".csv")
        np.savetxt(path, golden_rows(name), delimiter=",", fmt="%.9g")
        print(f"wrote {path}")
