"""Which file a ship is in: by its name in the package, by a path, by what it scales."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, check_known, shown
from ship_gym.reading import read_toml

DATA = Path(__file__).parent / "data"
LONGEST_CHAIN = 8  # of files that scale each other
Named = str | os.PathLike  # a ship of the package by name, or a ship file by its path


def available_ships() -> list[str]:
    """Names of the ships that come with the package."""
    return sorted(path.parent.name for path in DATA.glob("*/ship.toml"))


def text_of(name: Named) -> str:
    """Name or path of a ship as text."""
    if not isinstance(name, str | os.PathLike):
        raise ConfigError(
            f"ship = {shown(name)}: must be a name, the path of a ship file or a Ship"
        )
    return os.fspath(name)


def name_of(path: Path) -> str:
    """Name of the ship in a file; not that of a ship of the package, whose gains are not its."""
    path = path.resolve()
    name = path.parent.name if path.stem == "ship" else path.stem
    own = path.parent.parent != DATA.resolve()
    return f"own_{name}" if own and name in available_ships() else name


def file_of(name: Named) -> Path:
    """The ship file of a ship of the package, or the one that is named."""
    name = text_of(name)
    if name.endswith(".toml"):
        return Path(name)
    if len(Path(name).parts) > 1:
        raise ConfigError(
            f"ship = {shown(name)}: a ship file ends in .toml, as in 'mine/ship.toml'"
        )
    return DATA / check_known("ship", name, available_ships()) / "ship.toml"


def base_of(data: Mapping[str, Any], path: Path) -> str | None:
    """Name or path of the ship that a file scales; a path counts from the file's folder."""
    base = data.get("scaled_from")
    if base is None:
        return None
    if not isinstance(base, str):
        raise ConfigError(f"{path}: scaled_from = {shown(base)}: must be a name or a ship file")
    if not base.endswith(".toml"):
        return base
    return str(path.parent / base)


def chain_of(path: Path) -> list[tuple[Path, dict[str, Any]]]:
    """A ship file, the one that it scales, the one that that scales, and so on, with its values.

    Raises
    ------
    ConfigError
        The files scale each other in a circle, or there are more than `LONGEST_CHAIN`.
    """
    first, chain, seen = path, [(path, read_toml(path))], [path.resolve()]
    while base := base_of(chain[-1][1], chain[-1][0]):
        path = file_of(base)
        if path.resolve() in seen:
            circle = " -> ".join(one.name for one in (*seen, path.resolve()))
            raise ConfigError(f"{first}: scaled_from goes in a circle: {circle}")
        if len(chain) == LONGEST_CHAIN:
            raise ConfigError(f"{first}: scaled_from: more than {LONGEST_CHAIN} files in a row")
        chain.append((path, read_toml(path)))
        seen.append(path.resolve())
    return chain
