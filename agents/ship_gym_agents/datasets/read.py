"""Read a data set of Minari that Ship Gym has written: from disk only, and no code of it is run."""

from __future__ import annotations

import os
from pathlib import Path

import minari
import numpy as np
from minari.dataset.minari_storage import METADATA_FILE_NAME

from ship_gym.config import ConfigError, check_known, shown
from ship_gym.keys import Keys, read_keys
from ship_gym.reading import parsed_json, read_as
from ship_gym_agents.datasets.minari_set import KWARGS, checked_id, is_set, usual_folder

_ENTRY = "ship_gym.envs.classes:"  # of the environments of all tasks
_VECTOR = "ship_gym.envs.vector_env:ShipVectorEnv"


def load_set(name: str, folder: str | os.PathLike | None = None) -> minari.MinariDataset:
    """A data set by its id, from the folder where ``ship-gym dataset`` writes.

    Nothing comes from the network. Minari makes whatever environment a set names where
    ``recover_environment`` is called, and where the set has no spaces already when it is read;
    here only environments of Ship Gym are let through.

    Parameters
    ----------
    name : str
        Such as ``"ShipGym/HeadingKeeping/pid-kcs-v0"``.
    folder : path-like, optional
        Of all data sets; `usual_folder` if omitted.

    Raises
    ------
    ConfigError
        There is none of that name, with the nearest one; or it is none of Ship Gym.
    """
    folder = usual_folder() if folder is None else Path(folder)
    path = folder / checked_id(name)
    if not is_set(path):
        check_known(f"data set in {folder}", name, sets_in(folder))
    return read_set(path)


def sets_in(folder: Path) -> list[str]:
    """Ids of the data sets in a folder."""
    found = folder.rglob(f"data/{METADATA_FILE_NAME}")
    names = [one.parents[1].relative_to(folder).as_posix() for one in found]
    return sorted(name for name in names if "/." not in f"/{name}")  # those are not whole


def read_set(path: str | os.PathLike) -> minari.MinariDataset:
    """As `load_set`, by the folder of the set itself."""
    data = Path(path) / "data"
    file = data / METADATA_FILE_NAME
    _check(read_keys(file))
    with read_as(data, "a data set of Minari"):
        dataset = minari.MinariDataset(data)
        list(dataset.storage.get_episode_metadata(dataset.episode_indices[[0, -1]]))
    return dataset


def _check(told: Keys) -> None:
    """Refuse metadata that lack what Minari needs, or name an environment that is not ours."""
    for key in ("dataset_id", "observation_space", "action_space"):
        told.text(key)
    for word in told.items("requirements", []):
        if not isinstance(word, str):
            raise ConfigError(f"{told.where}: requirements has {shown(word)}: allowed are texts")
    told.known("data_format", ["hdf5"])
    told.known("minari_version", minari.supported_dataset_versions)
    for key in ("env_spec", "eval_env_spec"):
        if key == "env_spec" or key in told.values:
            _check_spec(Keys(parsed_json(told.text(key), told.where), told.where, key))


def _check_spec(spec: Keys) -> None:
    entry, vector = spec.text("entry_point"), spec.value("vector_entry_point", None)
    if not entry.startswith(_ENTRY) or vector not in (None, _VECTOR):
        what = shown(entry if vector in (None, _VECTOR) else vector)
        raise ConfigError(f"{spec.where}: {spec.name} makes {what}, no environment of Ship Gym")
    if spec.value("additional_wrappers", []):
        raise ConfigError(f"{spec.where}: {spec.name} has wrappers; allowed are none")
    for key in spec.table("kwargs").values:
        check_known(f"argument of {spec.name} in {spec.where}", key, KWARGS)


def select(
    dataset: minari.MinariDataset, controller: str | None = None, noise: float | None = None
) -> minari.MinariDataset:
    """The episodes of one controller, with one noise, or both, as a data set on the same files."""
    wanted = {"controller": controller, "noise": noise}
    with read_as(dataset.storage.data_path, "a data set of Minari"):
        told = list(dataset.storage.get_episode_metadata(dataset.episode_indices))
    mask = np.ones(len(told), dtype=bool)
    for key, value in wanted.items():
        there = dict.fromkeys(one.get(key) for one in told)
        if value is not None and value not in there:
            allowed = ", ".join(map(str, there))
            raise ConfigError(f"{key} = {shown(value)}: the data set has {allowed}")
        if value is not None:
            mask &= np.array([one.get(key) == value for one in told])
    return minari.MinariDataset(dataset.storage, dataset.episode_indices[mask])
