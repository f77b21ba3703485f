"""How the views of a recording are laid out on the screen."""

from __future__ import annotations

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ship_gym.recording.panels import Panel
from ship_gym.recording.rerun_export.log import TIMELINE

FOLLOWED = "world/at_ship/compass"  # the eye follows only what can be drawn; its size sets how far


def _past() -> rrb.VisibleTimeRanges:
    """Show everything up to the time cursor, which makes a track grow."""
    start, end = rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative()
    return rrb.VisibleTimeRanges([rrb.VisibleTimeRange(TIMELINE, start=start, end=end)])


def scene_view(columns, length: float, row: int) -> rrb.Spatial3DView:
    """Look over the ship from astern on its port side as it is in a row, and stay with it."""
    cosine, sine = np.cos(columns["psi"][row]), np.sin(columns["psi"][row])
    target = np.array([columns["x"][row], columns["y"][row], 0.0])
    aft, port, up = 1.3 * length, 1.0 * length, 0.75 * length
    eye = target + np.array([-aft * cosine + port * sine, -aft * sine - port * cosine, -up])
    return rrb.Spatial3DView(
        origin="/world",
        name="Ship",
        background=[150, 172, 190],
        line_grid=rrb.LineGrid3D(spacing=length, color=[255, 255, 255, 40], stroke_width=1.0),
        eye_controls=rrb.EyeControls3D(
            position=eye, look_target=target, eye_up=(0.0, 0.0, -1.0), tracking_entity=FOLLOWED
        ),
        overrides={"world/wake": _past()},
    )


def plan_view(low: np.ndarray, high: np.ndarray) -> rrb.Spatial2DView:
    """Show the plan between two corners [m]."""
    bounds = rrb.VisualBounds2D(x_range=(low[0], high[0]), y_range=(low[1], high[1]))
    name = "Plan, north up [m]"
    return rrb.Spatial2DView(
        origin="/plan", name=name, visual_bounds=bounds, overrides={"plan/track": _past()}
    )


def whole(t: np.ndarray) -> tuple[rr.TimeRange, rrb.TimePanel]:
    """Time axis and clock of a run that is over: all of it, shown in about a minute."""
    edge = rr.TimeRangeBoundary.absolute
    pace = max(1.0, float(np.round((t[-1] - t[0]) / 60.0)))
    axis = rr.TimeRange(start=edge(seconds=t[0]), end=edge(seconds=t[-1]))
    return axis, rrb.TimePanel(state="collapsed", timeline=TIMELINE, playback_speed=pace)


def latest() -> tuple[rr.TimeRange, rrb.TimePanel]:
    """Time axis and clock of a run that is on: everything up to the newest row."""
    edge = rr.TimeRangeBoundary
    axis = rr.TimeRange(start=edge.infinite(), end=edge.cursor_relative())
    return axis, rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following")


def blueprint(
    axis: rr.TimeRange, clock: rrb.TimePanel, views: list, steering: list[Panel], motion
) -> rrb.Blueprint:
    """Pictures on the left, steering in the middle, motion, forces and reward on the right."""
    plots = [
        rrb.Vertical(*(_plot_view(panel, axis) for panel in panels))
        for panels in (steering, motion)
        if panels
    ]
    pictures = rrb.Vertical(*views, row_shares=[3, 2][: len(views)])
    shares = [4, 3, 3][: 1 + len(plots)]
    layout = rrb.Horizontal(pictures, *plots, column_shares=shares)
    return rrb.Blueprint(layout, clock, collapse_panels=True)


def _plot_view(panel: Panel, axis: rr.TimeRange) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=f"/{panel.path}",
        name=panel.title,
        axis_x=rrb.TimeAxis(view_range=axis),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=len(panel.series) > 1),
    )
