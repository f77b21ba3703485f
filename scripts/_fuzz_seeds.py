"""The good files that cases are made of: those of the package, and small ones made once."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path


@dataclasses.dataclass(frozen=True)
class Seed:
    """One good input.

    Attributes
    ----------
    name : str
    files : dict of str to bytes
        By name in the folder of the case; the first is the one that is read, the others lie
        beside it.
    options : dict
        What who reads it must know, as the ship that a table belongs to.
    """

    name: str
    files: dict[str, bytes]
    options: dict = dataclasses.field(default_factory=dict)


def file(path: Path, name: str = "", **options) -> Seed:
    """One file, under its own name or another."""
    return Seed(path.stem, {name or path.name: path.read_bytes()}, options)


def ships() -> Iterator[Seed]:
    """Ships of the package with what lies beside them; no wave tables, which are large."""
    from ship_gym.ships.files import DATA

    for name in ("kcs_model", "kvlcc2_model", "onrt_model", "dtc_model", "s175", "kcs", "onrt"):
        files = {"ship.toml": (DATA / name / "ship.toml").read_bytes()}
        for beside in ("kp505_open_water.csv", "surrogate_G2_SA.npz"):
            if (DATA / name / beside).is_file():
                files[beside] = (DATA / name / beside).read_bytes()
        yield Seed(name, files)
        if name == "kvlcc2_model":  # without ranges: what it does then is checked all the same
            free = b"strict = false\n" + files["ship.toml"]
            yield Seed("kvlcc2_model, not strict", {**files, "ship.toml": free})
    for variant in ("hull_a", "hull_c"):
        folder = DATA / "kcs_model"
        names = (f"{variant}.toml", "ship.toml", "kp505_open_water.csv", "surrogate_G2_SA.npz")
        files = {name: (folder / name).read_bytes() for name in names}
        yield Seed(variant, files, {"variant": variant})


def toml_files(folder: Path, pattern: str = "*.toml", most: int = 100) -> Iterator[Seed]:
    """Files of a folder of the package."""
    for path in sorted(folder.glob(pattern))[:most]:
        yield file(path)


def scenarios() -> Iterator[Seed]:
    """Scenarios of the package, and one with everything a user may write in the section sea."""
    import ship_gym.scenarios

    yield from toml_files(Path(ship_gym.scenarios.__file__).parent)


def seas() -> Iterator[Seed]:
    """The section ``sea`` of a scenario on its own base."""
    from _fuzz_values import toml

    from ship_gym.reading import read_toml
    from ship_gym.sea.state import _STATES

    swell = {"wave_height": 2.5, "peak_period": 11.0, "gusts": False, "states": []}
    for name, sea in {
        "own": swell,
        "states": {"states": ["ss4", "ss5"], "current_speed": 0.5, "wave_encounter_deg": 45.0},
        "wind": {"states": [], "wind_speed": 12.0, "gusts": True},
    }.items():
        yield Seed(name, {"sea.toml": toml({"base": "heading_keeping", "sea": sea}).encode()})
    for name, sea in read_toml(_STATES).items():
        yield Seed(name, {"state.toml": toml(sea).encode()}, {"state": True})


def ranges() -> Iterator[Seed]:
    """Ranges of a search for hyperparameters."""
    from ship_gym_agents.training.search_space import RANGES

    for path in sorted(Path(RANGES).glob("*.toml")):
        yield file(path, algorithm=path.stem)


def hyperparameters() -> Iterator[Seed]:
    """Hyperparameters of each algorithm."""
    import ship_gym_agents.sb3

    for path in sorted(Path(ship_gym_agents.sb3.__file__).parent.rglob("*.toml")):
        if "." not in path.stem:
            yield file(path, algorithm=path.stem)


def force_tables() -> Iterator[Seed]:
    """Fitted surrogates."""
    from ship_gym.ships.files import DATA

    for path in sorted((DATA / "kcs_model").glob("surrogate_G*.npz"))[:2]:
        yield file(path, ship="kcs_model")
    yield file(DATA / "onrt_model" / "surrogate_G2_SA.npz", ship="onrt_model")


def wave_tables() -> Iterator[Seed]:
    """Wave tables of the package; the case reads one beside its ship."""
    from ship_gym.ships.files import DATA

    for name in ("dtc_model", "s175"):
        ship = (DATA / name / "ship.toml").read_bytes()
        waves = (DATA / name / "waves.npz").read_bytes()
        yield Seed(name, {"waves_mine.npz": waves, "mine.toml": ship})


def policies() -> Iterator[Seed]:
    """The policies of the package."""
    from ship_gym_agents.controllers import PRETRAINED

    for path in sorted(Path(PRETRAINED).glob("*.safetensors")):
        yield file(path)
