"""Short voyages of `ShipTorchEnv` that meet what a step can meet; run as a program, on the card.

``python voyages.py FOLDER`` sails them on device "cuda" and writes what came of every interval to
npz files, and what it answers to an action that is not finite: the tests run it with numba's
simulator as the card.
"""

import sys
from pathlib import Path

import numpy as np

from ship_gym import ShipTorchEnv
from ship_gym.config import ConfigError
from ship_gym.conventions import U
from ship_gym.gpu.batch import NAMES

ENDS_OFTEN = {"duration": 12.0, "start.heading_error_deg": 20.0, "limits.heading_error_deg": 24.0}
DRAWN = {"randomisation.hull_std": 0.1, "randomisation.gear": 0.2, "randomisation.sensors": 0.5}
FAILURE = {
    "failure.time": 3.0,
    "failure.rudder_rate": 0.5,
    "failure.heading_bias_deg": 3.0,
    "failure.propeller_speed": 0.8,
    "failure.dropout": 4.0,
    "sensors.dropout_rate": 300.0,
    "sensors.dropout_time": 2.0,
}
TRACK = {  # 14 intervals: the next leg begins, some leave the track
    "control_interval": 4.0,
    "duration": 48.0,
    "start.cross_track": 0.1,
    "limits.cross_track": 0.12,
    "track.leg_min": 1.05,
    "track.leg_max": 1.5,
    "track.legs": 2,
    "track.acceptance": 1.0,
}
VOYAGES = {
    "heading": {"overrides": ENDS_OFTEN},
    "course": {
        "scenario": "course_changing",
        "overrides": {"duration": 12.0, "course.first": 2.0, "course.interval_min": 4.0},
    },
    "track": {"scenario": "track_following", "ship": "kvlcc2_model", "overrides": TRACK},
    "fleet": {
        "ship": ["kcs", "onrt", "kvlcc2_model"],
        "control": "rudder+rpm",
        "privileged": True,
        "overrides": {"duration": 8.0, "sea.states": ["ss6"], **DRAWN, **FAILURE},
    },
    "calm": {"overrides": {"duration": 8.0, "sea.states": [], "sea.gusts": False}},
}
N, INTERVALS, LOST_AT, LOST = 3, 14, 4, 1


def voyage(name: str, device: str) -> dict[str, np.ndarray]:
    """Sail at random; at one time one ship is thrown off: she must end as diverged."""
    import torch

    env = ShipTorchEnv(N, device, **VOYAGES[name])
    kept: dict[str, list] = {key: [] for key in (*NAMES, "seen", "final_obs", "ended")}
    generator = np.random.default_rng(5)
    seen, _ = env.reset(seed=7)
    for k in range(INTERVALS):
        if k == LOST_AT:
            env.tensor("state")[LOST, U] = 1e4
        shape = env.action_space.shape
        actions = torch.from_numpy(generator.uniform(-1.2, 1.2, shape)).to(
            env.tensor("state").device
        )
        seen, _, terminated, truncated, info = env.step(actions)
        ended = terminated | truncated
        final = info["final_obs"] * ended[:, None] if info else torch.zeros_like(seen)
        for key, value in (("seen", seen), ("final_obs", final), ("ended", ended)):
            kept[key].append(value.cpu().numpy().copy())
        for key in NAMES:
            kept[key].append(env.tensor(key).cpu().numpy().copy())
    return {key: np.array(values) for key, values in kept.items()}


def answer_to_a_bad_action(device: str) -> str:
    """What is said of an action that is not finite; after a reset all is as before."""
    import torch

    env = ShipTorchEnv(N, device, **VOYAGES["calm"])
    first = env.reset(seed=1)[0].clone()
    actions = torch.zeros(env.action_space.shape)
    actions[2] = torch.nan
    try:
        env.step(actions)
    except ConfigError as error:
        again = (env.reset(seed=1)[0] == first).all() and not env.tensor("elapsed").any()
        return f"{error}; then {'as before' if again else 'otherwise'}"
    return "nothing"


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for key in VOYAGES:
        np.savez(folder / f"{key}.npz", **voyage(key, "cuda"))
    (folder / "bad_action.txt").write_text(answer_to_a_bad_action("cuda"))
