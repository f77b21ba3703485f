"""Changes of binary files that know their format: npz, safetensors, sealed recordings, meshes.

Where a file carries a digest, most edits put it right again, as somebody who changes a file on
purpose would: a reader that trusts the digest alone is tried too.
"""

from __future__ import annotations

import hashlib
import io
import json
import struct
import zipfile

import numpy as np
from _fuzz_mutate import bytes_edit, json_edit, pick, text_edit, tree_edit
from _fuzz_values import json_text

_KINDS = ("f4", "f2", "i8", "u1", "?", "c16", "S3", "U3", ">f8", "M8[s]")
_FILLS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, -1e300, 5e-324)


class _Pickled:
    """What a damaged file may hold where objects are read: unpickled, it says so and ends."""

    def __reduce__(self):
        return exec, ("raise SystemError('code of a file ran')",)


@np.errstate(all="ignore")
def array_edit(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    """An array with other numbers, shape or type."""
    how = rng.integers(7)
    if how == 0 and array.size:
        made = array.astype(float) if array.dtype.kind in "fiu" else array.copy()
        if made.dtype.kind == "f":
            made.flat[int(rng.integers(made.size))] = pick(rng, _FILLS)
        return made
    if how == 1 and array.dtype.kind in "fiu":
        return np.full(array.shape, pick(rng, _FILLS))
    if how == 2 and array.ndim:
        return array[: int(rng.integers(len(array) + 1))]
    if how == 3:
        return pick(rng, (array.T, array.ravel(), array[None], np.empty(0), np.float64(1.0)))
    if how == 4:
        try:
            return array.astype(pick(rng, _KINDS))
        except (ValueError, TypeError):
            return np.zeros(array.shape, "S3")
    if how == 5 and array.dtype.kind in "fiu":
        return array * pick(rng, (0.0, -1.0, 1e-9, 1e3, 1e9, 1e200))
    if how == 6 and array.ndim and len(array) > 1:
        return array[::-1]
    return np.zeros((*array.shape, 2))


def npz_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """An npz file with an array, its name, its JSON or its bytes changed."""
    members = members_of(data)
    if rng.random() < 0.25 or not members:
        return bytes_edit(rng, data)
    name, how = pick(rng, list(members)), rng.random()
    if how < 0.1:
        del members[name]
    elif how < 0.18:
        members["x" + name] = members.pop(name)
    elif how < 0.26:
        members[name] = bytes_edit(rng, members[name])
    elif how < 0.32:
        members[name] = _npy_of(rng)
    else:
        members[name] = _npy_edit(rng, members[name])
    return _zipped(rng, members)


def members_of(data: bytes) -> dict[str, bytes]:
    """Files of an archive by name; none, if it is damaged."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    except Exception:  # an earlier edit has broken it
        return {}


def _zipped(rng: np.random.Generator, members: dict[str, bytes]) -> bytes:
    kind = zipfile.ZIP_STORED if rng.random() < 0.2 else zipfile.ZIP_DEFLATED
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", kind) as archive:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name)  # a fixed date
            entry.compress_type = kind
            archive.writestr(entry, content)
    return stream.getvalue()


def _npy_edit(rng: np.random.Generator, content: bytes) -> bytes:
    """One array of an npz file; bytes that are JSON are edited as that."""
    try:
        array = np.load(io.BytesIO(content), allow_pickle=False)
    except Exception:
        return bytes_edit(rng, content)
    if array.dtype == np.uint8 and array.tobytes()[:1] in (b"{", b"["):
        array = np.frombuffer(json_edit(rng, array.tobytes()), dtype=np.uint8)
    else:
        array = array_edit(rng, array)
    return _npy(array)


def _npy(array: np.ndarray, pickled: bool = False) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=pickled)
    return stream.getvalue()


def _npy_of(rng: np.random.Generator) -> bytes:
    """An array of objects, which is a pickle, or one whose head promises what is not there."""
    if rng.random() < 0.5:
        return _npy(np.array([_Pickled()], dtype=object), pickled=True)
    shape = pick(rng, ((10**12,), (2**31, 2**31), (-1,), (2**63,), (300_000_000,), (0, 10**12)))
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape!r}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + bytes(64)


# --- policies ------------------------------------------------------------------------------------


def policy_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A policy with a tensor or its card changed and its digest put right, or with other bytes."""
    from safetensors.numpy import load, save
    from ship_gym_agents.policies.policy_file import _MARK, _digest

    try:
        length = int.from_bytes(data[:8], "little")
        head = json.loads(json.loads(data[8 : 8 + length])["__metadata__"][_MARK])
        card, tensors = head["card"], dict(load(data))
    except Exception:
        return bytes_edit(rng, data)
    how = rng.random()
    if how < 0.25:
        return bytes_edit(rng, data)
    if how < 0.35:
        return _header_edit(rng, data, length)
    if how < 0.65:
        card = tree_edit(rng, card)
    else:
        name = pick(rng, sorted(tensors))
        tensors[name] = np.ascontiguousarray(array_edit(rng, tensors[name]))
        if rng.random() < 0.1:
            tensors["x" + name] = tensors.pop(name)
    try:
        head |= {"card": card, "digest": _digest(card, tensors)}
        return save(tensors, metadata={_MARK: json_text(head)})
    except Exception:  # a type that the format does not have, a number that JSON does not
        return _header_edit(rng, data, length)


def _header_edit(rng: np.random.Generator, data: bytes, length: int) -> bytes:
    """The head of a safetensors file, a JSON of its own, as JSON; its length right or wrong."""
    head = json_edit(rng, data[8 : 8 + length])
    told = len(head) if rng.random() < 0.8 else int(rng.integers(0, 2**62))
    return told.to_bytes(8, "little") + head + data[8 + length :]


def old_policy_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A policy of version 0.1: an archive of a card and two npz files."""
    members = members_of(data)
    if rng.random() < 0.2 or not members:
        return bytes_edit(rng, data)
    name = pick(rng, sorted(members))
    if rng.random() < 0.1:
        del members[name]
    else:
        edit = npz_edit if name.endswith(".npz") else json_edit
        members[name] = edit(rng, members[name])
    return _zipped(rng, members)


# --- recordings ----------------------------------------------------------------------------------


def rrd_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A recording with messages or their payloads changed and sealed again, or other bytes."""
    from ship_gym.recording import sealed

    if rng.random() < 0.4:
        return bytes_edit(rng, data)
    try:
        found = list(sealed._messages(data))
        messages = [(kind, payload[: -sealed._SEAL]) for kind, payload in found]
    except Exception:
        return bytes_edit(rng, data)
    if not messages:
        return bytes_edit(rng, data)
    k, how = int(rng.integers(len(messages))), rng.random()
    if how < 0.2:
        del messages[k]
    elif how < 0.3:
        messages.insert(k, messages[int(rng.integers(len(messages)))])
    elif how < 0.4:
        messages = messages[:k]
    elif how < 0.5:
        messages[k] = (int(rng.integers(0, 9)), messages[k][1])
    else:
        messages[k] = (messages[k][0], bytes_edit(rng, messages[k][1]))
    stream = data[:12] + b"".join(
        struct.pack("<QQ", kind, len(payload)) + payload for kind, payload in messages
    )
    return sealed.seal(stream, data[:12])


def journal_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A journal with its head, or the size of its blocks, changed and its digests put right."""
    from ship_gym.recording import journal

    if rng.random() < 0.4:
        return bytes_edit(rng, data)
    blocks, at = [], len(journal._LINE)
    try:
        while at < len(data):
            tag, length = journal._BLOCK.unpack_from(data, at)
            at += journal._BLOCK.size
            blocks.append((tag, data[at : at + length]))
            at += length + journal._DIGEST
    except struct.error:
        return bytes_edit(rng, data)
    if not blocks:
        return bytes_edit(rng, data)
    k = int(rng.integers(len(blocks)))
    tag, payload = blocks[k]
    blocks[k] = (tag, json_edit(rng, payload) if k == 0 else _rows_edit(rng, payload))
    made, digest = journal._LINE, b""
    for tag, payload in blocks:
        block = journal._BLOCK.pack(tag, len(payload)) + payload
        digest = hashlib.sha256(digest + block).digest()[: journal._DIGEST]
        made += block + digest
    return made


def _rows_edit(rng: np.random.Generator, payload: bytes) -> bytes:
    rows = np.frombuffer(payload[: len(payload) // 8 * 8], dtype="<f8").copy()
    if not rows.size or rng.random() < 0.3:
        return bytes_edit(rng, payload)
    rows[int(rng.integers(rows.size))] = pick(rng, _FILLS)
    return rows.tobytes()


# --- tables of benchmarks ------------------------------------------------------------------------


def parquet_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A table with its meta, a column or a row changed, or other bytes."""
    import pyarrow as pa
    from pyarrow import parquet

    if rng.random() < 0.3:
        return bytes_edit(rng, data)
    try:
        table = parquet.read_table(io.BytesIO(data))
        table = _table_edit(rng, pa, table)
        stream = io.BytesIO()
        parquet.write_table(table, stream)
    except Exception:
        return bytes_edit(rng, data)
    return stream.getvalue()


def _table_edit(rng: np.random.Generator, pa, table):
    name, how = pick(rng, table.column_names), rng.random()
    if how < 0.4:
        meta = dict(table.schema.metadata or {})
        key = pick(rng, sorted(meta)) if meta else b"x"
        return table.replace_schema_metadata(meta | {key: json_edit(rng, meta.get(key, b"{}"))})
    if how < 0.6:
        return table.drop_columns([name])
    if how < 0.7:
        return table.slice(0, int(rng.integers(table.num_rows + 1)))
    k = table.column_names.index(name)
    value = pick(rng, (None, "x", -1.0, 1e300, np.nan, True, [1.0], 10**15))
    return table.set_column(k, name, pa.array([value] * table.num_rows))


# --- meshes --------------------------------------------------------------------------------------


def mesh_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A mesh with lines, words or bytes changed; one in text mostly by its words."""
    if b"\0" in data[:4096]:
        return bytes_edit(rng, data)
    if rng.random() < 0.4:
        return text_edit(rng, data)
    lines = data.split(b"\n")
    k = int(rng.integers(min(len(lines), 6) if rng.random() < 0.3 else len(lines)))
    words = lines[k].split()
    if not words:
        return text_edit(rng, data)
    odd = (
        b"nan",
        b"inf",
        b"0",
        b"-1",
        b"999999",
        b"1e300",
        b"-1e9",
        b"abc",
        b"",
        b"1/2/3",
        b"9" * 50,
    )
    words[int(rng.integers(len(words)))] = pick(rng, odd)
    lines[k] = b" ".join(words)
    return b"\n".join(lines)
