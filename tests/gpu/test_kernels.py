"""What a thread does for one ship, done by the CPU one by one: the same bits as its own step."""

import numpy as np
import pytest

from ship_gym.conventions import N_STATES, U
from ship_gym.envs.vector_env import ShipVectorEnv
from ship_gym.gpu.batch import batch_of
from ship_gym.gpu.kernels import ENDED, REFUSED, RUNNING, interval_of_one
from ship_gym.gpu.rows import leaves, of_one_ship
from ship_gym.physics.scratch import scratch_for
from tests.gpu.voyages import VOYAGES

N, LOST, INTERVALS = 3, 1, 6
# a ship that is lost may overflow, which numpy tells where Python runs the kernels
pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")


def built(name):
    options = {"scenario": None, **VOYAGES[name]}
    return ShipVectorEnv(N, autoreset_mode="Disabled", **options)


def made(name):
    envs = built(name)
    envs.reset(seed=7)
    return envs.episodes


def scratches():
    return scratch_for(1), np.zeros((1, N_STATES))


# m/s of the ship that is lost; at the second her loads are not finite, and Python's math refuses
SPEEDS = [
    pytest.param(name, 1e4, marks=[pytest.mark.slow] if name in ("course", "track") else [])
    for name in VOYAGES  # each task is compiled, which is what is slow
]
SPEEDS += [pytest.param("heading", 1e200, marks=pytest.mark.compiled)]


@pytest.mark.parametrize("name, speed", SPEEDS)
def test_one_ship_after_the_other(name, speed):
    ours, theirs = made(name), made(name)
    batch, sail = batch_of(ours), interval_of_one(ours.task)
    one, _ = of_one_ship(batch)
    values = tuple(value for _, value in leaves(batch))
    generator = np.random.default_rng(5)
    for k in range(INTERVALS):
        if k == INTERVALS - 1:
            ours.sim.state[LOST, U] = theirs.sim.state[LOST, U] = speed
        actions = generator.uniform(-1.0, 1.0, (N, ours.n_actions))
        batch.episodes.actions[:] = actions
        came = [sail(one(values, i, i + 1, *scratches())) for i in range(N)]
        theirs.step(actions)
        for (field, a), (_, b) in zip(leaves(batch), leaves(batch_of(theirs)), strict=True):
            np.testing.assert_array_equal(a, b, err_msg=field)
        ends = theirs.terminated | theirs.truncated
        assert came == np.where(ends, ENDED, RUNNING).tolist()
    assert came[LOST] == ENDED and theirs._diverged.tolist() == [False, True, False]


def test_an_action_that_is_not_finite_is_not_sailed():
    episodes = made("calm")
    batch = batch_of(episodes)
    one, _ = of_one_ship(batch)
    batch.episodes.actions[0] = np.nan
    before = episodes.sim.state.copy()
    values = tuple(value for _, value in leaves(batch))
    assert interval_of_one(episodes.task)(one(values, 0, 1, *scratches())) == REFUSED
    np.testing.assert_array_equal(episodes.sim.state, before)


def test_batches_of_other_ships_have_other_names(own_versions):
    """Machine code is kept by these names: what no ship has, as a second screw, is left out."""
    names = [
        of_one_ship(batch_of(built(name).episodes))[1] for name in ("heading", "calm", "fleet")
    ]
    assert names[0] == names[1] != names[2]
