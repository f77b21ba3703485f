import pickle

import numpy as np
import pytest

from ship_gym import load_ship
from ship_gym.config import ConfigError
from ship_gym.evaluation import rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.guard import ControllerFailed, ControllerRefused, Guarded
from ship_gym.scenarios.scenario import load_scenario

SHORT = {"duration": 30.0}


class Own(ConstantController):
    """Steers by a function of interval and observations."""

    def __init__(self, act, reset=lambda: None):
        super().__init__(name="own")
        self._own, self._begin = act, reset

    def reset(self, count, ship, scenario):
        super().reset(count, ship, scenario)
        self._begin()
        self.k = -1

    def act(self, observations):
        self.k += 1
        return self._own(self.k, super().act(observations))


def fails_at_17(k, actions):
    if k == 17:
        raise ValueError("no\n  more")
    return actions


def leaves(k, actions):
    raise SystemExit(3)


def spoilt(value, row=1):
    def act(k, actions):
        actions = actions.copy()
        actions[row] = value
        return actions

    return act


@pytest.mark.parametrize(
    ("act", "seeds", "interval", "words"),
    [
        (fails_at_17, (3, 4, 5), 17, "interval 17: ValueError: no more (test_guard.py:"),
        (leaves, (3, 4, 5), 0, "interval 0: SystemExit: 3 (test_guard.py:"),
        (spoilt(np.nan), (4,), 0, "interval 0: action = [nan]: must be finite"),
        (spoilt(np.inf), (4,), 0, "action = [inf]: must be finite"),
        (lambda k, a: a[:2], (3, 4, 5), 0, "actions have shape (2, 1), allowed is (3, 1)"),
        (lambda k, a: a[:, 0], (3, 4, 5), 0, "actions have shape (3,)"),
        (lambda k, a: [[0.0], [0.0, 1.0], []], (3, 4, 5), 0, "must be 1 numbers in [-1, 1]"),
        (lambda k, a: None, (3, 4, 5), 0, "actions have shape ()"),
        (lambda k, a: a.astype(str), (3, 4, 5), 0, "action has type <U"),
    ],
)
def test_what_a_controller_does_wrong_is_told_with_episode_and_interval(
    act, seeds, interval, words
):
    with pytest.raises(ControllerFailed) as caught:
        rollout(Own(act), "heading_calm", seeds=[3, 4, 5], overrides=SHORT)
    failed = caught.value
    assert (failed.controller, failed.seeds, failed.interval) == ("own", seeds, interval)
    several = "episodes 3 to 5" if len(seeds) > 1 else "episode 4"
    assert str(failed).startswith(f"controller own, {several}, interval") and words in str(failed)
    assert "\n" not in str(failed) and isinstance(failed, ConfigError)
    again = pickle.loads(pickle.dumps(failed))
    assert (str(again), again.seeds) == (str(failed), seeds)


def raised(error):
    def reset():
        raise error

    return reset


def test_a_reset_that_raises_is_told_and_one_that_refuses_says_so_itself():
    with pytest.raises(ControllerFailed, match=r"own, episode 3, reset: KeyError: 'gain'"):
        rollout(Own(None, raised(KeyError("gain"))), "heading_calm", seeds=[3], overrides=SHORT)
    with pytest.raises(ControllerRefused, match=r"^own: no gains for this ship$"):
        refusing = Own(None, raised(ConfigError("own: no gains for this ship")))
        rollout(refusing, "heading_calm", seeds=[3], overrides=SHORT)


def test_an_interruption_is_nobodys_fault():
    with pytest.raises(KeyboardInterrupt):
        interrupted = Own(lambda k, a: raised(KeyboardInterrupt())())
        rollout(interrupted, "heading_calm", seeds=[3], overrides=SHORT)


def test_mean_time_of_a_decision_is_limited_for_each_row():
    now = [0.0]

    def takes(seconds):
        def act(k, actions):
            now[0] += seconds[min(k, len(seconds) - 1)]
            return actions

        return act

    def sail(seconds, n=2, allowed=1.0):
        guarded = Guarded(Own(takes(seconds)), range(n), allowed)
        guarded.reset(n, load_ship("kcs"), load_scenario("heading_calm"))
        for _ in range(6):
            guarded.act(np.zeros((n, 9)))
        return guarded

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ship_gym.evaluation.guard.time.perf_counter", lambda: now[0])
        assert sail([1.9]).seconds == pytest.approx([1.9] * 6)  # two rows: 0.95 s each
        sail([5.0, 0.1])  # the first one may load: the mean of three counts
        with pytest.raises(ControllerFailed, match="too slow: a decision takes more than 1 s") as e:
            sail([2.1])
        assert e.value.slow and e.value.seeds == (0, 1) and e.value.interval == 2
        with pytest.raises(ControllerFailed) as e:
            sail([0.1, 0.1, 0.1, 20.0])
        assert e.value.interval == 3
        sail([20.0], allowed=None)
