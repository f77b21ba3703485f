"""LiveView: a running episode in rerun's viewer, with the views of a recording."""

from __future__ import annotations

import math
import os
import socket
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.conventions import FORCE_AXES
from ship_gym.recording.panels import plots_meta
from ship_gym.recording.recorder import Recorder
from ship_gym.recording.screen import has_screen
from ship_gym.recording.trajectory import Trajectory, import_rerun_export
from ship_gym.ships.particulars import Ship

_ADDRESS = "rerun+http://127.0.0.1:9876/proxy"  # of a viewer that rerun opens
_SCHEMES = ("rerun", "rerun+http", "rerun+https")
_INSTEAD = 'use render_mode = "rgb_array", or record the rollout with ship-gym record'
_SETTLED = 1.0  # a viewer that finds no screen ends within this time [s]
_REACH = 12.0  # sea that is shown around the start, and at least around the ship later [L]
_ROOM = 2.0  # distance to its edge at which it grows [L]
# Share of 1/2 rho L d U0^2 (and times L) by which the units of forces and moments are chosen.
_FORCE = 0.01
_FORCES = tuple(f"{axis}_" for axis in FORCE_AXES)  # how columns of forces begin


class LiveView:
    """Streams rows of a running episode to rerun.

    Parameters
    ----------
    ship : Ship
        The ship that sails.
    title : str
        Of the recordings, such as the task.
    sink : path-like, optional
        Where the rows go instead of a viewer on this screen: a file ``*.rrd``, one for each episode
        (``run.rrd``, ``run_2.rrd``, ...), as a ``Recorder`` writes it; or the address of a viewer,
        ``"rerun+http://host:9876/proxy"``.

    plots : sequence, optional
        Of the task's own columns, see ``panels.plots_meta``.

    Raises
    ------
    ConfigError
        A sink that is neither.
    ImportError
        If rerun-sdk is not installed.
    RuntimeError
        At once or at the first row, if no viewer can be opened or reached.
    """

    def __init__(
        self,
        ship: Ship,
        title: str,
        sink: str | os.PathLike | None = None,
        plots: Sequence[tuple[str, str, Sequence[str]]] = (),
    ):
        self._sink = _checked_sink(sink)
        self._rerun = import_rerun_export()
        self._ship, self._title, self._plots = ship, title, plots_meta(plots)
        force = _FORCE * 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
        self._largest = {"X": force, "Y": force, "N": force * ship.hull.L}
        self._episode = 0
        self._out: Any = None  # of an episode in a viewer
        self._recorder: Recorder | None = None  # of one in a file
        self._last: float | None = None  # time of its last row; None: none has begun
        if self._sink is None:
            _check_screen()
        elif "://" in self._sink:
            _check_listening(self._sink)

    def show(
        self,
        row: Mapping[str, float],
        track: np.ndarray | None = None,
        sea: Mapping[str, Any] | None = None,
    ) -> None:
        """Show one row; one that is earlier than the last begins a new episode.

        Parameters
        ----------
        row : mapping of str to float
            By the names of the columns of a ``Trajectory``, with ``t``; every row of an episode has
            the same names. A row of the same time as the last one is left out.
        track : numpy.ndarray, optional
            Way-points north, east [m], shape (W, 2), which the first row of an episode shows.
        sea : mapping, optional
            Of an episode: ``sea`` and ``waves`` as in the meta of a recording.

        Raises
        ------
        ConfigError
            A value that is not finite, or other names than those of the first row.
        """
        _check_row(row)
        now = float(row["t"])
        if self._last is not None and now < self._last:
            self._end_episode()
        if self._last is None:
            self._begin_episode(row, track, sea)
        elif now == self._last:
            return
        self._append(row)
        self._last = now
        if self._recorder is not None:
            self._recorder.add(self._rows[self._count - 1])
            return
        trajectory = self._trajectory()
        self._out.fixed = self._anything_new(trajectory)
        self._rerun.send_picture(self._out, trajectory)

    def close(self) -> None:
        """End the episode and close the file; the viewer stays open."""
        if self._last is not None:
            self._end_episode()

    def _begin_episode(self, row: Mapping[str, float], track, sea) -> None:
        self._episode += 1
        # A wave-frequency motion that is zero at first is that of calm water; it is not shown.
        self._names = [k for k in row if not (k.startswith("wave_") and row[k] == 0.0)]
        self._hidden = [k for k in row if k not in self._names]
        self._rows = np.zeros((256, len(self._names)))
        self._count, self._half = 0, 0.0
        self._seen: tuple[str, ...] = ()
        self._meta = {"task": self._title, "ship": _drawn(self._ship), "episode": self._episode}
        self._meta |= {**self._plots, **(sea or {})}
        if track is not None:
            self._meta["waypoints"] = np.asarray(track).tolist()
        if self._sink is not None and "://" not in self._sink:
            path = Path(self._sink)
            name = path.stem if self._episode == 1 else f"{path.stem}_{self._episode}"
            self._recorder = Recorder(path.with_stem(name), self._meta, self._names)
        else:
            stream = self._opened(self._sink)
            self._out = self._rerun.Output(stream, largest=self._largest)

    def _opened(self, sink: str | None):
        try:
            stream = self._rerun.open_stream(f"ship_gym_{self._title}", sink)
        except RuntimeError as error:
            raise RuntimeError(f"rerun's viewer cannot be opened: {error}; {_INSTEAD}") from error
        if sink is None and self._episode == 1:
            _check_stays_open()
        return stream

    def _append(self, row: Mapping[str, float]) -> None:
        first = [*self._names, *self._hidden]
        if sorted(row) != sorted(first):
            changes = {"without": set(first) - set(row), "with": set(row) - set(first)}
            told = [f"{how} {', '.join(sorted(names))}" for how, names in changes.items() if names]
            raise ConfigError(
                f"a row has other names than the first row of the episode: {'; '.join(told)}"
            )
        if self._count == len(self._rows):
            self._rows = np.concatenate([self._rows, np.zeros_like(self._rows)])
        self._rows[self._count] = [row[name] for name in self._names]
        self._count += 1

    def _trajectory(self) -> Trajectory:
        columns = dict(zip(self._names, self._rows[: self._count].T, strict=True))
        return Trajectory(columns, self._meta)

    def _anything_new(self, trajectory: Trajectory) -> bool:
        """Whether the sea must grow or a row has begun to show something, such as a force."""
        columns, L = trajectory.columns, self._ship.hull.L
        grown = False
        if {"x", "y"} <= columns.keys():
            start, now = (np.array([columns["x"][k], columns["y"][k], 0.0]) for k in (0, -1))
            needed = float(np.abs(now - start).max()) + _ROOM * L
            grown = needed > self._half
            if grown:
                self._half = max(_REACH * L, 2.0 * needed)
                self._out.area = start + self._half * np.array([[-1, -1, 0], [1, 1, 0]])
        seen = tuple(name for name in self._names if name[:2] in _FORCES and columns[name].any())
        changed, self._seen = seen != self._seen, seen
        return grown or changed

    def _end_episode(self) -> None:
        out, recorder = self._out, self._recorder
        self._out = self._recorder = self._last = None
        if recorder is not None:
            recorder.finish(self._trajectory())
        else:
            self._rerun.send_about(out, self._trajectory())
            out.stream.flush()
            out.stream.disconnect()


def _drawn(ship: Ship) -> dict[str, object]:
    """What a picture needs of a ship, as ``Trajectory`` keeps it."""
    hull = ship.hull
    sizes = {"L": hull.L, "B": hull.B, "d": hull.d, "A_R": ship.rudder.A_R, "D_P": ship.propeller.D}
    sizes["delta_max"] = ship.gear.delta_max
    return {"name": ship.name, **sizes}


def _check_row(row: Mapping[str, float]) -> None:
    if "t" not in row:
        raise ConfigError(f"a row needs 't' [s]; it has {', '.join(row)}")
    for name, value in row.items():
        if not math.isfinite(value):
            raise ConfigError(f"row at t = {row['t']} s: {name} = {value}: must be finite")


def _checked_sink(sink: str | os.PathLike | None) -> str | None:
    if sink is None:
        return None
    text = os.fspath(sink)
    good = urlsplit(text).scheme in _SCHEMES if "://" in text else text.endswith(".rrd")
    if not good:
        raise ConfigError(
            f"sink = {text!r}: allowed is a file '*.rrd' or the address of a viewer, "
            f"such as {_ADDRESS!r}"
        )
    return text


def _check_screen() -> None:
    """Refuse to open a window where there is none, before rerun tries."""
    if not has_screen():
        raise RuntimeError(
            f"there is no screen for rerun's viewer (DISPLAY is not set); {_INSTEAD}"
        )


def _check_listening(address: str) -> None:
    """Refuse an address where nobody listens; rerun itself would drop the rows silently."""
    parts = urlsplit(address)
    try:
        socket.create_connection((parts.hostname, parts.port or 9876), timeout=5.0).close()
    except OSError as error:
        raise RuntimeError(f"no viewer listens at {address} ({error}); {_INSTEAD}") from error


def _check_stays_open() -> None:
    """Look whether a viewer that has just been opened is still there."""
    until = time.monotonic() + _SETTLED
    while time.monotonic() < until:
        _check_listening(_ADDRESS)
        time.sleep(0.2)
