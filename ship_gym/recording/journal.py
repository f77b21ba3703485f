"""The journal of a run that is on: rows in whole chunks, readable after a kill at any moment.

A file ``NAME.rrd.partial`` is a line and then blocks: tag (4 bytes), length (uint64, little
endian), payload, digest (16 bytes) of the block and of the digest before it. The first block holds
the names of the columns and the meta as JSON, each other one rows of float64, little endian. It
needs no rerun.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO

import numpy as np

from ship_gym.config import ConfigError, shown
from ship_gym.locks import take_lock, unfit
from ship_gym.reading import read_bytes
from ship_gym.recording.sealed import MOST, DamagedRecording, damage_told

SUFFIX = ".partial"
_LINE = b"Ship Gym journal 1\n"
_BLOCK = struct.Struct("<4sQ")
_HEAD, _ROWS = b"HEAD", b"ROWS"
_DIGEST = 16


def journal_path(path: str | os.PathLike) -> Path:
    """Where the journal of a recording is, ``run.rrd.partial`` of ``run.rrd``."""
    path = Path(path)
    return path.with_name(path.name + SUFFIX)


class BeingWritten(ConfigError):
    """A journal that another process, or another run of this one, writes."""


class Journal:
    """A journal that is being written, held by a lock; one that a dead run left is overwritten.

    Only the process that has opened it writes it: a forked one has the same file in its hands.

    Parameters
    ----------
    path : path-like
        ``*.rrd.partial``; its folder is created if missing.
    names : sequence of str
        Of the columns, ``"t"`` among them.
    meta : mapping
        What is known of the run before it begins; only what JSON can hold.

    Raises
    ------
    BeingWritten
        A ConfigError: another process, or another run of this one, writes it.
    OSError
        It cannot be written there.
    """

    def __init__(self, path: str | os.PathLike, names: Sequence[str], meta: Mapping):
        self.path = Path(path)
        self._file = _opened(self.path)
        self._size, self._digest = 0, b""
        self._chunks, self._process = 0, os.getpid()  # chunks: of rows
        try:
            self._write(_LINE)
            head = {"columns": list(names), "meta": dict(meta)}
            self._append(_HEAD, json.dumps(head).encode())
        except BaseException:
            self.remove()
            raise

    def append(self, rows: np.ndarray) -> None:
        """Hand one chunk of rows, float64 of shape (k, C), to the operating system."""
        self._append(_ROWS, np.ascontiguousarray(rows, dtype="<f8").tobytes())
        self._chunks += 1

    def close(self) -> None:
        """Let the file go; it stays, with every chunk. Without any it is removed."""
        if self._chunks:
            self._file.close()
        else:
            self.remove()

    def remove(self) -> None:
        """Remove the file."""
        if os.name == "nt":  # which removes no open file
            self._file.close()
        if self._process == os.getpid():
            with contextlib.suppress(FileNotFoundError):
                self.path.unlink()
        self._file.close()

    def _append(self, tag: bytes, payload: bytes) -> None:
        if self._process != os.getpid():
            return
        block = _BLOCK.pack(tag, len(payload)) + payload
        digest = _chained(self._digest, block)
        self._write(block + digest)
        self._digest = digest

    def _write(self, data: bytes) -> None:
        """Write all of `data` or nothing of it."""
        done = 0
        try:
            while done < len(data):
                done += self._file.write(data[done:])
        except BaseException as error:
            with contextlib.suppress(OSError):
                self._file.truncate(self._size)
                self._file.seek(self._size)
            if isinstance(error, OSError):
                raise OSError(error.errno, error.strerror, str(self.path)) from error
            raise
        self._size += done


def read_journal(path: str | os.PathLike) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """Columns and meta up to the last whole chunk.

    Parameters
    ----------
    path : path-like
        ``*.rrd.partial``.

    Returns
    -------
    columns : dict of str to numpy.ndarray
        Each float64, shape (T,).
    meta : dict
        With ``complete`` false.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    DamagedRecording
        A byte was changed, or there is no whole chunk of rows; names the file and the byte.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no recording {path}")
    return parsed(read_bytes(path, MOST), path)


def parsed(data: bytes, path: str | os.PathLike) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """The bytes of a journal as `read_journal` gives them; `path` is for what it says."""
    if not data.startswith(_LINE[: len(data)]):
        raise DamagedRecording(f"{path} is not a journal of Ship Gym: byte 0 begins none")
    payloads, at, digest = [], len(_LINE), b""
    while (block := _block(data, at, digest, path)) is not None:
        payload, digest, at = block
        payloads.append(payload)
    if len(payloads) < 2:
        raise DamagedRecording(
            f"{path}: ends at byte {len(data)}, before its first whole chunk of rows"
        )
    names, meta = _head(payloads[0], path)
    with damage_told(path):
        rows = np.frombuffer(b"".join(payloads[1:]), dtype="<f8").reshape(-1, len(names))
    columns = rows.T.astype(np.float64, order="C")
    return dict(zip(names, columns, strict=True)), meta | {"complete": False}


def _head(payload: bytes, path: str | os.PathLike) -> tuple[list[str], dict[str, object]]:
    """Names of the columns, each once, and the meta."""
    with damage_told(path):
        head = json.loads(payload)
        names, meta = head["columns"], head["meta"]
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise DamagedRecording(f"{path}: columns = {shown(names)}: allowed is a list of names")
    if not names or len(set(names)) < len(names):
        raise DamagedRecording(f"{path}: columns = {shown(names)}: each is allowed once, none not")
    if not isinstance(meta, dict):
        raise DamagedRecording(f"{path}: meta = {shown(meta)}: allowed is a mapping")
    return names, meta


def _block(data: bytes, at: int, before: bytes, path: str | os.PathLike):
    """Payload, digest and end of the block at a byte; None where the last whole one ended."""
    begun = at + _BLOCK.size
    if begun > len(data):
        return None
    _, length = _BLOCK.unpack_from(data, at)
    stop = begun + length
    # zeros to the end instead of a digest: a machine that went down
    if stop + _DIGEST > len(data) or not any(data[stop:]):
        return None
    digest = _chained(before, data[at:stop])
    if digest != data[stop : stop + _DIGEST]:
        raise DamagedRecording(f"{path}: damaged between bytes {at} and {stop + _DIGEST}")
    return data[begun:stop], digest, stop + _DIGEST


def _chained(before: bytes, block: bytes) -> bytes:
    return hashlib.sha256(before + block).digest()[:_DIGEST]


def _opened(path: Path) -> IO[bytes]:
    """The file, empty and locked."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if what := unfit(path):
        raise ConfigError(f"{path}: {what}")
    while True:
        file = path.open("a+b", buffering=0)
        try:
            free = take_lock(file)
        except OSError:
            file.close()
            if path.stat().st_size == 0:
                path.unlink()
            raise
        if not free:
            file.close()
            raise BeingWritten(f"{path}: another run is recorded into this file; give another name")
        if path.exists() and os.path.samestat(path.stat(), os.fstat(file.fileno())):
            file.truncate(0)
            return file
        file.close()  # the one who held it has just removed it
