"""What a viewer is sent of a run: layout, marks, water, and how many bytes that takes."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

from ship_gym.conventions import G
from ship_gym.recording import Trajectory

rr = pytest.importorskip("rerun")
chunk = pytest.importorskip("rerun.chunk")

import rerun.blueprint as rrb  # noqa: E402 (needs rerun)

from ship_gym.recording.rerun_export import blueprint, log  # noqa: E402 (needs rerun)
from ship_gym.recording.rerun_export.rows import MOST_ROWS, changes, shown_rows  # noqa: E402

pytestmark = pytest.mark.filterwarnings("error::rerun.error_utils.RerunWarning")

SHIP = {"name": "kcs", "L": 230.0, "B": 32.2, "d": 10.8, "delta_max": 0.61}


def waves() -> dict[str, list[float]]:
    """Sixty long-crested waves, as an episode has them."""
    rng = np.random.default_rng(3)
    k = (2.0 * math.pi / np.linspace(90.0, 400.0, 60)).tolist()
    return {
        "amplitude": [0.28] * 60,
        "omega": np.sqrt(G * np.array(k)).tolist(),
        "k": k,
        "direction_to": [0.4] * 60,
        "phase": rng.uniform(0.0, 2.0 * math.pi, 60).tolist(),
    }


def run(rows: int = 601, **meta) -> Trajectory:
    """A run in which everything moves as in an episode."""
    t, rng = np.arange(rows) * 1.0, np.random.default_rng(1)

    def slowly(size):
        return size * np.cumsum(rng.normal(size=rows)) / math.sqrt(rows)

    psi = 0.2 + slowly(0.05)
    columns = {"t": t, "x": 7.0 * np.cumsum(np.cos(psi)), "y": 7.0 * np.cumsum(np.sin(psi))}
    columns |= {"psi": psi, "u": 7.0 + slowly(0.2), "v": slowly(0.1), "r": slowly(0.01)}
    columns |= {"delta": slowly(0.2), "n": 1.4 + slowly(0.01), "psi_ordered": 0.2 + 0.0 * t}
    columns |= {"delta_command": slowly(0.2), "psi_measured": psi + slowly(0.01)}
    columns |= {"reward": -psi, "reward_heading": -psi}
    columns |= {f"{a}_{p}": slowly(1e5) for a in "XYN" for p in ("hull", "rudder", "wave", "wind")}
    columns |= {f"wave_{name}": slowly(0.03) for name in ("sway", "roll", "yaw", "yaw_rate")}
    return Trajectory(columns, {"task": "heading", "ship": SHIP, **meta})


def reader(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return chunk.RrdReader(path)


def batches(path, entity: str) -> list:
    """Record batches of an entity."""
    parts = [part for part in reader(path).stream() if part.entity_path == entity]
    return [part.to_record_batch() for part in parts]


def layout(path) -> dict[str, dict]:
    """Components of the blueprint of a file by entity, with their values."""
    found: dict[str, dict] = {}
    file = reader(path)
    for part in file.stream(store=file.blueprints()[0]):
        batch = part.to_record_batch()
        names = [name for name in batch.schema.names if ":" in name]
        values = {name: batch.column(name).to_pylist()[-1] for name in names}
        found.setdefault(part.entity_path, {}).update(values)
    return found


def test_it_opens_paused_with_collapsed_panels_and_says_what_was_run(tmp_path):
    made = run(controller="pid", seed=7, outcome="end of time", sea={"wave_height": 6.0,
               "wave_period": 12.4, "wave_direction_to": 0.0})  # fmt: skip
    made.to_rrd(tmp_path / "run.rrd")
    found = layout(tmp_path / "run.rrd")
    panel = found["/time_panel"]
    assert panel["TimePanelBlueprint:play_state"] == [1]  # paused
    assert panel["TimePanelBlueprint:state"] == [2]  # collapsed
    names = [v.get("ViewBlueprint:display_name", [""])[0] for v in found.values()]
    (title,) = (name for name in names if "kcs" in name)
    assert title.startswith("heading, kcs, pid, seed 7: end of time. waves H 6.0 m, T 12.4 s")
    assert {"Card", "Marks", "Plan, north up [m]"} <= set(names)
    (tabs,) = (
        box
        for box in found.values()
        if box.get("ContainerBlueprint:container_kind") == [1] and len(box) > 0
        and len(box["ContainerBlueprint:contents"]) == 3
        and box["ContainerBlueprint:contents"][0].startswith("container")
    )  # fmt: skip
    assert tabs["ContainerBlueprint:active_tab"] == tabs["ContainerBlueprint:contents"][:1]


def test_a_packed_blueprint_is_the_usual_one_in_fewer_messages(tmp_path):
    lines = rr.SeriesLines(names=["a"], colors=[[1, 2, 3]])
    view = rrb.TimeSeriesView(
        origin="/p", contents="/p", name="P", overrides={"p": lines.visualizer()},
        axis_y=rrb.ScalarAxis(range=(0.0, 1.0)),
    )  # fmt: skip
    parts = rrb.Tabs(view, rrb.TextDocumentView()), rrb.TimePanel(play_state="paused")
    sizes = []
    for kind in (rrb.Blueprint, blueprint.Packed):
        path = tmp_path / f"{kind.__name__}.rrd"
        stream = rr.RecordingStream("packed")
        stream.save(path)
        stream.send_blueprint(kind(*parts, collapse_panels=True))
        stream.disconnect()
        sizes.append(path.stat().st_size)
    first, second = (layout(tmp_path / f"{name}.rrd") for name in ("Blueprint", "Packed"))
    assert first == second
    assert sizes[1] < 0.9 * sizes[0]


def test_times_of_plots_are_stored_once_in_single_precision(tmp_path):
    run(40).to_rrd(tmp_path / "run.rrd")
    (often,) = batches(tmp_path / "run.rrd", "/plots/often")
    names = [name for name in often.schema.names if name.startswith("ShipGymPlot:")]
    assert len(names) == 7
    for name in names:
        assert often.schema.field(name).type.value_type == "float", name
    assert often.num_rows == 40
    (seldom,) = batches(tmp_path / "run.rrd", "/plots/seldom")
    assert 10 < seldom.num_rows < 20


def test_marks_are_points_on_the_lines_that_are_followed(tmp_path):
    run(outcome="end of time").to_rrd(tmp_path / "run.rrd")
    for name in ("heading", "rudder"):
        assert batches(tmp_path / "run.rrd", f"/plots/{name}/marks")
    assert not batches(tmp_path / "run.rrd", "/plots/speed/marks")


def test_rudder_and_propeller_stay_at_their_places_while_they_turn(tmp_path):
    """A place that is static is not seen beside turns in time: rerun 0.41 leaves it out."""
    run(40).to_rrd(tmp_path / "run.rrd")
    for name in ("rudder", "propeller"):
        found = batches(tmp_path / "run.rrd", f"/world/ship/{name}")
        (moved,) = (b for b in found if "Transform3D:quaternion" in b.schema.names)
        places = np.array([p[0] for p in moved.column("Transform3D:translation").to_pylist()])
        assert (places == places[0]).all()
        assert places[0, 0] < -0.4 * SHIP["L"]
        assert len(moved) > 5


def test_the_water_moves_and_is_cheap(tmp_path):
    calm, rough = run(), run(waves=waves())
    calm.to_rrd(tmp_path / "calm.rrd")
    rough.to_rrd(tmp_path / "rough.rrd")
    (flat,) = (
        b for b in batches(tmp_path / "calm.rrd", "/world/sea") if "sim_time" in b.schema.names
    )
    assert flat.num_rows == 1
    (seen,) = (
        b for b in batches(tmp_path / "rough.rrd", "/world/sea") if "sim_time" in b.schema.names
    )
    assert 150 < seen.num_rows < 300
    first, later = (np.array(seen.column("Mesh3D:vertex_positions")[k].as_py()) for k in (0, 1))
    assert np.array_equal(first[:, :2], later[:, :2])
    assert not np.array_equal(first[:, 2], later[:, 2])
    grown = (tmp_path / "rough.rrd").stat().st_size - (tmp_path / "calm.rrd").stat().st_size
    assert grown < 120e3


def test_a_picture_of_ten_minutes_is_smaller_than_half_a_megabyte(tmp_path):
    made = run(waves=waves())
    made.to_rrd(tmp_path / "run.rrd")
    record = 8 * len(made) * len(made.names)
    assert (tmp_path / "run.rrd").stat().st_size < record + 500e3


def test_a_long_run_is_shown_in_as_many_rows_as_a_screen_has():
    rows = shown_rows(40 * MOST_ROWS, live=False)
    assert np.count_nonzero(rows) == MOST_ROWS
    assert rows[0] and rows[-1]
    assert shown_rows(40 * MOST_ROWS, live=True).all()
    assert shown_rows(MOST_ROWS, live=False).all()


def test_only_what_changes_is_sent():
    still, moving = np.zeros((5, 3)), np.array([0, 0, 1, 1, 2])
    assert changes(still).tolist() == [True, False, False, False, False]
    assert changes(still, moving).tolist() == [True, False, True, False, True]


def test_runs_do_not_share_a_layout():
    """A viewer gives recordings of one id one layout, and so the axes of one run to all."""
    ids = {log.application_id(f"heading, kcs, pid, seed {seed}") for seed in (1, 2)}
    assert ids == {"ship_gym_heading_kcs_pid_seed_1", "ship_gym_heading_kcs_pid_seed_2"}
