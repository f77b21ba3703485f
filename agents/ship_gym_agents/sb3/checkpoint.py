"""Checkpoints: everything that a run needs to go on, written whole or not at all."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.save_util import load_from_zip_file, save_to_zip_file

from ship_gym.config import ConfigError
from ship_gym.provenance import atomic_path
from ship_gym_agents.sb3.environments import form_env

_STATE = "state.json"
_REPLAY = "replay_buffer.pkl"


def save_checkpoint(model: BaseAlgorithm, folder: Path, counters: Mapping[str, Any]) -> None:
    """Write weights, optimiser, normaliser, price, counters and, if any, the replay buffer.

    Parameters
    ----------
    model : BaseAlgorithm
    folder : path
    counters : mapping
        Plain values that `load_checkpoint` gives back.
    """
    env = model.get_vec_normalize_env()
    statistics = {
        name: {"mean": rms.mean.tolist(), "var": rms.var.tolist(), "count": float(rms.count)}
        for name, rms in (("obs_rms", env.obs_rms), ("ret_rms", env.ret_rms))
    }
    state = {**counters, **statistics, "samples": model.num_timesteps}
    state["price"] = form_env(env).price.state()
    _, tensors = model._get_torch_save_params()
    with atomic_path(folder / "model.zip") as temporary:
        save_to_zip_file(
            temporary,
            params=model.get_parameters(),
            pytorch_variables={name: getattr(model, name) for name in tensors},
        )
        with zipfile.ZipFile(temporary, "a") as archive:
            archive.writestr(_STATE, json.dumps(state))
    if getattr(model, "replay_buffer", None) is not None:
        with atomic_path(folder / _REPLAY) as temporary:
            model.save_replay_buffer(temporary)


def load_checkpoint(model: BaseAlgorithm, folder: Path) -> dict[str, Any]:
    """Put a model where `save_checkpoint` left it; return the counters.

    The environments are not part of it: they begin new episodes.
    """
    file = folder / "model.zip"
    try:
        _, parameters, tensors = load_from_zip_file(file, load_data=False, device="cpu")
        with zipfile.ZipFile(file) as archive:
            state = json.loads(archive.read(_STATE))
        model.set_parameters(parameters, exact_match=True, device="cpu")
    except (OSError, ValueError, KeyError, RuntimeError, zipfile.BadZipFile) as error:
        raise ConfigError(f"{file}: not a checkpoint of this run, or damaged: {error}") from error
    for name, value in (tensors or {}).items():
        if value is not None:
            getattr(model, name).data = value.data
    env = model.get_vec_normalize_env()
    for name in ("obs_rms", "ret_rms"):
        rms, saved = getattr(env, name), state[name]
        rms.mean, rms.var = np.array(saved["mean"]), np.array(saved["var"])
        rms.count = saved["count"]
    form_env(env).price.restore(state["price"])
    model.num_timesteps = state["samples"]
    if getattr(model, "replay_buffer", None) is not None and (folder / _REPLAY).is_file():
        model.load_replay_buffer(folder / _REPLAY)
    return state
