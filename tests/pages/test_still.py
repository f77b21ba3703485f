import numpy as np
import pytest

from pages.still import still
from ship_gym import ENVIRONMENTS
from ship_gym.config import ConfigError
from ship_gym.evaluation.controller import ConstantController

pytest.importorskip("PIL")


@pytest.mark.parametrize("env_id", ENVIRONMENTS)
def test_still_is_a_picture_and_always_the_same(env_id):
    pictures = [still(ConstantController(), env_id, seed=1, intervals=k) for k in (5, 5, 10)]
    assert pictures[0].dtype == np.uint8 and pictures[0].ndim == 3
    assert len(np.unique(pictures[0].reshape(-1, 3), axis=0)) > 10
    assert (pictures[0] == pictures[1]).all() and (pictures[0] != pictures[2]).any()


def test_an_episode_that_ends_earlier_is_refused():
    hard_over = ConstantController(rudder=1.0)
    with pytest.raises(ConfigError, match=r"intervals = 599: .* ends after"):
        still(hard_over, "ShipGym/HeadingKeeping-v0", seed=1, intervals=599)
