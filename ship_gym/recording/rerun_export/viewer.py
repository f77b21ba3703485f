"""Recordings in rerun's viewer: on the screen, in a browser, as a picture; all on loopback only.

Rerun's own ``spawn`` listens on every address of the machine, so the program is started here.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import rerun_cli
from rerun.experimental import ViewerClient

from ship_gym.provenance import atomic_path
from ship_gym.recording.rerun_export.log import TIMELINE

_HOST = "127.0.0.1"
_PATIENCE = 20.0  # longest wait [s] for a viewer to answer, for a file to load, for it to be drawn
_PAUSE = 0.1  # between two questions [s]
_PROGRAMS = ("Rerun.app/Contents/MacOS/Rerun", "rerun.exe", "rerun")
# its log on errors only, which it would also draw over a picture
_ENVIRONMENT = {"RUST_LOG": "error", "RERUN_APP_ONLY": "true"}


class NoViewer(OSError):
    """The viewer cannot run here, such as without a graphics driver."""


class Served:
    """A recording that is served to browsers on this machine until `stop`.

    Attributes
    ----------
    address : str
        To be opened in a browser.
    """

    def __init__(self, process: subprocess.Popen, address: str):
        self.process, self.address = process, address

    def wait(self) -> None:
        """Return when the server ends."""
        self.process.wait()

    def stop(self) -> None:
        """End the server."""
        _end(self.process)


def has_screen() -> bool:
    """Whether a window can be opened: on Linux, a display server is named."""
    if os.name != "posix" or os.uname().sysname == "Darwin":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


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
    with _running([*map(os.fspath, paths)]) as (process, client):
        if moment is not None:
            _loaded(client)
            client.set_time(TIMELINE, duration=float(moment), play_state="paused")
        if process.wait() > 0:  # below 0: a signal, such as that of Ctrl+C
            raise RuntimeError("broke off")


def serve_web(*paths: str | os.PathLike) -> Served:
    """Serve recordings to browsers on this machine; nothing outside it can connect.

    Raises
    ------
    NoViewer
        The server did not start.
    """
    data, page = _free_ports(2)
    arguments = ["--serve-web", "--web-viewer-port", str(page), *map(os.fspath, paths)]
    with _log() as log:
        process = _start(arguments, data, log)
        try:
            _wait(lambda: _listens(page), process, log)
        except BaseException:
            _end(process)
            raise
    source = quote(f"rerun+http://{_HOST}:{data}/proxy", safe="")
    return Served(process, f"http://{_HOST}:{page}/?url={source}")


def screenshot(
    path: str | os.PathLike,
    out: str | os.PathLike,
    time: float | None = None,
    size: tuple[int, int] = (1920, 1080),
    light: bool = False,
) -> None:
    """Write a PNG of what the native viewer shows of a recording, without a window.

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

    Raises
    ------
    NoViewer
        No graphics driver is found, or the viewer broke off.
    """
    arguments = ["--headless", "--window-size", f"{size[0]}x{size[1]}"]
    with _running(arguments) as (_, client):
        client.open(os.fspath(Path(path).absolute()))
        end = _loaded(client)
        client.set_time(TIMELINE, duration=end if time is None else time, play_state="paused")
        image = _settled(client)
    with atomic_path(out) as temporary:
        temporary.write_bytes(image)


@contextlib.contextmanager
def _running(arguments: Sequence[str]) -> Iterator[tuple[subprocess.Popen, ViewerClient]]:
    """A viewer that answers, with what speaks to it; ended with the block."""
    (port,) = _free_ports(1)
    with _log() as log:
        process = _start(arguments, port, log)
        try:
            yield process, _wait(lambda: _client(port), process, log)
        except (ConnectionError, RuntimeError) as error:
            _wait_for_end(process)
            raise NoViewer(_reason(process, log, str(error))) from None
        finally:
            _end(process)


def _start(arguments: Sequence[str], port: int, log: Path) -> subprocess.Popen:
    """Start rerun's program, bound to loopback; what it prints goes to a file."""
    command = [_program(), "--bind", _HOST, "--port", str(port), "--hide-welcome-screen"]
    with log.open("wb") as stream:
        return subprocess.Popen(
            [*command, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=stream,
            env=os.environ | _ENVIRONMENT,
        )


def _program() -> str:
    """Rerun's program itself: its Python script would start it as a further process."""
    folder = Path(rerun_cli.__file__).parent
    found = [str(folder / name) for name in _PROGRAMS if (folder / name).is_file()]
    found += filter(None, [shutil.which("rerun")])
    if not found:
        raise NoViewer("rerun's viewer is not there: install rerun-sdk again")
    return found[0]


@contextlib.contextmanager
def _log() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        yield Path(folder) / "log"


def _free_ports(count: int) -> list[int]:
    """Ports of loopback that nobody uses now."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind((_HOST, 0))
        return [one.getsockname()[1] for one in sockets]


def _wait(ready: Callable[[], Any], process: subprocess.Popen, log: Path) -> Any:
    """What `ready()` gives when it is true; NoViewer if the process ends before, or too late."""
    end = time.monotonic() + _PATIENCE
    while not (found := ready()):
        if process.poll() is not None or time.monotonic() > end:
            raise NoViewer(_reason(process, log, f"no answer within {_PATIENCE:.0f} s"))
        time.sleep(_PAUSE)
    return found


def _client(port: int) -> ViewerClient | None:
    """What speaks to the viewer, once it answers."""
    try:
        client = ViewerClient.connect(f"rerun+http://{_HOST}:{port}/proxy")
        client.get_state()
    except (ConnectionError, RuntimeError):
        return None
    return client


def _listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex((_HOST, port)) == 0


def _loaded(client: ViewerClient) -> float:
    """Wait until all of the recording is there; its last instant [s]."""
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        state = client.get_state()
        ends = [
            line.end for one in state.recordings for line in one.timelines if line.name == TIMELINE
        ]
        if not state.loading and ends and None not in ends:
            return max(ends) * 1e-9
        time.sleep(_PAUSE)
    raise NoViewer(f"the recording was not loaded within {_PATIENCE:.0f} s")


def _settled(client: ViewerClient) -> bytes:
    """The picture when it stops changing: axes glide to their range in the first frames."""
    end = time.monotonic() + _PATIENCE
    last, image = b"", client.take_screenshot()
    while image != last and time.monotonic() < end:
        time.sleep(_PAUSE)
        last, image = image, client.take_screenshot()
    return image


def _reason(process: subprocess.Popen, log: Path, otherwise: str) -> str:
    """Why a viewer did not run, in one line."""
    if process.poll() is None:
        return f"rerun's viewer: {otherwise}"
    text = log.read_text(encoding="utf-8", errors="replace")
    if "render context" in text or "graphics adapter" in text:
        return "no graphics driver for rerun's viewer (Debian, Ubuntu: mesa-vulkan-drivers)"
    said = [line for line in text.splitlines() if "panicked" in line or line.startswith("Error")]
    return f"rerun's viewer: {said[0] if said else otherwise}"


def _wait_for_end(process: subprocess.Popen) -> None:
    """Give a viewer that breaks off the moment it needs to say why."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(1.0)


def _end(process: subprocess.Popen) -> None:
    """End a viewer that was started here."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
