"""``ship-gym review show``."""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ship_gym_agents.cli.options import verb
from ship_gym_agents.cli.review.files import files
from ship_gym_agents.cli.review.moments import WORST, At

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory


@verb("runs/rollout.rrd", "runs/pid.rrd runs/lqg.rrd --web")
@files()
@click.option("--web", is_flag=True, help="In a browser; served to this machine only.")
@click.option(
    "--at",
    type=At(WORST),
    default=WORST,
    help="Of one FILE: the time shown first [s]; of a browser only told.",
)
def command(as_json, files, web, at) -> None:
    """Show recordings in rerun's viewer, in a window or in a browser.

    Returns when the window is closed, or at Ctrl+C. Every FILE is verified before the viewer sees
    it; the journal of a run that is on or was broken off (.rrd.partial) is drawn first.
    """
    from ship_gym.recording.trajectory import import_rerun_export
    from ship_gym_agents.cli.output import need, progress
    from ship_gym_agents.cli.review.files import drawn, viewable

    need("rerun")
    import_rerun_export()
    _check_one(files, at)
    if not web:
        check_screen(files)
    runs = [viewable(path) for path in progress(files, "reading")]
    moment, where = _moment(runs, at)
    with drawn(files, runs) as paths, contextlib.suppress(KeyboardInterrupt), _ended_by_signals():
        if web:
            _serve(as_json, files, paths, moment, where)
        else:
            _open(as_json, files, paths, moment, where)


def _check_one(files: Sequence[Path], at: str | float) -> None:
    """Refuse a time of several files."""
    from ship_gym.config import ConfigError

    if len(files) > 1 and at != WORST:
        raise ConfigError(f"--at {at:g}: is of one FILE; there are {len(files)}")


def _moment(runs: Sequence[Trajectory | None], at: Any) -> tuple[float | None, str]:
    """The time to show [s], also in words; none of several, of a comparison only a given one."""
    from ship_gym_agents.cli.review.moments import said, time_of

    if len(runs) > 1 or (runs[0] is None and at == WORST):
        return None, ""
    if runs[0] is None:
        return at, f"{at:.6g} s"
    moment = time_of(runs[0], at)
    return moment, said(runs[0], moment)


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Take a signal that ends this process for Ctrl+C, so that no viewer is left behind."""
    signals = [getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP")]
    before = {one: signal.signal(one, signal.default_int_handler) for one in signals if one}
    try:
        yield
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)


def check_screen(files: Sequence[Path], option: str = "") -> None:
    """Refuse a window where there is no screen, and say what else there is for files."""
    from ship_gym.config import ConfigError
    from ship_gym.recording.rerun_export.viewer import has_screen
    from ship_gym_agents.cli.review.files import next_review

    if not has_screen():
        raise ConfigError(
            f"{option}no screen here (neither DISPLAY nor WAYLAND_DISPLAY is set); for a browser: "
            f"{next_review('show', '--web', *files)}; for a picture: "
            f"{next_review('picture', files[0])}"
        )


def _open(as_json, files, paths, moment, where) -> None:
    from ship_gym.recording.rerun_export.viewer import show as open_window
    from ship_gym_agents.cli.output import show

    names = ", ".join(map(str, files))
    text = f"{names} in rerun's viewer" + (f" at {where}" if where else "")
    data = {"files": [str(path) for path in files], "time": moment}
    show(as_json, data, f"{text}\nnext: close its window, or press Ctrl+C here")
    sys.stdout.flush()
    open_window(*paths, moment=moment)


def _serve(as_json, files, paths, moment, where) -> None:
    import webbrowser

    from ship_gym.recording.rerun_export.viewer import has_screen, serve_web
    from ship_gym_agents.cli.output import show

    served = serve_web(*paths)
    try:
        opened = has_screen() and webbrowser.open(served.address)
        text = f"{', '.join(map(str, files))} at {served.address}, for this machine only"
        following = "press Ctrl+C here when done" if opened else "open the address in a browser"
        following += f"; move its time to {where}" if where else ""
        data = {"files": [str(path) for path in files], "address": served.address, "time": moment}
        show(as_json, data, f"{text}\nnext: {following}")
        sys.stdout.flush()
        served.wait()
    finally:
        served.stop()
