import numpy as np
import pytest
from ship_gym_agents.training.least_squares import MOST_DAMPING, next_damping, steps

rng = np.random.default_rng(0)
A = rng.normal(size=(40, 5))  # residuals A x - b
B = rng.normal(size=40)
X = rng.normal(size=5)


def test_undamped_step_of_a_linear_problem_is_its_least_squares_solution():
    (found,) = steps(A.T, A @ X - B, X, [0.0], ridge=0.0)
    np.testing.assert_allclose(found, np.linalg.lstsq(A, B, rcond=None)[0], rtol=1e-10)


def test_ridge_is_that_of_the_weights_not_of_the_step():
    ridge = 3.0
    (found,) = steps(A.T, A @ X - B, X, [0.0], ridge)
    wide = np.vstack([A, np.sqrt(ridge) * np.eye(5)])
    wanted = np.linalg.lstsq(wide, np.append(B, np.zeros(5)), rcond=None)[0]
    np.testing.assert_allclose(found, wanted, rtol=1e-10)


def test_damping_shortens_the_step():
    found = steps(A.T, A @ X - B, X, [0.0, 1.0, 10.0, 1e6], ridge=0.0)
    lengths = np.linalg.norm(found - X, axis=1)
    assert np.all(np.diff(lengths) < 0.0)
    assert lengths[-1] < 1e-5 * lengths[0]


def test_weight_that_nothing_feels_goes_to_zero_by_the_ridge():
    slopes = np.vstack([A.T, np.zeros(40)])
    (found,) = steps(slopes, A @ X - B, np.append(X, 7.0), [0.0], ridge=1e-3)
    assert found[5] == pytest.approx(0.0, abs=1e-6)


def test_weight_that_nothing_feels_stays_without_a_ridge():
    slopes = np.vstack([A.T, np.zeros(40)])
    (found,) = steps(slopes, A @ X - B, np.append(X, 7.0), [0.01], ridge=0.0)
    assert found[5] == 7.0 and np.all(np.isfinite(found))


def test_next_damping_is_that_of_the_step_taken_or_more():
    assert next_damping(0.1, 0.01) == 0.01
    assert next_damping(0.1, None) > 0.1
    assert next_damping(MOST_DAMPING, None) == MOST_DAMPING
