import copy
import json
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.evaluation.score import (
    FILE,
    Reference,
    cell_score,
    mean_score,
    normalised,
    read_references,
)
from ship_gym.evaluation.statistics import Estimate, estimate

CELL = {
    "measure": "J_steady",
    "nothing": 160.0,
    "reference": 10.0,
    "reference_controller": "pid",
    "optimum": 5.0,
    "optimum_kind": "gauss-newton plan",
    "optimum_seeds": 16,
    "headroom": {"value": 50.0, "low": 40.0, "high": 60.0},
}
TEXT = {
    "version": "ShipBench-1",
    "seeds": [2_000_000, 64],
    "cells": {"heading_keeping/kcs": CELL},
    "git_commit": "abc",
}
REFERENCE = Reference("heading_keeping", "kcs", "J_steady", 160.0, 10.0, "pid", 5.0)


def written(tmp_path, change=None, cell=None):
    text = copy.deepcopy(TEXT)
    text.update(change or {})
    if cell is not None:
        text["cells"]["heading_keeping/kcs"] = cell
    path = tmp_path / "shipbench_1.json"
    path.write_text(json.dumps(text))
    return path


@pytest.mark.parametrize(
    ("x", "score"), [(160.0, 0.0), (10.0, 100.0), (40.0, 50.0), (5.0, 125.0), (320.0, -25.0)]
)
def test_scores_by_hand(x, score):
    """160 / 10 = 2^4, so that halving the measure earns 25."""
    assert normalised(x, 160.0, 10.0) == pytest.approx(score, abs=1e-12)
    assert REFERENCE.score(x) == pytest.approx(score, abs=1e-12)


def test_scores_of_single_episodes():
    found = REFERENCE.scores([160.0, math.nan, 10.0, 20.0])
    assert found[[0, 2, 3]] == pytest.approx([0.0, 100.0, 75.0]) and np.isnan(found[1])
    with pytest.raises(ConfigError, match="cell 'a/kcs' has no score"):
        Reference("a", "kcs", "J_steady", 10.0, 9.9, "pid").scores([1.0])


def test_a_cell_whose_reference_is_hardly_better_than_nothing_has_no_score():
    assert normalised(5.0, 10.4, 10.0) is None
    assert normalised(5.0, 10.5, 10.0) is not None
    assert normalised(5.0, 9.0, 10.0) is None
    poor = Reference("heading_calm", "kcs", "J_steady", 10.0, 9.9, "pid", 5.0)
    assert not poor.scored and poor.optimum_score is None
    assert cell_score([1.0, 2.0], poor) is None and mean_score([([1.0, 2.0], poor)]) is None


@pytest.mark.parametrize("x", [0.0, -1.0, math.nan, math.inf, None])
def test_a_measure_that_is_not_positive_has_no_logarithm(x):
    with pytest.raises(ConfigError, match=r"x = .*: a score needs a positive, finite measure"):
        normalised(x, 160.0, 10.0)


def test_score_of_a_cell_is_that_of_its_interquartile_mean():
    """Of 8 values the middle 4 count: mean 40, score 50; the interval is that of the mean, bent."""
    values = [1e9, 20.0, 30.0, 50.0, 60.0, 1.0, 2.0, 1e6]
    found, mean = cell_score(values, REFERENCE), estimate(values)
    assert mean.value == pytest.approx(40.0)
    assert found.value == pytest.approx(50.0)
    assert found.low == pytest.approx(REFERENCE.score(mean.high), rel=1e-3)
    assert found.high == pytest.approx(REFERENCE.score(mean.low), rel=1e-3)
    assert cell_score([40.0], REFERENCE) == Estimate(pytest.approx(50.0), None, None)


def test_mean_over_cells_by_hand():
    """Scores 50 and 125: 87.5; a cell without a score is left out."""
    poor = Reference("heading_calm", "kcs", "J_steady", 10.0, 9.9, "pid")
    cells = [([40.0] * 4, REFERENCE), ([5.0] * 6, REFERENCE), ([9.0] * 4, poor)]
    found = mean_score(cells)
    assert (found.value, found.low, found.high) == pytest.approx((87.5, 87.5, 87.5))


def test_an_episode_without_a_value_leaves_no_score():
    assert cell_score([40.0, math.nan, 40.0], REFERENCE) is None
    assert cell_score([40.0, None, 40.0], REFERENCE) is None
    assert mean_score([([40.0] * 3, REFERENCE), ([40.0, math.nan], REFERENCE)]) is None
    assert mean_score([]) is None


def test_cells_of_the_same_seeds_are_drawn_together():
    """Two cells alike say no more than one; opposite ones cancel; unequal numbers are strata."""
    values = np.exp(np.random.default_rng(1).normal(3.0, 1.0, 64))
    one = cell_score(values, REFERENCE)
    twice = mean_score([(values, REFERENCE)] * 2)
    assert (twice.low, twice.high) == pytest.approx((one.low, one.high))
    strata = mean_score([(values, REFERENCE), (np.tile(values, 2)[:63], REFERENCE)])
    ratio = (strata.high - strata.low) / (one.high - one.low)
    assert ratio == pytest.approx(math.sqrt(0.5), rel=0.1)


def test_reference_values_are_read(tmp_path):
    found = read_references(written(tmp_path))
    assert found.seeds == (2_000_000, 64) and found.about == {"git_commit": "abc"}
    cell = found.of("heading_keeping", "kcs")
    assert cell.name == "heading_keeping/kcs" and cell.reference_controller == "pid"
    assert cell.optimum_score == pytest.approx(125.0)
    assert cell.headroom == Estimate(50.0, 40.0, 60.0)
    assert found.of("heading_keeping", "dtc") is None
    bare = {**CELL, "optimum": None, "optimum_kind": None, "optimum_seeds": None, "headroom": None}
    cell = read_references(written(tmp_path, cell=bare)).of("heading_keeping", "kcs")
    assert cell.optimum_score is None and cell.headroom is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"version": "ShipBench-2"}, "version = 'ShipBench-2':.*Known: ShipBench-1"),
        ({"seeds": [64]}, r"seeds = \[64\]: allowed is \[first, number\]"),
        ({"cells": []}, "cells = .*: must be a table of keys"),
        ({"cells": {"kcs": CELL}}, "cell 'kcs': its name must be scenario/ship"),
        ({"cells": {"a/kcs": 1.0}}, "cells.a/kcs = 1.0: must be a table of keys"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, change, message):
    with pytest.raises(ConfigError, match=message):
        read_references(written(tmp_path, change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"nothing": 0.0}, "nothing = 0.0: allowed is 1e-12 to 1e\\+12"),
        ({"reference": None}, "reference = null: must have a value"),
        ({"measure": "J_stedy"}, "did you mean 'J_steady'"),
        ({"measure": "success"}, "measure = 'success'"),
        ({"optimum_kind": "guess"}, "optimum_kind = 'guess'.*Known: gauss-newton plan"),
        ({"optimun": 3.0}, "did you mean 'optimum'"),
        ({"headroom": {"low": 1.0}}, "missing key 'value' in cells.heading_keeping/kcs.headroom"),
    ],
)
def test_a_wrong_cell_is_refused_by_name(tmp_path, change, message):
    with pytest.raises(ConfigError, match=message) as refused:
        read_references(written(tmp_path, cell={**CELL, **change}))
    assert "heading_keeping/kcs" in str(refused.value)


def test_missing_keys_and_files_are_named(tmp_path):
    cell = {key: value for key, value in CELL.items() if key != "reference_controller"}
    with pytest.raises(ConfigError, match="missing key 'reference_controller'"):
        read_references(written(tmp_path, cell=cell))
    path = tmp_path / "none.json"
    with pytest.raises(ConfigError, match="no such file"):
        read_references(path)
    path.write_text("{")
    with pytest.raises(ConfigError, match="not valid JSON"):
        read_references(path)
    path.write_text('{"version": "ShipBench-1", "cells": {}}')
    with pytest.raises(ConfigError, match="missing key 'seeds'"):
        read_references(path)


@pytest.mark.skipif(not FILE.exists(), reason="reference values are not made yet")
def test_the_package_s_reference_values_can_be_read():
    assert read_references().cells
