"""Recordings in rerun's viewer: on the screen, in a browser, as a picture; all on loopback only."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import quote

from rerun.experimental import ViewerClient

from ship_gym.config import check_number
from ship_gym.recording.rerun_export.light import make_light
from ship_gym.recording.rerun_export.log import TIMELINE
from ship_gym.recording.rerun_export.program import (
    HOST,
    PATIENCE,
    PAUSE,
    NoViewer,
    Program,
    free_ports,
    listens,
)
from ship_gym.recording.screen import has_screen
from ship_gym.writing import atomic_path

_ROUNDING = 1e-6  # of times [s], which a viewer has in whole nanoseconds


class Served:
    """Recordings that are served to browsers on this machine until `stop`.

    Attributes
    ----------
    address : str
        To be opened in a browser.
    """

    def __init__(self, program: Program, address: str):
        self._program, self.address = program, address

    def wait(self) -> None:
        """Return when the server ends."""
        self._program.wait()

    def stop(self) -> None:
        """End the server."""
        self._program.end()


def show(*paths: str | os.PathLike, moment: float | None = None) -> None:
    """Open recordings in a window and return when it is closed.

    Parameters
    ----------
    *paths : path-like
        Files ``.rrd`` that were verified.
    moment : float, optional
        Time that is shown first [s].

    Raises
    ------
    NoViewer
        No screen, no graphics driver, or the viewer broke off.
    """
    if not has_screen():
        raise NoViewer("no screen here: neither DISPLAY nor WAYLAND_DISPLAY is set")
    with _running([os.fspath(each) for each in paths]) as (program, client):
        if moment is not None:
            moment = check_number("time", moment, 0.0, _loaded(client) + _ROUNDING, "s")
            client.set_time(TIMELINE, duration=moment, play_state="paused")
        program.wait()


def serve_web(*paths: str | os.PathLike) -> Served:
    """Serve recordings to browsers on this machine; nothing outside it can connect.

    Parameters
    ----------
    *paths : path-like
        Files ``.rrd`` that were verified.

    Raises
    ------
    NoViewer
        The server did not start.
    """
    data, page = free_ports(2)
    arguments = ["--serve-web", "--web-viewer-port", str(page)]
    arguments += [os.fspath(each) for each in paths]
    program = Program(arguments, data)
    try:
        program.until(lambda: listens(page))
    except BaseException:
        program.end()
        raise
    source = quote(f"rerun+http://{HOST}:{data}/proxy", safe="")
    return Served(program, f"http://{HOST}:{page}/?url={source}")


def screenshot(
    path: str | os.PathLike,
    out: str | os.PathLike,
    time: float | None = None,
    size: tuple[int, int] = (1920, 1080),
    light: bool = False,
) -> None:
    """Write a PNG of what the native viewer shows of a recording; nothing appears on a screen.

    Parameters
    ----------
    path : path-like
        A file ``.rrd`` that was verified.
    out : path-like
        PNG file, written whole or not at all.
    time : float, optional
        Where the time cursor stands [s]; the last instant if omitted.
    size : tuple of int
        Width and height [pixels].
    light : bool
        In the light theme instead of the dark one.

    Raises
    ------
    ConfigError
        The time is outside the recording.
    NoViewer
        No graphics driver is found, or the viewer broke off.
    """
    arguments = ["--headless", "--window-size", f"{size[0]}x{size[1]}"]
    with _running(arguments) as (program, client):
        if light:
            make_light(client, program.port)
        client.open(os.fspath(Path(path).absolute()))
        end = _loaded(client)
        time = end if time is None else check_number("time", time, 0.0, end + _ROUNDING, "s")
        client.set_time(TIMELINE, duration=time, play_state="paused")
        image = _settled(client)
    with atomic_path(out) as temporary:
        temporary.write_bytes(image)


@contextlib.contextmanager
def _running(arguments: Sequence[str]) -> Iterator[tuple[Program, ViewerClient]]:
    """A viewer that answers, with what speaks to it; ended with the block."""
    (port,) = free_ports(1)
    program = Program(arguments, port)
    try:
        yield program, program.until(lambda: _client(port))
    except (ConnectionError, RuntimeError) as error:
        raise NoViewer(program.why(str(error))) from None
    finally:
        program.end()


def _client(port: int) -> ViewerClient | None:
    """What speaks to the viewer, once it answers."""
    try:
        client = ViewerClient.connect(f"rerun+http://{HOST}:{port}/proxy")
        client.get_state()
    except (ConnectionError, RuntimeError):
        return None
    return client


def _loaded(client: ViewerClient) -> float:
    """Wait until all of the recording is there; its last instant [s]."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        state = client.get_state()
        ends = [
            line.end for one in state.recordings for line in one.timelines if line.name == TIMELINE
        ]
        if not state.loading and ends and None not in ends:
            return max(ends) * 1e-9
        time.sleep(PAUSE)
    raise NoViewer(f"the recording was not loaded within {PATIENCE:.0f} s")


def _settled(client: ViewerClient) -> bytes:
    """The picture when it stops changing: axes glide to their range in the first frames."""
    end = time.monotonic() + PATIENCE
    last, image = b"", client.take_screenshot()
    while image != last and time.monotonic() < end:
        time.sleep(PAUSE)
        last, image = image, client.take_screenshot()
    return image
