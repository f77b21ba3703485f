"""The table of formats: good files, how to change them, and what is then done with them.

A new format is one line of `FORMATS`, with a function of ``_fuzz_seeds`` that gives good files, an
edit of ``_fuzz_mutate`` or ``_fuzz_binary`` for each kind of file in them, and a function of
``_fuzz_use`` that reads the result as a user does.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import _fuzz_binary as binary
import _fuzz_commands as commands
import _fuzz_field as field
import _fuzz_field_edits as field_edits
import _fuzz_field_use as field_use
import _fuzz_fit as fit
import _fuzz_impossible as impossible
import _fuzz_made as made
import _fuzz_mutate as text
import _fuzz_seeds as seeds
import _fuzz_sets as sets
import _fuzz_use as use
import numpy as np
from _fuzz_seeds import Seed

# edit of a file by the end of its name; longer ends first
EDITS: dict[str, text.Edit] = {
    ".rrd.partial": binary.journal_edit,
    ".rrd": binary.rrd_edit,
    ".toml": text.toml_edit,
    ".csv": text.csv_edit,
    ".geojson": text.json_edit,
    ".json": text.json_edit,
    ".npz": binary.npz_edit,
    ".safetensors": binary.policy_edit,
    ".zip": binary.old_policy_edit,
    ".parquet": binary.parquet_edit,
    ".words": commands.words_edit,
    ".nmea": field_edits.nmea_edit,
    ".nc": field_edits.netcdf_edit,
    ".hdf5": sets.hdf5_edit,
    **dict.fromkeys((".rtz", ".gpx", ".vtu"), field_edits.xml_edit),
    **dict.fromkeys((".obj", ".stl", ".gdf", ".off", ".ply"), binary.mesh_edit),
    **dict.fromkeys((".mar", ".dat", ".hst", ".pnl", ".msh", ".vtk"), binary.mesh_edit),
}


@dataclasses.dataclass(frozen=True)
class Format:
    """One kind of input.

    Attributes
    ----------
    weight : float
        Its share of the cases, beside those of the others.
    seeds : function
        Gives the good inputs.
    use : function
        Reads the first file of an input and uses it a little.
    owner : str
        Who mends what is found: a word of the report.
    """

    weight: float
    seeds: Callable[[], Iterator[Seed]]
    use: Callable[..., Any]
    owner: str


def _of(name: str) -> Callable[[], Iterator[Seed]]:
    """Files of a folder of the package ship_gym_agents."""

    def found() -> Iterator[Seed]:
        import ship_gym_agents

        yield from seeds.toml_files(Path(ship_gym_agents.__file__).parent / name)

    return found


def _suites() -> Iterator[Seed]:
    from ship_gym.evaluation import suite

    yield from seeds.toml_files(suite._FOLDER)


def _baseline() -> Iterator[Seed]:
    yield seeds.file(Path(__file__).with_name("speed_baseline.json"))


FORMATS: dict[str, Format] = {
    "ship": Format(18, seeds.ships, use.ship, "ships"),
    "scenario": Format(10, seeds.scenarios, use.scenario, "text"),
    "sea": Format(4, seeds.seas, use.sea, "text"),
    "suite": Format(5, _suites, use.suite, "text"),
    "gains": Format(5, _of("gains"), use.controller, "text"),
    "recipe": Format(4, _of("recipes"), use.recipe, "text"),
    "hyperparameters": Format(3, seeds.hyperparameters, use.hyperparameters, "text"),
    "ranges": Format(2, seeds.ranges, use.ranges, "text"),
    "captive csv": Format(5, made.captive, use.captive, "text"),
    "captive fit": Format(3, fit.captive, fit.fit_captive, "fit-hull"),
    "free record": Format(3, fit.records, fit.calibrate, "fit-hull"),
    "samples csv": Format(5, made.samples, use.samples, "text"),
    "trials csv": Format(3, made.trials, use.trials, "text"),
    "history csv": Format(3, made.histories, use.history, "text"),
    "track": Format(6, made.tracks, use.track, "text"),
    "force table": Format(5, seeds.force_tables, use.force_table, "binary"),
    "wave table": Format(4, seeds.wave_tables, use.wave_table, "binary"),
    "recording": Format(4, made.recordings, use.recording, "binary"),
    "journal": Format(4, made.journals, use.recording, "binary"),
    "policy": Format(8, seeds.policies, use.controller, "binary"),
    "old policy": Format(3, made.old_policies, use.old_policy, "binary"),
    "run card": Format(4, made.run_cards, use.run_card, "text"),
    "settings": Format(2, made.settings_files, use.settings, "text"),
    "references": Format(3, made.references, use.references, "text"),
    "results": Format(3, made.results, use.results, "binary"),
    "manoeuvres": Format(2, made.manoeuvres, use.manoeuvres, "binary"),
    "speed baseline": Format(1, _baseline, use.speed_baseline, "text"),
    "curve": Format(1, made.curves, use.curve, "text"),
    "mesh": Format(5, made.meshes, use.mesh, "binary"),
    "route": Format(5, field.routes, field_use.route, "routes"),
    "spectrum": Format(4, field.spectra, field_use.spectrum, "seas"),
    "hull": Format(4, field.hulls, field_use.hull, "hulls"),
    "data set": Format(3, sets.sets, sets.use, "data sets"),
    "sentences": Format(3, field.sentences, field_use.sentences, "serve"),
    "command": Format(10, commands.seeds, commands.use, "command line"),
    impossible.NAME: Format(0, impossible.seeds, use.ship, "ships"),  # each once, never changed
}


@functools.cache
def good(name: str) -> tuple[Seed, ...]:
    """The good inputs of a format, made once."""
    return tuple(FORMATS[name].seeds())


@dataclasses.dataclass(frozen=True)
class Case:
    """One input that may be wrong.

    Attributes
    ----------
    number : int
        Of the case among those of its seed; negative: of the list of impossible ships.
    kind : str
        Key of `FORMATS`.
    seed : str
        Name of the good input.
    edits : tuple of (int, str)
        Number of each edit that is made, and the file that it changes.
    files : dict of str to bytes
        What comes of it.
    options : dict
        Of the seed.
    """

    number: int
    kind: str
    seed: str
    edits: tuple[tuple[int, str], ...]
    files: dict[str, bytes]
    options: dict[str, Any]


def case(seed: int, number: int, kept: tuple[int, ...] | None = None) -> Case:
    """Case `number` of a seed; always the same, whatever was run before.

    Parameters
    ----------
    seed, number : int
    kept : tuple of int, optional
        Numbers of the edits that are made; all, if omitted.
    """
    if number < 0:
        found = good(impossible.NAME)[-1 - number]
        return Case(number, impossible.NAME, found.name, (), found.files, found.options)
    rng = np.random.default_rng([seed, number])
    kind = _drawn(rng)
    begun = text.pick(rng, good(kind))
    files, main = dict(begun.files), next(iter(begun.files))
    planned = []
    for j in range(int(min(rng.geometric(0.5), 5))):
        planned.append((j, main if rng.random() < 0.75 else text.pick(rng, list(files))))
    edits = tuple(one for one in planned if kept is None or one[0] in kept)
    for j, name in edits:
        edit = next(edit for end, edit in EDITS.items() if name.endswith(end))
        files[name] = edit(np.random.default_rng([seed, number, j]), files[name])
    return Case(number, kind, begun.name, edits, files, begun.options)


def kind_of(seed: int, number: int) -> str:
    """The format of a case, without making it."""
    return _drawn(np.random.default_rng([seed, number]))


def _drawn(rng: np.random.Generator) -> str:
    names = [name for name, each in FORMATS.items() if each.weight]
    shares = np.array([FORMATS[name].weight for name in names], dtype=float)
    return names[int(rng.choice(len(names), p=shares / shares.sum()))]
