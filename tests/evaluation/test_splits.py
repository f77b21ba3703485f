import itertools

import pytest

from ship_gym.config import ConfigError
from ship_gym.evaluation.rollout import EVALUATION_SEED, TUNING_SEED, evaluation_seeds, tuning_seeds
from ship_gym.evaluation.splits import (
    HELD_OUT_SHIPS,
    SPLITS,
    TRAINING_SHIPS,
    VALIDATION_SEED,
    seeds_of,
    split_of,
)
from ship_gym.ships import available_ships


def test_splits_follow_one_another_without_gap_or_overlap():
    splits = list(SPLITS.values())
    assert [split.name for split in splits] == ["training", "validation", "tuning", "test", "final"]
    assert splits[0].first == 0
    assert all(a.end == b.first for a, b in itertools.pairwise(splits))


def test_splits_are_frozen():
    """A change would make every number of ShipBench-1 incomparable."""
    firsts = {name: split.first for name, split in SPLITS.items()}
    assert firsts == {
        "training": 0,
        "validation": 400_000,
        "tuning": 500_000,
        "test": 2_000_000,
        "final": 3_000_000,
    }


def test_seeds_of_a_split():
    assert seeds_of("validation", 2) == [400_000, 400_001]
    assert seeds_of("test", 3) == evaluation_seeds(3) == [2_000_000, 2_000_001, 2_000_002]
    assert seeds_of("tuning", 1) == tuning_seeds(1) == [TUNING_SEED]
    assert (VALIDATION_SEED, EVALUATION_SEED) == (400_000, 2_000_000)
    with pytest.raises(ConfigError, match="did you mean 'training'"):
        seeds_of("train", 1)
    with pytest.raises(ConfigError, match="episodes = 100001"):
        seeds_of("validation", 100_001)


def test_every_seed_tells_its_split():
    for seed, name in ((0, "training"), (399_999, "training"), (400_000, "validation")):
        assert split_of(seed) == name and seed in SPLITS[name]
    assert split_of(1_999_999) == "tuning" and split_of(2_000_000) == "test"
    assert split_of(2_999_999) == "test" and split_of(3_000_000) == "final"
    assert split_of(4_000_000) is None and split_of(-1) is None


def test_ships_are_split_too():
    assert not set(TRAINING_SHIPS) & set(HELD_OUT_SHIPS)
    assert set(TRAINING_SHIPS + HELD_OUT_SHIPS) <= set(available_ships())
