"""PPO of stable-baselines3 that sails the next rollout while it learns from the last one.

Learning is done by a process of its own, on a second core. The next rollout is sailed at the same
time by the weights of before: a lag of one rollout, of which the loss takes account, see `Learner`.
The lag does not depend on the machine: on one core the same is done one after the other, with the
same numbers.
"""

from __future__ import annotations

import contextlib
import os
import time
from concurrent.futures import Future
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.distributions import DiagGaussianDistribution

from ship_gym.config import ConfigError
from ship_gym_agents.sb3.learner import Learner, Rollout, log_density, take_over
from ship_gym_agents.sb3.learner_process import Gone, LearnerProcess

# A run that ends sooner [s] has nothing from the second process, whose start takes that long.
_PATIENCE = 2.0
_REFUSED = ("use_sde", "target_kl", "clip_range_vf", "rollout_buffer_class")


class OverlappedPPO(PPO):
    """PPO with Gaussian actions, whose sailing and learning overlap.

    Parameters
    ----------
    overlap : bool
        False: a rollout is sailed by the weights that all earlier rollouts have taught, and
        everything is done in this process.
    second_core : bool, optional
        Whether the overlap uses a second process; None: where there is a second core. Same
        numbers.
    **options
        As ``stable_baselines3.PPO``; neither state-dependent exploration nor ``target_kl`` nor
        ``clip_range_vf``. Adam updates all weights in one operation, unless ``policy_kwargs`` has
        ``optimizer_kwargs``.

    Raises
    ------
    ConfigError
        An option, a device or an action space that this class does not have.
    """

    _last_obs: Any  # of stable-baselines3
    _last_episode_starts: Any

    def __init__(
        self, *args: Any, overlap: bool = True, second_core: bool | None = None, **options: Any
    ):
        for name in _REFUSED:
            if options.get(name):
                raise ConfigError(f"{name} = {options[name]!r}: OverlappedPPO does not have it")
        self.overlap = overlap
        self.second_core = cores() > 1 if second_core is None else second_core
        self.learned: dict[str, float] = {}  # what learning from the last rollout gave
        self.side_by_side = False  # whether that was done by the second process
        network = dict(options.pop("policy_kwargs", None) or {})
        network.setdefault("optimizer_kwargs", {"eps": 1e-5, "fused": True})
        super().__init__(*args, policy_kwargs=network, **{"device": "cpu", **options})

    def _setup_model(self) -> None:
        super()._setup_model()
        if self.device.type != "cpu":
            raise ConfigError(f"device = {self.device}: OverlappedPPO learns on 'cpu' only")
        if not isinstance(self.policy.action_dist, DiagGaussianDistribution):
            raise ConfigError(f"{self.action_space}: OverlappedPPO takes Gaussian actions only")

    def learn(
        self,
        total_timesteps: int,
        callback: Any = None,
        log_interval: int | None = 1,
        tb_log_name: str = "PPO",
        reset_num_timesteps: bool = True,
        progress_bar: bool = False,
    ) -> OverlappedPPO:
        """As stable-baselines3."""
        total, callback = self._setup_learn(
            total_timesteps, callback, reset_num_timesteps, tb_log_name, progress_bar
        )
        callback.on_training_start(locals(), globals())
        with _Helper(self.overlap and self.second_core) as helper:
            last: Rollout | None = None  # the rollout from which nothing has been learned yet
            iteration = 0
            while self.num_timesteps < total:
                callback.on_rollout_start()
                before = last and self._learner()
                started = helper.begin(before, last) if before and last else None
                following = self.sail(callback)
                if before and last:
                    self._learn_from(last, before, started)
                last = following
                if last is None:
                    break
                self._update_current_progress_remaining(self.num_timesteps, total)
                iteration += 1
                if log_interval is not None and iteration % log_interval == 0:
                    self.dump_logs(iteration)
                if not self.overlap:
                    self._learn_from(last, self._learner())
                    last = None
            if last:
                self._learn_from(last, self._learner())
        callback.on_training_end()
        return self

    def sail(self, callback: BaseCallback) -> Rollout | None:
        """One rollout by the weights as they are; None: the callback wants to stop.

        Of the infos of a step, callbacks get to see those of the episodes that ended with it.
        """
        policy, seen, dones = self.policy, self._last_obs, self._last_episode_starts
        policy.set_training_mode(False)
        buffer = RolloutBuffer(
            self.n_steps, self.observation_space, self.action_space, "cpu", self.gae_lambda,
            self.gamma, self.n_envs,
        )  # fmt: skip
        log_std = policy.log_std.detach().clone()
        noise = torch.randn(buffer.actions.shape)
        away = (noise * log_std.exp()).numpy()
        cut_off = []
        for k in range(self.n_steps):
            buffer.observations[k], buffer.episode_starts[k] = seen, dones
            buffer.actions[k] = mean_action(policy, seen) + away[k]
            low, high = self.action_space.low, self.action_space.high
            seen, rewards, dones, infos = self.env.step(np.clip(buffer.actions[k], low, high))
            buffer.rewards[k] = rewards
            self.num_timesteps += self.n_envs
            callback.update_locals({"infos": infos, "dones": dones, "rewards": rewards})
            if not callback.on_step():
                return None
            for i in np.flatnonzero(dones):
                self._update_info_buffer([infos[i]], dones[[i]])
                if infos[i].get("TimeLimit.truncated", False):
                    cut_off.append((k, int(i), infos[i]["terminal_observation"]))
        buffer.log_probs[:] = log_density(noise, log_std).numpy()
        buffer.pos, buffer.full = self.n_steps, True
        self._last_obs, self._last_episode_starts, self.rollout_buffer = seen, dones, buffer
        callback.on_rollout_end()
        return Rollout(buffer, log_std, seen, dones, cut_off)

    def _learner(self) -> Learner:
        """The policy as it is, and how it shall learn."""
        self._update_learning_rate(self.policy.optimizer)
        clip = self.clip_range(self._current_progress_remaining)
        return Learner(
            self.policy, self.n_epochs, self.batch_size, self.ent_coef, self.vf_coef,
            self.max_grad_norm, self.normalize_advantage, clip, int(torch.randint(2**62, ())),
            self.overlap,
        )  # fmt: skip

    def _learn_from(
        self, rollout: Rollout, learner: Learner, started: Future | None = None
    ) -> None:
        """Learn from a rollout, unless that has been started elsewhere, and record how it went."""
        found, self.side_by_side = None, started is not None
        if started is not None:
            with contextlib.suppress(Gone):
                policy, found = started.result()
                take_over(self.policy, policy)
        if found is None:
            found = learner.learn(rollout)
        self.learned = found
        self._n_updates += self.n_epochs
        std = self.policy.log_std.detach().exp().mean().item()
        for name, value in {**found, "std": std, "clip_range": learner.clip}.items():
            self.logger.record(f"train/{name}", value)
        self.logger.record("train/n_updates", self._n_updates, exclude="tensorboard")


class _Helper:
    """The second process, once a run has gone on for so long that it is worth its start."""

    def __init__(self, wanted: bool):
        self._wanted, self._since = wanted, time.monotonic()
        self._open = contextlib.ExitStack()
        self._process: LearnerProcess | None = None

    def __enter__(self) -> _Helper:
        return self

    def __exit__(self, *_: Any) -> None:
        self._open.close()

    def begin(self, learner: Learner, rollout: Rollout) -> Future | None:
        """Learning in the second process; None where it is not there, or not yet."""
        if self._process is None:
            if self._wanted and time.monotonic() - self._since > _PATIENCE:
                self._process = self._open.enter_context(LearnerProcess())
            return None
        return self._process.begin(learner, rollout) if self._process.ready else None


def mean_action(policy: Any, observations: np.ndarray) -> np.ndarray:
    """Mean action (n, n_actions) without the objects of a distribution, which cost more than it."""
    with torch.no_grad():
        features = policy.extract_features(torch.from_numpy(observations))
        if not policy.share_features_extractor:
            features = features[0]
        return policy.action_net(policy.mlp_extractor.forward_actor(features)).numpy()


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
