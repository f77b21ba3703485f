"""``ship-gym review export``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ship_gym_agents.cli.options import force, verb
from ship_gym_agents.cli.review.files import files

if TYPE_CHECKING:
    from ship_gym.recording import Trajectory
    from ship_gym_agents.cli.replace import Result

_KINDS = ("csv", "parquet", "png", "mp4", "gpx", "geojson", "kml")
_NOTES = """
formats:
  csv      all columns, SI units, angles in rad; the meta as JSON in lines that begin with #
  parquet  the same columns; the meta as JSON in the metadata of the schema, key ship_gym
  png      its plots, one below the other
  mp4      what env.render draws
  gpx, geojson, kml
           the sailed track in degrees (WGS84), of a run on a route or chart, or with --origin
"""


@verb(
    "runs/rollout.rrd --out runs/rollout.csv",
    "runs/*.rrd --format parquet --out runs/tables    # a folder",
    "runs/rollout.rrd --out runs/rollout.gpx --origin 54.3 10.2    # north = east = 0 lies there",
    notes=_NOTES,
)
@files()
@click.option("--format", "kind", metavar="|".join(_KINDS), help="Format.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="File, or folder of several; default: beside."
)
@click.option(
    "--origin",
    nargs=2,
    type=float,
    metavar="LAT LON",
    help="Place of north = east = 0 of runs without a chart [deg]; for gpx, geojson and kml.",
)
@click.option("--start", metavar="TIME", help="Of their first row, as 2026-05-01T12:00:00Z.")
@force()
def command(as_json, files, kind, out, origin, start, force) -> None:
    """Write recordings as csv, parquet, png, mp4, gpx, geojson or kml.

    The extension of --out says the format, too. A run that was broken off is written as far as it
    goes.
    """
    from ship_gym.config import told_of
    from ship_gym_agents.cli.output import need, progress, show
    from ship_gym_agents.cli.review.files import recorded

    need("rerun")
    kind = _format(kind, out, len(files))
    targets = _targets(files, kind, out)
    need(*_NEEDED.get(kind, ()))
    where = _where(kind, origin, start)
    if not force and kind in _KEPT:
        _check_replaced(files, targets, _KEPT[kind])
    for path, target in progress(list(zip(files, targets, strict=True)), "writing"):
        with told_of(path):
            FORMATS[kind](recorded(path), target, **where)
    written = [str(target) for target in targets]
    show(as_json, {"format": kind, "files": written}, f"wrote {', '.join(written)}")


def _format(kind: str | None, out: Path | None, count: int) -> str:
    """The format that is asked for, in one way or in both."""
    from ship_gym.config import ConfigError, check_known

    if kind is not None:
        check_known("format", kind, FORMATS)
    suffix = out.suffix.removeprefix(".").lower() if out is not None else ""
    if count > 1 or not suffix:
        if kind is None:
            raise ConfigError(f"--format: which? Allowed are {', '.join(FORMATS)}")
        return kind
    if suffix not in FORMATS:
        raise ConfigError(f"--out {out}: allowed is a file .{', .'.join(FORMATS)}")
    if kind not in (None, suffix):
        raise ConfigError(f"--out {out}: --format says {kind}; leave one of them out")
    return suffix


def _targets(paths: Sequence[Path], kind: str, out: Path | None) -> list[Path]:
    """The file to write of each recording, all of them tried before any work."""
    from ship_gym.config import ConfigError
    from ship_gym.writing import check_place

    names = [f"{path.name.partition('.rrd')[0]}.{kind}" for path in paths]
    if out is None:
        found = [path.with_name(name) for path, name in zip(paths, names, strict=True)]
    elif out.suffix.lower() == f".{kind}" and len(paths) == 1:
        found = [out]
    else:
        found = [check_place(out, "--out", folder=True) / name for name in names]
    if twice := next((path for path in found if found.count(path) > 1), None):
        raise ConfigError(f"--out {out}: two of the recordings would be written as {twice}")
    return [check_place(path, "--out") for path in found]


def _where(kind: str, origin: tuple[float, float] | None, start: str | None) -> dict[str, Any]:
    """Place and time of files on the earth, as arguments."""
    import datetime

    from ship_gym.config import ConfigError, shown

    if kind not in _ON_EARTH:
        if origin is not None or start is not None:
            option = "--start" if origin is None else "--origin"
            raise ConfigError(f"{option}: of {', '.join(_ON_EARTH)}, not of {kind}")
        return {}
    time = None
    if start is not None:
        try:
            time = datetime.datetime.fromisoformat(start)
        except ValueError:
            time = None
        if time is None or time.tzinfo is None:
            raise ConfigError(
                f"--start {shown(start)}: allowed is a date and time with its zone, such as "
                "2026-05-01T12:00:00Z"
            )
    return {"origin": origin, "start": time}


def _check_replaced(paths: Sequence[Path], targets: Sequence[Path], what: Callable) -> None:
    """Refuse files that hold something else than what is made of their recording."""
    from ship_gym_agents.cli.replace import check_replaced
    from ship_gym_agents.cli.review.files import recorded

    for path, target in zip(paths, targets, strict=True):
        if target.is_file():
            check_replaced(target, what(recorded(path)), False)


def _history(run: Trajectory) -> Result:
    from ship_gym_agents.cli.replace import history

    return history(run.meta)


def _voyage(run: Trajectory) -> Result:
    from ship_gym.recording.earth_files import voyage_mark
    from ship_gym_agents.cli.replace import voyage

    return voyage(voyage_mark(run))


def _csv(run: Trajectory, path: Path) -> None:
    run.to_csv(path)


def _parquet(run: Trajectory, path: Path) -> None:
    from ship_gym.evaluation.trajectory_table import write_parquet

    write_parquet(run, path)


def _png(run: Trajectory, path: Path) -> None:
    from ship_gym.plotting.run import plot_run

    plot_run(run, path)


def _mp4(run: Trajectory, path: Path) -> None:
    from ship_gym.rendering.replay import write_video
    from ship_gym_agents.cli.output import progress

    write_video(run, path, progress=progress)


def _on_earth(run: Trajectory, path: Path, origin=None, start=None) -> None:
    from ship_gym.config import ConfigError
    from ship_gym.recording.earth_files import write_on_earth

    if origin is None and "chart" not in run.meta:
        raise ConfigError(
            "its x and y have no place on the earth; --origin LAT LON says where north = east = 0 "
            "lies"
        )
    write_on_earth(run, path, origin, start)


FORMATS: dict[str, Callable[[Trajectory, Path], None]] = {
    "csv": _csv,
    "parquet": _parquet,
    "png": _png,
    "mp4": _mp4,
    "gpx": _on_earth,
    "geojson": _on_earth,
    "kml": _on_earth,
}
_ON_EARTH = ("gpx", "geojson", "kml")
# what a file says that it holds; the others are pictures
_KEPT: dict[str, Callable[[Trajectory], Result]] = {
    **dict.fromkeys(("csv", "parquet"), _history),
    **dict.fromkeys(_ON_EARTH, _voyage),
}
_NEEDED = {"parquet": ("pyarrow",), "png": ("matplotlib",), "mp4": ("av", "PIL")}
_NEEDED |= {"gpx": ("pyproj", "gpxpy"), "geojson": ("pyproj",), "kml": ("pyproj",)}
