"""``ship-gym review picture``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ship_gym_agents.cli.options import out, verb
from ship_gym_agents.cli.review.moments import STRIP, WORST, At, Size

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory

_FRAMES = 6  # of a strip


@verb(
    "runs/rollout.rrd",
    "runs/rollout.rrd --at 120 --light --out runs/at_120.png",
    "runs/rollout.rrd --at strip          # the run in six frames",
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
    from ship_gym_agents.cli.review.files import recorded
    from ship_gym_agents.cli.review.moments import said, time_of

    need("rerun")
    _check_together(at, light, painter)
    out = place(out, file.with_name(f"{file.name.partition('.rrd')[0]}.png"))
    run = recorded(file)
    if at == STRIP:
        moment, by = None, "painter"
        reason = _paint_strip(run, out)
        where = f"{_FRAMES} frames"
    else:
        moment = time_of(run, at)
        by, reason = ("painter", "") if painter else _shoot(file, run, out, moment, size, light)
        if by == "painter":
            _paint(run, out, moment)
        where = said(run, moment)
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


def _shoot(file, run: Trajectory, out: Path, moment: float, size, light: bool) -> tuple[str, str]:
    """Draw by rerun's viewer; who is to draw then, and why it is the painter."""
    from ship_gym.recording.rerun_export.viewer import NoViewer, screenshot
    from ship_gym_agents.cli.review.files import drawn

    with drawn([file], [run]) as (path,):
        try:
            screenshot(path, out, moment, size, light)
        except NoViewer as error:
            if light:
                raise
            return "painter", str(error)
    return "rerun", ""


def _paint(run: Trajectory, out: Path, moment: float) -> None:
    """Draw the row nearest to a time."""
    import numpy as np
    from ship_gym.rendering.replay import frame

    from ship_gym.rendering.png import save_png

    save_png(frame(run, int(np.argmin(np.abs(run["t"] - moment)))), out)


def _paint_strip(run: Trajectory, out: Path) -> str:
    """Draw frames evenly over the run, its ends among them."""
    import numpy as np
    from ship_gym.rendering.replay import strip

    from ship_gym.rendering.png import save_png

    t = run["t"]
    save_png(strip(run, np.linspace(t[0], t[-1], _FRAMES)), out)
    return ""
