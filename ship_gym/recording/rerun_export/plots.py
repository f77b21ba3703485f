"""The plots of a recording: one entity holds the lines of many, each view shows its own.

So times are stored once, and values in 32 bits, enough for an eye; the exact columns are in the
record. A view finds its lines by a mapping from a component of that entity.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

from ship_gym.recording.axes import USUAL, free_corner, is_shown, y_range
from ship_gym.recording.panel import COURSE, STEERING, Panel
from ship_gym.recording.rerun_export.log import Output
from ship_gym.recording.rerun_export.rows import send_chosen

_OFTEN, _SELDOM = "plots/often", "plots/seldom"
_FAST = (STEERING, COURSE)  # topics whose lines need every row
_ARCHETYPE = "ShipGymPlot"
_CUT = " (axis without the largest tenth)"
_WIDTH, _THIN = 1.6, 1.0  # of a line [points]


def send_panels(out: Output, t: np.ndarray, often, seldom, panels: list[Panel]) -> None:
    """Send the lines of all plots: what moves with the waves `often`, forces and flow `seldom`.

    Parameters
    ----------
    out : Output
    t : numpy.ndarray
        Times [s], shape (T,).
    often, seldom : numpy.ndarray of bool
        Rows, shapes (T,); those that are new are sent.
    panels : list of Panel
    """
    for path, mask in ((_OFTEN, often), (_SELDOM, seldom)):
        chosen = [panel for panel in panels if _entity(panel) == path]
        if chosen:
            send_chosen(out, path, t, mask, _lines(chosen))


def _entity(panel: Panel) -> str:
    return _OFTEN if panel.topic in _FAST else _SELDOM


def _lines(panels: list[Panel]):
    """Columns of some plots for the rows of a mask."""

    def rows(new):
        found = []
        for panel in panels:
            values = np.stack([series.values[new] for series in panel.series], axis=1)
            parts = {panel.name: values.astype(np.float32).ravel()}
            columns = rr.DynamicArchetype.columns(archetype=_ARCHETYPE, components=parts)
            found += columns.partition([len(panel.series)] * len(values))
        return found

    return rows


def with_near_limits(panel: Panel) -> Panel:
    """A plot of a run that is over without the limits that are not on its axis."""
    moving = [series.values for series in panel.series if not series.limit]
    near = [s for s in panel.series if not s.limit or is_shown(s.values, moving)]
    return dataclasses.replace(panel, series=near)


def marked_line(panel: Panel) -> int | None:
    """Number of the line on which the marks of a run are points; None: on none of this plot."""
    if panel.topic != STEERING or panel.name in ("speed", "reward"):
        return None
    labels = [series.label for series in panel.series]
    return next((labels.index(name) for name in ("true", "achieved") if name in labels), 0)


def plot_view(
    panel: Panel, t: np.ndarray, axis: rr.TimeRange, live: bool, plots: int
) -> rrb.TimeSeriesView:
    """View of one of some plots above each other; the axes of a run that is over show all of it."""
    lines = rr.SeriesLines(
        names=[series.label for series in panel.series],
        colors=[series.color for series in panel.series],
        widths=[_THIN if series.limit else _WIDTH for series in panel.series],
    )
    source = VisualizerComponentMapping(
        "Scalars:scalars",
        ComponentSourceKind.SourceComponent,
        source_component=f"{_ARCHETYPE}:{panel.name}",
    )
    path = _entity(panel)
    look = {} if live else _look(panel, t, plots)
    return rrb.TimeSeriesView(
        origin=f"/{path}",
        contents=[f"/{path}", f"/{panel.path}/**"],
        name=panel.title + (_CUT if panel.robust and not live else ""),
        overrides={path: lines.visualizer(mappings=[source])},
        axis_x=rrb.TimeAxis(view_range=axis),
        **look,
    )


def _look(panel: Panel, t: np.ndarray, plots: int) -> dict:
    """Axis and legend of a run that is over, as far as they differ from what the viewer does."""
    limits = [series.values for series in panel.series if series.limit]
    moving = [series.values for series in panel.series if not series.limit]
    ends = y_range(moving, limits, panel.robust, plots)
    entries = len({series.label for series in panel.series})
    corner = free_corner(t, moving, ends, entries)
    found = {"axis_y": rrb.ScalarAxis(range=ends)}
    if panel.topic == STEERING and (entries < 2 or corner != USUAL):
        place = getattr(rrb.Corner2D, corner)
        found["plot_legend"] = rrb.PlotLegend(corner=place, visible=entries > 1)
    return found
