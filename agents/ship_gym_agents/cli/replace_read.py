"""Which result of Ship Gym a file holds."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

from ship_gym.config import ConfigError
from ship_gym_agents.cli.replace import (
    Result,
    bound,
    comparison,
    evaluation,
    fitted_ship,
    fmu,
    gains,
    history,
    page,
    policy,
    route,
    surrogate,
    trials,
    wave_table,
)

_WRITTEN_BY = re.compile(r"<!-- Written by `ship-gym ([a-z-]+)\b")


def result_in(path: Path) -> Result | None:
    """What a file of a result holds; None: nothing that Ship Gym has written."""
    reader = _READERS.get(path.suffix.lower())
    try:
        return reader(path) if reader else None
    except Exception:  # whatever a reader says: it is no such result
        return None


def _policy_in(path: Path) -> Result:
    from ship_gym_agents.policies.policy_file import read_card

    return policy(read_card(path))


def _onnx_in(path: Path) -> Result:
    from ship_gym_agents.policies.onnx_export import exported_card

    return policy(exported_card(path))


def _gains_in(path: Path) -> Result:
    from ship_gym.reading import read_toml

    if first := _fitted_from(path):
        return fitted_ship(first)
    found = read_toml(path)
    found["gains"], found["tuning"]
    return gains(found.get("controller", "pid"), found["ship"], found.get("task"))


def _fitted_from(path: Path) -> str:
    """The ship that a fitted one began with, from the first line of its file; else empty."""
    from ship_gym.identification.ship_text import MARK
    from ship_gym.reading import read_text

    line = read_text(path).partition("\n")[0]
    return line.removeprefix(f"{MARK} from ").partition(";")[0] if line.startswith(MARK) else ""


def _table_in(path: Path) -> Result:
    from ship_gym.sea.wave_table import WaveTable
    from ship_gym.tables import Table

    try:
        card = WaveTable.load(path).card
        return wave_table(card["ship"], card["grid"])
    except ConfigError:
        card = Table.load(path).card
        return surrogate(card["data"], card["made_for"]["ship"])


def _recording_in(path: Path) -> Result:
    from ship_gym.recording import Trajectory

    try:
        return history(Trajectory.from_file(path).meta)
    except ValueError:
        from ship_gym.recording.rerun_export.compare import read_comparison

        return comparison(read_comparison(path)["sources"])


def _fmu_in(path: Path) -> Result:
    from ship_gym.cosim.write import ship_in

    return fmu(ship_in(path))


def _parquet_in(path: Path) -> Result:
    from ship_gym.evaluation.trajectory_table import read_meta

    return history(read_meta(path))


def _csv_in(path: Path) -> Result | None:
    from ship_gym.reading import read_text

    head, lines = [], read_text(path).splitlines()
    if not lines[0].startswith("# Ship Gym trajectory"):
        return _trials_in(path)
    for line in lines[1:]:
        if not line.startswith("# "):
            break
        head.append(line[2:])
    return history(json.loads("\n".join(head)))


def _trials_in(path: Path) -> Result | None:
    from ship_gym.csv_file import read_csv
    from ship_gym.reports.trials import SOURCE, read_values

    if read_csv(path).header.get("source") != SOURCE:
        return None
    return trials(ship for ship, _, _ in read_values(path)[0])


def _json_in(path: Path) -> Result:
    from ship_gym.reading import read_json

    found = read_json(path)
    if "bound" in found:
        return bound(found["bound"])
    found["differences"], found["episodes"]
    return evaluation(found["scenario"], found["ship"], found["seeds"], found["controllers"])


def _route_in(path: Path) -> Result:
    from ship_gym.tracks import load_route

    return route(load_route(path).to_meta(), path)


def _markdown_in(path: Path) -> Result | None:
    from ship_gym.reading import read_text

    found = _WRITTEN_BY.match(read_text(path))
    return page(found[1]) if found else None


def _html_in(path: Path) -> Result | None:
    from ship_gym.reading import read_text
    from ship_gym.reports.page import GENERATOR

    return page("report") if GENERATOR in read_text(path)[:1000] else None


def _voyage_in(path: Path) -> Result | None:
    from ship_gym.reading import read_text
    from ship_gym.recording.earth_files import MARK

    found = re.search(MARK + r" [0-9a-f]{16}", read_text(path))
    return Result("the track of another recording", ["voyage", found[0]]) if found else None


def _on_earth_in(path: Path) -> Result | None:
    """A sailed track, else a route."""
    return _voyage_in(path) or _route_in(path)


_READERS: dict[str, Callable[[Path], Result | None]] = {
    ".safetensors": _policy_in,
    ".onnx": _onnx_in,
    ".toml": _gains_in,
    ".npz": _table_in,
    ".rrd": _recording_in,
    ".parquet": _parquet_in,
    ".csv": _csv_in,
    ".json": _json_in,
    ".rtz": _route_in,
    ".gpx": _on_earth_in,
    ".geojson": _on_earth_in,
    ".kml": _voyage_in,
    ".md": _markdown_in,
    ".html": _html_in,
    ".fmu": _fmu_in,
}
