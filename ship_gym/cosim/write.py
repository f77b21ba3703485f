"""`write_fmu`: a ship in a sea as an FMU of FMI 2.0 or 3.0 for co-simulation."""

from __future__ import annotations

import hashlib
import importlib
import io
import json
import os
import re
import shutil
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known
from ship_gym.cosim.card import CARD, FORMAT, SHIPS
from ship_gym.cosim.osp import write_osp
from ship_gym.cosim.unit import ShipUnit
from ship_gym.cosim.values import sea_of, ship_of, start_values
from ship_gym.keys import Keys
from ship_gym.provenance import versions
from ship_gym.reading import check_unpacked, parsed_json, read_as, read_bytes, read_toml
from ship_gym.ships.files import DATA, chain_of, file_of, text_of
from ship_gym.ships.particulars import Ship
from ship_gym.simulation import ShipSim
from ship_gym.writing import atomic_path

# version of FMI -> library that writes it, and how it names what a unit can do
EXPORTERS = {"2": "pythonfmu", "3": "pythonfmu3"}
_CAN = {
    "2": {"canGetAndSetFMUstate": True, "canSerializeFMUstate": True},
    "3": {"canGetAndSetFMUState": True, "canSerializeFMUState": True},
}
_MODEL = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,99}")
_HULLS, _TABLES = "hull_*.toml", ("surrogate_*.npz", "waves*.npz")  # beside a ship file
_STEP = 1.0  # [s] that is proposed to a master


def write_fmu(
    ship: str | os.PathLike, path: str | os.PathLike, fmi: str | int = "2", **given: Any
) -> list[Path]:
    """Write a ship as FMU, and beside it its groups of variables for OSP.

    Parameters
    ----------
    ship : str or path
        Name, or ship file: with all that lies beside it for it, it goes into the FMU.
    path : path
        ``MODEL.fmu``; the model has this name.
    fmi : str or int
        Version of FMI, 2 or 3.
    **given
        What parameters start with, as in ``values.start_values``.

    Returns
    -------
    list of Path
        The FMU and ``MODEL_OspModelDescription.xml``.

    Raises
    ------
    ConfigError
        A parameter that is refused, or a name that no model may have.
    ImportError
        pythonfmu, or pythonfmu3, is not installed.
    """
    fmi = str(fmi)
    check_known("version of FMI", fmi, EXPORTERS)
    if find_spec(EXPORTERS[fmi]) is None:
        raise ImportError(f'an FMU needs {EXPORTERS[fmi]}: pip install "ship-gym[fmu]"')
    path = Path(path)
    model = model_name(path)
    values = start_values(text_of(ship), **given)
    vessel = ship_of(values, Path())
    ShipSim(vessel, sea=sea_of(values, vessel)).reset(  # refuses what cannot be sailed
        0, speed=values["start.speed"], n=values["start.propeller_speed"]
    )
    groups = path.with_name(f"{model}_OspModelDescription.xml")
    with tempfile.TemporaryDirectory(prefix="ship_gym_fmu_") as folder:
        files = _resources(Path(folder), model, values, vessel, fmi)
        unit = ShipUnit(json.loads(files[CARD].read_text())["values"], vessel.propellers, Path())
        with atomic_path(path) as fmu, atomic_path(groups) as osp:
            _build(files, fmu, fmi)
            write_osp(unit, osp)
    return [path, groups]


def model_name(path: Path) -> str:
    """Name of the model of an FMU, which is that of its file; refused where it is none of C."""
    if path.suffix != ".fmu" or not _MODEL.fullmatch(path.stem):
        raise ConfigError(
            f"{path}: the name of an FMU is that of its model: letters, digits and _, no digit "
            "first, then .fmu"
        )
    return path.stem


def _resources(
    folder: Path, model: str, values: dict[str, Any], ship: Ship, fmi: str
) -> dict[str, Path]:
    """What goes into the resources of an FMU, by name: card, script and own ships."""
    ships = folder / SHIPS
    name = values["ship.name"]
    if name.endswith(".toml"):
        values = values | {"ship.name": _pack_ship(Path(name), ships)}
    version = versions()["ship-gym"]
    card: dict[str, Any] = {
        "format": FORMAT,
        "ship": ship.name,
        "modelName": model,
        "description": f"{ship.name} in a sea, by Ship Gym {version}",
        "version": version,
        "propellers": ship.propellers,
        "step": _STEP,
        "values": values,
    }
    content = json.dumps(card, indent=1).encode() + b"".join(
        file.read_bytes() for file in sorted(ships.rglob("*")) if file.is_file()
    )
    card["guid"] = str(uuid.uuid5(uuid.NAMESPACE_URL, hashlib.sha256(content).hexdigest()))
    (folder / CARD).write_text(json.dumps(card, indent=1), encoding="utf-8")
    # modules of all FMUs of a process have one name space: each has a name of its own
    script = folder / f"ship_gym_unit_{card['guid'].replace('-', '')}.py"
    shutil.copyfile(Path(__file__).with_name(f"fmi{fmi}_script.py"), script)
    return {CARD: folder / CARD, "script": script} | ({SHIPS: ships} if ships.exists() else {})


def _pack_ship(path: Path, ships: Path) -> str:
    """Copy an own ship file, those that it scales and what lies beside them for them.

    Returns
    -------
    str
        The ship file in `ships`.
    """
    chain = [(file.resolve(), data) for file, data in chain_of(file_of(path))]
    own = [(file, data) for file, data in chain if DATA.resolve() not in file.parents]
    top = Path(os.path.commonpath([file.parent.parent for file, _ in own]))
    for file, data in own:
        for found in _with_its_files(file, data):
            if top not in found.parents:
                raise ConfigError(f"{file}: {found} is outside of {top}, where its FMU takes files")
            there = ships / found.relative_to(top)
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(found, there)
    return own[0][0].relative_to(top).as_posix()


def _with_its_files(file: Path, data: Mapping[str, Any]) -> Iterator[Path]:
    """A ship file, its hull sets and tables, and the open-water points that it or they name."""
    hulls = sorted(file.parent.glob(_HULLS))
    for one in (data, *map(read_toml, hulls)):
        entry = one.get("open_water")
        if isinstance(entry, Mapping) and isinstance(entry.get("points"), str):
            yield (file.parent / entry["points"]).resolve()
    yield from (file, *hulls, *(found for kind in _TABLES for found in file.parent.glob(kind)))


def _build(files: Mapping[str, Path], path: Path, fmi: str) -> None:
    """Have pythonfmu put the FMU together."""
    builder = importlib.import_module(EXPORTERS[fmi]).FmuBuilder
    script = files["script"]
    project = [file for name, file in files.items() if name != "script"]
    with _left_as_it_was(script.stem), tempfile.TemporaryDirectory() as folder:
        made = builder.build_FMU(script, folder, project_files=project, **_CAN[fmi])
        shutil.copyfile(made, path)


@contextmanager
def _left_as_it_was(module: str) -> Iterator[None]:
    """Undo what pythonfmu does to Python's search path and modules."""
    before = list(sys.path)
    try:
        yield
    finally:
        sys.path[:] = before
        sys.modules.pop(module, None)


def usual_name(ship: str | os.PathLike) -> str:
    """File that an FMU of a ship goes into if none is named."""
    path = Path(ship)
    name = path.parent.name if path.stem == "ship" and path.parent.name else path.stem
    name = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return f"{name if _MODEL.fullmatch(name) else f'ship_{name}'}.fmu"


def ship_in(path: Path) -> str:
    """The ship that an FMU of ours was written for, as it was named then.

    Raises
    ------
    ConfigError
        It is none.
    """
    data = read_bytes(path)
    with read_as(path, "an FMU of Ship Gym"), zipfile.ZipFile(io.BytesIO(data)) as archive:
        check_unpacked(archive)
        card = parsed_json(archive.read(f"resources/{CARD}"), path)
    return Keys(card, str(path)).text("ship")
