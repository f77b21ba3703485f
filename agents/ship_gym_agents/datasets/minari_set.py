"""Sets of Minari are made beside their place and put there whole."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium as gym
import minari
from minari.data_collector import EpisodeBuffer
from minari.dataset.minari_dataset import parse_dataset_id
from minari.dataset.minari_storage import METADATA_FILE_NAME, MinariStorage
from minari.namespace import NAMESPACE_METADATA_FILENAME

from ship_gym.config import ConfigError, shown
from ship_gym.locks import held
from ship_gym.writing import atomic_path, check_place, full_disk_named

VERSION = minari.__version__
# what an environment of a set may be given
KWARGS = ("scenario", "ship", "control", "surrogate", "privileged", "overrides", "info")
_TREES = 3000  # bytes that HDF5 adds to an array
_FOLDER = "runs/datasets"  # where Minari has no folder of its own by MINARI_DATASETS_PATH


def usual_folder() -> Path:
    """Folder of data sets: ``MINARI_DATASETS_PATH`` where it is set, else ``runs/datasets``."""
    return Path(os.environ.get("MINARI_DATASETS_PATH") or _FOLDER)


def checked_id(name: str) -> str:
    """The id of a data set, refused if Minari could not read it."""
    with contextlib.suppress(ValueError, TypeError):  # TypeError: without a version
        parse_dataset_id(name)
        if "//" not in name:
            return name
    raise ConfigError(
        f"name = {shown(name)}: allowed is (NAMESPACE/)NAME-v0 of letters, digits, '-', '_'; a "
        "namespace has two letters at least"
    )


def check_free(folder: Path, name: str, force: bool) -> Path:
    """Path of a data set that can be written; refuse to replace one, other things always."""
    path = check_place(folder / checked_id(name), "--out", folder=True)
    for above in [path.parents[k] for k in range(name.count("/"))]:
        if is_set(above):
            raise ConfigError(f"{path}: {above} is a data set; none can be inside another")
    if not os.path.lexists(path):
        return path
    if not is_set(path) or path.is_symlink():
        raise ConfigError(f"{path}: is there and no data set of Minari; give another name")
    if not force:
        raise ConfigError(f"{path}: that data set is there; --force replaces it, or give --name")
    return path


def is_set(path: Path) -> bool:
    """Whether a folder holds a data set of Minari."""
    return (path / "data" / METADATA_FILE_NAME).is_file()


class NewSet:
    """A data set that grows in a hidden folder beside its place.

    Parameters
    ----------
    path : Path
        Of the folder that holds ``data``.
    spec : gymnasium.envs.registration.EnvSpec
        Of the environment that ``recover_environment`` gives.
    """

    def __init__(self, path: Path, spec: Any):
        self.path = path
        data = (path / "data").absolute()  # of a relative one Minari cannot tell the size
        data.mkdir(parents=True)
        with contextlib.closing(gym.make(spec)) as env:
            spaces = env.observation_space, env.action_space
        self._storage = MinariStorage.new(data, *spaces, spec)

    def add(self, episodes: Sequence[Any], metadata: Sequence[Mapping[str, Any]]) -> None:
        """Append episodes (``sail.Episode``), each with words and numbers of its own."""
        first = self._storage.total_episodes
        check_room(self.path, sum(map(room_of, episodes)))
        self._storage.update_episodes([_buffer(one) for one in episodes])
        ids = range(first, first + len(episodes))
        self._storage.update_episode_metadata([dict(one) for one in metadata], ids)

    def describe(self, metadata: Mapping[str, Any]) -> None:
        """Write metadata of the whole set."""
        self._storage.update_metadata({"minari_version": VERSION, **metadata})


def room_of(one: Any) -> int:
    """Bytes that an episode takes on disk at most: its arrays, each with the trees of HDF5."""
    arrays = (one.observations, one.actions, one.rewards, one.terminations, one.truncations)
    arrays += tuple(one.infos.values())
    return sum(array.nbytes for array in arrays) + _TREES * (len(arrays) + 1)


def check_room(folder: Path, size: int) -> None:
    """Refuse what the disk has no room for: HDF5 ends the whole process where one fills up.

    Room is taken behind what the file of the set holds, and given back at once, so that a quota
    and a limit of file sizes count as well. Where the system cannot, nothing is refused.
    """
    if not hasattr(os, "posix_fallocate"):
        return
    file = folder / "data" / "main_data.hdf5"
    with tempfile.TemporaryFile(dir=folder) as room:
        os.posix_fallocate(room.fileno(), file.stat().st_size, size)


def _buffer(one: Any) -> EpisodeBuffer:
    return EpisodeBuffer(
        seed=one.seed,
        observations=one.observations,
        actions=one.actions,
        rewards=one.rewards,
        terminations=one.terminations,
        truncations=one.truncations,
        infos=one.infos or None,
    )


@contextlib.contextmanager
def put_whole(path: Path, folder: Path) -> Iterator[Path]:
    """Give a hidden folder to write into; it becomes `path` only if the block succeeds.

    One process at a time; what a killed one left is removed. A set that is there stays until the
    new one is whole.

    Parameters
    ----------
    path : Path
        Of the data set.
    folder : Path
        Of all data sets; the namespaces between it and `path` become known to Minari.
    """
    work = path.with_name(f".{path.name}.ship_gym.tmp")
    with full_disk_named(path), held(path, "writes this data set"):
        _put_back(work / "old", path)
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        try:
            yield work / "new"
            _name_spaces(path, folder)
            if path.exists():
                path.rename(work / "old")
            (work / "new").rename(path)
        except BaseException:
            if (work / "old").exists() and not path.exists():
                (work / "old").rename(path)
            raise
        finally:
            shutil.rmtree(work, ignore_errors=True)


def _put_back(old: Path, path: Path) -> None:
    """Put back what a writer had put aside for its own when it was killed, and say so."""
    if old.exists() and not path.exists():
        old.rename(path)
        raise ConfigError(f"{path}: put aside by a writer that was killed; it is back, start again")


def _name_spaces(path: Path, folder: Path) -> None:
    """Tell Minari of the folders above a set, as its ``create_namespace`` does."""
    for above in path.parents:
        if above == folder:
            return
        file = above / NAMESPACE_METADATA_FILENAME
        if not file.exists():
            with atomic_path(file) as temporary:
                temporary.write_text(json.dumps({}), encoding="utf-8")
