"""Wrapper that records episodes of the native vector environment while it is used."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from ship_gym.envs.record_rerun import recording_of_base
from ship_gym.envs.recording_options import RecordingOptions
from ship_gym.envs.vector_base import VectorEnv, VectorWrapper
from ship_gym.envs.vector_env import ShipVectorEnv


class RecordRerunVector(VectorWrapper):
    """As `RecordRerun`, around a ``ShipVectorEnv``; ``make_vec(id, record=folder)`` is the same.

    Environments under other vector environments, such as ``SyncVectorEnv``, are wrapped one by one
    with `RecordRerun`, each with a folder or name of its own.

    Parameters
    ----------
    env : gymnasium.vector.VectorEnv
    folder : path-like
    **options
        Those of `RecordRerun`. Numbers count the episodes of all environments together, those that
        begin together by the index of the environment; it stands in the file name.
    """

    def __init__(self, env: VectorEnv, folder: str | os.PathLike, **options: Any):
        super().__init__(env)
        made = RecordingOptions.from_option({"folder": folder, **options})
        self._recording = recording_of_base(env.unwrapped, ShipVectorEnv, made)

    @property
    def files(self) -> list[Path]:
        """Files of the episodes that are over, of "worst" the worst one last."""
        return [] if self._recording is None else self._recording.files

    def close(self, **kwargs: Any) -> None:
        """Close the recording, then the environment."""
        if self._recording is not None:
            self._recording.close()
        super().close(**kwargs)
