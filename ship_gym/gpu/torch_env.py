"""ShipTorchEnv: n environments whose observations and actions are torch tensors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.envs.vector_env import ShipVectorEnv
from ship_gym.gpu.batch import NAMES, CardBatch, HostBatch
from ship_gym.gpu.card import card, torch_of

if TYPE_CHECKING:
    import torch

    from ship_gym.scenarios.scenario import Scenario
    from ship_gym.ships.particulars import Ship


class ShipTorchEnv:
    """Ships that sail where the learner is: on the CPU, or all of them on a graphics card.

    On a card each ship is a thread that runs the same kernels as the CPU in float64, and everything
    of a step stays on the card, but for one count: whether an episode has ended. New episodes are
    drawn by the host, with the numbers that `ShipVectorEnv` draws, and their rows go to the card.
    Observations, rewards and flags are tensors of the very memory that the kernels write: a step or
    reset changes them in place, so clone what must stay.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    device : str or torch.device
        ``"cpu"``, ``"cuda"`` or ``"cuda:1"``.
    ship, control, surrogate, scenario, privileged, overrides, parallel, max_episode_steps
        As in ``ShipVectorEnv``; `parallel` is for the CPU.
    autoreset : bool
        An episode that ends is begun anew within the same step (``"SameStep"`` of Gymnasium);
        False: call ``reset(mask=...)``.

    Attributes
    ----------
    single_observation_space, single_action_space, observation_space, action_space
        Of Gymnasium.
    scenario : Scenario
    ships : list of Ship
        The ship of each environment.

    Raises
    ------
    ConfigError
        What a card needs and is not there: torch built for CUDA, numba-cuda, a driver, the card.
    """

    def __init__(
        self,
        num_envs: int = 1,
        device: str | torch.device = "cpu",
        ship: str | Ship | Sequence[str | Ship] | None = None,
        control: str | None = None,
        surrogate: str | None = None,
        scenario: str | Mapping[str, Any] | Scenario | None = None,
        privileged: bool | None = None,
        overrides: Mapping[str, Any] | None = None,
        autoreset: bool = True,
        parallel: bool | None = None,
        max_episode_steps: int | None = None,
    ):
        self._torch = torch_of(str(device))
        self.device = _device(self._torch, device)
        if self.device.type == "cuda":
            card(str(self.device), self.device.index or 0)  # refuse before anything is made
        self._host = ShipVectorEnv(
            num_envs, ship, control, surrogate, scenario, privileged, overrides,
            autoreset_mode="Disabled", parallel=parallel, max_episode_steps=max_episode_steps,
        )  # fmt: skip
        host = self._host
        self.num_envs, self.scenario, self.ships = host.num_envs, host.scenario, host.ships
        self.single_observation_space = host.single_observation_space
        self.single_action_space = host.single_action_space
        self.observation_space, self.action_space = host.observation_space, host.action_space
        self.autoreset = autoreset
        self._batch: HostBatch | CardBatch | None = None

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
        mask: torch.Tensor | None = None,
    ) -> tuple[torch.Tensor, dict[str, torch.Tensor]]:
        """Begin new episodes, in all environments or those of a mask.

        Parameters
        ----------
        seed : int or sequence, optional
            Environment i uses the stream seed + i.
        options : dict, optional
            As in ``ShipVectorEnv.reset``.
        mask : torch.Tensor, optional
            bool, shape (num_envs,).

        Returns
        -------
        observations : torch.Tensor
            float32, shape (num_envs, n).
        info : dict
            Empty.
        """
        which = np.ones(self.num_envs, dtype=np.bool_)
        if mask is not None:
            which = mask.cpu().numpy()
            options = {**(options or {}), "reset_mask": which}
        self._host.reset(seed=seed, options=options)
        if self._batch is None:
            self._batch = self._made()
        else:
            self._batch.upload(np.flatnonzero(which))
        return self.tensor("observations"), {}

    def step(
        self, actions: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor, torch.Tensor, dict[str, torch.Tensor]]:
        """Sail one control interval in every environment.

        Parameters
        ----------
        actions : torch.Tensor
            Floats in [-1, 1] on `device`, shape (num_envs, n_actions).

        Returns
        -------
        observations : torch.Tensor
            float32, shape (num_envs, n); with `autoreset` the first of a new episode where one has
            ended.
        rewards : torch.Tensor
            float64, shape (num_envs,).
        terminated, truncated : torch.Tensor
            bool, shape (num_envs,).
        info : dict
            With `autoreset`, where an episode has ended, ``final_obs``, the last observations of
            all environments, of which those count whose episode has ended. `tensor` has the rest.
        """
        batch = self._begun()
        info: dict[str, Any] = {}
        flags = [self.tensor(name) for name in ("reward", "terminated", "truncated")]
        if batch.step(self._checked(actions)) and self.autoreset:
            flags = [flag.clone() for flag in flags]  # a reset writes over them
            info["final_obs"] = self.tensor("observations").clone()
            self.reset(mask=flags[1] | flags[2])
        return (self.tensor("observations"), *flags, info)

    def tensor(self, name: str) -> torch.Tensor:
        """Present values of all environments, without a copy.

        Parameters
        ----------
        name : str
            Shape (num_envs,): ``reward``, ``terminated``, ``truncated``, ``error`` (in the unit of
            the task), ``power`` [W], ``energy`` [J], ``cost``, ``elapsed`` (intervals),
            ``outcome``, ``success``, ``time`` [s]. ``observations``; ``state``
            (``conventions.STATE_NAMES``), ``commands``, ``waves``, ``forces``, ``flow`` and
            ``reward_terms`` as ``ShipSim`` and ``EpisodeBatch`` have them.
        """
        return self._begun().tensor(check_known("tensor", name, NAMES))

    def close(self) -> None:
        """Nothing is open: Gymnasium's users call it."""

    def _begun(self) -> HostBatch | CardBatch:
        if self._batch is None:
            raise ConfigError("step before reset: call reset first")
        return self._batch

    def _made(self) -> HostBatch | CardBatch:
        if self.device.type == "cpu":
            return HostBatch(self._host.episodes, self._torch)
        return CardBatch(self._host.episodes, self._torch, self.device)

    def _checked(self, actions: Any) -> Any:
        """Actions without their gradient, else ConfigError."""
        if not isinstance(actions, self._torch.Tensor):
            raise ConfigError(f"actions are {type(actions).__name__}: must be a torch.Tensor")
        shape = self.action_space.shape
        if tuple(actions.shape) != shape:
            raise ConfigError(f"actions have shape {tuple(actions.shape)}, allowed is {shape}")
        if not actions.dtype.is_floating_point:
            raise ConfigError(f"actions have type {actions.dtype}, allowed are floats in [-1, 1]")
        where = self.tensor("reward").device
        if actions.device != where:
            raise ConfigError(f"actions are on {actions.device}, the ships on {where}")
        return actions.detach()


def _device(torch: Any, device: Any) -> Any:
    """The device, cpu or cuda."""
    try:
        found = torch.device(device)
    except (RuntimeError, TypeError):
        found = None
    if found is None or found.type not in ("cpu", "cuda"):
        raise ConfigError(f"device = {device!r}: allowed are 'cpu', 'cuda' and 'cuda:0' and so on")
    return found
