"""How the views of a recording are laid out on the screen."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.recording.panel import STEERING, Panel
from ship_gym.recording.rerun_export.annotations import CARD, marks_view
from ship_gym.recording.rerun_export.log import TIMELINE
from ship_gym.recording.rerun_export.plots import plot_view

FOLLOWED = "world/at_ship/compass"  # the eye follows only what can be drawn; its size sets how far
_SKY, _CHART = [150, 172, 190], [16, 34, 52]  # grounds of the pictures, in both themes
_MOST_PLOTS = 4  # of a tab


def _past() -> rrb.VisibleTimeRanges:
    """Show everything up to the time cursor, which makes a track grow."""
    start, end = rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative()
    return rrb.VisibleTimeRanges([rrb.VisibleTimeRange(TIMELINE, start=start, end=end)])


def scene_view(columns, length: float, row: int, name: str) -> rrb.Spatial3DView:
    """Look over the ship from astern on its port side as it is in a row, and stay with it."""
    cosine, sine = np.cos(columns["psi"][row]), np.sin(columns["psi"][row])
    target = np.array([columns["x"][row], columns["y"][row], 0.0])
    aft, port, up = 1.45 * length, 1.0 * length, 0.8 * length
    eye = target + np.array([-aft * cosine + port * sine, -aft * sine - port * cosine, -up])
    return rrb.Spatial3DView(
        origin="/world",
        name=name,
        background=_SKY,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            position=eye, look_target=target, eye_up=(0.0, 0.0, -1.0), tracking_entity=FOLLOWED
        ),
        overrides={"world/wake": _past()},
    )


def plan_view(low: np.ndarray, high: np.ndarray) -> rrb.Spatial2DView:
    """Show the plan between two corners [m]."""
    return rrb.Spatial2DView(
        origin="/plan",
        name="Plan, north up [m]",
        background=_CHART,
        visual_bounds=rrb.VisualBounds2D(x_range=(low[0], high[0]), y_range=(low[1], high[1])),
        overrides={"plan/track": _past()},
    )


def text_views() -> list[rrb.View]:
    """Card of the run and its marks."""
    return [
        rrb.TextDocumentView(origin=f"/{CARD}", name="Card"),
        marks_view(),
    ]


def whole(t: np.ndarray) -> tuple[rr.TimeRange, rrb.TimePanel]:
    """Time axis and clock of a run that is over: all of it; played in about a minute."""
    edge = rr.TimeRangeBoundary.absolute
    pace = max(1.0, float(np.round((t[-1] - t[0]) / 60.0)))
    axis = rr.TimeRange(start=edge(seconds=t[0]), end=edge(seconds=t[-1]))
    clock = rrb.TimePanel(
        state="collapsed", timeline=TIMELINE, playback_speed=pace, play_state="paused"
    )
    return axis, clock


def latest() -> tuple[rr.TimeRange, rrb.TimePanel]:
    """Time axis and clock of a run that is on: everything up to the newest row."""
    edge = rr.TimeRangeBoundary
    axis = rr.TimeRange(start=edge.infinite(), end=edge.cursor_relative())
    return axis, rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following")


def blueprint(
    axis: rr.TimeRange,
    clock: rrb.TimePanel,
    views: list,
    panels: list[Panel],
    t: np.ndarray,
    live: bool,
) -> Packed:
    """Pictures on the left; on the right the plots that are seen at once, the others in tabs."""
    pictures = rrb.Vertical(*views, row_shares=[3, 2][: len(views)])
    columns = [pictures]
    if panels:
        tabs = [
            rrb.Vertical(
                *(plot_view(panel, t, axis, live, len(chosen)) for panel in chosen), name=topic
            )
            for topic, chosen in _tabs(panels)
        ]
        columns.append(rrb.Tabs(*tabs, active_tab=0) if len(tabs) > 1 else tabs[0])
    layout = rrb.Horizontal(*columns, column_shares=[1, 1][: len(columns)])
    return Packed(layout, clock, collapse_panels=True)


def _tabs(panels: list[Panel]) -> list[tuple[str, list[Panel]]]:
    """Panels by topic in their order, not more on a tab than can be read."""
    topics: dict[str, list[Panel]] = {STEERING: []}
    for panel in panels:
        topics.setdefault(panel.topic, []).append(panel)
    found = []
    for topic, chosen in topics.items():
        for k in range(0, len(chosen), _MOST_PLOTS):
            name = topic if k == 0 else f"{topic} {k // _MOST_PLOTS + 1}"
            found.append((name, chosen[k : k + _MOST_PLOTS]))
    return found


class Packed(rrb.Blueprint):
    """A blueprint in fewer messages, which are most of its size: one for each entity.

    It overrides what rerun keeps private; the version of rerun is pinned, and a blueprint that is
    sent the usual way looks the same.
    """

    def send(self, stream: rr.RecordingStream) -> None:
        """Send it by a stream.

        Rerun makes a stream of its own for it and never frees that, as it and its memory hold each
        other: two threads and 2 MB for each recording.
        """
        stream.send_blueprint(self)
        self._own.disconnect()

    def _log_to_stream(self, stream: rr.RecordingStream) -> None:
        self._own = stream
        found = _Gathered()
        super()._log_to_stream(found)
        for (path, static), batches in found.batches.items():
            if not batches:  # all is left to the viewer
                continue
            columns = [_one_row(batch) for batch in batches]
            clock = [] if static else [rr.TimeColumn("blueprint", sequence=[0])]
            rr.send_columns(path, clock, columns, recording=stream, strict=True)


def _one_row(batch) -> rr.ComponentColumn:
    return rr.ComponentColumn(
        batch.component_descriptor(), batch, lengths=[len(batch.as_arrow_array())]
    )


class _Gathered:
    """Takes what is logged to a stream, by entity."""

    def __init__(self) -> None:
        self.batches: dict[tuple[str, bool], list] = {}

    def log(self, path: str, entity, *, static: bool = False) -> None:
        """As ``RecordingStream.log``."""
        parts = entity.as_component_batches() if hasattr(entity, "as_component_batches") else entity
        self.batches.setdefault((path, static), []).extend(parts)
