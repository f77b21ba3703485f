"""A sealed file is read only as far as it is what was written."""

from __future__ import annotations

import struct

import pytest

from ship_gym.recording import DamagedRecording
from ship_gym.recording.sealed import checked, seal, verify

HEADER = b"RRF2" + bytes(8)
_MESSAGE = struct.Struct("<QQ")


def stream(*payloads: bytes) -> bytes:
    """Messages as rerun gives them, with what it closes a stream with."""
    messages = [_MESSAGE.pack(2, len(p)) + p for p in payloads]
    return HEADER + b"".join(messages) + _MESSAGE.pack(0, 8) + b"manifest" + bytes(32)


DATA = seal(stream(b"head", b"rows 1", b"rows 2"), stream(b"a picture"))


def ends() -> list[int]:
    """Where the messages end."""
    at, found = 12, []
    while at < len(DATA):
        at += _MESSAGE.size + _MESSAGE.unpack_from(DATA, at)[1]
        found.append(at)
    return found


def verified(data: bytes):
    return checked(data, "run.rrd")


def test_a_whole_file(tmp_path):
    (tmp_path / "run.rrd").write_bytes(DATA)
    found = verify(tmp_path / "run.rrd")
    assert found.complete
    assert found.data == DATA
    assert len(ends()) == 4
    assert found.record == ends()[2]  # without the picture
    assert b"manifest" not in DATA


def test_each_flipped_bit_is_damage_that_names_file_and_byte():
    for bit in range(8 * len(DATA)):
        data = bytearray(DATA)
        data[bit // 8] ^= 1 << bit % 8
        with pytest.raises(DamagedRecording, match=r"run\.rrd.* byte"):
            verified(bytes(data))


def test_each_cut_gives_the_messages_before_it():
    for length in range(len(DATA)):
        whole = max((end for end in ends() if end <= length), default=0)
        if not whole:
            with pytest.raises(DamagedRecording, match=r"run\.rrd.* byte"):
                verified(DATA[:length])
            continue
        found = verified(DATA[:length])
        assert not found.complete
        assert found.data == DATA[:whole]
        assert found.record == min(whole, ends()[2])


def test_no_changed_byte_passes_in_a_file_that_was_cut_too():
    for bit in range(8 * ends()[1]):
        data = bytearray(DATA[: ends()[2] - 1])
        data[bit // 8] ^= 1 << bit % 8
        try:
            found = verified(bytes(data))
        except DamagedRecording:
            continue
        assert not found.complete  # a length that was changed looks like a cut further ahead
        assert DATA.startswith(found.data)


@pytest.mark.parametrize(
    "data",
    [DATA + b"\0", DATA + DATA, DATA[: ends()[1]] + bytes(len(DATA) - ends()[1])],
    ids=["a byte more", "twice", "zeros at the end"],
)
def test_other_changes_are_damage(data):
    with pytest.raises(DamagedRecording, match="damaged"):
        verified(data)


def test_messages_that_changed_places_are_damage():
    a, b, c = ends()[:3]
    with pytest.raises(DamagedRecording, match="damaged"):
        verified(DATA[:a] + DATA[b:c] + DATA[a:b] + DATA[c:])


def test_a_file_without_a_seal_says_so():
    with pytest.raises(DamagedRecording, match=r"no seal .* record it again"):
        verified(stream(b"head" * 40, b"rows"))
    with pytest.raises(DamagedRecording, match="not a readable"):
        verified(b"t,x\n")
    with pytest.raises(DamagedRecording, match="not a readable"):
        verified(b"")
