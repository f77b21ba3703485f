"""A live view sends what a recording holds, row by row, and says why it cannot."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory, live, panels
from ship_gym.ships.loader import load_ship

rr = pytest.importorskip("rerun")
chunk = pytest.importorskip("rerun.chunk")

from ship_gym.recording.rerun_export import log, program, read_chunks  # noqa: E402 (needs rerun)

pytestmark = pytest.mark.filterwarnings("error::rerun.error_utils.RerunWarning")


@pytest.fixture(scope="module")
def ship():
    return load_ship("kcs")


def row_at(t: float, speed: float = 7.0) -> dict[str, float]:
    """A turn in which forces and reward are zero at first."""
    psi = 0.01 * t
    row = {"t": t, "x": speed * 100.0 * math.sin(psi), "y": speed * 100.0 * (1.0 - math.cos(psi))}
    row |= {"psi": psi, "u": speed, "v": 0.0, "r": 0.01, "delta": 0.1, "n": 1.4}
    row |= {"psi_ordered": 0.3, "X_hull": -1e5 * t, "Y_hull": 1e4 * t, "N_hull": 1e6 * t}
    row |= {"X_wave": -1e3 * t, "Y_wave": 1e3 * t, "N_wave": 1e4 * t, "reward": -0.1 * t}
    return row | {"current_speed": 0.5, "current_direction_to": 1.0, "wave_yaw": 0.0}


def streamed(ship, path, rows, track=None) -> Trajectory:
    view = live.LiveView(ship, "heading_keeping", sink=path)
    for row in rows:
        view.show(row, track)
    view.close()
    return Trajectory.from_rrd(path)


def lengths(parts) -> dict[str, int]:
    """Rows in time of each entity."""
    found: dict[str, int] = {}
    for part in parts:
        if not part.is_static:
            found[part.entity_path] = found.get(part.entity_path, 0) + part.num_rows
    return found


def test_streamed_rows_read_back(tmp_path, ship):
    rows = [row_at(float(t)) for t in range(20)]
    run = streamed(ship, tmp_path / "run.rrd", rows, track=np.array([[0.0, 0.0], [9.0, 9.0]]))
    assert len(run) == 20
    for name in run.names:
        assert run[name].tolist() == [row[name] for row in rows]
    assert "wave_yaw" not in run  # calm water
    assert run.meta["task"] == "heading_keeping"
    assert run.meta["ship"]["L"] == ship.hull.L
    assert run.meta["waypoints"] == [[0.0, 0.0], [9.0, 9.0]]


def watched(ship, path, rows, monkeypatch, sea=None) -> None:
    """Send rows as to a viewer, but into a file."""

    def to_file(name, sink):
        stream = rr.RecordingStream(name)
        stream.save(path)
        return stream

    monkeypatch.setattr(live, "_check_listening", lambda address: None)
    view = live.LiveView(ship, "heading_keeping", sink="rerun+http://127.0.0.1:9/proxy")
    monkeypatch.setattr(view._rerun, "open_stream", to_file)
    for row in rows:
        view.show(row, None, sea)
    view.close()


def test_views_are_those_of_a_recording(tmp_path, ship, monkeypatch):
    rows = [row_at(float(t)) for t in range(20)]
    streamed(ship, tmp_path / "run.rrd", rows)
    watched(ship, tmp_path / "live.rrd", rows, monkeypatch)
    # A viewer gets every entity of the recording but the record, with as many rows in time; but in
    # its first row there is no force yet, so no arrow. Arrows of forces have a row in some seconds.
    whole = read_chunks(tmp_path / "run.rrd")
    shown = [part for part in whole if not part.entity_path.startswith("/record")]
    found = chunk.RrdReader(tmp_path / "live.rrd")
    sent = found.stream().to_chunks()
    assert lengths(shown)["/world/at_ship/wave_force"] == 7
    assert lengths(sent) == lengths(shown) | {"/world/at_ship/wave_force": 6}
    assert found.blueprints()
    assert {part.entity_path for part in sent} == {part.entity_path for part in shown}


def test_a_killed_view_leaves_a_journal(tmp_path, ship):
    view = live.LiveView(ship, "heading_keeping", sink=tmp_path / "run.rrd")
    for t in range(40):
        view.show(row_at(float(t)))
    run = Trajectory.from_file(tmp_path / "run.rrd.partial")  # as it is now
    assert len(run) == 32
    assert not run.complete
    view.close()
    assert not (tmp_path / "run.rrd.partial").exists()


def test_the_sea_grows_with_the_way(tmp_path, ship, monkeypatch):
    rows = [row_at(float(t), speed=100.0) for t in range(60)]  # leaves the first area
    watched(ship, tmp_path / "live.rrd", rows, monkeypatch)
    sent = chunk.RrdReader(tmp_path / "live.rrd").stream().to_chunks()
    assert lengths(sent)["/world/ship"] == 60
    seas = [part for part in sent if part.entity_path == "/world/sea"]
    assert sum(part.num_rows for part in seas) > 1


def test_a_row_of_the_past_begins_a_new_episode(tmp_path, ship):
    view = live.LiveView(ship, "heading_keeping", sink=tmp_path / "run.rrd")
    for t in (0.0, 1.0, 1.0, 2.0, 0.0, 1.0):
        view.show(row_at(t))
    assert (tmp_path / "run.rrd").is_file()  # the first episode is over
    view.close()
    view.close()
    assert Trajectory.from_rrd(tmp_path / "run.rrd")["t"].tolist() == [0.0, 1.0, 2.0]
    assert Trajectory.from_rrd(tmp_path / "run_2.rrd")["t"].tolist() == [0.0, 1.0]


def test_the_unit_of_forces_stays_that_of_the_ship():
    small = {"X_hull": np.array([0.0, 10.0])}
    titles = [panel.title for panel in panels.motion_panels(small, {"X": 2e6, "Y": 1.0, "N": 1.0})]
    assert titles == ["X: surge force [MN]"]
    assert [panel.title for panel in panels.motion_panels(small)] == ["X: surge force [N]"]


@pytest.mark.parametrize("sink", ["run.mp4", "http://127.0.0.1:9876/proxy", ""])
def test_other_sinks_are_refused(ship, sink):
    with pytest.raises(ConfigError, match=r"sink = .*allowed is a file '\*\.rrd'"):
        live.LiveView(ship, "heading_keeping", sink=sink)


def test_a_viewer_that_does_not_listen_is_noticed(ship):
    with pytest.raises(RuntimeError, match=r"no viewer listens .*rgb_array"):
        live.LiveView(ship, "heading_keeping", sink="rerun+http://127.0.0.1:9/proxy")


def test_no_screen_is_said_at_once(monkeypatch, ship):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(RuntimeError, match=r"no screen .*rgb_array.*ship-gym record"):
        live.LiveView(ship, "heading_keeping")


def test_a_viewer_that_cannot_start_is_said(monkeypatch, ship):
    monkeypatch.setenv("DISPLAY", ":0")

    def fail(*_):
        raise RuntimeError("Failed to find Rerun Viewer executable in PATH.")

    view = live.LiveView(ship, "heading_keeping")
    monkeypatch.setattr(view._rerun, "open_stream", fail)
    with pytest.raises(RuntimeError, match=r"cannot be opened: Failed to find .*rgb_array"):
        view.show(row_at(0.0))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"psi": math.nan}, "psi = nan: must be finite"),
        ({"extra": 1.0}, "first row of the episode: with extra"),
    ],
)
def test_rows_that_do_not_fit_are_refused(tmp_path, ship, change, message):
    view = live.LiveView(ship, "heading_keeping", sink=tmp_path / "run.rrd")
    view.show(row_at(0.0))
    with pytest.raises(ConfigError, match=message):
        view.show(row_at(1.0) | change)
    with pytest.raises(ConfigError, match="needs 't'"):
        view.show({"psi": 0.0})
    view.show(row_at(1.0))
    view.close()
    assert len(Trajectory.from_rrd(tmp_path / "run.rrd")) == 2


def test_a_viewer_is_opened_on_loopback_only(monkeypatch):
    """Rerun's own spawn would listen on every address of the machine."""
    started = []

    class Program:
        def __init__(self, arguments, port, detached):
            assert detached  # it stays open when training is interrupted
            started.append(port)

        def until(self, ready):
            return True

    monkeypatch.setattr(log, "Program", Program)
    monkeypatch.setattr(log, "_VIEWERS", [])
    monkeypatch.setattr(log, "listens", lambda port: False)
    assert log.open_viewer() == live._ADDRESS
    assert started == [log.PORT]
    monkeypatch.setattr(log, "listens", lambda port: True)  # one is open
    assert log.open_viewer() == live._ADDRESS
    assert started == [log.PORT]
    assert program.HOST == "127.0.0.1"


def test_the_viewer_of_the_screen_is_told_to_bind_to_loopback(monkeypatch):
    """What ``render_mode="human"`` starts: the whole command."""
    commands, answers = [], iter([False, True])
    monkeypatch.setattr(program.subprocess, "Popen", lambda given, **_: commands.append(given))
    monkeypatch.setattr(log, "_VIEWERS", [])
    monkeypatch.setattr(log, "listens", lambda port: next(answers))
    log.open_viewer()
    (command,) = commands
    assert command[1:5] == ["--bind", "127.0.0.1", "--port", str(log.PORT)]
    assert "--bind" not in command[5:]


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="needs the list of Linux")
def test_what_is_started_listens_on_loopback_only():
    """By the system's own list of sockets, of the same program without a window."""
    (port,) = program.free_ports(1)
    viewer = program.Program(["--serve-grpc"], port)
    try:
        viewer.until(lambda: program.listens(port))
        assert listening(port) == {"0100007F"}  # 127.0.0.1
    finally:
        viewer.end()


def listening(port: int) -> set[str]:
    """Addresses of this machine at which somebody listens on a port, as Linux writes them."""
    rows = [
        line.split()
        for name in ("tcp", "tcp6")
        for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]
    ]
    found = [row[1].split(":") for row in rows if row[3] == "0A"]
    return {address for address, number in found if int(number, 16) == port}


def test_a_viewer_that_does_not_come_is_a_runtime_error(monkeypatch):
    def fail(*_, **__):
        raise program.NoViewer("rerun's viewer: no graphics")

    monkeypatch.setattr(log, "listens", lambda port: False)
    monkeypatch.setattr(log, "Program", fail)
    with pytest.raises(RuntimeError, match="no graphics"):
        log.open_viewer()


def test_a_live_view_shows_the_waves(tmp_path, ship, monkeypatch):
    waves = {"amplitude": [2.0], "omega": [0.5], "k": [0.5**2 / 9.80665], "direction_to": [0.0]}
    sea = {"sea": {"wave_height": 4.0, "wave_period": 12.6, "wave_direction_to": 0.0}}
    sea["waves"] = waves | {"phase": [0.0]}
    rows = [row_at(float(t)) for t in range(20)]
    watched(ship, tmp_path / "live.rrd", rows, monkeypatch, sea)
    sent = lengths(chunk.RrdReader(tmp_path / "live.rrd").stream().to_chunks())
    assert 4 <= sent["/world/sea"] <= 7  # a picture in some seconds
    assert sent["/world/at_ship/waves"] == 1
