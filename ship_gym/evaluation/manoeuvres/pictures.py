"""Pictures of the manoeuvres of one ship for the page."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from pathlib import Path

from ship_gym.evaluation.manoeuvres.definition import CALM
from ship_gym.evaluation.manoeuvres.sailing import Sailed
from ship_gym.plotting import histories
from ship_gym.plotting.figure import for_page
from ship_gym.plotting.handling import plot_handling
from ship_gym.plotting.histories import Curve, plot_turns, plot_zigzags
from ship_gym.reports.case import Case
from ship_gym.reports.handling import Handling
from ship_gym.reports.histories import SOURCE, computed_history, measured_history
from ship_gym.reports.page import Picture


def pictures(cases: Sequence[Sailed], trials: Path | None) -> Iterator[Picture]:
    """Turning circles, zig-zags and the spiral of one ship.

    Parameters
    ----------
    cases : sequence of Sailed
        Of the ship.
    trials : Path or None
        Folder of measured histories.
    """
    sailed = [each for each in cases if isinstance(each.case, Case)]
    turns = [each for each in sailed if each.manoeuvre.kind == "turning"]
    zigzags = [each for each in sailed if each.manoeuvre.kind == "zigzag"]
    name = cases[0].ship.name
    if turns:
        curves = [curve for each in turns for curve in _curves(each, trials)]
        details = _details(curves)
        yield for_page(
            f"{name}: {turns[0].manoeuvre.name} to either side. {details}.",
            lambda path: plot_turns(curves, f"{name}: turning circles", details, path),
            f"{name}_turning",
        )
    if zigzags:
        panels: dict[str, list[Curve]] = {}
        for each in zigzags:
            title = f"{each.manoeuvre.name}, {each.side} first"
            panels.setdefault(title, []).extend(_curves(each, trials))
        details = _details([curve for curves in panels.values() for curve in curves])
        yield for_page(
            f"{name}: zig-zags, rudder by heading, to either side. {details}.",
            lambda path: plot_zigzags(panels, f"{name}: zig-zags", details, path),
            f"{name}_zigzag",
        )
    for each in cases:
        if each.manoeuvre.kind == "spiral" and isinstance(each.case, Handling):
            yield for_page(
                f"{name}: steady yaw rate over the rudder angle, direct spiral.",
                functools.partial(plot_handling, each.case),
                f"{name}_spiral",
            )


def _curves(each: Sailed, trials: Path | None) -> list[Curve]:
    """The computed history, and in calm water what was measured."""
    assert isinstance(each.case, Case)
    kind = histories.CALM if each.sea == CALM else histories.WAVES
    found = [Curve("calm" if each.sea == CALM else each.sea, kind, computed_history(each.case))]
    measured = measured_history(each.case, trials)
    return found if measured is None else [*found, Curve("measured", histories.TRIAL, measured)]


def _details(curves: Sequence[Curve]) -> str:
    seas = dict.fromkeys(c.label for c in curves if c.kind != histories.TRIAL)
    measured = any(c.kind == histories.TRIAL for c in curves)
    return f"Computed: {', '.join(seas)}" + (f"; measured: {SOURCE}" if measured else "")
