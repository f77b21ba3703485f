"""Checkpoints: everything that a run needs to go on, written whole or not at all.

Reading one runs no code that it may hold: weights and optimisers are read by torch's reader of
plain tensors (``weights_only``), the rest is JSON and arrays.
"""

from __future__ import annotations

import io
import json
import pickle
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.save_util import save_to_zip_file

from ship_gym.config import ConfigError, shown
from ship_gym.keys import Keys
from ship_gym.reading import check_array, check_unpacked, parsed_json, read_as, read_bytes
from ship_gym.writing import atomic_path
from ship_gym_agents.sb3.environments import form_env
from ship_gym_agents.sb3.replay_file import load_replay, save_replay

_MODEL, _STATE = "model.zip", "state.json"
_VARIABLES = "pytorch_variables"  # member of what is no network, such as SAC's entropy coefficient
_MOST = 1 << 33  # [bytes] of all weights and optimisers


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
    with atomic_path(folder / _MODEL) as temporary:
        save_to_zip_file(
            temporary,
            params=model.get_parameters(),
            pytorch_variables={name: getattr(model, name) for name in tensors},
        )
        with zipfile.ZipFile(temporary, "a") as archive:
            archive.writestr(_STATE, json.dumps(state))
    if getattr(model, "replay_buffer", None) is not None:
        save_replay(model.replay_buffer, folder)


def load_checkpoint(model: BaseAlgorithm, folder: Path) -> dict[str, Any]:
    """Put a model where `save_checkpoint` left it; return the counters.

    The environments are not part of it: they begin new episodes.

    Raises
    ------
    ConfigError
        Not a checkpoint of this run, damaged, with numbers that are not finite, or a replay buffer
        as a pickle, which is not read.
    """
    file = folder / _MODEL
    found, state = read_model(file)
    variables = found.pop(_VARIABLES, None) or {}
    _check_finite({**found, _VARIABLES: variables}, file)
    _check_state(state, model, file)
    with read_as(file, "a checkpoint of this run"):
        model.set_parameters(found, exact_match=True, device="cpu")
        _put_variables(model, variables)
        _check_optimisers(model)
    env = model.get_vec_normalize_env()
    for name in ("obs_rms", "ret_rms"):
        rms, saved = getattr(env, name), state[name]
        rms.mean, rms.var = np.array(saved["mean"]), np.array(saved["var"])
        rms.count = saved["count"]
    form_env(env).price.restore(state["price"])
    model.num_timesteps = state["samples"]
    buffer = getattr(model, "replay_buffer", None)
    if buffer is not None and not load_replay(buffer, folder):
        warnings.warn(f"{folder}: no replay buffer; it is filled anew", stacklevel=2)
    return state


def read_model(file: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Plain tensors of the parts of a model by their names, and the state; nothing is checked.

    Raises
    ------
    ConfigError
        Not such a file, damaged, or with anything else than numbers in it, which is not read.
    """
    data = read_bytes(file, _MOST)
    with read_as(file, "a checkpoint of this run"), zipfile.ZipFile(io.BytesIO(data)) as archive:
        check_unpacked(archive, _MOST)
        state = parsed_json(archive.read(_STATE), file)
        found = {}
        for name in archive.namelist():
            if name.endswith(".pth"):
                found[name.removesuffix(".pth")] = _plain_tensors(archive.read(name), name)
    if not isinstance(state, dict):
        raise ConfigError(f"{file}: {_STATE} = {shown(state)}: allowed is a mapping")
    return found, state


def _plain_tensors(data: bytes, name: str) -> Any:
    """Tensors in mappings and lists, as torch saves them; no other object is made."""
    try:
        return torch.load(io.BytesIO(data), map_location="cpu", weights_only=True)
    except pickle.UnpicklingError:  # torch's words advise to run it
        raise ValueError(f"{name} holds more than numbers, or is damaged") from None


def _check_finite(parts: Mapping[str, Any], file: Path) -> None:
    for name, value in _numbers(parts, ""):
        if not torch.isfinite(torch.as_tensor(value)).all():
            raise ConfigError(f"{file}: {name.lstrip('.')} is not finite")


def _numbers(values: Any, name: str) -> Iterator[tuple[str, torch.Tensor | float]]:
    """All tensors and numbers of nested mappings and lists, with their names."""
    if isinstance(values, torch.Tensor | float):
        yield name, values
    elif isinstance(values, Mapping):
        for key, value in values.items():
            yield from _numbers(value, f"{name}.{key}")
    elif isinstance(values, list | tuple):
        for k, value in enumerate(values):
            yield from _numbers(value, f"{name}.{k}")


def _put_variables(model: BaseAlgorithm, variables: Mapping[str, Any]) -> None:
    """Put tensors that belong to no network where the model has them."""
    _, names = model._get_torch_save_params()
    if not set(variables) <= set(names):
        raise ValueError(f"variables {sorted(variables)}: the model has {sorted(names)}")
    for name, value in variables.items():
        if value is None:
            continue
        there = getattr(model, name)
        if value.shape != there.shape or value.dtype != there.dtype:
            raise ValueError(f"{name} has shape {tuple(value.shape)}, not {tuple(there.shape)}")
        there.data = value.data


def _check_optimisers(model: BaseAlgorithm) -> None:
    """Refuse moments of another shape than their weights, which torch takes without a word."""
    names, _ = model._get_torch_save_params()
    for name in (name for name in names if name.endswith("optimizer")):
        optimiser = model
        for part in name.split("."):
            optimiser = getattr(optimiser, part)
        for weights, moments in optimiser.state.items():
            for key, moment in moments.items():
                if isinstance(moment, torch.Tensor) and moment.shape not in ((), weights.shape):
                    raise ValueError(f"{name}: {key} has shape {tuple(moment.shape)}")


def _check_state(state: dict[str, Any], model: BaseAlgorithm, file: Path) -> None:
    """Refuse counters, normaliser and price that are not as `save_checkpoint` writes them."""
    env, keys = model.get_vec_normalize_env(), Keys(state, str(file))
    if missing := sorted({"samples", "price", "obs_rms", "ret_rms"} - set(state)):
        raise ConfigError(f"{file}: {_STATE} has no {missing[0]!r}")
    keys.whole("samples", 0, (1 << 53) - 1)
    for name in ("obs_rms", "ret_rms"):
        _check_statistics(keys.table(name), np.shape(getattr(env, name).mean))
    price, wanted = keys.table("price"), form_env(env).price.state()
    if set(price.values) != set(wanted):
        raise ConfigError(f"{file}: price = {shown(price.values)}: needed are {sorted(wanted)}")
    for name in price.values:
        price.number(name, 0.0)


def _check_statistics(saved: Keys, shape: tuple[int, ...]) -> None:
    for key, low in (("mean", None), ("var", 0.0)):
        with read_as(saved.label(key), "numbers"):
            array = np.array(saved.value(key))
        check_array(saved.label(key), array, shape, *(() if low is None else (low,)))
    saved.number("count", 0.0, 1e18)
