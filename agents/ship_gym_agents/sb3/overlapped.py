"""PPO of stable-baselines3 that sails the next rollout while it learns from the last one.

The rollouts are sailed on a thread of their own: the kernels of the ships and the operations of
torch both leave Python's lock alone, so that two cores do two things at once. Rollout k + 1 is
sailed by the weights that also sailed, or began to learn from, nothing later than rollout k - 1:
a lag of one rollout, whatever the machine. The numbers therefore do not depend on how the two
threads happen to run, and a machine of one core gets the same ones, one after the other.
"""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.distributions import DiagGaussianDistribution
from stable_baselines3.common.utils import explained_variance

from ship_gym.config import ConfigError

# A thread that wants Python's lock asks for it after this time [s]; by default after 5 ms, in
# which the other one can sail ten intervals.
_SWITCH = 2e-4


@dataclasses.dataclass
class Rollout:
    """What was recorded in one rollout.

    Attributes
    ----------
    buffer : RolloutBuffer
        Without values and advantages yet: the critic gives them when learning begins.
    log_std : Tensor
        Logarithm of the standard deviation of the actions (n_actions,).
    last_observations : array
        (n, n_observations), after the last step.
    last_dones : array
        (n,) bool, of the last step.
    ended : list of dict
        Of each step, the infos of the episodes that ended with it, by environment.
    """

    buffer: RolloutBuffer
    log_std: torch.Tensor
    last_observations: np.ndarray
    last_dones: np.ndarray
    ended: list[dict[int, dict[str, Any]]] = dataclasses.field(default_factory=list)

    def cut_off(self) -> tuple[list[int], list[int], list[np.ndarray]]:
        """Step, environment and last observation of the episodes that ended by time alone."""
        found = [
            (k, i, info["terminal_observation"])
            for k, infos in enumerate(self.ended)
            for i, info in infos.items()
            if info.get("TimeLimit.truncated", False)
        ]
        steps, envs, last = zip(*found, strict=True) if found else ((), (), ())
        return list(steps), list(envs), list(last)


class OverlappedPPO(PPO):
    """PPO with Gaussian actions, whose sailing and learning overlap.

    The loss is that of stable-baselines3's PPO. Values are computed once for a whole rollout, a
    rollout is shuffled once per epoch, and Adam updates all weights in one operation. Callbacks
    run on the caller's thread, those of single steps after their rollout, so that they meet no
    rollout under way.

    Parameters
    ----------
    overlap : bool
        False: a rollout is sailed by the weights that all earlier rollouts have taught.
    threaded : bool, optional
        Whether the overlap uses a second thread; None: where there is a second core. Same numbers.
    **options
        As ``stable_baselines3.PPO``; neither state-dependent exploration nor ``target_kl`` nor
        ``clip_range_vf``.

    Raises
    ------
    ConfigError
        An option or an action space that this class does not have.
    """

    def __init__(
        self, *args: Any, overlap: bool = True, threaded: bool | None = None, **options: Any
    ):
        for name in ("use_sde", "target_kl", "clip_range_vf", "rollout_buffer_class"):
            if options.get(name):
                raise ConfigError(f"{name} = {options[name]!r}: OverlappedPPO does not have it")
        self.overlap = overlap
        self.threaded = cores() > 1 if threaded is None else threaded
        self._sailing_noise, self._shuffling = torch.Generator(), torch.Generator()
        network = dict(options.pop("policy_kwargs", None) or {})
        network.setdefault("optimizer_kwargs", {"eps": 1e-5, "fused": True})
        super().__init__(*args, policy_kwargs=network, **options)

    def _setup_model(self) -> None:
        super()._setup_model()
        if not isinstance(self.policy.action_dist, DiagGaussianDistribution):
            raise ConfigError(f"{self.action_space}: OverlappedPPO takes Gaussian actions only")
        self._sailor = copy.deepcopy(self.policy)  # sails, while the policy itself learns
        self._sailor.optimizer = None

    def set_random_seed(self, seed: int | None = None) -> None:
        """As stable-baselines3; also what is drawn in sailing and in shuffling."""
        super().set_random_seed(seed)
        if seed is not None:
            self._sailing_noise.manual_seed(seed)
            self._shuffling.manual_seed(seed + 1)

    def _excluded_save_params(self) -> list[str]:
        return [*super()._excluded_save_params(), "_sailor", "_sailing_noise", "_shuffling"]

    def learn(
        self,
        total_timesteps: int,
        callback: Any = None,
        log_interval: int = 1,
        tb_log_name: str = "PPO",
        reset_num_timesteps: bool = True,
        progress_bar: bool = False,
    ) -> OverlappedPPO:
        """As stable-baselines3."""
        total, callback = self._setup_learn(
            total_timesteps, callback, reset_num_timesteps, tb_log_name, progress_bar
        )
        callback.on_training_start(locals(), globals())
        with _second_thread(self.overlap and self.threaded) as begin:
            following = self._depart(begin, callback) if self.num_timesteps < total else None
            iteration = 0
            while following is not None:
                rollout, following = following.result(), None
                if not self._arrive(rollout, callback):
                    break
                iteration += 1
                self._update_current_progress_remaining(self.num_timesteps, total)
                if log_interval is not None and iteration % log_interval == 0:
                    self.dump_logs(iteration)
                more = self.num_timesteps < total
                if more and self.overlap:
                    following = self._depart(begin, callback)
                self.learn_from(rollout)
                if more and not self.overlap:
                    following = self._depart(begin, callback)
        callback.on_training_end()
        return self

    def _depart(self, begin: Callable[..., Future], callback: BaseCallback) -> Future:
        """Begin a rollout with the weights as they are now."""
        callback.on_rollout_start()
        self._sailor.load_state_dict(self.policy.state_dict())
        return begin(self.sail)

    def sail(self) -> Rollout:
        """One rollout by the sailing copy of the policy; touches nothing that learning touches."""
        env, sailor = self.env, self._sailor
        buffer = RolloutBuffer(
            self.n_steps, self.observation_space, self.action_space, "cpu", self.gae_lambda,
            self.gamma, self.n_envs,
        )  # fmt: skip
        log_std = sailor.log_std.detach().clone()
        noise = torch.randn(buffer.actions.shape, generator=self._sailing_noise)
        away = (noise * log_std.exp()).numpy()
        rollout = Rollout(buffer, log_std, self._last_obs, self._last_episode_starts)
        for k in range(self.n_steps):
            buffer.observations[k] = rollout.last_observations
            buffer.episode_starts[k] = rollout.last_dones
            actions = buffer.actions[k]
            np.add(mean_action(sailor, rollout.last_observations), away[k], out=actions)
            seen, rewards, dones, infos = env.step(
                np.clip(actions, self.action_space.low, self.action_space.high)
            )
            buffer.rewards[k] = rewards
            rollout.ended.append({int(i): infos[i] for i in np.flatnonzero(dones)})
            rollout.last_observations, rollout.last_dones = seen, dones
        density = -0.5 * noise**2 - log_std - 0.5 * np.log(2.0 * np.pi)
        buffer.log_probs[:] = density.sum(-1).numpy()
        buffer.pos, buffer.full = self.n_steps, True
        self._last_obs, self._last_episode_starts = seen, dones
        return rollout

    def _arrive(self, rollout: Rollout, callback: BaseCallback) -> bool:
        """Count the steps of a rollout and tell the callbacks; False: one of them wants to stop."""
        dones = [*rollout.buffer.episode_starts[1:].astype(bool), rollout.last_dones]
        for k, ended in enumerate(rollout.ended):
            self.num_timesteps += self.n_envs
            infos = [ended.get(i, {}) for i in range(self.n_envs)]
            callback.update_locals(
                {"infos": infos, "dones": dones[k], "rewards": rollout.buffer.rewards[k]}
            )
            if not callback.on_step():
                return False
            self._update_info_buffer(list(ended.values()), np.ones(len(ended), dtype=bool))
        callback.on_rollout_end()
        return True

    def learn_from(self, rollout: Rollout) -> None:
        """Set the values and advantages of a rollout and learn from it."""
        buffer = self.rollout_buffer = rollout.buffer
        self.policy.set_training_mode(False)
        with torch.no_grad():
            flat = buffer.observations.reshape(-1, *buffer.obs_shape)
            buffer.values[:] = self._values(flat).reshape(buffer.values.shape)
            steps, envs, last = rollout.cut_off()
            if steps:
                buffer.rewards[steps, envs] += self.gamma * self._values(np.stack(last))
            after = torch.from_numpy(self._values(rollout.last_observations))
        buffer.compute_returns_and_advantage(after, rollout.last_dones)
        with self._explored(rollout.log_std):
            self.train()

    def _values(self, observations: np.ndarray) -> np.ndarray:
        return self.policy.predict_values(torch.from_numpy(observations))[:, 0].numpy()

    @contextlib.contextmanager
    def _explored(self, log_std: torch.Tensor) -> Iterator[None]:
        """A width of exploration that is set, not learned, is that of the rollout."""
        own = self.policy.log_std
        if own.requires_grad:
            yield
            return
        now = own.detach().clone()
        own.copy_(log_std)
        yield
        own.copy_(now)

    def train(self) -> None:
        """Learn from ``rollout_buffer``: all epochs, in minibatches."""
        self.policy.set_training_mode(True)
        self._update_learning_rate(self.policy.optimizer)
        clip = self.clip_range(self._current_progress_remaining)
        data = _flat(self.rollout_buffer)
        count = len(data["advantages"])
        for _ in range(self.n_epochs):
            order = torch.randperm(count, generator=self._shuffling)
            mixed = {name: values[order] for name, values in data.items()}
            logs = [
                self._step({name: v[i : i + self.batch_size] for name, v in mixed.items()}, clip)
                for i in range(0, count, self.batch_size)
            ]
        self._n_updates += self.n_epochs
        self._log(logs, clip)

    def _step(self, batch: dict[str, torch.Tensor], clip: float) -> dict[str, torch.Tensor]:
        """One step of Adam on the loss of a minibatch; its parts, for the log."""
        policy = self.policy
        values, log_prob, entropy = policy.evaluate_actions(batch["observations"], batch["actions"])
        advantages = batch["advantages"]
        if self.normalize_advantage and len(advantages) > 1:
            advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
        log_ratio = log_prob - batch["log_probs"]
        ratio = log_ratio.exp()
        gain = torch.min(advantages * ratio, advantages * ratio.clamp(1.0 - clip, 1.0 + clip))
        value_loss = torch.nn.functional.mse_loss(values[:, 0], batch["returns"])
        entropy_loss = -entropy.mean()
        loss = -gain.mean() + self.ent_coef * entropy_loss + self.vf_coef * value_loss
        policy.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(policy.parameters(), self.max_grad_norm)
        policy.optimizer.step()
        with torch.no_grad():
            return {
                "loss": loss.detach(),
                "policy_gradient_loss": -gain.detach().mean(),
                "value_loss": value_loss.detach(),
                "entropy_loss": entropy_loss.detach(),
                "approx_kl": (ratio - 1.0 - log_ratio).mean(),
                "clip_fraction": ((ratio - 1.0).abs() > clip).float().mean(),
            }

    def _log(self, logs: list[dict[str, torch.Tensor]], clip: float) -> None:
        """Record means over the minibatches of the last epoch."""
        for name in logs[0]:
            self.logger.record(f"train/{name}", float(np.mean([log[name].item() for log in logs])))
        buffer = self.rollout_buffer
        explained = explained_variance(buffer.values.flatten(), buffer.returns.flatten())
        self.logger.record("train/explained_variance", explained)
        self.logger.record("train/std", self.policy.log_std.detach().exp().mean().item())
        self.logger.record("train/n_updates", self._n_updates, exclude="tensorboard")
        self.logger.record("train/clip_range", clip)


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


def _flat(buffer: RolloutBuffer) -> dict[str, torch.Tensor]:
    """Tensors of a rollout, all steps and environments in one row."""
    names = ("observations", "actions", "log_probs", "advantages", "returns")
    arrays = {name: getattr(buffer, name) for name in names}
    return {
        name: torch.from_numpy(array.reshape(-1, *array.shape[2:]))
        for name, array in arrays.items()
    }


@contextlib.contextmanager
def _second_thread(wanted: bool) -> Iterator[Callable[..., Future]]:
    """A function that begins another one on a second thread, or does it at once."""
    if not wanted:
        yield _at_once
        return
    before = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH)
    try:
        with ThreadPoolExecutor(1, "sailing") as pool:
            yield pool.submit
    finally:
        sys.setswitchinterval(before)


def _at_once(function: Callable[[], Any]) -> Future:
    done: Future = Future()
    done.set_result(function())
    return done
