"""A small suite with controllers that go wrong, for the tests of benchmarks."""

CONTROLLERS = '''
import os

import numpy as np


class Good:
    """Heading error and yaw rate to the rudder."""

    name = "good"

    def reset(self, count, ship, scenario):
        self.k = -1

    def act(self, observations):
        self.k += 1
        return -2.0 * observations[:, :1] - observations[:, 2:3]


class Raises(Good):
    name = "raises"

    def act(self, observations):
        actions = super().act(observations)
        if self.k == 17 and (observations[:, 0] > 0.0).any():
            raise ValueError("to starboard")
        return actions


class NotANumber(Good):
    name = "nan"

    def act(self, observations):
        actions = super().act(observations)
        actions[(observations[:, 0] > 0.0) & (self.k == 5)] = np.nan
        return actions


class Shape(Good):
    name = "shape"

    def act(self, observations):
        return np.zeros(3)


class Reset(Good):
    name = "reset"

    def reset(self, *_):
        raise RuntimeError("not today")


class Alone(Good):
    name = "alone"

    def act(self, observations):
        assert len(observations) == 1
        return super().act(observations)


class Ends(Good):
    name = "ends"

    def act(self, observations):
        if self.k == 30:
            os._exit(7)
        return super().act(observations)


class Sleeps(Good):
    name = "sleeps"

    def act(self, observations):
        import time

        time.sleep(0.02)
        return super().act(observations)
'''
SCENARIO = 'base = "heading_ss5_beam"\nduration = 60.0\n'
SUITE = """
name = "small"
version = "1"
title = "Small"
ships = ["kcs"]
controllers = ["own.py:Good"]

[[scenario]]
name = "short.toml"
tier = "seaway"

[[scenario]]
name = "heading_calm"
measure = "J_1"
"""


def write_suite(folder, suite=SUITE):
    """Files of the suite in a folder; gives the suite's."""
    (folder / "own.py").write_text(CONTROLLERS)
    (folder / "short.toml").write_text(SCENARIO)
    (folder / "small.toml").write_text(suite)
    return folder / "small.toml"


def own(folder, *names):
    """Names of controllers of the file."""
    return [f"{folder / 'own.py'}:{name}" for name in names]


def without_times(results):
    """The table without what differs from run to run."""
    return results.table.drop_columns(["decision_ms"])
