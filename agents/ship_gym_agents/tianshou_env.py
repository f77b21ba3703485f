"""ShipTianshouEnv: the native vector environment in the form that Tianshou takes.

Tianshou makes vectors of functions for single environments (``DummyVectorEnv``,
``SubprocVectorEnv``). This adapter gives its collectors one batch step for all ships instead.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
from tianshou.env.venvs import BaseVectorEnv

from ship_gym.config import ConfigError
from ship_gym.envs.vector_env import ShipVectorEnv

_FIXED = ("autoreset_mode", "copy", "info")
Ids = int | Sequence[int] | np.ndarray | None


class ShipTianshouEnv(BaseVectorEnv):
    """Tianshou's ``BaseVectorEnv`` over one ``ShipVectorEnv``.

    Gives what ``DummyVectorEnv`` over scalar ``ShipEnv`` gives, bit for bit, with these
    differences. The infos are empty: a collector copies each of them into its buffer; those of the
    last step are in `info`. A ship that is left out of a step sails on unseen with the middle of
    each action (an episode that ends so is begun anew, which uses up one of its seed) and must be
    reset before it is stepped again, as collectors do.

    Parameters
    ----------
    num_envs : int
        Number of ships.
    **options
        Of ``ShipVectorEnv``, without ``autoreset_mode``, ``copy`` and ``info``.

    Attributes
    ----------
    env : ShipVectorEnv
    info : dict
        Infos of all ships, as of the last step or reset, until the next.

    Raises
    ------
    ConfigError
        An option that the adapter sets itself, a ship that was left out, an attribute for some
        ships only.
    """

    def __init__(self, num_envs: int, **options: Any):
        # BaseVectorEnv's own __init__ makes workers, of which there is none
        if taken := [name for name in _FIXED if name in options]:
            raise ConfigError(f"{taken[0]} of ShipTianshouEnv: it is set by the adapter")
        self.env = ShipVectorEnv(num_envs, autoreset_mode="Disabled", copy=False, **options)
        self.env_num = self.wait_num = self.env.num_envs
        self.is_async, self.timeout = False, None
        self.waiting_id: list[int] = []
        self.ready_id = list(range(self.env_num))
        self.is_closed = False
        self.info: dict[str, Any] = {}
        space = self.env.single_action_space
        self._action_spaces = [copy.deepcopy(space) for _ in range(self.env_num)]
        self._actions = np.zeros((self.env_num, *(space.shape or ())), dtype=np.float32)
        self._ended = np.zeros(self.env_num, dtype=np.bool_)
        self._left_out = np.zeros(self.env_num, dtype=np.bool_)

    def reset(self, env_id: Ids = None, **kwargs: Any) -> tuple[np.ndarray, np.ndarray]:
        """Begin new episodes for some ships; observations (k, n_observations), k empty infos.

        A `seed` is that of ship 0, ship i has i more; `options` are those of ``ShipVectorEnv``.
        """
        self._assert_is_not_closed()
        ids = self._ids(env_id)
        mask = np.zeros(self.env_num, dtype=np.bool_)
        mask[ids] = True
        options = {**(kwargs.pop("options", None) or {}), "reset_mask": mask}
        seen, self.info = self.env.reset(options=options, **kwargs)
        self._ended[mask] = self._left_out[mask] = False
        return seen[ids], _empty(len(ids))

    def step(self, action: Any, id: Ids = None) -> tuple[np.ndarray, ...]:
        """Sail one interval; observations, rewards, terminated, truncated, infos of the ships `id`.

        Actions have shape (k, n_actions), in [-1, 1].
        """
        self._assert_is_not_closed()
        ids = self._ids(id)
        if self._left_out[ids].any():
            missed = np.asarray(ids)[self._left_out[ids]].tolist()
            raise ConfigError(f"ships {missed} were left out of a step: reset them before the next")
        others = np.ones(self.env_num, dtype=np.bool_)
        others[ids] = False
        if (over := others & self._ended).any():
            self.env.reset(options={"reset_mask": over})
        self._left_out |= others
        self._actions[:] = 0.0
        self._actions[ids] = action
        seen, rewards, terminated, truncated, self.info = self.env.step(self._actions)
        self._ended = terminated | truncated
        return seen[ids], rewards[ids], terminated[ids], truncated[ids], _empty(len(ids))

    def seed(self, seed: int | Sequence[int] | None = None) -> list[list[int] | None]:
        """Seed the ships, ship i with `seed` + i, and begin their episodes."""
        self._assert_is_not_closed()
        _, self.info = self.env.reset(seed=seed)
        self._ended[:] = self._left_out[:] = False
        seeds = self.env.np_random_seed
        for space, one in zip(self._action_spaces, seeds, strict=True):
            space.seed(one)
        return [None if one is None else [one] for one in seeds]

    def get_env_attr(self, key: str, id: Ids = None) -> list[Any]:
        """An attribute as a single environment has it, once for each ship."""
        self._assert_is_not_closed()
        if key == "action_space":
            return [self._action_spaces[i] for i in self._ids(id)]
        name = f"single_{key}" if key == "observation_space" else key
        return [getattr(self.env, name)] * len(self._ids(id))

    def set_env_attr(self, key: str, value: Any, id: Ids = None) -> None:
        """Set an attribute of the batch; only for all ships at once."""
        self._assert_is_not_closed()
        if sorted(self._ids(id)) != self.ready_id:
            raise ConfigError(
                f"cannot set {key!r} for ships {id}: they are one batch, leave out id"
            )
        setattr(self.env, key, value)

    def render(self, **kwargs: Any) -> list[np.ndarray]:
        """Picture of each ship, with ``render_mode="rgb_array"``."""
        self._assert_is_not_closed()
        return list(self.env.render())

    def close(self) -> None:
        """Release the ships."""
        self._assert_is_not_closed()
        self.env.close()
        self.is_closed = True

    def _ids(self, given: Ids) -> list[int] | np.ndarray:
        ids = self._wrap_id(given)
        return [int(i) for i in ids] if isinstance(ids, list) else np.asarray(ids)


def _empty(n: int) -> np.ndarray:
    """Infos as a collector takes them: objects, one dict for each ship."""
    return np.array([{} for _ in range(n)], dtype=object)
