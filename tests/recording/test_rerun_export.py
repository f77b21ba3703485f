"""Recordings give back every bit, are written whole or not at all, and show what they can."""

from __future__ import annotations

import gc
import os
import warnings

import numpy as np
import pytest

from ship_gym.recording import DamagedRecording, Trajectory

rr = pytest.importorskip("rerun")
chunk = pytest.importorskip("rerun.chunk")

from ship_gym.recording import rerun_export  # noqa: E402 (needs rerun)
from ship_gym.recording.rerun_export import compare  # noqa: E402

pytestmark = pytest.mark.filterwarnings("error::rerun.error_utils.RerunWarning")

SHIP = {"name": "kcs", "L": 230.0, "B": 32.2, "d": 10.8, "A_R": 115.0, "D_P": 7.9}


def steered_run(rows: int = 60) -> Trajectory:
    """A run with all that a viewer can show."""
    t = np.arange(rows) * 1.0
    psi = 0.01 * t
    columns = {"t": t, "x": 7.0 * np.sin(psi) / 0.01, "y": 7.0 * (1.0 - np.cos(psi)) / 0.01}
    columns |= {"psi": psi, "u": 7.0 + 0.0 * t, "v": -0.1 * t, "r": 0.01 + 0.0 * t}
    columns |= {"delta": 0.1 * np.sin(t), "n": 1.4 + 0.0 * t, "psi_ordered": 0.3 + 0.0 * t}
    columns |= {"delta_command": 0.1 + 0.0 * t, "n_command": 1.4 + 0.0 * t, "reward": -psi}
    columns |= {f"{axis}_{part}": 1e5 * np.cos(t) for axis in "XYN" for part in ("hull", "rudder")}
    columns |= {f"{axis}_disturbance": 1e3 * np.sin(t) for axis in "XYN"}
    columns |= {"reward_heading": -psi, "current_speed": 0.5 + 0.0 * t, "wind_speed": 9.0 + 0.0 * t}
    columns |= {"current_direction_to": 1.0 + 0.0 * t, "wind_direction_from": 2.0 + 0.0 * t}
    return Trajectory(
        columns, {"task": "heading", "seed": 3, "ship": SHIP, "waypoints": [[0, 0], [9, 9]]}
    )


def entities(path) -> set[str]:
    return {part.entity_path for part in rerun_export.read_chunks(path)}


def reader(path):
    """Open a file with rerun's own reader, which warns that it has no manifest."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return chunk.RrdReader(path)


def plots(path) -> set[str]:
    """Names of the plots of a file."""
    found = set()
    for part in reader(path).stream():
        if part.entity_path.startswith("/plots/"):
            names = part.to_record_batch().schema.names
            found |= {n.split(":")[1] for n in names if n.startswith("ShipGymPlot:")}
    return found


def same(one: Trajectory, two: Trajectory) -> bool:
    bits = all(one[name].tobytes() == two[name].tobytes() for name in one.names)
    return one.names == two.names and one.meta == two.meta and bits


def test_round_trip_keeps_every_bit(tmp_path):
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(1e-12, 1e-2, 500)) - 2.0  # some steps below rerun's nanosecond
    bits = rng.integers(0, 2**63, 500).astype(np.uint64).view(np.float64)
    columns = {
        "t": t,
        "any bits": np.where(np.isfinite(bits), bits, -0.0),
        "tiny": np.full(500, -5e-324),
        "reward/heading.x:y": rng.normal(size=500),
        "sim_time": rng.normal(size=500),
        "rerun.controls.RowId": rng.normal(size=500),
        "json": rng.normal(size=500),
        "\u03c8 [\u00b0]": rng.normal(size=500),
    }
    meta = {
        "config": {"deep": [1, 2.5, None, True, {"\u03c8": "\u00b0\n"}]},
        "seed": 2**60,
        "x": 0.1,
    }
    run = Trajectory(columns, meta)
    run.to_rrd(tmp_path / "run.rrd")
    assert same(run, Trajectory.from_rrd(tmp_path / "run.rrd"))


def test_everything_is_shown_and_small(tmp_path):
    run = steered_run(600)
    path = tmp_path / "run.rrd"
    run.to_rrd(path)
    assert same(run, Trajectory.from_rrd(path))
    assert path.stat().st_size < 2e6
    shown = entities(path)
    for name in ("hull", "house", "rudder", "propeller", "ahead"):
        assert f"/world/ship/{name}" in shown
    for name in ("compass", "ordered_heading", "current", "wind", "disturbance_force"):
        assert f"/world/at_ship/{name}" in shown
    assert plots(path) == {
        *("heading", "rudder", "speed", "reward", "heading_error", "yaw_rate"),
        *("force_X", "force_Y", "force_N"),
    }
    assert {"/plan/track", "/plan/ship", "/plan/grid", "/plan/route", "/about", "/marks"} <= shown
    assert reader(path).blueprints()


@pytest.mark.parametrize(
    ("kept", "shown", "hidden"),
    [
        (["x", "y", "psi", "delta"], "/world/ship/hull", "/plots/reward"),
        (["psi", "delta"], "/plots/often", "/world/sea"),
        (["reward"], "/plots/often", "/plots/seldom"),
        ([], "/about", "/plan/track"),
    ],
)
def test_missing_groups_are_left_out(tmp_path, kept, shown, hidden):
    run = steered_run()
    run = Trajectory({name: run[name] for name in ["t", *kept]}, run.meta)
    run.to_rrd(tmp_path / "run.rrd")
    assert same(run, Trajectory.from_rrd(tmp_path / "run.rrd"))
    found = entities(tmp_path / "run.rrd")
    assert shown in found
    assert hidden not in found


@pytest.mark.parametrize("ship", [None, "kcs", {"name": "kcs"}, {"L": 3.0, "B": 0.4, "d": 0.1}])
def test_ship_sizes_are_optional(tmp_path, ship):
    run = Trajectory(steered_run(1).columns, {"ship": ship})  # one row is enough, too
    run.to_rrd(tmp_path / "run.rrd")
    sized = isinstance(ship, dict) and "L" in ship
    assert ("/world/ship/hull" in entities(tmp_path / "run.rrd")) == sized


def test_several_recordings_in_one_process(tmp_path):
    runs = [steered_run(rows) for rows in (5, 6, 7)]
    for k, run in enumerate(runs):
        run.to_rrd(tmp_path / f"{k}.rrd")
    gc.collect()
    for k, run in enumerate(runs):
        assert same(run, Trajectory.from_rrd(tmp_path / f"{k}.rrd"))
        assert len(reader(tmp_path / f"{k}.rrd").recordings()) == 1
    assert rr.get_global_data_recording() is None
    assert rr.get_thread_local_data_recording() is None


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="counts threads as Linux does")
@pytest.mark.parametrize("kind", ["record", "picture", "comparison"])
def test_recordings_leave_no_threads_behind(tmp_path, kind):
    """Nor the memory of their streams: a training writes thousands."""

    def write():
        if kind == "comparison":
            compare.write_comparison([steered_run(), steered_run(50)], tmp_path / "two.rrd")
        else:
            steered_run().to_rrd(tmp_path / "run.rrd", picture=kind == "picture")

    def threads():
        gc.collect()
        return len(os.listdir("/proc/self/task"))

    write()
    before = threads()
    for _ in range(4):
        write()
    assert threads() <= before


def rewritten(run: Trajectory, folder):
    """A file of `run` whose parts rerun has written again in another order."""
    run.to_rrd(folder / "run.rrd")
    again = chunk.LazyChunkStream.from_iter(rerun_export.read_chunks(folder / "run.rrd")[::-1])
    again.write_rrd(folder / "again.rrd", application_id="a", recording_id="b")
    return folder / "again.rrd"


def test_rewritten_and_split_file_still_reads(tmp_path):
    run = steered_run(600)  # of several pieces
    path = rewritten(run, tmp_path)
    with pytest.raises(DamagedRecording, match=r"again\.rrd carries no seal .* record it again"):
        Trajectory.from_rrd(path)
    assert same(run, Trajectory.from_rrd(path, sealed=False))


def test_columns_of_a_rewritten_file_are_compared_with_their_checksums(tmp_path, monkeypatch):
    monkeypatch.setattr(rerun_export.rrd_file, "_checksum", lambda data: "0")
    path = rewritten(steered_run(), tmp_path)
    monkeypatch.undo()
    with pytest.raises(DamagedRecording, match=r"again\.rrd: the meta is not the one"):
        Trajectory.from_rrd(path, sealed=False)


@pytest.mark.parametrize(
    "step",
    ["picture._log_scene", "picture.send_panels", "picture.blueprint", "rrd_file._check_record"],
)
def test_interrupted_write_leaves_the_old_file(tmp_path, monkeypatch, step):
    path = tmp_path / "run.rrd"
    path.write_bytes(b"old")

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"{rerun_export.__name__}.{step}", interrupt)
    with pytest.raises(KeyboardInterrupt):
        steered_run().to_rrd(path)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["run.rrd"]


def test_incomplete_file_is_noticed(tmp_path, monkeypatch):
    monkeypatch.setattr(rerun_export.rrd_file, "log_record", lambda *_: None)
    with pytest.raises(OSError, match="did not make a whole record"):
        steered_run().to_rrd(tmp_path / "run.rrd")
    assert os.listdir(tmp_path) == []


def test_no_bit_can_be_changed(tmp_path):
    run = steered_run()
    path = tmp_path / "run.rrd"
    run.to_rrd(path)
    data = path.read_bytes()
    for bit in np.random.default_rng(1).integers(0, 8 * len(data), 60):
        changed = bytearray(data)
        changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        with pytest.raises(DamagedRecording, match=r"run\.rrd"):
            Trajectory.from_rrd(path)


def test_a_cut_file_gives_its_first_rows_and_says_so(tmp_path):
    run = steered_run(600)
    path = tmp_path / "run.rrd"
    run.to_rrd(path)
    data = path.read_bytes()
    found = []
    for length in np.linspace(0, len(data), 40, endpoint=False).astype(int):
        path.write_bytes(data[:length])
        try:
            read = Trajectory.from_rrd(path)
        except DamagedRecording as error:
            assert "run.rrd" in str(error)
            found.append(0)
            continue
        assert not read.complete
        assert read.meta == run.meta | {"complete": False}
        for name in run.names:
            assert read[name].tobytes() == run[name][: len(read)].tobytes()
        found.append(len(read))
    assert set(found) == {0, 200, 400, 600}


def test_the_record_alone(tmp_path):
    run = steered_run()
    run.to_rrd(tmp_path / "run.rrd", picture=False)
    assert same(run, Trajectory.from_rrd(tmp_path / "run.rrd"))
    assert entities(tmp_path / "run.rrd") == {"/record", "/record/meta", "/__properties"}


def test_rerun_that_is_off_is_noticed(tmp_path, monkeypatch):
    monkeypatch.setenv("RERUN", "off")
    with pytest.raises(OSError, match=r"run\.rrd.*RERUN=off"):
        steered_run().to_rrd(tmp_path / "run.rrd")
    assert os.listdir(tmp_path) == []


def test_a_full_disk_is_one_line_and_leaves_nothing(tmp_path, limited):
    with limited(20_000), pytest.raises(OSError, match=r"run\.rrd.*too large") as error:
        steered_run().to_rrd(tmp_path / "run.rrd")
    assert "\n" not in str(error.value)
    assert os.listdir(tmp_path) == []


def test_no_room_for_the_copy_that_is_read_is_said(tmp_path, limited):
    steered_run().to_rrd(tmp_path / "run.rrd")
    with limited(1000), pytest.raises(OSError, match=r"run\.rrd cannot be read: no copy in "):
        Trajectory.from_rrd(tmp_path / "run.rrd")


def test_other_files_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="no recording"):
        Trajectory.from_rrd(tmp_path / "none.rrd")
    (tmp_path / "text.rrd").write_text("not a recording")
    with pytest.raises(ValueError, match="not a readable"):
        Trajectory.from_rrd(tmp_path / "text.rrd")
    stream = rr.RecordingStream("other")
    stream.save(tmp_path / "other.rrd")
    stream.log("text", rr.TextLog("hello"), static=True)
    stream.flush()
    stream.disconnect()
    with pytest.raises(DamagedRecording, match="carries no seal"):
        Trajectory.from_rrd(tmp_path / "other.rrd")
    with pytest.raises(DamagedRecording, match="not a recording of Ship Gym"):
        Trajectory.from_rrd(tmp_path / "other.rrd", sealed=False)


def test_waves_and_wind_are_shown(tmp_path):
    run = steered_run()
    t = run["t"]
    more = {f"wave_{name}": 0.01 * np.cos(t) for name in ("sway", "roll", "yaw", "yaw_rate")}
    more |= {f"{axis}_{part}": 1e4 * np.sin(t) for axis in "XYN" for part in ("wave", "wind")}
    run = Trajectory({**run.columns, **more}, run.meta)
    run.to_rrd(tmp_path / "run.rrd")
    assert same(run, Trajectory.from_rrd(tmp_path / "run.rrd"))
    shown = entities(tmp_path / "run.rrd")
    assert {"/world/at_ship/wave_force", "/world/at_ship/wind_force"} <= shown
    assert "wave_motion" in plots(tmp_path / "run.rrd")
