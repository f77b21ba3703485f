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
from ship_gym.gpu.kernels import N_COUNTS, Failing, Fleet, Shared

if TYPE_CHECKING:
    from ship_gym.envs.episodes import EpisodeBatch

_RESULTS = ("reward", "error", "power", "energy", "cost", "elapsed", "outcome", "success")
NAMES = {
    **{name: ("results", name) for name in (*_RESULTS, "terminated", "truncated")},
    "state": ("states", None),
    "commands": ("commands", None),
    "time": ("times", None),
    "waves": ("met", None),
    "forces": ("forces", None),
    "flow": ("flow", None),
    "reward_terms": ("terms", None),
    "observations": ("observations", None),
}


def fleet_of(episodes: EpisodeBatch) -> Fleet:
    """Arrays of the host that belong to single ships."""
    sim = episodes.sim
    return Fleet(
        states=sim.state,
        before=episodes._before,
        commands=sim.commands,
        times=sim.time,
        clock=sim._clock,
        ships=sim.records,
        seas=sim.seas,
        waves=sim.water.waves,
        met=sim.waves,
        forces=sim.forces,
        flow=sim.flow,
        tasks=episodes.tasks,
        plans=episodes.plans,
        terms=episodes.terms,
        results=episodes._results,
        observations=episodes.observations,
        lost=episodes._diverged,
    )


def shared_of(episodes: EpisodeBatch) -> Shared:
    """Arrays of the host that all ships share."""
    sim = episodes.sim
    return Shared(
        open_water=sim._open_water,
        deflected=sim._deflected,
        groups=sim.water.groups,
        response=sim.water.response,
        winds=sim.water.winds,
        failed=episodes._failures,
        reached=episodes._aims,
    )


def failing_of(episodes: EpisodeBatch) -> Failing:
    """The failure of the scenario; without one it never begins."""
    failure = episodes.scenario.failure
    if not failure.any:
        return Failing(-1, 0.0, math.inf, 1.0)
    speed = math.inf if failure.propeller_speed is None else failure.propeller_speed
    bias = math.radians(failure.heading_bias_deg)
    return Failing(episodes._fails_at, bias, float(speed), float(failure.rudder_rate))


class HostBatch:
    """Episodes on the CPU: tensors are views of the arrays of the `EpisodeBatch`."""

    def __init__(self, episodes: EpisodeBatch, torch: Any):
        self._episodes, self._torch = episodes, torch

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
        array = getattr(fleet_of(self._episodes), array)
        return self._torch.from_numpy(array if field is None else array[field])


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
        from ship_gym.gpu.threads import THREADS, sail_all, settle_all

        self._torch, self._index = torch, device.index or 0
        self._memory = torch.device("cpu") if simulated() else device
        self._task = episodes.task
        made = (self._cuda, torch, self._memory)
        with self._cuda.gpus[self._index]:
            self._mirrors = Fleet(*(Mirror(a, *made) for a in fleet_of(episodes)))
            self._shared = Shared(*(self._cuda.to_device(a) for a in shared_of(episodes)))
            self._actions = Mirror(np.zeros((episodes.n, episodes.n_actions)), *made)
            self._counts = Mirror(np.zeros(N_COUNTS, dtype=np.int32), *made)
        self._ordered, self._counted = self._actions.tensor(), self._counts.tensor()
        self._fleet = Fleet(*(mirror.kernel for mirror in self._mirrors))
        self._failing = failing_of(episodes)
        self._blocks = math.ceil(episodes.n / THREADS)
        self._threads = min(THREADS, episodes.n)
        self._sail = sail_all
        self._settle = settle_all(episodes.task, episodes.scenario.privileged)

    def step(self, actions: Any) -> bool:
        """Sail one interval under actions (n, n_actions); whether an episode has ended.

        Three counts come to the host, nothing else.

        Raises
        ------
        ConfigError
            An action that is not finite; the other ships have sailed then, so reset. An outcome
            that the task does not name.
        """
        self._ordered.copy_(actions)
        self._counted.zero_()
        with self._cuda.gpus[self._index]:
            at = (self._blocks, self._threads, *self._stream())
            counts = self._counts.kernel
            self._sail[at](self._fleet, self._shared, self._actions.kernel, counts)
            self._settle[at](self._fleet, self._shared, self._failing, counts)
        ended, refused, unnamed = self._counted.tolist()
        if refused:
            self._refuse(actions)
        if unnamed:
            known = ", ".join(outcome.name for outcome in self._task.all_outcomes)
            raise ConfigError(
                f"task {self._task.name!r}: its kernel gives an outcome beyond those named: {known}"
            )
        return ended > 0

    def upload(self, which: np.ndarray) -> None:
        """New episodes have begun on the host: bring their rows (numbers, shape (m,)) here."""
        places = self._torch.from_numpy(which).to(self._memory)
        for mirror in self._mirrors:
            mirror.upload(which, places)

    def tensor(self, name: str) -> Any:
        """Present values by a name of `NAMES`, without a copy."""
        array, field = NAMES[name]
        return getattr(self._mirrors, array).tensor(field)

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
