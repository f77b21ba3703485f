"""The light theme of rerun's viewer, which no argument sets: a click in its settings does.

The program that clicks is part of rerun's: ``rerun viewer-mcp`` takes lines of JSON-RPC and answers
in lines, see modelcontextprotocol.io.
"""

from __future__ import annotations

import json
import subprocess
import time
from typing import IO, Any

from rerun.experimental import ViewerClient

from ship_gym.recording.rerun_export.program import HOST, PATIENCE, PAUSE, NoViewer, end, path

_HELLO = {
    "protocolVersion": "2025-03-26",
    "capabilities": {},
    "clientInfo": {"name": "ship-gym", "version": "1"},
}
# the pointer is drawn, too
_AWAY = {"name": "hover", "arguments": {"pos": {"x": -100.0, "y": -100.0}}}


def make_light(client: ViewerClient, port: int) -> None:
    """Set the light theme of a viewer that shows nothing yet.

    Raises
    ------
    NoViewer
        Its settings have no such button.
    """
    client.run_command("ui.open_settings")
    clicks = subprocess.Popen(
        [path(), "viewer-mcp", "--endpoint", f"http://{HOST}:{port}"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert clicks.stdin is not None and clicks.stdout is not None
    try:
        _ask(clicks, 0, "initialize", _HELLO)
        _tell(clicks.stdin, {"method": "notifications/initialized"})
        _click(clicks, "Light")
        _ask(clicks, -1, "tools/call", _AWAY)
    finally:
        clicks.stdin.close()
        end(clicks)
        clicks.stdout.close()


def _click(clicks: subprocess.Popen, label: str) -> None:
    """Click a button as soon as it is drawn."""
    until, number = time.monotonic() + PATIENCE, 0
    while True:
        number += 1
        given = {"name": "click", "arguments": {"label_contains": label}}
        answer = _ask(clicks, number, "tools/call", given)
        if not answer.get("error") and not answer.get("result", {}).get("isError"):
            return
        if time.monotonic() > until:
            raise NoViewer(f"rerun's viewer: its settings have no button {label!r}")
        time.sleep(PAUSE)


def _ask(clicks: subprocess.Popen, number: int, method: str, given: dict) -> dict[str, Any]:
    """The answer to a request."""
    assert clicks.stdin is not None and clicks.stdout is not None
    _tell(clicks.stdin, {"id": number, "method": method, "params": given})
    for line in clicks.stdout:
        answer = json.loads(line)
        if answer.get("id") == number:
            return answer
    raise NoViewer("rerun's viewer: the program that clicks in it ended")


def _tell(stream: IO[str], message: dict) -> None:
    stream.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
    stream.flush()
