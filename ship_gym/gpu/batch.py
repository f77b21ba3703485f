"""n episodes that are sailed on the card, and the same on the CPU: what `ShipTorchEnv` drives.

The host's `EpisodeBatch` makes the episodes and begins new ones; on the card its arrays have
`Mirror` images, which a step changes and a reset writes row by row. The host's own rows are not
brought up to date in between.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.gpu.arrays import Mirror
from ship_gym.gpu.card import card, simulated
from ship_gym.gpu.kernels import ENDED, N_COUNTS, REFUSED, UNNAMED, Batch
from ship_gym.gpu.rows import SHARED, leaves

if TYPE_CHECKING:
    from ship_gym.envs.episodes import EpisodeBatch

_RESULTS = ("reward", "error", "power", "energy", "cost", "elapsed", "outcome", "success")
# what `ShipTorchEnv.tensor` shows: array of the batch, and field of its records
NAMES = {
    **{name: ("results", name) for name in (*_RESULTS, "terminated", "truncated")},
    "state": ("state", None),
    "commands": ("commands", None),
    "time": ("time", None),
    "waves": ("met", None),
    "forces": ("forces", None),
    "flow": ("flow", None),
    "reward_terms": ("terms", None),
    "observations": ("observations", None),
}


def batch_of(episodes: EpisodeBatch) -> Batch:
    """The arrays of the host."""
    loops = episodes._loops
    return Batch(loops.fleet, loops.episodes)


class HostBatch:
    """Episodes on the CPU: tensors are views of the arrays of the `EpisodeBatch`."""

    def __init__(self, episodes: EpisodeBatch, torch: Any):
        self._episodes, self._torch = episodes, torch
        self._arrays = dict(leaves(batch_of(episodes)))

    def step(self, actions: Any) -> bool:
        """Sail one interval under actions (n, n_actions); whether an episode has ended."""
        episodes = self._episodes
        episodes.step(actions.numpy())
        return bool(episodes.terminated.any() or episodes.truncated.any())

    def upload(self, which: np.ndarray) -> None:
        """New episodes have begun: they are where they should be."""

    def tensor(self, name: str) -> Any:
        """Present values by a name of `NAMES`, without a copy."""
        array, field = NAMES[name]
        host = self._arrays[array]
        return self._torch.from_numpy(host if field is None else host[field])


class CardBatch:
    """Episodes on the card.

    Parameters
    ----------
    episodes : EpisodeBatch
        Begun; its arrays are copied to the card.
    torch : module
    device : torch.device
        Of type cuda.
    """

    def __init__(self, episodes: EpisodeBatch, torch: Any, device: Any):
        self._cuda = card(str(device), device.index or 0)
        from ship_gym.gpu.threads import THREADS, kernel_of

        self._torch, self._index, self._task = torch, device.index or 0, episodes.task
        self._memory = torch.device("cpu") if simulated() else device
        batch, made = batch_of(episodes), (self._cuda, torch, self._memory)
        self._mirrors: dict[str, Mirror] = {}
        values = []
        with self._cuda.gpus[self._index]:
            for name, value in leaves(batch):
                if not isinstance(value, np.ndarray):
                    values.append(value)
                elif name in SHARED:
                    values.append(self._cuda.to_device(value))
                else:
                    self._mirrors[name] = Mirror(value, *made)
                    values.append(self._mirrors[name].kernel)
            self._counts = Mirror(np.zeros(N_COUNTS, dtype=np.int32), *made)
        self._values = tuple(values)
        self._ordered, self._counted = self.tensor_of("actions"), self._counts.tensor()
        self._n, self._threads = episodes.n, min(THREADS, episodes.n)
        self._sail = kernel_of(episodes.task, batch)

    def step(self, actions: Any) -> bool:
        """Sail one interval under actions (n, n_actions); whether an episode has ended.

        Some counts come to the host, nothing else.

        Raises
        ------
        ConfigError
            An action that is not finite; the other ships have sailed then, so reset. An outcome
            that the task does not name.
        """
        self._ordered.copy_(actions)
        self._counted.zero_()
        blocks = math.ceil(self._n / self._threads)
        with self._cuda.gpus[self._index]:
            launch = self._sail[(blocks, self._threads, *self._stream())]
            launch(self._values, self._n, self._counts.kernel)
        counts = self._counted.tolist()
        if counts[REFUSED]:
            self._refuse(actions)
        if counts[UNNAMED]:
            known = ", ".join(outcome.name for outcome in self._task.all_outcomes)
            raise ConfigError(
                f"task {self._task.name!r}: its kernel gives an outcome beyond those named: {known}"
            )
        return counts[ENDED] > 0

    def upload(self, which: np.ndarray) -> None:
        """New episodes have begun on the host: bring their rows (numbers, shape (m,)) here."""
        places = self._torch.from_numpy(which).to(self._memory)
        for mirror in self._mirrors.values():
            mirror.upload(which, places)

    def tensor(self, name: str) -> Any:
        """Present values by a name of `NAMES`, without a copy."""
        return self.tensor_of(*NAMES[name])

    def tensor_of(self, array: str, field: str | None = None) -> Any:
        """An array of the batch, or a field of its records, as a tensor of its memory."""
        return self._mirrors[array].tensor(field)

    def _stream(self) -> tuple[Any, ...]:
        """Torch's present stream for a launch, so that both work in one order."""
        if simulated():
            return ()
        number = self._torch.cuda.current_stream(self._memory).cuda_stream
        return (self._cuda.external_stream(number),) if number else ()

    def _refuse(self, actions: Any) -> None:
        bad = self._torch.isfinite(actions).all(dim=1).logical_not()
        row = int(bad.nonzero()[0, 0])
        raise ConfigError(f"action {row} = {actions[row].tolist()}: must be finite, in [-1, 1]")
