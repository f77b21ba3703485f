"""ShipVectorEnv: n episodes in one batch, the native vector environment."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ship_gym.config import ConfigError, check_number
from ship_gym.envs.env import (
    Given,
    action_space,
    observation_space,
    recording_of,
    resolved_fleet,
    with_steps,
)
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.flat_info import flat, is_flat
from ship_gym.envs.start_options import start_options
from ship_gym.envs.streams import Streams
from ship_gym.envs.vector_base import AutoresetMode, VectorEnv, batch_space
from ship_gym.envs.view import Screen, check_render_mode, offered_modes
from ship_gym.scenarios.scenario import Scenario
from ship_gym.ships.particulars import Ship

Stepped = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]  # of `step`

_RENDER_MODES = ("rgb_array",)  # a viewer shows one ship


class ShipVectorEnv(VectorEnv):
    """Vector environment that steps all ships in one compiled loop, whatever the id.

    Bit for bit the same as ``gymnasium.vector.SyncVectorEnv`` over ``ShipEnv``: environment i of
    seed s uses the stream s + i.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    ship : str, Ship or sequence of them
        As in ``ShipEnv``. Of several (a mixed fleet), environment i sails number i modulo their
        number; all of them the same scenario.
    control, surrogate, scenario, privileged, overrides, render_mode
        As in ``ShipEnv``; the render mode is ``"rgb_array"`` or None.
    autoreset_mode : str or gymnasium.vector.AutoresetMode
        ``"NextStep"`` (default), ``"SameStep"`` (``final_obs``, ``final_info`` in info) or
        ``"Disabled"`` (reset with ``options={"reset_mask": mask}``).
    parallel : bool, optional
        Threads or not; None: from 1024 environments on. Same numbers.
    max_episode_steps : int, optional
        Control intervals of an episode, instead of what the scenario's duration says.
    copy : bool
        Whether observations, rewards and infos stay as they are. If False they are the batch's own
        arrays, which the next step or reset overwrites (an info counts when it is looked at).
    record, info
        As in ``ShipEnv``.
    """

    metadata = {  # noqa: RUF012  Gymnasium's own form
        "render_modes": list(_RENDER_MODES),
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    _recording: Any = None  # also of one that `__init__` refuses: gymnasium closes it too

    def __init__(
        self,
        num_envs: int = 1,
        ship: Given | Sequence[str | Ship] = None,
        control: str | None = None,
        surrogate: str | None = None,
        scenario: str | Mapping[str, Any] | Scenario | None = None,
        privileged: bool | None = None,
        overrides: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        parallel: bool | None = None,
        max_episode_steps: int | None = None,
        copy: bool = True,
        record: str | os.PathLike | Mapping[str, Any] | None = None,
        info: str = "nested",
    ):
        super().__init__()
        self._copy, self._flat = bool(copy), is_flat(info)
        check_render_mode(render_mode, _RENDER_MODES)
        self.num_envs = int(check_number("num_envs", num_envs, 1, 10**7))
        if self.num_envs != num_envs:
            raise ConfigError(f"num_envs = {num_envs}: must be a whole number")
        self.render_mode = render_mode
        self.autoreset_mode = _mode(autoreset_mode)
        self.metadata = {
            **self.metadata,
            "render_modes": offered_modes(_RENDER_MODES),
            "autoreset_mode": self.autoreset_mode,
        }
        options = (control, surrogate, privileged, overrides)
        scenario = "heading_keeping" if scenario is None else scenario
        resolved, given = resolved_fleet(scenario, ship, *options)
        self.scenario = with_steps(resolved, max_episode_steps, overrides)
        self.episodes = EpisodeBatch(self.num_envs, self.scenario, given, parallel)
        self.single_observation_space = observation_space(self.scenario)
        self.single_action_space = action_space(self.scenario)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._streams = Streams(self.num_envs)
        self._ended = np.zeros(self.num_envs, dtype=np.bool_)
        self._everyone = np.ones(self.num_envs, dtype=np.bool_)
        shown = range(self.num_envs)
        self._screens = [Screen(render_mode, self.episodes, i) for i in shown if render_mode]
        self._recording = None if record is None else recording_of(record, self)

    @property
    def ship(self) -> Ship:
        """The ship that sails in every environment; of a mixed fleet a ConfigError."""
        return self.episodes.ship

    @property
    def ships(self) -> list[Ship]:
        """The ship of each environment."""
        return self.episodes.ships

    @property  # type: ignore[misc]  # has no setter: each environment is seeded by `reset`
    def np_random(self) -> tuple[np.random.Generator | None, ...]:  # type: ignore[override]
        """Generator of each environment as it is now, a copy; None before the first reset."""
        return self._streams.generators()

    @property
    def np_random_seed(self) -> tuple[int | None, ...]:  # type: ignore[override]
        """Seed of each environment, seed + i; None before the first reset."""
        return tuple(self._streams.seeds)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin new episodes, in all environments or those of ``options["reset_mask"]``.

        The other options are those of ``ShipEnv.reset``, one value for all or one for each.
        """
        given = start_options(options, self.num_envs, also=("reset_mask",))
        mask = self._reset_mask(options)
        self._streams.seed(self._seeds(seed), mask)
        self._begin(mask, given)
        return self._seen(), self._infos(mask)

    def step(self, actions: Any) -> Stepped:
        """Sail one control interval in every environment, with resets as the mode says."""
        if self.autoreset_mode is AutoresetMode.NEXT_STEP:
            return self._next_step(actions)
        return self._plain_step(actions)

    def render(self) -> tuple[np.ndarray, ...]:
        """Pictures of all environments, each uint8 (height, width, 3)."""
        if not self._screens:
            raise ConfigError(
                "render without a render mode: make the environments with render_mode='rgb_array'"
            )
        pictures = [screen.picture() for screen in self._screens]
        return tuple(picture for picture in pictures if picture is not None)

    def elevation(self, x: Any, y: Any, t: Any = None, index: int = 0) -> np.ndarray:
        """Elevation of the sea of an environment at places and times [m], ``ShipSim.elevation``."""
        return self.episodes.sim.elevation(x, y, t, index)

    def origin(self, index: int) -> tuple[int | None, int]:
        """Seed of the stream of an environment and resets after it, as ``ShipEnv.origin``."""
        return self._streams.seeds[index], int(self._streams.begun[index]) - 1

    def close_extras(self, **kwargs: Any) -> None:
        """Close the recording, if there is one."""
        if self._recording is not None:
            self._recording.close()

    def _follow(self) -> None:
        for screen in self._screens:
            screen.follow()

    def _next_step(self, actions: Any) -> Stepped:
        """An episode that has ended is reset by the next step, whose action is not used."""
        episodes, ended = self.episodes, self._ended
        if ended.any():
            actions = np.where(ended[:, None], 0.0, actions)
        episodes.step(actions)
        self._follow()
        if ended.any():
            self._begin(ended)
        terminated, truncated = episodes.terminated.copy(), episodes.truncated.copy()
        self._ended = terminated | truncated
        rewards = episodes.rewards.copy() if self._copy else episodes.rewards
        return self._seen(), rewards, terminated, truncated, self._infos(self._everyone)

    def _plain_step(self, actions: Any) -> Stepped:
        """Step; in SAME_STEP mode an episode that ends is reset at once, its end kept in info."""
        episodes = self.episodes
        if self.autoreset_mode is AutoresetMode.DISABLED and self._ended.any():
            raise ConfigError(
                f"episodes {np.flatnonzero(self._ended).tolist()} have ended: reset them with "
                "options={'reset_mask': mask} before the next step"
            )
        episodes.step(actions)
        self._follow()
        terminated, truncated = episodes.terminated.copy(), episodes.truncated.copy()
        ended = terminated | truncated
        begins = self.autoreset_mode is AutoresetMode.SAME_STEP and ended.any()
        rewards = episodes.rewards.copy() if self._copy or begins else episodes.rewards
        final: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.DISABLED:
            self._ended = ended
        elif begins:
            final = self._final_infos(ended)
            self._begin(ended)
        infos = self._infos(self._everyone)
        infos.update(final)
        return self._seen(), rewards, terminated, truncated, infos

    def _begin(self, mask: np.ndarray, given: Mapping[str, np.ndarray] | None = None) -> None:
        which = np.flatnonzero(mask)
        draws = self._streams.random(which, self.episodes.n_draws)
        given = {name: values[which] for name, values in (given or {}).items()}
        self.episodes.start(which, draws, given)
        self._ended[which] = False
        if self._screens:
            for i in which:
                self._screens[i].begin()

    def _seeds(self, seed: Any) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer) and not isinstance(seed, bool) and seed >= 0:
            return [int(seed) + i for i in range(self.num_envs)]
        if not isinstance(seed, Sequence | np.ndarray):
            raise ConfigError(
                f"seed = {seed!r}: must be a whole number or one for each environment"
            )
        if np.ndim(seed) != 1:
            raise ConfigError(
                f"seeds of shape {np.shape(seed)} given for {self.num_envs} environments: allowed "
                f"is one whole number, or ({self.num_envs},) of them"
            )
        if len(seed) != self.num_envs:
            raise ConfigError(f"{len(seed)} seeds given for {self.num_envs} environments")
        seeds = list(seed)
        for one in seeds:
            whole = isinstance(one, int | np.integer) and not isinstance(one, bool)
            if one is not None and not (whole and one >= 0):
                raise ConfigError(f"seed {one!r}: must be a whole number from 0 on, or None")
        return [None if one is None else int(one) for one in seeds]

    def _reset_mask(self, options: dict[str, Any] | None) -> np.ndarray:
        if not options or "reset_mask" not in options:
            return self._everyone
        mask = np.asarray(options["reset_mask"])
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise ConfigError(
                f"options['reset_mask'] has shape {mask.shape}, type {mask.dtype}: allowed is a "
                f"bool array of shape ({self.num_envs},) with at least one True"
            )
        return mask

    def _seen(self) -> np.ndarray:
        observations = self.episodes.observations
        return observations.copy() if self._copy else observations

    def _infos(self, mask: np.ndarray, copy: bool | None = None) -> dict[str, Any]:
        info = self.episodes.info(mask.copy(), self._copy if copy is None else copy)
        return flat(info) if self._flat else info

    def _final_infos(self, ended: np.ndarray) -> dict[str, Any]:
        final = np.full(self.num_envs, None, dtype=object)
        for i in np.flatnonzero(ended):
            final[i] = self.episodes.observations[i].copy()
        return {
            "final_obs": final,
            "_final_obs": ended.copy(),
            "final_info": self._infos(ended, copy=True),  # the reset that follows is not seen
            "_final_info": ended.copy(),
        }


def _mode(mode: str | AutoresetMode) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError:
        allowed = ", ".join(repr(m.value) for m in AutoresetMode)
        raise ConfigError(f"autoreset_mode = {mode!r}: allowed is {allowed}") from None
