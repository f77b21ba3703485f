"""Pictures and videos of a recording, by the painter of ``render_mode="rgb_array"``."""

from __future__ import annotations

import io
import itertools
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_number, shown
from ship_gym.recording.marks import bearing, marks, seconds, worst_moment
from ship_gym.recording.trajectory import Trajectory
from ship_gym.rendering.recorded import scene_at
from ship_gym.writing import atomic_path

_SHORTEST, _VIDEO = 5.0, 30.0  # least and usual length of a video [s]
_APART = 0.02  # least share of a run between two moments of a strip
_WORTH = ("failure", "saturation", "limit", "leg", "error", "end")  # marks, the first ones first
_ACROSS = 3  # pictures of a strip that stand side by side
_ENCODING = {"crf": "20", "preset": "veryfast"}  # good for text; encoding takes less than drawing
_NO_AV = 'videos need PyAV: pip install "ship-gym[video]"'


def frame(trajectory: Trajectory, row: int, width: int = 960, height: int = 540) -> np.ndarray:
    """The picture of a row.

    Parameters
    ----------
    trajectory : Trajectory
    row : int
        Negative ones count from the end.
    width, height : int
        As of ``PlanView``.

    Returns
    -------
    numpy.ndarray
        uint8, shape (height, width, 3), RGB.

    Raises
    ------
    ImportError
        Pillow is not installed.
    ConfigError
        A size that is not possible, or what `scene_at` refuses.
    """
    return next(frames(trajectory, [row], width, height))


def frames(
    trajectory: Trajectory, rows: Iterable[int], width: int = 960, height: int = 540
) -> Iterator[np.ndarray]:
    """The pictures of some rows, see `frame`; a row that comes twice in a row is drawn once."""
    from ship_gym.rendering.plan_view import PlanView

    view = PlanView(width, height)
    for row, again in itertools.groupby(rows):
        picture = view.draw(scene_at(trajectory, row))
        for _ in again:
            yield picture


def row_at(trajectory: Trajectory, time: float) -> int:
    """The last row that is not later than a time [s]; the first one for an earlier time.

    Raises
    ------
    ConfigError
        The time is not within the recording.
    """
    t = trajectory["t"]
    check_number("time", time, float(t[0]), float(t[-1]), "s")
    return int(np.searchsorted(t, time, side="right")) - 1


def moments(trajectory: Trajectory, most: int = 6) -> list[float]:
    """Times worth a picture [s]: the start, the worst, the end, then failures, limits and legs."""
    t = trajectory["t"]
    found, apart = {float(t[0]), float(t[-1])}, _APART * float(t[-1] - t[0])
    others = sorted(marks(trajectory), key=lambda mark: _WORTH.index(mark.kind))
    for time in (worst_moment(trajectory), *(mark.time for mark in others)):
        if len(found) < most and min(abs(time - other) for other in found) > apart:
            found.add(time)
    return sorted(found)


def strip(
    trajectory: Trajectory,
    times: Sequence[float] | None = None,
    width: int = 640,
    height: int = 360,
) -> np.ndarray:
    """Several moments in one picture, up to three side by side, each under what happens there.

    Parameters
    ----------
    trajectory : Trajectory
    times : sequence of float, optional
        [s]; default: those of `moments`.
    width, height : int
        Of each picture.

    Returns
    -------
    numpy.ndarray
        uint8, RGB.

    Raises
    ------
    ConfigError
        No time, one that is not within the recording, and what `frame` refuses.
    """
    times = moments(trajectory) if times is None else list(times)
    if not times:
        raise ConfigError("times = []: a strip needs at least one time")
    rows = [row_at(trajectory, time) for time in times]
    pictures = frames(trajectory, rows, width, height)
    tiles = [
        np.concatenate([_caption(trajectory, row, width), picture])
        for row, picture in zip(rows, pictures, strict=True)
    ]
    across = min(_ACROSS, len(tiles))
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % across)
    lines = [np.concatenate(tiles[k : k + across], axis=1) for k in range(0, len(tiles), across)]
    return np.concatenate(lines)


def write_video(
    trajectory: Trajectory,
    path: str | os.PathLike,
    fps: int = 25,
    speed: float | None = None,
    *,
    width: int = 960,
    height: int = 540,
    progress: Callable[[Iterable], Iterable] | None = None,
) -> None:
    """Write a video of a run, H.264 in a file ``*.mp4``.

    Parameters
    ----------
    trajectory : Trajectory
    path : path-like
        File to write; an interrupted write leaves an existing one as it was.
    fps : int
        Pictures in a second, 1 to 60. A row stays until the next one comes.
    speed : float, optional
        Recorded seconds in a second of the video; default: what makes it half a minute long, but
        not slower than the ship.
    width, height : int
        As of ``PlanView``.
    progress : callable, optional
        Wraps the iterable of pictures, e.g. ``tqdm.tqdm``.

    Raises
    ------
    ImportError
        PyAV or Pillow is not installed.
    ConfigError
        Another ending than .mp4, a rate, speed or size that is not possible, or what `scene_at`
        refuses.
    OSError
        The file cannot be written; names it.
    """
    if Path(path).suffix != ".mp4":
        raise ConfigError(f"{path}: a video is a file *.mp4")
    rows = video_rows(trajectory, fps, speed)
    scene_at(trajectory, 0)  # refused before anything is written
    shown = progress(rows) if progress else rows
    with atomic_path(path) as temporary:  # a place that cannot be written is found at once
        pictures = frames(trajectory, shown, width, height)
        temporary.write_bytes(_encoded(pictures, fps, (width, height)))


def _encoded(pictures: Iterable[np.ndarray], fps: int, size: tuple[int, int]) -> bytes:
    """An mp4 file of pictures; in memory, so that a full disk is found by Python."""
    av = _import_av()
    data = io.BytesIO()
    with av.open(data, "w", format="mp4") as file:
        stream = file.add_stream("libx264", rate=fps, options=_ENCODING)
        (stream.width, stream.height), stream.pix_fmt = size, "yuv420p"
        for picture in pictures:
            file.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        file.mux(stream.encode())
    return data.getvalue()


def video_rows(trajectory: Trajectory, fps: int = 25, speed: float | None = None) -> list[int]:
    """Row of each picture of a video, see `write_video`; the last row is the last picture."""
    if not isinstance(fps, int) or isinstance(fps, bool) or not 1 <= fps <= 60:
        raise ConfigError(f"fps = {shown(fps)}: allowed is an integer from 1 to 60")
    t = trajectory["t"]
    duration = float(t[-1] - t[0])
    if speed is None:
        speed = max(1.0, duration / _VIDEO)
    check_number("speed", speed, 1e-3, 1e5)
    count = int(duration / speed * fps)
    times = t[0] + np.arange(count + 1) * speed / fps
    rows = np.maximum(np.searchsorted(t, times, side="right") - 1, 0)
    return [*rows.tolist(), len(t) - 1]


def _caption(trajectory: Trajectory, row: int, width: int) -> np.ndarray:
    """A line with the time of a row and what happens there."""
    from ship_gym.rendering.canvas import PAPER, Canvas

    unit = width / 640.0
    canvas = Canvas(width, round(28 * unit), unit, PAPER)
    t = trajectory["t"]
    here = [mark.text for mark in marks(trajectory) if row_at(trajectory, mark.time) == row]
    text = f"{seconds(float(t[row]))}   " + (
        "; ".join(here) or f"heading {bearing(trajectory['psi'][row])}"
    )
    canvas.text((10, 14), canvas.fitted(text, 13, 620), 13, anchor="lm")
    return canvas.pixels()


def _import_av():
    try:
        import av
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != "av":
            raise
        raise ImportError(_NO_AV) from error
    return av
