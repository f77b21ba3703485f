"""PPO that overlaps sailing and learning: the loss, the lag, the second process."""

from __future__ import annotations

import copy

import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="extra 'rl' not installed")

import torch
from ship_gym_agents.sb3 import overlapped
from ship_gym_agents.sb3.learner import Learner
from ship_gym_agents.sb3.learner_process import Gone, LearnerProcess
from ship_gym_agents.sb3.overlapped import OverlappedPPO, mean_action
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

from ship_gym.config import ConfigError

STEPS, ENVS = 8, 6


class Quiet(BaseCallback):
    """Does nothing, or stops after some steps."""

    def __init__(self, steps=10**9):
        super().__init__()
        self.steps = steps

    def _on_step(self):
        return self.n_calls < self.steps


class Weights(Quiet):
    """The weights at the beginning of each rollout."""

    def _on_training_start(self):
        self.seen = []

    def _on_rollout_start(self):
        self.seen.append(weights(self.model.policy))


def weights(policy):
    return torch.cat([p.detach().flatten() for p in policy.parameters()]).numpy().copy()


def make(duration=3.0, **given):
    env = ShipVecEnv(ENVS, overrides={"duration": duration})
    options = {"n_steps": STEPS, "batch_size": STEPS * ENVS, "n_epochs": 1, "second_core": False}
    network = {"net_arch": [8, 8]}
    return OverlappedPPO(
        "MlpPolicy", env, seed=3, policy_kwargs=network, learning_rate=1e-2, **{**options, **given}
    )


def sailed(model):
    _, callback = model._setup_learn(1, Quiet())
    return model.sail(callback)


def learner_of(model, **changes):
    options = {
        "policy": copy.deepcopy(model.policy),
        "n_epochs": model.n_epochs,
        "batch_size": model.batch_size,
        "ent_coef": model.ent_coef,
        "vf_coef": model.vf_coef,
        "max_grad_norm": model.max_grad_norm,
        "normalize_advantage": True,
        "clip": 0.2,
        "seed": 0,
        "lagging": False,
    }
    return Learner(**{**options, **changes})


def test_one_step_is_that_of_stable_baselines3():
    model = make(ent_coef=0.01, vf_coef=0.7, max_grad_norm=0.3)
    rollout = sailed(model)
    learner = learner_of(model)
    before = weights(model.policy)
    learner.learn(rollout)  # sets values and advantages, which PPO.train takes from the buffer
    model.rollout_buffer = rollout.buffer
    PPO.train(model)
    theirs = weights(model.policy)
    assert np.abs(theirs - before).max() > 1e-3
    np.testing.assert_allclose(weights(learner.policy), theirs, atol=2e-6)


def test_a_rollout_is_that_of_the_policy():
    model = make()
    rollout = sailed(model)
    buffer = rollout.buffer
    observations = torch.from_numpy(buffer.observations.reshape(-1, *buffer.obs_shape))
    actions = torch.from_numpy(buffer.actions.reshape(-1, buffer.action_dim))
    with torch.no_grad():
        values, log_probs, _ = model.policy.evaluate_actions(observations, actions)
    expected = log_probs.numpy().reshape(STEPS, ENVS)
    np.testing.assert_allclose(buffer.log_probs, expected, atol=1e-5)
    learner_of(model, n_epochs=1).learn(rollout)
    expected = values.numpy().reshape(STEPS, ENVS)
    np.testing.assert_allclose(buffer.values, expected, atol=1e-6)
    seen = buffer.observations[3]
    mean = model.predict(seen, deterministic=True)[0]
    np.testing.assert_allclose(mean_action(model.policy, seen), mean, atol=1e-6)


def test_an_episode_cut_off_by_time_counts_on_with_the_value_of_its_end():
    model = make(duration=4.0)  # 4 intervals
    rollout = sailed(model)
    assert {k for k, _, _ in rollout.cut_off} == {3, 7} and len(rollout.cut_off) == 2 * ENVS
    rewards = rollout.buffer.rewards.copy()
    learner_of(model)._judge(rollout)
    step, env, last = rollout.cut_off[1]
    value = model.policy.predict_values(torch.from_numpy(last[None])).item()
    added = rollout.buffer.rewards - rewards
    assert added[step, env] == pytest.approx(model.gamma * value, rel=1e-4)
    assert np.count_nonzero(added[[0, 1, 2, 4, 5, 6]]) == 0


def test_samples_of_other_weights_count_by_how_likely_they_are_now():
    model = make()
    rollout = sailed(model)
    learner = learner_of(model)
    before = rollout.buffer.log_probs.copy()
    assert learner._weigh(rollout.buffer).numpy() == pytest.approx(1.0, abs=1e-5)
    with torch.no_grad():
        learner.policy.action_net.bias += 0.3
    ratio = learner._weigh(rollout.buffer).numpy().reshape(before.shape)
    buffer = rollout.buffer
    mean = mean_action(model.policy, buffer.observations.reshape(-1, *buffer.obs_shape))
    noise = buffer.actions[..., 0] - mean.reshape(before.shape)  # standard deviation 1
    expected = np.exp(-0.5 * (noise - 0.3) ** 2 + 0.5 * noise**2)
    np.testing.assert_allclose(ratio, np.minimum(expected, 2.0), rtol=1e-4)
    assert ratio.max() > 1.2


def test_a_lagging_learner_of_weights_that_sailed_is_a_plain_one():
    found = []
    for lagging in (False, True):
        model = make(n_epochs=2, batch_size=16)
        rollout = sailed(model)
        learner = learner_of(model, lagging=lagging)
        learner.learn(rollout)
        found.append(weights(learner.policy))
    np.testing.assert_allclose(found[1], found[0], atol=1e-5)


def test_the_overlap_sails_by_the_weights_of_one_rollout_earlier():
    weights_of = {}
    for overlap in (True, False):
        callback = Weights()
        make(overlap=overlap).learn(4 * STEPS * ENVS, callback)
        weights_of[overlap] = callback.seen
    late, at_once = weights_of[True], weights_of[False]
    assert len(late) == len(at_once) == 4
    assert (late[0] == late[1]).all() and (late[1] != late[2]).any()
    assert (at_once[0] != at_once[1]).any()
    np.testing.assert_allclose(
        late[2], at_once[1], atol=1e-7
    )  # both have learned from the first only


def test_a_width_that_is_set_is_neither_learned_nor_mixed_up():
    model = make()
    model.policy.log_std.requires_grad_(False).fill_(-1.0)
    rollout = sailed(model)
    model.policy.log_std.fill_(-2.0)  # that of the next rollout
    learner = learner_of(model)
    found = learner.learn(rollout)
    assert learner.policy.log_std.item() == -2.0
    assert found["clip_fraction"] == 0.0 and abs(found["approx_kl"]) < 1e-6


def test_a_callback_stops_within_a_rollout():
    model = make()
    model.learn(10**6, Quiet(steps=STEPS + 3))
    assert model.num_timesteps == (STEPS + 3) * ENVS


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"use_sde": True}, "use_sde"),
        ({"target_kl": 0.1}, "target_kl"),
        ({"clip_range_vf": 0.2}, "clip_range_vf"),
    ],
)
def test_what_it_does_not_have_is_refused(options, said):
    with pytest.raises(ConfigError, match=said):
        make(**options)


def test_only_gaussian_actions():
    with pytest.raises(ConfigError, match="Gaussian"):
        OverlappedPPO("MlpPolicy", "CartPole-v1")


def test_saved_and_loaded(tmp_path):
    model = make()
    model.learn(STEPS * ENVS)
    model.save(tmp_path / "model")
    again = OverlappedPPO.load(tmp_path / "model", env=model.get_env())
    np.testing.assert_array_equal(weights(again.policy), weights(model.policy))
    again.learn(STEPS * ENVS)


@pytest.fixture
def second_process(monkeypatch):
    """A second process from the second rollout on, waited for."""

    def ready(self):
        return self._hello.result() == "hello"

    monkeypatch.setattr(overlapped, "_PATIENCE", 0.0)
    monkeypatch.setattr(LearnerProcess, "ready", property(ready))


@pytest.mark.slow
def test_the_second_process_gives_the_same_numbers_even_if_it_dies(second_process):
    class Killer(Quiet):
        def _on_rollout_start(self):
            if self.num_timesteps == 4 * STEPS * ENVS:
                assert self.model.side_by_side
                for process in running:
                    process._process.kill()

    running = []
    begin = LearnerProcess.__enter__

    def enter(self):
        running.append(self)
        return begin(self)

    found = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(LearnerProcess, "__enter__", enter)
        for second_core, callback in ((False, Quiet()), (True, Quiet()), (True, Killer())):
            model = make(second_core=second_core, n_epochs=3, batch_size=16)
            model.learn(7 * STEPS * ENVS, callback)
            found.append(weights(model.policy))
    assert len(running) == 2 and all(p._process.poll() is not None for p in running)
    np.testing.assert_array_equal(found[1], found[0])
    np.testing.assert_array_equal(found[2], found[0])


@pytest.mark.slow
def test_an_error_in_the_second_process_is_told():
    model = make()
    with LearnerProcess() as process:
        with pytest.raises(RuntimeError, match="TypeError"):
            process.begin(learner_of(model, batch_size="no_such"), sailed(model)).result()
        process._process.kill()
        with pytest.raises(Gone):
            process.begin(learner_of(model), sailed(model)).result()
