"""The seal of a recording: no byte of it goes to a reader before it is known to be unchanged.

An ``.rrd`` file is a header of 12 bytes and messages: kind and length (uint64, little endian), then
a protobuf payload. The seal is a field of each payload that rerun does not know and so passes over:
the sizes of the whole file and of the record at its beginning, and a SHA-256 digest of the message
and of the digest before it. So every message vouches for all that stand before it, and the first
one says how long the file was: a file that ends early was cut and is whole up to there; any other
difference is damage. It is no signature: who changes a file on purpose can seal it again.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import struct
from collections.abc import Iterator
from typing import NamedTuple

from ship_gym.config import ConfigError
from ship_gym.reading import read_bytes

_MAGIC, _HEADER = b"RRF2", 12
_KIND = struct.Struct("<QQ")  # kind and length of a message
_END = 0  # kind of what rerun closes a stream with: the manifest, which only remote stores need
_START = b"Ship Gym recording, format 2"
# Protobuf: number 15001, wire type 2 (bytes), their count; then sizes and digest.
_FIELD = bytes([0xCA, 0xA9, 0x07, 48])
_SIZES = struct.Struct("<QQ")  # bytes of the file, and of the record it begins with
_DIGEST = 32
MOST = 1 << 34  # [bytes] of a file
_SEAL = len(_FIELD) + _SIZES.size + _DIGEST


class DamagedRecording(ConfigError):  # which every verb says in one line
    """A recording that is not as it was written; the message names the file and the byte."""


@contextlib.contextmanager
def damage_told(path: str | os.PathLike) -> Iterator[None]:
    """Turn whatever the contents of a file raise in the block into one line.

    The seal is no signature, so what lies behind it may be anything.
    """
    try:
        yield
    except (ConfigError, OSError, ImportError):
        raise
    except RecursionError:
        raise DamagedRecording(f"{path}: not a recording, or damaged: nested too deep") from None
    except Exception as error:
        told = " ".join(str(error).split()) or type(error).__name__
        told = f"no {told}" if isinstance(error, KeyError) else told
        raise DamagedRecording(f"{path}: not a recording, or damaged: {told}") from error


class Verified(NamedTuple):
    """What of a file is as it was written.

    Attributes
    ----------
    data : bytes
        The file up to its last whole message.
    record : int
        Bytes of it that hold the record; the rest is the picture.
    complete : bool
        False: the file was cut after `data`.
    """

    data: bytes
    record: int
    complete: bool

    @property
    def has_picture(self) -> bool:
        """Whether there is more than the record: without a picture a viewer shows nothing."""
        return len(self.data) > self.record


def seal(record: bytes, picture: bytes = b"") -> bytes:
    """Make one sealed file of streams as ``rr.BinaryStream.read`` gives them.

    Parameters
    ----------
    record, picture : bytes
        Each with a header of its own; what closes a stream is left out.

    Returns
    -------
    bytes
    """
    parts = [list(_messages(stream)) for stream in (record, picture)]
    sizes = [sum(_KIND.size + len(payload) + _SEAL for _, payload in part) for part in parts]
    ends = _SIZES.pack(_HEADER + sum(sizes), _HEADER + sizes[0])
    header = record[:_HEADER]
    sealed, digest = [header], _begun(header)
    for kind, payload in (*parts[0], *parts[1]):
        message = b"".join((_KIND.pack(kind, len(payload) + _SEAL), payload, _FIELD, ends))
        digest = hashlib.sha256(digest + message).digest()
        sealed += [message, digest]
    return b"".join(sealed)


def verify(path: str | os.PathLike) -> Verified:
    """Read a sealed file and find out how far it is as it was written.

    Parameters
    ----------
    path : path-like

    Returns
    -------
    Verified

    Raises
    ------
    DamagedRecording
        A byte was changed or added, the file was cut before its first whole message, or it carries
        no seal.
    ConfigError
        It cannot be read.
    """
    return checked(read_bytes(path, MOST), path)


def checked(data: bytes, path: str | os.PathLike) -> Verified:
    """The bytes of a file as `verify` gives them; `path` is for what it says."""
    if data[:4] != _MAGIC[: len(data)] or not data:
        raise DamagedRecording(f"{path} is not a readable .rrd file: byte 0 begins no recording")
    at, digest, ends = _HEADER, _begun(data[:_HEADER]), None
    view = memoryview(data)
    while ends is None or at < min(len(data), ends[0]):
        stop = _stop(data, at)
        if stop > len(data):
            break
        found, digest = _message(view[at:stop], digest, path, at, first=ends is None)
        ends, at = found, stop
    if ends is None:
        raise DamagedRecording(
            f"{path}: damaged or cut off at byte {len(data)}, within its first message"
        )
    size, record = ends
    if at < len(data) and len(data) >= size:
        raise DamagedRecording(
            f"{path}: damaged at byte {at}: it was {size} bytes long and is {len(data)}"
        )
    return Verified(data[:at], min(record, at), at == size)


def _begun(header: bytes) -> bytes:
    return hashlib.sha256(_START + header).digest()


def _messages(stream: bytes) -> Iterator[tuple[int, bytes]]:
    """Kind and payload of each message of an unsealed stream, up to its close."""
    at = _HEADER
    while at < len(stream):
        kind, length = _KIND.unpack_from(stream, at)
        if kind == _END:
            return
        at += _KIND.size + length
        yield kind, stream[at - length : at]


def _stop(data: bytes, at: int) -> int:
    """Where the message at a byte ends; behind the file if its beginning is cut."""
    begun = at + _KIND.size
    return begun + (_KIND.unpack_from(data, at)[1] if begun <= len(data) else len(data))


def _message(message: memoryview, before: bytes, path, at: int, first: bool):
    """Sizes and digest of a message that is as it was written."""
    place = len(message) - _SEAL
    if first and (place < _KIND.size or message[place : place + len(_FIELD)] != _FIELD):
        raise DamagedRecording(
            f"{path} carries no seal at byte {at}: damaged, rewritten by another program, or made "
            "by an older version; record it again"
        )
    digest = hashlib.sha256(before)
    digest.update(message[:-_DIGEST])
    if place < _KIND.size or digest.digest() != message[-_DIGEST:]:
        start = 0 if first else at  # the first one vouches for the header, too
        raise DamagedRecording(f"{path}: damaged between bytes {start} and {at + len(message)}")
    return _SIZES.unpack_from(message, place + len(_FIELD)), digest.digest()
