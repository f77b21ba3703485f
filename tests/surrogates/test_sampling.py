"""Where to sample next."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from ship_gym.surrogates.fit import Options, fit
from ship_gym.surrogates.samples import KCS, ONRT, SINGLE
from ship_gym.surrogates.sampling import (
    box_grid,
    least_sure,
    proposals,
    relative_std,
    space_filling,
)

BOX = (0.2, 0.9, 0.0, 0.8)


@pytest.fixture(scope="module")
def regression():
    return fit(KCS)


def test_the_least_sure_point_has_the_largest_std_of_the_box(regression):
    found = {row["quantity"]: row for row in least_sure(regression)}
    assert set(found) == {*KCS.quantities, "mean"}  # K_S is printed, its spread is not known
    row = found["K_T"]
    place = np.array([[row["J"], row["beta"]]])
    model, values = regression.models[SINGLE]["K_T"], regression.training[SINGLE].values["K_T"]
    assert row["share"] == pytest.approx(model.predict(place)[1][0] / np.ptp(values))
    assert (model.predict(box_grid(KCS.box, 17))[1] / np.ptp(values)).max() <= row["share"] + 1e-12
    # far from every sample: the Latin hypercube left the corner of low J and no drift empty
    assert (row["J"], row["beta"]) == (0.2, 0.0)


def test_a_process_is_surest_at_its_points():
    found = fit(KCS, Options("gp", noise="none"))
    at_points = relative_std(found, SINGLE, found.training[SINGLE].X)["K_T"]
    assert at_points.max() < 0.01 * max(row["share"] for row in least_sure(found))


def test_both_sides_are_asked():
    assert {row["side"] for row in least_sure(fit(ONRT))} == {"leeward", "windward"}


def test_printed_coefficients_know_no_std():
    assert least_sure(fit(KCS, None, "G2", "SST")) == []


def test_new_points_fill_the_box_away_from_the_others(regression):
    X = regression.training[SINGLE].X
    new = space_filling(X, BOX, count=4, seed=3)
    low, span = np.array(BOX[0::2]), np.array([0.7, 0.8])
    unit, there = (new - low) / span, (X - low) / span
    assert new.shape == (4, 2) and (unit >= 0.0).all() and (unit <= 1.0).all()
    for k in range(2):  # a Latin hypercube: one point in each quarter of each input
        assert sorted(np.floor(4.0 * unit[:, k])) == [0.0, 1.0, 2.0, 3.0]
    random = np.random.default_rng(0).random((200, 4, 2))
    usual = np.median([cdist(points, there).min() for points in random])
    assert cdist(unit, there).min() > 2.0 * usual
    np.testing.assert_array_equal(new, space_filling(X, BOX, count=4, seed=3))
    assert not np.array_equal(new, space_filling(X, BOX, count=4, seed=4))


def test_proposals_are_plain_data_within_the_box(regression):
    found = proposals(regression, count=5, seed=1)
    assert len(found["space_filling"]) == 5
    assert all(type(row["J"]) is float for rows in found.values() for row in rows)
    J = [row["J"] for row in found["space_filling"]]
    assert KCS.box[0] <= min(J) and max(J) <= KCS.box[1] and J == sorted(J)
    small = dataclasses.replace(regression, data=dataclasses.replace(KCS, box=(0.4, 0.5, 0.1, 0.2)))
    assert all(0.4 <= row["J"] <= 0.5 for row in least_sure(small))
