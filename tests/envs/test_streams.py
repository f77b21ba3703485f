"""Streams of many environments in a few bytes: the numbers of Gymnasium's generators."""

import copy
import pickle

import numpy as np
from gymnasium.utils import seeding

from ship_gym.envs.streams import Streams

ALL = np.ones(3, dtype=bool)


def made(seeds=(5, 6, 2**70 + 1)):
    streams = Streams(3)
    streams.seed(list(seeds), ALL)
    return streams


def test_the_numbers_are_those_of_gymnasium_s_generators_one_after_the_other():
    streams = made()
    others = [seeding.np_random(seed)[0] for seed in streams.seeds]
    for which in ([0, 1, 2], [1], [2, 0], [0, 1, 2]):
        drawn = streams.random(np.array(which), 7)
        assert drawn.shape == (len(which), 7)
        for row, i in zip(drawn, which, strict=True):
            assert (row == others[i].random(7)).all()


def test_only_those_of_the_mask_begin_anew_and_a_running_one_goes_on_without_a_seed():
    streams, others = made(), made()
    streams.seed([None, 7, 8], np.array([True, True, False]))
    assert streams.seeds == [5, 7, 2**70 + 1]
    assert (streams.random(np.array([0, 2]), 3) == others.random(np.array([0, 2]), 3)).all()
    assert (streams.random(np.array([1]), 3) == seeding.np_random(7)[0].random(3)).all()


def test_without_a_seed_each_gets_one():
    streams = made([None, None, 3])
    assert len(set(streams.seeds)) == 3
    again = made(streams.seeds)
    assert (streams.random(np.arange(3), 4) == again.random(np.arange(3), 4)).all()


def test_generators_are_copies_of_what_comes_next():
    streams = made()
    drawn = [generator.random(4) for generator in streams.generators()]
    assert (streams.random(np.arange(3), 4) == drawn).all()
    assert Streams(2).generators() == (None, None)


def test_copies_go_on_alike():
    streams = made()
    streams.random(np.array([1]), 5)
    twins = copy.deepcopy(streams), pickle.loads(pickle.dumps(streams))
    expected = streams.random(np.arange(3), 6)
    for twin in twins:
        assert (twin.random(np.arange(3), 6) == expected).all()
