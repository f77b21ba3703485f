"""``ship-gym review picture``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ship_gym_agents.cli.options import out, verb
from ship_gym_agents.cli.review.moments import STRIP, WORST, At, Size

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory


@verb(
    "runs/rollout.rrd",
    "runs/rollout.rrd --at 120 --light --out runs/at_120.png",
    "runs/rollout.rrd --at strip          # its moments side by side",
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--at", type=At(WORST, STRIP), default=WORST, help="Moment, or frames of the run.")
@out(".png", "Picture; default: FILE with this extension.")
@click.option("--light", is_flag=True, help="Light instead of dark.")
@click.option("--size", type=Size(), default="1920x1080", help="Of the viewer [pixels].")
@click.option("--painter", is_flag=True, help="By the painter of env.render, without rerun's.")
def command(as_json, file, at, out, light, size, painter) -> None:
    """Draw a recording at its worst moment, at a time, or as a strip.

    It is what rerun's viewer shows, drawn without a window, where the machine has a graphics
    driver, be it one in software; else, and as a strip, it is what env.render draws.
    """
    from ship_gym_agents.cli.output import need, place, show
    from ship_gym_agents.cli.review.files import viewable
    from ship_gym_agents.cli.review.moments import said, time_of

    need("rerun")
    _check_together(at, light, painter)
    need(*(["PIL"] if painter or at == STRIP else []))
    out = place(out, file.with_name(f"{file.name.partition('.rrd')[0]}.png"))
    run = viewable(file)
    moment, by, reason = None, "painter", ""
    if run is None:
        moment, where = _of_comparison(file, at, painter)
    elif at == STRIP:
        where = f"{_paint_strip(run, out)} moments"
    else:
        moment = time_of(run, at)
        where = said(run, moment)
    if at != STRIP and not painter:
        by, reason = _shoot(file, run, out, moment, size, light)
    if at != STRIP and by == "painter":
        assert run is not None and moment is not None  # only rerun draws a comparison
        _paint(run, out, moment)
    data = {"file": str(out), "recording": str(file), "time": moment, "by": by, "reason": reason}
    drawn_by = "rerun's viewer" if by == "rerun" else "the painter of env.render"
    text = f"{file} at {where}\nwrote {out}, drawn by {drawn_by}" + (
        f": {reason}" if reason else ""
    )
    show(as_json, data, text)


def _check_together(at, light: bool, painter: bool) -> None:
    """Refuse what only the viewer can."""
    from ship_gym.config import ConfigError

    if light and (painter or at == STRIP):
        raise ConfigError("--light: is of rerun's viewer; the painter has one look")


def _of_comparison(file: Path, at, painter: bool) -> tuple[float | None, str]:
    """Time of a comparison, in words, too; only the viewer draws one."""
    from ship_gym.config import ConfigError

    if painter or at == STRIP:
        option = "--painter" if painter else "--at strip"
        raise ConfigError(f"{option}: {file} is a comparison, which only rerun's viewer draws")
    return (None, "its end") if at == WORST else (at, f"{at:.6g} s")


def _shoot(file, run: Trajectory | None, out: Path, moment, size, light) -> tuple[str, str]:
    """Draw by rerun's viewer; who is to draw then, and why it is the painter."""
    from ship_gym.recording.rerun_export.viewer import NoViewer, screenshot
    from ship_gym_agents.cli.output import need
    from ship_gym_agents.cli.review.files import drawn

    with drawn([file], [run]) as (path,):
        try:
            screenshot(path, out, moment, size, light)
        except NoViewer as error:
            if light or run is None:
                raise
            need("PIL")
            return "painter", str(error)
    return "rerun", ""


def _paint(run: Trajectory, out: Path, moment: float) -> None:
    """Draw the row of a time."""
    from ship_gym.rendering.png import save_png
    from ship_gym.rendering.replay import frame, row_at

    save_png(frame(run, row_at(run, moment)), out)


def _paint_strip(run: Trajectory, out: Path) -> int:
    """Draw the moments worth a picture; how many there are."""
    from ship_gym.rendering.png import save_png
    from ship_gym.rendering.replay import moments, strip

    times = moments(run)
    save_png(strip(run, times), out)
    return len(times)
