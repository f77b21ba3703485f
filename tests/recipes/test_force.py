"""One more force is three files: table, formula, and where forces are evaluated."""

import json

from tests.recipes.recipe import apply, copied, run

FILES = {
    "ship_gym/conventions.py",  # the table
    "ship_gym/physics/tug.py",  # the formula
    "ship_gym/physics/step.py",  # where it is evaluated
}
SAIL = """
import json

import gymnasium as gym
import numpy as np

import ship_gym
from ship_gym.evaluation import rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.recording.scene import arrows

env = gym.make("ShipGym/HeadingKeeping-v0", privileged=True)
env.reset(seed=1)
seen, _, _, _, info = env.step(np.zeros(1, np.float32))
run = rollout(ConstantController(), seeds=[1], overrides={"duration": 5.0}).trajectory(0)
print(json.dumps({
    "file": ship_gym.__file__,
    "forces": {name: np.asarray(force).tolist() for name, force in info["forces"].items()},
    "observations": len(seen),
    "columns": {name: values[-2] for name, values in run.columns.items()},
    "arrows": [arrow.name for arrow in arrows(run.columns, 230.0)],
}))
"""


def test_a_force_is_three_files(tmp_path):
    folder = copied(tmp_path)
    before = json.loads(run(SAIL, folder))
    assert apply("A force", folder) == FILES
    after = json.loads(run(SAIL, folder))
    assert after["file"].startswith(str(folder))
    # in info, beside the others, which are as they were at the start
    assert after["forces"] == before["forces"] | {"tug": [0.0, 3.0e5, 3.0e7]}
    # in a recording, which draws its arrow
    new = set(after["columns"]) - set(before["columns"])
    assert new == {"X_tug", "Y_tug", "N_tug"}
    assert [after["columns"][f"{axis}_tug"] for axis in "XYN"] == [0.0, 3.0e5, 3.0e7]
    assert set(after["arrows"]) - set(before["arrows"]) == {"tug_force"}
    # it moves the ship: sway and yaw to starboard beside the run without it
    assert after["columns"]["v"] > before["columns"]["v"] + 1e-3
    assert after["columns"]["r"] > before["columns"]["r"] + 1e-5
    # and a critic sees it
    assert after["observations"] == before["observations"] + 3
