"""ShipVecEnv: the native vector environment in the form that stable-baselines3 takes.

Stable-baselines3 does not accept a Gymnasium ``VectorEnv``. This adapter costs one batch step per
call instead of n scalar environments, builds no info for an episode that is still running, and
that of one that has ended only as far as somebody looks at it.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv

from ship_gym.config import ConfigError
from ship_gym.envs.info import Info
from ship_gym.envs.vector_env import ShipVectorEnv
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship


class ShipVecEnv(VecEnv):
    """stable-baselines3 ``VecEnv`` over one ``ShipVectorEnv``.

    Gives what ``DummyVecEnv`` over scalar ``ShipEnv`` gives, with two differences: the info of a
    running episode is empty, and that of an ended one also has ``episode`` (return ``r``, length
    ``l``, seconds since construction ``t``), so no ``VecMonitor`` is needed.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    stagger : bool
        Let the first episodes after a reset end early, at random times drawn from the seed. The
        environments are then spread over all phases of an episode; without it a short rollout
        sees n starts and the next n steady voyages.
    ship, control, surrogate, scenario, privileged, overrides, parallel, max_episode_steps
        As in ``ShipVectorEnv``; the autoreset mode is given by stable-baselines3.
    render_mode : str, optional
        ``"rgb_array"``: `render` gives one picture with those of all ships in rows, as
        ``VecVideoRecorder`` of stable-baselines3 takes it.
    """

    def __init__(
        self,
        num_envs: int,
        stagger: bool = False,
        ship: str | Ship | Sequence[str | Ship] | None = None,
        control: str | None = None,
        surrogate: str | None = None,
        scenario: str | Mapping[str, Any] | Scenario = "heading_keeping",
        privileged: bool | None = None,
        overrides: Mapping[str, Any] | None = None,
        parallel: bool | None = None,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
    ):
        self.env = ShipVectorEnv(
            num_envs,
            ship,
            control,
            surrogate,
            scenario,
            privileged,
            overrides,
            render_mode,
            autoreset_mode="SameStep",
            parallel=parallel,
            max_episode_steps=max_episode_steps,
        )
        self.stagger = stagger
        super().__init__(num_envs, self.env.single_observation_space, self.env.single_action_space)
        self.metadata["render_fps"] = self.env.metadata["render_fps"]
        self._actions = np.zeros((num_envs, *self.action_space.shape), dtype=np.float32)
        self._returns = np.zeros(num_envs)
        self._lengths = np.zeros(num_envs, dtype=np.int64)
        self._born = time.monotonic()
        self._told: tuple[str, ...] = ()  # names in the info of an ended episode

    def reset(self) -> np.ndarray:
        """Begin new episodes everywhere with the seeds of `seed`; float32 (n, n_observations)."""
        seeds = self._seeds if self._seeds[0] is not None else None
        observations, _ = self.env.reset(seed=seeds, options=self._options_for_all())
        if self.stagger:
            generator = np.random.default_rng(self._seeds[0])
            steps = self.env.scenario.steps
            self.env.episodes.elapsed[:] = generator.integers(0, steps, self.num_envs)
        self._reset_seeds()
        self._reset_options()
        self._returns[:], self._lengths[:] = 0.0, 0
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return observations

    def _options_for_all(self) -> dict[str, Any] | None:
        """Options of `set_options`, one dict for each environment, as the batch takes them."""
        names = {name for options in self._options for name in options}
        if any(set(options) != names for options in self._options):
            raise ConfigError(
                f"options {self._options}: all environments need the same names of options"
            )
        return {name: [options[name] for options in self._options] for name in names} or None

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions, shape (n, n_actions), for `step_wait`."""
        self._actions = np.asarray(actions, dtype=np.float32)

    def step_wait(self):
        """Sail one interval: observations, rewards (n,), dones (n,), infos [n dicts]."""
        observations, rewards, terminated, truncated, batch = self.env.step(self._actions)
        self._returns += rewards
        self._lengths += 1
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(dones):
            infos[i] = self._end_of_episode(int(i), batch)
            infos[i]["TimeLimit.truncated"] = bool(truncated[i] and not terminated[i])
        return observations, rewards.astype(np.float32), dones, infos

    def _end_of_episode(self, i: int, batch: dict[str, Any]) -> dict[str, Any]:
        """Info of the last interval, terminal observation and statistics; the counters restart."""
        final = batch["final_info"]
        if not self._told:
            self._told = tuple(name for name in final if not name.startswith("_"))
        info = Info(self._told, lambda name: _entry(final[name], i))
        info["terminal_observation"] = batch["final_obs"][i]
        info["episode"] = {
            "r": float(self._returns[i]),
            "l": int(self._lengths[i]),
            "t": round(time.monotonic() - self._born, 6),
        }
        self._returns[i], self._lengths[i] = 0.0, 0
        return info

    def close(self) -> None:
        """Release the environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices=None) -> list[Any]:
        """Attribute of the vector environment, once per index: all environments share it."""
        value = getattr(self.env, attr_name)
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices=None) -> None:
        """Set an attribute of the vector environment; only for all environments at once."""
        self._demand_all(indices, f"set {attr_name!r}")
        setattr(self.env, attr_name, value)

    def env_method(self, method_name: str, *method_args, indices=None, **method_kwargs):
        """Call a method of the vector environment once; its result, once per environment."""
        self._demand_all(indices, f"call {method_name!r}")
        if method_name in ("reset", "step", "close"):
            raise ConfigError(f"call {method_name!r} on ShipVecEnv itself, not by env_method")
        result = getattr(self.env, method_name)(*method_args, **method_kwargs)
        return [result] * self.num_envs

    def env_is_wrapped(self, wrapper_class: type, indices=None) -> list[bool]:
        """True for stable-baselines3's ``Monitor`` only, whose statistics the infos hold.

        ``evaluate_policy`` then takes the return of an episode from there, not from rewards that
        ``VecNormalize`` has scaled. No environment is wrapped: there is one batch.
        """
        return [wrapper_class is Monitor for _ in self._get_indices(indices)]

    def get_images(self) -> list[np.ndarray | None]:
        """Picture of each ship, uint8 (height, width, 3); without a render mode None for each.

        An episode that ended in the last step shows the start of the next.
        """
        return list(self.env.render()) if self.render_mode else [None] * self.num_envs

    def _demand_all(self, indices, what: str) -> None:
        if sorted(set(self._get_indices(indices))) != list(range(self.num_envs)):
            raise ConfigError(
                f"cannot {what} for environments {indices}: they are one batch, allowed is all "
                "of them (indices=None)"
            )


def _entry(value: Any, i: int) -> Any:
    """Row i of an entry of a batched info as plain values, as the scalar environment gives it."""
    if isinstance(value, dict):
        return {name: _entry(rows, i) for name, rows in value.items() if not name.startswith("_")}
    return value[i].copy() if value.ndim > 1 else value[i].item()
