"""Files to plain values, one reader for each format: text of any encoding, TOML, JSON,
XML, npz.

Whatever a parser or numpy raises for a damaged file becomes one line with the file's name, so that
who reads a file needs to know no kinds of error. What the values mean is the caller's to check.
Nothing here runs code of a file.
"""

from __future__ import annotations

import codecs
import contextlib
import io
import json
import math
import os
import re
import stat
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ship_gym.config import LARGEST, ConfigError, cut, nearest, shown

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

MOST = 1 << 29  # [bytes] of a file, packed or not
_MOST_TEXT = 1 << 26  # [bytes] of a file of text
_MOST_XML = 1 << 24  # [bytes]; a tree takes some ten times as much
_MOST_TOLD = 150  # characters of what a parser says: the file is to be named, too

# Byte order marks; the longer ones first, since that of UTF-16 begins that of UTF-32.
_MARKS = {
    codecs.BOM_UTF8: "utf-8",
    codecs.BOM_UTF32_LE: "utf-32-le",
    codecs.BOM_UTF32_BE: "utf-32-be",
    codecs.BOM_UTF16_LE: "utf-16-le",
    codecs.BOM_UTF16_BE: "utf-16-be",
}
# Dots between words: the parser takes a time that grows with the square of the parts of a key.
_DOT = re.compile(r"(?<=[\w\"'])[ \t]*\.[ \t]*(?=[\w\"'])")
_PARTS = re.compile("[={,\n]")
_DEEPEST = 100
_WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")  # xlsx and ods; xls


def read_bytes(path: str | os.PathLike, most: int = MOST) -> bytes:
    """Bytes of a file of at most `most` bytes.

    Raises
    ------
    ConfigError
        No such file, no regular file (a device or a pipe may never end), one that cannot be read
        or is too large.
    """
    try:
        with open(path, "rb", opener=_opened) as file:
            state = os.fstat(file.fileno())
            if not stat.S_ISREG(state.st_mode):
                raise ConfigError(f"{path}: allowed is a file, not a device, a pipe or a folder")
            if state.st_size > most:
                raise ConfigError(f"{path}: {state.st_size} bytes: allowed are at most {most}")
            return file.read(state.st_size)  # of a limit alone, all of it would be allocated
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # a name with a zero byte
        raise ConfigError(f"{shown(str(path))}: no file has such a name: {error}") from None


def _opened(name: str, flags: int) -> int:
    """Open without waiting for somebody to write into a pipe."""
    return os.open(name, flags | getattr(os, "O_NONBLOCK", 0))


@contextlib.contextmanager
def read_as(path: str | os.PathLike, what: str) -> Iterator[None]:
    """Turn whatever a parser or numpy raises in the block into a ``ConfigError`` of one line.

    For the step from bytes to plain values alone: what the values mean is checked afterwards, by
    names and ranges.

    Parameters
    ----------
    path : path-like
        For the message, as is `what`, such as "a TOML file".
    """
    try:
        yield
    except ConfigError:
        raise
    except RecursionError:
        raise ConfigError(f"{path}: not {what}: nested too deep") from None
    except Exception as error:
        told = cut(" ".join(str(error).split()), _MOST_TOLD) or type(error).__name__
        if isinstance(error, KeyError):
            told = f"no {told}"
        if "pickle" in told:  # numpy's words advise to run it
            told = "holds Python objects, which may be code and are not read"
        raise ConfigError(f"{path}: not {what}, or damaged: {told}") from None


def read_text(path: str | os.PathLike[str], fallback: str | None = None) -> str:
    r"""Text of a file, its lines ended by ``\n``; every reader of text goes through here.

    A byte order mark (UTF-8, UTF-16, UTF-32) is obeyed and left out; without one the file is in
    UTF-8.

    Parameters
    ----------
    path : path-like
    fallback : str, optional
        Encoding of a file that is not in UTF-8. Without it such a file is refused.

    Raises
    ------
    ConfigError
        No such file, one that cannot be read, or not a text file; the message says what to do.
    """
    path = Path(path)
    data = read_bytes(path, _MOST_TEXT)
    text = _decoded(path, data, fallback)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _decoded(path: Path, data: bytes, fallback: str | None) -> str:
    mark = next((mark for mark in _MARKS if data.startswith(mark)), b"")
    if not mark and data.startswith(_WORKBOOKS):
        raise ConfigError(f"{path}: a workbook, not a text file; save the sheet as 'CSV UTF-8'")
    if not mark and b"\0" in data:
        raise ConfigError(
            f"{path}: holds zero bytes: not a text file, or UTF-16 without a byte order mark; save "
            "it as UTF-8"
        )
    encoding = _MARKS.get(mark, "utf-8")
    try:
        return data[len(mark) :].decode(encoding)
    except UnicodeDecodeError as error:
        if not mark and fallback is not None:
            return data.decode(fallback, errors="replace")
        line = data[: error.start].count(b"\n") + 1
        where = f"{path}:{line}" if encoding == "utf-8" else f"{path}"
        raise ConfigError(
            f"{where}: not in {encoding.upper()} (byte 0x{data[len(mark) + error.start]:02x}); "
            "save the file as UTF-8"
        ) from None


def read_toml(path: str | os.PathLike) -> dict[str, Any]:
    """Read a TOML file; a missing or malformed file is a ConfigError with its path."""
    return parsed_toml(read_text(path), path)


def parsed_toml(text: str, path: str | os.PathLike) -> dict[str, Any]:
    """Values of a text in TOML, as `read_toml` reads one; `path` is for the message."""
    if any(len(_DOT.findall(part)) > _DEEPEST for part in _PARTS.split(text)):
        raise ConfigError(f"{path}: not a valid TOML file: a key of more than {_DEEPEST} parts")
    with read_as(path, "a valid TOML file"):
        return tomllib.loads(text)


def read_json(path: str | os.PathLike) -> Any:
    """Read a JSON file of numbers, texts, lists and mappings; its numbers are finite."""
    return parsed_json(read_text(path), path)


def parsed_json(text: str | bytes, path: str | os.PathLike) -> Any:
    """Values of a text in JSON, as `read_json` reads one; `path` is for the message."""
    with read_as(path, "valid JSON"):
        return json.loads(text, parse_constant=_no_number, parse_float=_finite)


def read_xml(path: str | os.PathLike, most: int = _MOST_XML) -> Element:
    """Root of an XML file, without entities, document types and network.

    Raises
    ------
    ConfigError
        As `read_bytes`; not XML, or with a document type, which alone may name entities and files.
    ImportError
        No defusedxml; names the extra to install.
    """
    data = read_bytes(path, most)
    try:
        from defusedxml import DefusedXmlException, ElementTree
    except ImportError:
        raise ImportError('XML files need defusedxml: pip install "ship-gym[geo]"') from None
    with read_as(path, "XML"):
        try:
            return ElementTree.fromstring(data, forbid_dtd=True)
        except DefusedXmlException:
            raise ConfigError(
                f"{path}: declares a document type or an entity; allowed is XML without them"
            ) from None


def _no_number(name: str) -> None:
    raise ValueError(f"{name} is no number of JSON")


def _finite(text: str) -> float:
    """A number of JSON; 1e999 would be infinite without a word."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{shown(text)} is larger than any number")
    return number


def read_npz(
    path: str | os.PathLike, *names: str, what: str = "an npz file"
) -> dict[str, np.ndarray]:
    """Arrays of an npz file; an array of objects, which would be a pickle, is refused.

    Parameters
    ----------
    path : path-like
    *names : str
        Arrays that must be there; others are read too.
    what : str
        What the file should be, for the message.
    """
    arrays = npz_arrays(read_bytes(path), path, what)
    for name in names:
        if name not in arrays:
            raise ConfigError(f"{path}: not {what}: no array {name!r};{nearest(name, arrays)}")
    return arrays


def npz_arrays(
    data: bytes, path: str | os.PathLike, what: str = "an npz file"
) -> dict[str, np.ndarray]:
    """Arrays of the bytes of an npz file, as `read_npz` reads one; `path` is for the message."""
    with read_as(path, what):
        found = np.load(io.BytesIO(data), allow_pickle=False)
        if not isinstance(found, np.lib.npyio.NpzFile):
            raise ValueError("holds one array without a name")
        assert found.zip is not None  # it is open
        check_unpacked(found.zip)
        return {name: np.asarray(found[name]) for name in found.files}


def read_npy(path: str | os.PathLike) -> np.ndarray:
    """The array of an npy file; one of objects, which would be a pickle, is refused."""
    data = io.BytesIO(read_bytes(path))
    with read_as(path, "an npy file"):
        return np.lib.format.read_array(data, allow_pickle=False)


def check_unpacked(archive: zipfile.ZipFile, most: int = MOST) -> None:
    """Refuse, by a ValueError, an archive whose files are larger than memory should be."""
    size = sum(entry.file_size for entry in archive.infolist())
    if size > most:
        raise ValueError(f"{size} bytes when unpacked, allowed are at most {most}")


def json_head(array: np.ndarray, path: str | os.PathLike) -> dict[str, Any]:
    """The mapping, in JSON, that lies in an npz file as an array of bytes."""
    if array.dtype != np.uint8 or array.ndim != 1:
        raise ConfigError(f"{path}: its text is an array of {array.dtype}: allowed are bytes")
    head = parsed_json(array.tobytes(), path)
    if not isinstance(head, dict):
        raise ConfigError(f"{path}: its text holds {shown(head)}: allowed is a mapping")
    return head


def check_array(
    field: str,
    array: np.ndarray,
    shape: tuple[int | None, ...],
    low: float = -LARGEST,
    high: float = LARGEST,
    unit: str = "-",
) -> np.ndarray:
    """Return an array of numbers that are finite and within [low, high], else a ConfigError.

    Parameters
    ----------
    field : str
        File and name, for the message.
    array : numpy.ndarray
        Of integers, floats or, by their absolute values, complex numbers.
    shape : tuple
        What it must have; None: any number, but not none.
    low, high : float
        By default what no quantity exceeds.
    unit : str
    """
    fits = array.ndim == len(shape) and all(
        size > 0 if wanted is None else size == wanted
        for size, wanted in zip(array.shape, shape, strict=False)
    )
    if not fits:
        wanted = ", ".join("any" if size is None else str(size) for size in shape)
        raise ConfigError(f"{field} has shape {array.shape}: allowed is ({wanted})")
    if array.dtype.kind not in "fiuc":
        raise ConfigError(f"{field} is of type {shown(str(array.dtype))}: allowed are numbers")
    sizes = np.abs(array) if array.dtype.kind == "c" else array
    if sizes.size and not (low <= sizes.min() and sizes.max() <= high):  # false for nan, too
        first = np.argwhere(~((sizes >= low) & (sizes <= high)))[0]
        place = ", ".join(map(str, first))
        value = shown(array[tuple(first)])
        raise ConfigError(f"{field}[{place}] = {value}: allowed is {low:g} to {high:g} [{unit}]")
    return array
