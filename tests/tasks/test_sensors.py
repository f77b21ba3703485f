import numpy as np
import pytest
from scipy import stats

from ship_gym.physics._kernel import kernel
from ship_gym.tasks.sensors import mixed_bits, normal_pair


@kernel
def table_of(keys, intervals, pairs, out):
    for i in range(keys):
        for j in range(intervals):
            for k in range(pairs):
                a, b = normal_pair(1234567 + 7919 * i, j, k)
                out[i, j, 2 * k], out[i, j, 2 * k + 1] = a, b


@pytest.fixture(scope="module")
def numbers():
    out = np.zeros((40, 600, 6))
    table_of(40, 600, 3, out)
    return out


def test_the_noise_is_standard_normal(numbers):
    flat = numbers.ravel()
    assert abs(flat.mean()) < 4.0 / np.sqrt(flat.size)
    assert abs(flat.std() - 1.0) < 4.0 / np.sqrt(2 * flat.size)
    assert stats.kstest(flat, "norm").pvalue > 1e-3


def test_the_noise_is_white_and_channels_and_episodes_are_independent(numbers):
    bound = 4.0 / np.sqrt(numbers[..., 0].size)
    for lag in (1, 2, 7):
        assert abs(np.mean(numbers[:, lag:] * numbers[:, :-lag])) < bound
    for k in range(1, 6):
        assert abs(np.mean(numbers[..., 0] * numbers[..., k])) < bound
        assert abs(np.mean(numbers[..., k - 1] ** 2 * (numbers[..., k] ** 2 - 1.0))) < 6 * bound
    assert abs(np.mean(numbers[1:] * numbers[:-1])) < bound


def test_neighbouring_keys_give_other_noise():
    seen = {normal_pair(key, interval, 0) for key in range(30) for interval in range(30)}
    assert len(seen) == 900


@pytest.mark.compiled
def test_python_gives_the_same_bits_and_words_stay_words():
    for key in (0, 1, 2**31, 2**32 - 1):
        assert normal_pair.py_func(key, 599, 2) == normal_pair(key, 599, 2)
        assert 0 <= mixed_bits(key) == mixed_bits.py_func(key) < 2**32
    assert len({mixed_bits(k) for k in range(20000)}) == 20000
