"""Sail episodes under one controller in one batch, with noise on its actions."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from ship_gym.envs.flat_info import flat
from ship_gym.evaluation.controller import Controller
from ship_gym.evaluation.guard import Guarded
from ship_gym.evaluation.rollout import begin
from ship_gym_agents.datasets.action_noise import action_noise

CLEAN = "controller_action"  # key of the infos: what the controller asked for, before the noise
_ROWS = 400_000  # intervals of all episodes that are held at once, some 200 MB with infos

Progress = Callable[[Iterable, str], Iterable]


@dataclasses.dataclass(frozen=True, eq=False)
class Episode:
    """One episode of T control intervals.

    Attributes
    ----------
    seed : int
        Of ``reset``.
    observations : numpy.ndarray
        float32 (T+1, columns); the last row is that after the last interval.
    actions : numpy.ndarray
        float32 (T, n_actions), within [-1, 1]: what was given to the environment, noise included.
    rewards, terminations, truncations : numpy.ndarray
        (T,), float64 and bool.
    infos : dict of numpy.ndarray
        By the keys of flat infos, each (T+1, ...); row 0 is the reset's. `CLEAN` of row k + 1
        belongs to action k.
    outcome : int
        Index of the task's outcomes.
    """

    seed: int
    observations: np.ndarray
    actions: np.ndarray
    rewards: np.ndarray
    terminations: np.ndarray
    truncations: np.ndarray
    infos: dict[str, np.ndarray]
    outcome: int

    def __len__(self) -> int:
        """Return the number of control intervals."""
        return len(self.rewards)


def batches(seeds: Sequence[int], steps: int) -> list[Sequence[int]]:
    """The seeds in portions whose histories find room."""
    size = max(1, _ROWS // steps)
    return [seeds[k : k + size] for k in range(0, len(seeds), size)]


def sail(
    controller: Controller,
    seeds: Sequence[int],
    env: dict[str, Any],
    std: float = 0.0,
    memory: float = 0.0,
    infos: bool = True,
    progress: Callable[[Iterable], Iterable] = iter,
) -> list[Episode]:
    """Sail one episode for each seed, all in one batch.

    The environment gets what is stored: controller's action and noise, limited to [-1, 1] and
    rounded to float32. So ``env.reset(seed=seed)`` and the stored actions give the same episode,
    bit for bit.

    Parameters
    ----------
    controller : Controller
    seeds : sequence of int
    env : dict
        As ``rollout.begin`` takes it.
    std, memory : float
        Of the noise, see ``action_noise``.
    infos : bool
        Whether infos are kept.
    progress : callable
        Wraps the iterable of control intervals.
    """
    batch = begin(seeds, **env)
    if hasattr(controller, "seeds"):  # random actions are fixed by them
        controller.seeds = tuple(seeds)
    steps, n = batch.scenario.steps, batch.n
    guarded = Guarded(controller, seeds)
    guarded.reset(n, batch.ship, batch.scenario)
    noise = action_noise(seeds, steps, batch.n_actions, std, memory)
    everyone, lengths, outcomes = np.ones(n, bool), np.full(n, steps), np.zeros(n, np.int64)
    seen, done = [batch.observations.copy()], []
    kept = [_infos(batch, everyone, np.zeros((n, batch.n_actions)))] if infos else []
    ended = np.zeros(n, dtype=bool)
    for k in progress(range(steps)):
        clean = np.clip(guarded.act(batch.observations), -1.0, 1.0)
        actions = np.clip(clean + noise[k], -1.0, 1.0).astype(np.float32)
        batch.step(actions)
        seen.append(batch.observations.copy())
        flags = batch.terminated.copy(), batch.truncated.copy()
        done.append((actions, batch.rewards.copy(), *flags))
        if infos:
            kept.append(_infos(batch, everyone, clean))
        new = ~ended & (flags[0] | flags[1])
        lengths[new], outcomes[new] = k + 1, batch.outcomes[new]
        ended |= new
        if ended.all():
            break
    return _cut(seeds, lengths, outcomes, seen, done, kept)


def _infos(batch: Any, everyone: np.ndarray, clean: np.ndarray) -> dict[str, np.ndarray]:
    """Arrays (n, ...) of a batch by the keys of flat infos."""
    found = flat(batch.info(everyone))
    return {key: value for key, value in found.items() if key[0] != "_"} | {CLEAN: clean}


def _cut(
    seeds: Sequence[int],
    lengths: np.ndarray,
    outcomes: np.ndarray,
    seen: list[np.ndarray],
    done: Sequence[tuple[np.ndarray, ...]],
    kept: list[dict[str, np.ndarray]],
) -> list[Episode]:
    """Episodes from the histories of a batch, each to its end."""
    seen_all = np.stack(seen)
    actions, rewards, terminations, truncations = map(np.stack, zip(*done, strict=True))
    infos = {key: np.stack([one[key] for one in kept]) for key in (kept[0] if kept else ())}
    return [
        Episode(
            int(seed),
            seen_all[: length + 1, i].copy(),
            actions[:length, i].copy(),
            rewards[:length, i].copy(),
            terminations[:length, i].copy(),
            truncations[:length, i].copy(),
            {key: values[: length + 1, i].copy() for key, values in infos.items()},
            int(outcome),
        )
        for i, (seed, length, outcome) in enumerate(
            zip(seeds, lengths.tolist(), outcomes.tolist(), strict=True)
        )
    ]
