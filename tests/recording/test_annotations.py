"""Card and marks are in the rerun file, each mark at its time."""

from __future__ import annotations

import numpy as np
import pytest

from ship_gym.recording import Trajectory
from ship_gym.recording.card import card_text
from ship_gym.recording.marks import marks
from ship_gym.recording.panel import Panel, Series

rr = pytest.importorskip("rerun")
chunk = pytest.importorskip("rerun.chunk")

from ship_gym.recording.rerun_export import annotations  # noqa: E402 (needs rerun)
from ship_gym.recording.rerun_export.log import TIMELINE, Output  # noqa: E402


def run() -> Trajectory:
    t = np.arange(60.0)
    psi = np.where(t < 20, 0.0, 0.2)
    columns = {"t": t, "psi": psi, "psi_ordered": np.where(t < 20, 0.0, 0.25), "delta": 0.6 + 0 * t}
    meta = {"ship": {"name": "kcs", "delta_max": 0.6}, "failed": True, "outcome": "heading limit"}
    return Trajectory(columns, meta)


def written(tmp_path, send) -> dict[str, list]:
    """Columns of what `send(out)` has sent, by entity and name."""
    stream = rr.RecordingStream("ship_gym_test")
    stream.save(tmp_path / "run.rrd")
    send(Output(stream))
    stream.flush()
    stream.disconnect()
    found: dict[str, list] = {}
    for part in chunk.RrdReader(tmp_path / "run.rrd").stream().to_chunks():
        batch = part.to_record_batch()
        for name in batch.schema.names:
            found.setdefault(f"{part.entity_path} {name}", []).extend(
                batch.column(name).to_pylist()
            )
    return found


def test_marks_are_entries_of_a_log_with_levels(tmp_path):
    trajectory = run()
    found = written(tmp_path, lambda out: annotations.send_marks(out, trajectory))
    texts = [text for (text,) in found["/marks TextLog:text"]]
    levels = [level for (level,) in found["/marks TextLog:level"]]
    assert texts == [mark.text for mark in marks(trajectory)]
    assert levels[-1] == "ERROR"  # the episode has failed
    assert (
        levels[texts.index("ordered heading 014\N{DEGREE SIGN}, 14.3\N{DEGREE SIGN} to starboard")]
        == "INFO"
    )
    times = [time.total_seconds() for time in found[f"/marks {TIMELINE}"]]
    assert times == [mark.time for mark in marks(trajectory)]


def test_card_is_a_page(tmp_path):
    found = written(tmp_path, lambda out: annotations.send_card(out, run()))
    assert found["/about TextDocument:text"] == [[card_text(run())]]


def test_points_lie_on_the_line_of_a_plot(tmp_path):
    trajectory = run()
    t = trajectory["t"]
    panel = Panel(
        "plots/rudder", "Rudder", [Series("a", 0.0 * t, (1, 2, 3)), Series("b", t, (4, 5, 6))]
    )
    seen = marks(trajectory)
    found = written(tmp_path, lambda out: annotations.send_points(out, t, panel, seen, line=1))
    heights = [
        value for (value,) in found["/plots/rudder/marks Scalars:scalars"] if value is not None
    ]
    assert heights == [mark.time for mark in seen if mark.kind != "end"]


def test_plot_of_a_run_without_marks_gets_no_points(tmp_path):
    trajectory = Trajectory({"t": [0.0, 1.0], "n": [1.0, 1.0]})
    panel = Panel("plots/rpm", "Rpm", [Series("n", trajectory["n"], (1, 2, 3))])
    found = written(
        tmp_path,
        lambda out: annotations.send_points(out, trajectory["t"], panel, marks(trajectory)),
    )
    assert not [name for name in found if name.startswith("/plots")]
