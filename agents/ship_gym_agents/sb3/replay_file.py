"""The replay buffer of a run as one npz file: arrays alone, so that reading it runs no code.

stable-baselines3 pickles the whole buffer, and a pickle runs what it says. Here its arrays go into
an uncompressed archive, the filled rows of each, and come back into the arrays that the model has
already made: neither way is there a second buffer in memory.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.buffers import ReplayBuffer

from ship_gym.config import LARGEST, ConfigError, shown
from ship_gym.reading import read_as
from ship_gym.writing import atomic_path

REPLAY_FILE = "replay_buffer.npz"
PICKLE = "replay_buffer.pkl"  # as versions until 0.1 wrote it
_ARRAYS = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")
# Besides the arrays: next row to write; whether all rows have been written; whether an end by time
# counts as none; whether the next observations are in the array of observations.
_FACTS = ("pos", "full", "handle_timeout_termination", "optimize_memory_usage")
_PIECE = 1 << 22  # [bytes] that are read at once


def save_replay(buffer: ReplayBuffer, folder: Path) -> None:
    """Write the filled rows of a buffer into a folder, whole or not at all."""
    rows = buffer.size()
    if buffer.optimize_memory_usage:  # the row behind the last holds its next observation
        rows = min(rows + 1, buffer.buffer_size)
    arrays = {name: getattr(buffer, name)[:rows] for name in _present(buffer)}
    arrays["facts"] = np.array([int(getattr(buffer, name)) for name in _FACTS])
    with atomic_path(folder / REPLAY_FILE) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays)


def load_replay(buffer: ReplayBuffer, folder: Path) -> bool:
    """Fill the empty buffer of a model with what `save_replay` wrote; False if there is nothing.

    Raises
    ------
    ConfigError
        A pickle of an earlier version; or a file that is damaged, of another shape or type than
        the model's buffer, or with numbers that are not finite.
    """
    file = folder / REPLAY_FILE
    if not file.is_file():
        if (folder / PICKLE).is_file():
            raise ConfigError(
                f"{folder / PICKLE}: a pickle of an earlier version, not read since it may hold "
                "code; remove it to go on with an empty replay buffer"
            )
        return False
    with read_as(file, "a replay buffer"), zipfile.ZipFile(file) as archive:
        facts = _facts(archive, file, buffer)
        rows = buffer.buffer_size if facts["full"] else facts["pos"]
        if buffer.optimize_memory_usage:
            rows = min(rows + 1, buffer.buffer_size)
        for name in _present(buffer):
            _fill(archive, name, getattr(buffer, name)[:rows], file)
    buffer.pos, buffer.full = facts["pos"], bool(facts["full"])
    return True


def _present(buffer: ReplayBuffer) -> list[str]:
    return [name for name in _ARRAYS if getattr(buffer, name, None) is not None]


def _facts(archive: zipfile.ZipFile, file: Path, buffer: ReplayBuffer) -> dict[str, int]:
    """Numbers beside the arrays, those that do not change the same as the buffer's."""
    found = np.zeros(len(_FACTS), dtype=np.int64)
    _fill(archive, "facts", found, file)
    facts = dict(zip(_FACTS, found.tolist(), strict=True))
    highest = {"pos": buffer.buffer_size - 1}
    for name, value in facts.items():
        if not 0 <= value <= highest.get(name, 1):
            raise ConfigError(f"{file}: {name} = {value}: allowed is 0 to {highest.get(name, 1)}")
    for name in _FACTS[2:]:
        if facts[name] != int(getattr(buffer, name)):
            raise ConfigError(f"{file}: {name} = {facts[name]}: the run has {1 - facts[name]}")
    return facts


def _fill(archive: zipfile.ZipFile, name: str, array: np.ndarray, file: Path) -> None:
    """Read one array of an archive into `array`, piece by piece."""
    opened: Any = archive.open(f"{name}.npy")  # whose `readinto` typeshed does not know
    with opened as member:
        version = np.lib.format.read_magic(member)
        read_header = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        shape, by_columns, dtype = read_header(member)
        if (shape, dtype) != (array.shape, array.dtype) or (by_columns and array.ndim > 1):
            raise ConfigError(
                f"{file}: {name} is {dtype} of shape {shown(shape)}: the run needs "
                f"{array.dtype} of shape {array.shape}"
            )
        bare: Any = array
        view = memoryview(bare).cast("B") if array.size else memoryview(b"")
        for start in range(0, len(view), _PIECE):
            piece = view[start : start + _PIECE]
            if member.readinto(piece) != len(piece):
                raise ValueError(f"{name} ends too early")
        if member.read(1):
            raise ValueError(f"{name} is longer than its shape says")
    _check(name, array, file)


def _check(name: str, array: np.ndarray, file: Path) -> None:
    """Refuse numbers that are not finite or, of flags, not 0 or 1."""
    low, high = (0.0, 1.0) if name in ("dones", "timeouts") else (-LARGEST, LARGEST)
    if array.dtype.kind == "f" and array.size:
        least, most = array.min(), array.max()
        if not low <= least <= most <= high:  # false for nan, too
            raise ConfigError(
                f"{file}: {name} reaches {least:g} to {most:g}: allowed is {low:g} to {high:g}"
            )
