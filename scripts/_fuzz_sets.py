"""Data sets of Minari, as ``ship-gym dataset`` writes them: one to begin with, edits, a reading."""

from __future__ import annotations

import contextlib
import multiprocessing
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from _fuzz_mutate import changed_or_bytes, pick
from _fuzz_seeds import Seed
from _fuzz_use import Nonsense
from _fuzz_values import odd, scaled

_METADATA, _ARRAYS = "data/metadata.json", "data/main_data.hdf5"


def sets() -> Iterator[Seed]:
    """A set of few short episodes, made in a process of its own; read by its metadata or arrays."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as apart:
        files = apart.submit(_written).result()
    for first in (_METADATA, _ARRAYS):
        yield Seed(Path(first).stem, {first: files[first], **files})


def _written() -> dict[str, bytes]:
    from ship_gym_agents.datasets import Plan, scores, write_set

    scores.EPISODES = 2  # of the reference scores
    plan = Plan(("pid",), (0.0, 0.1), episodes=1, env={"overrides": {"duration": 20.0}})
    with tempfile.TemporaryDirectory() as folder:
        path = write_set(plan, folder, "fuzz/set-v0").path
        return {name: (path / name).read_bytes() for name in (_METADATA, _ARRAYS, "card.json")}


def use(path: Path, **_: Any) -> None:
    """Read it, pick a controller's episodes, make its environment, and look at every episode.

    Minari reads the episodes, where the user asks for them: what it then raises is its own, but it
    must not hang, die or take all memory.
    """
    from ship_gym_agents.datasets import read_set, select

    folder = path.parents[1]
    dataset = read_set(folder)
    picked = select(dataset, controller="pid")
    if not 0 < len(picked.episode_indices) <= len(dataset.episode_indices):
        raise Nonsense("other episodes than there are")
    dataset.recover_environment().close()
    with contextlib.suppress(Exception):
        for episode in dataset:
            len(episode)


def hdf5_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """An array, attribute or group changed, renamed or left out; or other bytes."""
    return changed_or_bytes(rng, data, _changed)


def _changed(rng: np.random.Generator, data: bytes) -> bytes:
    import h5py

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.hdf5"
        path.write_bytes(data)
        with h5py.File(path, "a") as opened:
            names: list[str] = []
            opened.visit(names.append)
            _edit(rng, opened, pick(rng, sorted(names)))
        return path.read_bytes()


def _edit(rng: np.random.Generator, opened: Any, name: str) -> None:
    import h5py

    one, how = opened[name], rng.random()
    if how < 0.12:
        del opened[name]
    elif how < 0.24:
        opened.move(name, pick(rng, (name + "x", "episode_7", "episode_0/actions/a", "\u00e9")))
    elif how < 0.3:  # a door to another file
        del opened[name]
        opened[name] = h5py.ExternalLink("/etc/passwd", "/x")
    elif how < 0.6 and len(one.attrs):
        key = pick(rng, sorted(one.attrs))
        one.attrs[key] = pick(rng, (odd(rng), -1, 1e300, b"\xff", np.zeros(0), "pid"))
    elif isinstance(one, h5py.Dataset):
        values = _values(rng, one[()])
        del opened[name]
        opened[name] = values
    else:
        opened.copy(one, pick(rng, ("episode_9", "infos", "episode_1/observations/a")))


def _values(rng: np.random.Generator, values: np.ndarray) -> np.ndarray:
    how = rng.integers(5)
    if how == 0:
        return values[: int(rng.integers(len(values) + 1))] if values.ndim else values
    if how == 1:
        return np.repeat(values[None], 3, axis=0)
    if how == 2:
        return values.astype(pick(rng, ("f8", "i1", "S3", "c16")))
    values = np.array(values, dtype=float)
    if how == 3 and values.size:
        values.flat[0] = pick(rng, (np.nan, np.inf, -1e300))
        return values
    return values * scaled(rng, 1.0)
