"""One rollout or manoeuvre as exact float64 columns, with the meta that reproduces it."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.recording.sealed import damage_told
from ship_gym.writing import atomic_path

_NO_RERUN = 'recordings as .rrd need rerun: pip install "ship-gym[rerun]"'


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Columns of one recorded run, checked once and read-only from then on.

    Any column may be stored. The viewer shows those whose names it knows (see
    ``ship_gym/recording/panels.py`` and ``scene.py``): the state and the commands as in
    ``ship_gym.conventions``, ``psi_ordered`` and ``psi_error`` [rad], forces ``X_hull`` ...
    ``N_disturbance`` [N, N m], ``reward`` and ``reward_<term>``, ``current_speed`` [m/s] with
    ``current_direction_to`` [rad], ``wind_speed`` [m/s] with ``wind_direction_from`` [rad].

    Parameters
    ----------
    columns : dict of str to array_like
        Every column is copied to float64, shape (T,), T >= 1. ``"t"`` [s] must be there and
        increase strictly; it is moved to the front. SI units, angles in rad.
    meta : dict, optional
        Anything that JSON can hold: config, seed, versions, git_commit, ``task`` (its name),
        ``waypoints`` ([[x, y], ...] [m]) and ``ship``, a dict with ``name``, ``L``, ``B``, ``d``
        [m], ``A_R`` (rudder area) [m2] and ``D_P`` (propeller diameter) [m]. Tuples become lists
        and numpy values plain ones, so that a stored meta is equal to the one in memory.

    Raises
    ------
    ValueError
        If a column or a meta entry cannot be stored exactly; the message names it.
    """

    columns: dict[str, np.ndarray]
    meta: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        columns = {name: _column(name, values) for name, values in self.columns.items()}
        if "t" not in columns:
            raise ValueError(f"a trajectory needs a column 't' [s]; it has {list(columns)}")
        columns = {"t": columns.pop("t"), **columns}
        _check_lengths(columns)
        _check_time(columns["t"])
        object.__setattr__(self, "columns", columns)
        object.__setattr__(self, "meta", plain(dict(self.meta), "meta"))

    def __len__(self) -> int:
        """Return the number of rows T."""
        return len(self.columns["t"])

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the column `name`, float64, shape (T,)."""
        try:
            return self.columns[name]
        except KeyError:
            raise KeyError(f"no column {name!r}; the columns are {self.names}") from None

    def __contains__(self, name: object) -> bool:
        """Tell whether there is a column `name`."""
        return name in self.columns

    @property
    def names(self) -> list[str]:
        """Column names in order, ``"t"`` first."""
        return list(self.columns)

    @property
    def complete(self) -> bool:
        """Whether this is the whole run; False: it was killed, or its file was cut."""
        return bool(self.meta.get("complete", True))

    def to_csv(self, path: str | os.PathLike) -> None:
        """Write a csv file: '# ' lines with the meta as JSON, a row of names, then the rows.

        Numbers have the fewest digits that give back the same float64.

        Parameters
        ----------
        path : path-like
            File ``*.csv`` to write; an interrupted write leaves an existing file as it was.

        Raises
        ------
        ConfigError
            Another extension.
        """
        _check_extension(path, ".csv")
        head = ["Ship Gym trajectory; SI units, angles in rad; the meta as JSON:"]
        head += json.dumps(self.meta, indent=1).splitlines()
        rows = zip(*(column.tolist() for column in self.columns.values()), strict=True)
        with atomic_path(path) as temporary, open(temporary, "w", newline="") as stream:
            stream.writelines(f"# {line}\n" for line in head)
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(self.names)
            writer.writerows(rows)

    def to_rrd(self, path: str | os.PathLike, *, picture: bool = True) -> None:
        """Write a rerun recording that opens ready to read and holds every column exactly.

        Parameters
        ----------
        path : path-like
            File ``*.rrd`` to write; an interrupted write leaves an existing file as it was.
        picture : bool
            Whether it holds what the viewer shows, or only the record.

        Raises
        ------
        ConfigError
            Another extension.
        ImportError
            If rerun-sdk is not installed.
        OSError
            If it cannot be written, as on a full disk; names the file.
        """
        _check_extension(path, ".rrd")
        import_rerun_export().write_rrd(self, path, picture=picture)

    @classmethod
    def from_rrd(cls, path: str | os.PathLike, *, sealed: bool = True) -> Trajectory:
        """Read the columns and the meta back, bit for bit, from a file of `to_rrd`.

        Parameters
        ----------
        path : path-like
            A ``.rrd`` file written by `to_rrd`.
        sealed : bool
            False: a file that rerun's own tools have rewritten; its columns and its meta are still
            compared with their checksums, but rerun reads its bytes before.

        Returns
        -------
        Trajectory
            Equal in every bit of every column, and in the meta. Of a file that was cut the rows
            before the cut, with ``complete`` false.

        Raises
        ------
        ImportError
            If rerun-sdk is not installed.
        FileNotFoundError
            If there is no such file.
        DamagedRecording
            A ValueError: the file is not as it was written, or is no recording of Ship Gym.
        """
        export = import_rerun_export()
        with damage_told(path):
            return cls(*export.read_rrd(path, sealed=sealed))

    @classmethod
    def from_file(cls, path: str | os.PathLike) -> Trajectory:
        """Read a recording ``*.rrd``, or the journal ``*.rrd.partial`` of a run that was killed.

        Raises
        ------
        ValueError
            A file of another name; and what `from_rrd` raises.
        """
        name = os.fspath(path).lower()
        if name.endswith(".rrd"):
            return cls.from_rrd(path)
        if name.endswith(".rrd.partial"):
            from ship_gym.recording.journal import read_journal

            with damage_told(path):
                return cls(*read_journal(path))
        raise ValueError(f"{path}: a recording is a file *.rrd or *.rrd.partial")


def _check_extension(path: str | os.PathLike, allowed: str) -> None:
    """Refuse a file whose name says that it is of another format."""
    if os.path.splitext(path)[1].lower() != allowed:
        raise ConfigError(f"path = {os.fspath(path)!r}: allowed is a {allowed} file")


def import_rerun_export() -> ModuleType:
    """Import the exporter late: rerun is optional, large, and not wanted by ``import ship_gym``."""
    try:
        from ship_gym.recording import rerun_export
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ("rerun", "rerun_bindings", "pyarrow"):
            raise
        raise ImportError(_NO_RERUN) from error
    return rerun_export


def _column(name: object, values: object) -> np.ndarray:
    """Copy one column to a read-only float64 array, or say what is wrong with it."""
    if not isinstance(name, str) or not name or not name.isprintable():
        raise ValueError(f"column names are printable, non-empty strings, not {name!r}")
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"column {name!r} is not numeric but {array.dtype}")
    if array.ndim != 1:
        raise ValueError(f"column {name!r} has shape {array.shape}, not (T,)")
    array = array.astype(np.float64)  # astype copies
    bad = ~np.isfinite(array)
    if bad.any():
        row = int(np.argmax(bad))
        raise ValueError(f"column {name!r} is {array[row]} in row {row}")
    array.flags.writeable = False
    return array


def _check_lengths(columns: dict[str, np.ndarray]) -> None:
    rows = len(columns["t"])
    if rows == 0:
        raise ValueError("a trajectory needs at least one row; column 't' is empty")
    for name, column in columns.items():
        if len(column) != rows:
            raise ValueError(f"column {name!r} has {len(column)} rows, but 't' has {rows}")


def _check_time(t: np.ndarray) -> None:
    late = np.flatnonzero(np.diff(t) <= 0.0)
    if len(late):
        row = int(late[0]) + 1
        raise ValueError(f"column 't' does not increase at row {row}: {t[row - 1]} then {t[row]}")


def plain(value: object, where: str) -> Any:
    """Turn `value` into what JSON gives back, so that a round trip is exact, or say why not."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{where} is {value}, which JSON cannot hold; use None")
        return float(value)
    if isinstance(value, Mapping):
        odd = [key for key in value if not isinstance(key, str)]
        if odd:
            raise ValueError(f"{where} has a key that is not a string: {odd[0]!r}")
        return {str(key): plain(entry, f"{where}[{key!r}]") for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry, f"{where}[{i}]") for i, entry in enumerate(value)]
    raise ValueError(f"{where} is a {type(value).__name__}, which JSON cannot hold")
