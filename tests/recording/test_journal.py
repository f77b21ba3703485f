"""A journal gives its whole chunks, whatever has happened to what comes after."""

from __future__ import annotations

import errno

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import DamagedRecording, Trajectory
from ship_gym.recording.journal import Journal, journal_path, parsed, read_journal

NAMES = ["t", "x"]
ROWS = np.array([[float(t), -0.1 * t] for t in range(9)])


def written(folder, chunks: int = 3):
    """A journal of chunks of three rows, as a killed run leaves it; and where each chunk ends."""
    journal = Journal(folder / "run.rrd.partial", NAMES, {"seed": 3})
    ends = []
    for k in range(chunks):
        journal.append(ROWS[3 * k : 3 * k + 3])
        ends.append(journal.path.stat().st_size)
    journal.close()
    return journal.path, ends


def read(path, data: bytes) -> int:
    """Rows of a journal with these bytes, none of which is changed."""
    columns, meta = parsed(data, path)
    count = len(columns["t"])
    assert np.array_equal(np.stack([columns[k] for k in NAMES], axis=1), ROWS[:count])
    assert meta == {"seed": 3, "complete": False}
    return count


def test_rows_are_there_while_it_is_written(tmp_path):
    journal = Journal(journal_path(tmp_path / "new" / "run.rrd"), NAMES, {})
    journal.append(ROWS[:3])
    run = Trajectory.from_file(tmp_path / "new" / "run.rrd.partial")
    assert run["x"].tobytes() == np.ascontiguousarray(ROWS[:3, 1]).tobytes()
    assert not run.complete
    journal.remove()
    assert not journal.path.exists()


def test_each_cut_gives_the_chunks_before_it(tmp_path):
    path, ends = written(tmp_path)
    data = path.read_bytes()
    for length in range(len(data) + 1):
        whole = sum(end <= length for end in ends)
        if whole:
            assert read(path, data[:length]) == 3 * whole
        else:
            with pytest.raises(DamagedRecording, match=r"run\.rrd\.partial.* byte"):
                read(path, data[:length])
    assert read(path, data + bytes(500)) == 9  # a file that grew while the machine went down


def test_zeros_where_a_block_was_not_written_are_a_cut(tmp_path):
    """So a machine that goes down leaves a file that had grown already."""
    path, ends = written(tmp_path)
    data = path.read_bytes()
    for length in range(ends[0], ends[1] - 16):  # the digest of the second chunk is 16 bytes long
        assert read(path, data[:length] + bytes(len(data) - length)) == 3


def test_a_journal_without_rows_does_not_stay(tmp_path, limited):
    path, _ = written(tmp_path, 0)
    assert not path.exists()
    journal = Journal(path, NAMES, {})
    with limited(path.stat().st_size + 10), pytest.raises(OSError, match=r"run\.rrd\.partial"):
        journal.append(ROWS)
    journal.close()
    assert not path.exists()


def test_no_changed_number_passes(tmp_path):
    path, _ = written(tmp_path)
    data = path.read_bytes()
    refused = 0
    for bit in range(8 * len(data)):
        changed = bytearray(data)
        changed[bit // 8] ^= 1 << bit % 8
        try:
            assert read(path, bytes(changed)) < 9  # a length that was changed looks like a cut
        except DamagedRecording:
            refused += 1
    assert refused > 0.9 * 8 * len(data)


def test_one_writes_it_at_a_time(tmp_path):
    path, _ = written(tmp_path, 1)
    journal = Journal(path, NAMES, {})  # that of a dead run is overwritten
    with pytest.raises(ConfigError, match=r"run\.rrd\.partial: another run is recorded"):
        Journal(path, NAMES, {})
    with pytest.raises(DamagedRecording, match="before its first whole chunk"):
        read_journal(path)
    journal.remove()
    Journal(path, NAMES, {}).close()


def test_a_full_disk_leaves_the_chunks_before(tmp_path, limited):
    journal = Journal(tmp_path / "run.rrd.partial", NAMES, {})
    journal.append(ROWS)
    with limited(journal.path.stat().st_size + 100):
        with pytest.raises(OSError, match=r"run\.rrd\.partial"):
            journal.append(np.repeat(ROWS, 100, axis=0))
        journal.append(ROWS[:1])  # where there is room again
    journal.close()
    assert len(read_journal(journal.path)[0]["t"]) == 10


def test_a_file_system_without_locks_is_said(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")

    def flock(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", flock)
    with pytest.raises(OSError, match=r"no lock: No locks available.*run\.rrd\.partial"):
        Journal(tmp_path / "run.rrd.partial", NAMES, {})
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_said_at_once(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        Journal(tmp_path / "file" / "run.rrd.partial", NAMES, {})


def test_other_files_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.rrd\.partial"):
        read_journal(tmp_path / "none.rrd.partial")
    (tmp_path / "text.rrd.partial").write_text("t,x\n")
    with pytest.raises(DamagedRecording, match="not a journal"):
        read_journal(tmp_path / "text.rrd.partial")


def with_head(path, head: bytes, rows=ROWS[:3], width: int | None = None):
    """A journal whose digests are right, whatever its head says."""
    journal = Journal(path, NAMES, {})
    journal._file.truncate(0)
    journal._file.seek(0)
    journal._digest = b""
    journal._write(b"Ship Gym journal 1\n")
    journal._append(b"HEAD", head)
    journal._append(b"ROWS", rows.tobytes()[: None if width is None else width])
    journal._file.close()
    return path


@pytest.mark.parametrize(
    ("head", "words"),
    [
        (b"", "not a recording, or damaged: Expecting value"),
        (b"[" * 100_000, "nested too deep"),
        (b"\xff\xfe", "not a recording, or damaged"),
        (b"[1]", "not a recording, or damaged"),
        (b'{"columns": ["t", "x"]}', "no 'meta'"),
        (b'{"columns": 7, "meta": {}}', "columns = 7: allowed is a list of names"),
        (b'{"columns": ["t", [1]], "meta": {}}', "allowed is a list of names"),
        (b'{"columns": ["t", "t"], "meta": {}}', "each is allowed once"),
        (b'{"columns": [], "meta": {}}', "each is allowed once, none not"),
        (b'{"columns": ["t", "x"], "meta": 1}', "meta = 1: allowed is a mapping"),
        (b'{"columns": ["t", "x", "y", "z"], "meta": {}}', "not a recording, or damaged: cannot"),
        (b'{"columns": ["a", "x"], "meta": {}}', "a trajectory needs a column 't'"),
        (b'{"columns": ["t", "\\u0000"], "meta": {}}', "column names are printable"),
    ],
)
def test_a_head_that_is_sealed_and_wrong_is_one_line(tmp_path, head, words):
    """The digests are no signature: what lies behind them may be anything."""
    path = with_head(tmp_path / "run.rrd.partial", head)
    with pytest.raises(DamagedRecording) as error:
        Trajectory.from_file(path)
    assert words in str(error.value) and str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (np.array([[0.0, np.nan]]), "column 'x' is nan in row 0"),
        (np.array([[1.0, 0.0], [0.0, 0.0]]), "column 't' does not increase at row 1"),
        (np.zeros(3), "not a recording, or damaged: cannot reshape"),
    ],
)
def test_rows_that_are_sealed_and_wrong_are_one_line(tmp_path, rows, words):
    head = b'{"columns": ["t", "x"], "meta": {}}'
    path = with_head(tmp_path / "run.rrd.partial", head, rows)
    with pytest.raises(DamagedRecording) as error:
        Trajectory.from_file(path)
    assert words in str(error.value) and str(path) in str(error.value)


def test_half_a_number_is_one_line(tmp_path):
    head = b'{"columns": ["t", "x"], "meta": {}}'
    path = with_head(tmp_path / "run.rrd.partial", head, width=45)
    with pytest.raises(DamagedRecording, match="buffer size must be a multiple"):
        Trajectory.from_file(path)
