import numpy as np
import pytest
from ship_gym_agents.tuning import search as searching
from ship_gym_agents.tuning.ranges import Range
from ship_gym_agents.tuning.search import Size, search

from ship_gym.config import ConfigError

RANGES = {"a": Range(-2.0, 3.0, 0.0), "b": Range(0.01, 100.0, 1.0)}


def bowl(candidates):
    """Least at a = 1, b = 10."""
    return np.array([(c["a"] - 1.0) ** 2 + np.log10(c["b"] / 10.0) ** 2 for c in candidates])


def found(size, costs=bowl, ticks=None):
    return search(costs, RANGES, size, lambda: ticks is not None and ticks.append(1))


def test_finds_the_least():
    pytest.importorskip("optuna")
    ticks = []
    best, cost = found(Size(generations=12, candidates=10, polish=60), ticks=ticks)
    assert best == pytest.approx({"a": 1.0, "b": 10.0}, rel=5e-3) and cost < 1e-5
    assert cost == bowl([best])[0] and len(ticks) == 13


def test_generations_come_in_batches_and_the_seed_decides():
    pytest.importorskip("optuna")
    sizes = []

    def costs(candidates):
        sizes.append(len(candidates))
        return bowl(candidates)

    size = Size(generations=3, candidates=6, polish=0)
    assert found(size, costs) == found(size) != found(Size(generations=3, candidates=6, seed=1))
    assert sizes == [1, 6, 6, 6]


def test_is_never_worse_than_the_start_and_stays_in_the_ranges():
    pytest.importorskip("optuna")

    def costs(candidates):
        assert all(-2.0 <= c["a"] <= 3.0 and 0.01 <= c["b"] <= 100.0 for c in candidates)
        return np.array([0.0 if c == {"a": 0.0, "b": 1.0} else 1.0 for c in candidates])

    size = Size(generations=2, candidates=5, polish=10)
    assert found(size, costs) == ({"a": 0.0, "b": 1.0}, 0.0)


def test_the_polish_goes_on_from_the_best():
    pytest.importorskip("optuna")
    rough = found(Size(generations=2, candidates=6, polish=0))[1]
    assert found(Size(generations=2, candidates=6, polish=50))[1] < 0.2 * rough


def test_without_optuna_the_extra_is_named(monkeypatch):
    monkeypatch.setattr(searching, "find_spec", lambda name: None)
    with pytest.raises(ImportError, match=r'needs optuna: pip install "ship-gym\[tune\]"'):
        found(Size())


@pytest.mark.parametrize("wrong", [{"episodes": 1}, {"generations": 0}, {"candidates": 2}])
def test_wrong_sizes_are_refused(wrong):
    with pytest.raises(ConfigError, match=next(iter(wrong))):
        Size(**wrong)
