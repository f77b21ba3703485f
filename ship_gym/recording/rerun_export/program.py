"""Rerun's viewer as a process of this machine: started on loopback, waited for, ended.

Rerun's own ``spawn`` listens on every address of the machine.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import rerun_cli

HOST = "127.0.0.1"
PATIENCE = 20.0  # longest wait [s] for a viewer to answer, for a file to load, for it to be drawn
PAUSE = 0.1  # between two questions [s]
_PROGRAMS = ("Rerun.app/Contents/MacOS/Rerun", "rerun.exe", "rerun")
# its log on errors only, which it would also draw over a picture
_QUIET = {"RUST_LOG": "error", "RERUN_APP_ONLY": "true"}


class NoViewer(OSError):
    """The viewer cannot run here, such as without a graphics driver."""


class Program:
    """The viewer, running; what it prints goes to a file.

    Parameters
    ----------
    arguments : sequence of str
        Beside those of the address.
    port : int
        Where it listens.
    detached : bool
        Whether it stays when this process is interrupted.
    """

    def __init__(self, arguments: Sequence[str], port: int, detached: bool = False):
        self.port = port
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._log = Path(self._folder.name) / "log"
        command = [path(), "--bind", HOST, "--port", str(port), "--hide-welcome-screen"]
        with self._log.open("wb") as log:
            self.process = subprocess.Popen(
                [*command, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                env=os.environ | _QUIET,
                start_new_session=detached,
            )

    def until(self, ready: Callable[[], Any]) -> Any:
        """What `ready()` gives once it is true; NoViewer if it ends before, or takes long."""
        end = time.monotonic() + PATIENCE
        while not (found := ready()):
            if self.process.poll() is not None or time.monotonic() > end:
                raise NoViewer(self.why(f"no answer within {PATIENCE:.0f} s"))
            time.sleep(PAUSE)
        return found

    def wait(self) -> None:
        """Return when it is closed; NoViewer if it broke off."""
        if self.process.wait() > 0:  # below 0: a signal, such as that of Ctrl+C
            raise NoViewer(self.why("broke off"))

    def why(self, otherwise: str) -> str:
        """Why it does not run, in one line."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(1.0)  # the moment it needs to say so
        if self.process.returncode is None:
            return f"rerun's viewer: {otherwise}"
        text = self._log.read_text(encoding="utf-8", errors="replace")
        if "render context" in text or "graphics adapter" in text:
            return "no graphics driver for rerun's viewer (Debian, Ubuntu: mesa-vulkan-drivers)"
        said = [
            line for line in text.splitlines() if line.startswith("Error") or "panicked" in line
        ]
        return f"rerun's viewer: {said[0] if said else otherwise}"

    def end(self) -> None:
        """End it."""
        end(self.process)
        self._folder.cleanup()


def end(process: subprocess.Popen) -> None:
    """End a process that was started here."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def path() -> str:
    """Rerun's program itself: its Python script would start it as a further process."""
    folder = Path(rerun_cli.__file__).parent
    found = [str(folder / name) for name in _PROGRAMS if (folder / name).is_file()]
    found += filter(None, [shutil.which("rerun")])
    if not found:
        raise NoViewer("rerun's viewer is not there: install rerun-sdk again")
    return found[0]


def free_ports(count: int) -> list[int]:
    """Ports of loopback that nobody uses now."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind((HOST, 0))
        return [one.getsockname()[1] for one in sockets]


def listens(port: int) -> bool:
    """Whether somebody listens at a port of loopback."""
    with socket.socket() as probe:
        return probe.connect_ex((HOST, port)) == 0
