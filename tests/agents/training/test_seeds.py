import dataclasses
import json

import pytest
from ship_gym_agents.policies.policy_file import load_policy
from ship_gym_agents.training.score import Score
from ship_gym_agents.training.seeds import summarised, train_seeds
from ship_gym_agents.training.summary import plan, summary
from ship_gym_agents.training.train import train

from ship_gym.config import ConfigError

pytest.importorskip("stable_baselines3")

import torch
from stable_baselines3.common.save_util import load_from_zip_file

LOWER = Score("J_steady", "deg2", "lower")


def card(seed, value, success=1.0):
    means = {"J_steady": value, "success": success, "rudder_travel": 900.0, "return": 0.0}
    return {"config": {"seed": seed}, "best": means}


def test_the_median_is_kept_and_of_two_the_worse_one():
    found = summarised([card(k, v) for k, v in enumerate((5.0, 1.0, 3.0, 2.0, 4.0))], LOWER)
    assert found["median"]["place"] == 2 and found["spread"] == [1.0, 5.0]
    assert summarised([card(k, v) for k, v in enumerate((1.0, 2.0))], LOWER)["median"]["seed"] == 1
    failed = [card(0, 1.0, 0.9), card(1, 2.0), card(2, 3.0)]
    assert summarised(failed, LOWER)["median"]["seed"] == 2, "one that fails is the worst"


def test_several_seeds_are_trained_interrupted_and_gone_on_with(tiny, tmp_path):
    config, out = tiny(seed=7), tmp_path / "run"

    class Bar:
        n, total = 0, 100

        def update(self, increment):
            self.n += increment
            if self.n > 80:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train_seeds(config, out, 2, steps=128, bar=Bar(), final=False)
    assert json.loads((out / "card.json").read_text())["status"] == "interrupted"
    first = (out / "seed_0" / "card.json").read_bytes()
    made = train_seeds(config, out, 2, steps=128, resume=True, final=False)
    assert (out / "seed_0" / "card.json").read_bytes() == first, "what is complete stays"
    assert [run["seed"] for run in made["runs"]] == [7, 8]
    assert json.loads((out / "summary.json").read_text()) == made
    kept = (out / f"seed_{made['median']['place']}" / "policy.safetensors").read_bytes()
    assert (out / "policy.safetensors").read_bytes() == kept and load_policy(out)
    assert (out / "curve.png").is_file()
    text = summary(config, made, out)
    assert "seed 7" in text and "kept: the median" in text
    assert "seeds 7 to 8" in plan(config, out, 1.0, None, 2)
    alone = train(dataclasses.replace(config, seed=8), tmp_path / "one", steps=128, final=False)
    assert alone["best"]["return"] == made["runs"][1]["return"], "each is a run as of one seed"
    with pytest.raises(ConfigError, match="holds a run"):
        train_seeds(config, out, 2, steps=128)
    with pytest.raises(ConfigError, match="another config or number of seeds"):
        train_seeds(config, out, 3, steps=128, resume=True)


@pytest.mark.slow
def test_seeds_side_by_side_are_those_in_turn(tiny, tmp_path):
    one = train_seeds(tiny(), tmp_path / "turn", 2, steps=128, final=False)
    two = train_seeds(tiny(), tmp_path / "side", 2, steps=128, final=False, jobs=2)
    assert [run["seed"] for run in one["runs"]] == [run["seed"] for run in two["runs"]]
    for k in (0, 1):  # not the policies: the processes validate on more seas, see conftest
        a, b = (weights(tmp_path / name / f"seed_{k}") for name in ("turn", "side"))
        assert a.keys() == b.keys() and all(torch.equal(a[name], b[name]) for name in a)


def weights(run):
    """Weights of the last checkpoint."""
    file = next(run.glob("checkpoint/*/model.zip"))
    return load_from_zip_file(file, load_data=False, device="cpu")[1]["policy"]
