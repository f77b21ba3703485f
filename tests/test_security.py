"""No file that is read runs code: a pickle in every place where a file is read, and in numba's.

Two things are looked at. Each reader gets files that hold a payload, which would leave a file
behind, and must say one line. And the sources themselves: what unpickles, and where files are read,
is listed here, so that a new reader is not forgotten.
"""

import ast
import functools
import io
import json
import os
import pickle
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from ship_gym.config import ConfigError

PACKAGES = [Path(__file__).parents[1] / name for name in ("ship_gym", "agents/ship_gym_agents")]


class Harmful:
    """Unpickled, it leaves a file behind."""

    def __init__(self, trace):
        self.trace = trace

    def __reduce__(self):
        return Path.touch, (self.trace,)


# --- payloads ------------------------------------------------------------------------------------


def raw(trace):
    return pickle.dumps(Harmful(trace))


def npy(trace):
    held, array = io.BytesIO(), np.empty(1, dtype=object)
    array[0] = Harmful(trace)
    np.save(held, array)
    return held.getvalue()


def npz(trace):
    """All arrays that any reader of npz files wants, as objects."""
    names = [
        "values",
        "meta",
        "froude",
        "heading",
        "omega",
        "CX_bem",
        "CX_snnm",
        "CY",
        "CN",
        "card",
    ]
    names += ["motions", "uncertainty", "vector", "mean", "scale", "limit", "facts", "observations"]
    return zipped({f"{name}.npy": npy(trace) for name in names})


def zipped(parts):
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return held.getvalue()


def model(trace):
    """An archive as stable-baselines3, torch or version 0.1 wrote it."""
    names = ("data", "data.pkl", "archive/data.pkl", "policy.pth", "pytorch_variables.pth")
    parts = {name: raw(trace) for name in names}
    parts |= {"actor.npz": npz(trace), "normaliser.npz": npz(trace)}
    return zipped(parts | {"card.json": b'{"name": "a", "format": 1, "network": {"layers": 1}}'})


def text(trace):
    """Text that a reader without care would evaluate."""
    return f'__import__("pathlib").Path({str(trace)!r}).touch()\n'.encode()


PAYLOADS = {"pickle": raw, "npy": npy, "npz": npz, "model": model, "text": text}


# --- readers -------------------------------------------------------------------------------------
# name: what to import, the name of the file, and the call. Every module of `READS` that reads files
# of others is named by one of them.


def ship(path):
    from ship_gym.ships import load_ship

    load_ship(path)


def scenario(path):
    from ship_gym.scenarios import load_scenario

    load_scenario(path)


def suite(path):
    from ship_gym.evaluation.suite import load_suite

    load_suite(path)


def csv(path):
    from ship_gym.csv_file import read_csv

    read_csv(path).require("speed")


def plain_csv(path):
    from ship_gym.plain_csv import read_plain_csv

    read_plain_csv(path).numbers("speed")


def captive(path):
    from ship_gym.reports.captive_file import read_measured
    from ship_gym.ships import load_ship

    read_measured(path, load_ship("kvlcc2_model"))


def free_record(path):
    from ship_gym.identification.records import read_record
    from ship_gym.ships import load_ship

    read_record(path, load_ship("kvlcc2_model"))


def samples(path):
    from ship_gym.surrogates.own import own_data_set

    own_data_set(path, "kcs_model")


def trial_values(path):
    from ship_gym.reports.trials import read_values

    read_values(path)


def track(path):
    from ship_gym.tracks.files import load_track

    load_track(path)


def spectrum(path):
    from ship_gym.sea import read_spectrum

    read_spectrum(path)


def table(path):
    from ship_gym.tables import Table

    Table.load(path)


def wave_table(path):
    from ship_gym.sea.wave_table import WaveTable

    WaveTable.load(path)


def wave_cells(path):
    from ship_gym.reading import read_npy

    read_npy(path)


def mesh(path):
    from ship_gym.seakeeping.hull_file import read_hull

    read_hull(path, "kcs")


def recording(path):
    from ship_gym.recording import Trajectory

    Trajectory.from_file(path)


def unsealed(path):
    from ship_gym.recording import Trajectory

    Trajectory.from_rrd(path, sealed=False)


def comparison(path):
    from ship_gym.recording.rerun_export.compare import read_comparison

    read_comparison(path)


def results(path):
    from ship_gym.evaluation.episodes_table import read_results

    read_results(path)


def manoeuvres(path):
    from ship_gym.evaluation.manoeuvres.table import read_manoeuvres

    read_manoeuvres(path)


def benchmark_settings(path):
    from ship_gym.evaluation.run_folder import RunFolder

    RunFolder(path.parent).settings()


def headroom(path):
    from ship_gym.evaluation.headroom import read

    read(path)


def references(path):
    from ship_gym.evaluation.score import read_references

    read_references(path)


def speed_baseline(path):
    from ship_gym.reports.speed_check import load_baseline

    load_baseline(path)


def gains(path):
    from ship_gym_agents import make_controller

    make_controller(path)


def policy(path):
    from ship_gym_agents.policies.policy_file import load_policy

    load_policy(path)


def card(path):
    from ship_gym_agents.policies.policy_file import read_card

    read_card(path)


def old_policy(path):
    from ship_gym_agents.policies.old_zip import load_old

    load_old(path)


def untrusted_model(path):
    from ship_gym_agents.sb3.sb3_zip import load_sb3_zip

    load_sb3_zip(path)


def recipe(path):
    from ship_gym_agents.sb3.config import load_recipe

    load_recipe(path)


def hyperparameters(path):
    from ship_gym_agents.sb3.sections import load_hyperparameters

    load_hyperparameters("ppo", path)


def ranges(path):
    from ship_gym_agents.training.search_space import load_ranges

    load_ranges("ppo", path, {"algorithm": "ppo", "settings": {}})


def run_card(path):
    from ship_gym_agents.sb3.config import load_config

    load_config(path.parent)


def run_state(path):
    from ship_gym_agents.sb3.run_card import read_run_state

    read_run_state(path)


def curve(path):
    from ship_gym_agents.training.curves import read_curve

    if not read_curve(path).get("samples"):  # a line of any words is the head of an empty one
        raise ConfigError("no samples")


def replay_buffer(path):
    import gymnasium as gym
    from ship_gym_agents.sb3.replay_file import load_replay
    from stable_baselines3.common.buffers import ReplayBuffer

    box = gym.spaces.Box(-1.0, 1.0, (2,), np.float32)
    load_replay(ReplayBuffer(4, box, box), path.parent)


def checkpoint(path):
    from ship_gym_agents.sb3.checkpoint import read_model

    read_model(path)


def fmu(path):
    from ship_gym.cosim.write import ship_in

    ship_in(path)


def fmu_card(path):
    from ship_gym.cosim.card import opened

    opened(path.parent, print)


def onnx(path):
    from ship_gym_agents.controllers import shipped_file
    from ship_gym_agents.policies.onnx_check import largest_difference
    from ship_gym_agents.policies.policy_file import load_policy

    if largest_difference(load_policy(shipped_file("heading_kcs")), path) is None:
        pytest.skip("no onnxruntime")


def set_metadata(path):
    """A data set of Minari, by its metadata."""
    pytest.importorskip("minari")
    from ship_gym_agents.datasets import read_set

    data = path.parent / "set" / "data"
    data.mkdir(parents=True, exist_ok=True)
    shutil.copy(path, data / "metadata.json")
    read_set(data.parent)


def set_episodes(path):
    """A data set of Minari whose metadata are right, by its episodes."""
    minari = pytest.importorskip("minari")
    from ship_gym_agents.datasets import read_set

    box = {"type": "Box", "dtype": "float32", "shape": [1], "low": [-1.0], "high": [1.0]}
    spec = {"id": "ShipGym/HeadingKeeping-v0", "kwargs": {}}
    spec["entry_point"] = "ship_gym.envs.classes:HeadingKeeping"
    spaces = dict.fromkeys(("observation_space", "action_space"), json.dumps(box))
    about = {"dataset_id": "a-v0", "data_format": "hdf5", "minari_version": minari.__version__}
    counts = {"total_episodes": 1, "total_steps": 1}
    data = path.parent / "set" / "data"
    data.mkdir(parents=True, exist_ok=True)
    shutil.copy(path, data / "main_data.hdf5")
    metadata = {"env_spec": json.dumps(spec), **spaces, **about, **counts}
    (data / "metadata.json").write_text(json.dumps(metadata))
    read_set(data.parent)


READERS = {
    "ship": (ship, "ship.toml"),
    "scenario": (scenario, "scenario.toml"),
    "suite": (suite, "suite.toml"),
    "csv": (csv, "a.csv"),
    "plain csv": (plain_csv, "a.csv"),
    "captive tests": (captive, "a.csv"),
    "record of a free ship": (free_record, "a.csv"),
    "samples": (samples, "a.csv"),
    "values of trials": (trial_values, "a.csv"),
    "track csv": (track, "track.csv"),
    "track GeoJSON": (track, "track.geojson"),
    "route RTZ": (track, "route.rtz"),
    "route GPX": (track, "route.gpx"),
    "spectrum csv": (spectrum, "a.csv"),
    "spectrum netCDF": (spectrum, "a.nc"),
    "table": (table, "surrogate_mine.npz"),
    "wave table": (wave_table, "waves.npz"),
    "metadata of a data set": (set_metadata, "metadata.json"),
    "episodes of a data set": (set_episodes, "main_data.hdf5"),
    "cells of a wave table": (wave_cells, "waves_000.npy"),
    "mesh stl": (mesh, "hull.stl"),
    "mesh obj": (mesh, "hull.obj"),
    "mesh ply": (mesh, "hull.ply"),
    "mesh gdf": (mesh, "hull.gdf"),
    "mesh vtk": (mesh, "hull.vtk"),
    "mesh msh": (mesh, "hull.msh"),
    "mesh vtu": (mesh, "hull.vtu"),
    "mesh xdmf": (mesh, "hull.xdmf"),
    "mesh mar": (mesh, "hull.mar"),
    "mesh dat": (mesh, "hull.dat"),
    "mesh hst": (mesh, "hull.hst"),
    "mesh pnl": (mesh, "hull.pnl"),
    "mesh step": (mesh, "hull.step"),
    "mesh iges": (mesh, "hull.igs"),
    "mesh of no kind": (mesh, "hull.npz"),
    "recording": (recording, "run.rrd"),
    "recording without a seal": (unsealed, "run.rrd"),
    "journal": (recording, "run.rrd.partial"),
    "comparison": (comparison, "both.rrd"),
    "results of a benchmark": (results, "episodes.parquet"),
    "manoeuvres": (manoeuvres, "manoeuvres.parquet"),
    "settings of a benchmark": (benchmark_settings, "settings.json"),
    "headroom": (headroom, "headroom.json"),
    "references": (references, "references.json"),
    "baseline of speed": (speed_baseline, "baseline.json"),
    "gains": (gains, "gains.toml"),
    "policy": (policy, "policy.safetensors"),
    "policy as a controller": (gains, "policy.safetensors"),
    "policy by another name": (policy, "policy.pt"),
    "zip as a policy": (policy, "policy.zip"),
    "card of a policy": (card, "policy.safetensors"),
    "policy of version 0.1": (old_policy, "policy.zip"),
    "model of stable-baselines3": (untrusted_model, "model.zip"),
    "recipe": (recipe, "recipe.toml"),
    "hyperparameters": (hyperparameters, "ppo.toml"),
    "ranges of a search": (ranges, "ranges.toml"),
    "card of a run": (run_card, "card.json"),
    "state of a run": (run_state, "run.json"),
    "curve": (curve, "curve.csv"),
    "replay buffer": (replay_buffer, "replay_buffer.npz"),
    "pickled replay buffer": (replay_buffer, "replay_buffer.pkl"),
    "checkpoint": (checkpoint, "model.zip"),
    "ONNX": (onnx, "policy.onnx"),
    "FMU": (fmu, "unit.fmu"),
    "card of an FMU": (fmu_card, "unit.json"),
}


@pytest.mark.parametrize("payload", PAYLOADS)
def test_the_traps_work(tmp_path, payload):
    trace = tmp_path / "trace"
    data = PAYLOADS[payload](trace)
    if payload == "text":
        eval(data)
    elif payload == "model":
        pickle.loads(zipfile.ZipFile(io.BytesIO(data)).read("policy.pth"))
    elif payload == "pickle":
        pickle.loads(data)
    else:
        found = np.load(io.BytesIO(data), allow_pickle=True)
        assert (found if payload == "npy" else found["values"]).dtype == object
    assert trace.exists()


@pytest.mark.parametrize("name", READERS)
def test_no_payload_in_a_file_is_run(tmp_path, name):
    read, file = READERS[name]
    for payload, make in PAYLOADS.items():
        trace = tmp_path / f"trace of {payload}"
        (tmp_path / file).write_bytes(make(trace))
        try:
            with pytest.raises(ConfigError) as error:
                read(tmp_path / file)
        except ModuleNotFoundError as missing:
            pytest.skip(str(missing))
        lines = str(error.value).splitlines()
        assert max(map(len, lines)) <= 300 and (len(lines) == 1 or payload == "text")
        assert not trace.exists(), payload


# --- Python files that a file names --------------------------------------------------------------


def test_a_run_is_not_resumed_by_python_that_its_card_names(tmp_path, monkeypatch):
    pytest.importorskip("stable_baselines3")
    from ship_gym_agents.sb3.config import load_config, plain, run_config

    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.py").write_text("from pathlib import Path\nPath('trace').touch()\n")
    made = plain(run_config("ppo", settings={"form.base": "pid"}))
    made["hyperparameters"]["form"]["base"] = "own.py:Own"
    card = {"name": "a", "status": "running", "config": made, "budget": {"steps": 100}}
    (tmp_path / "card.json").write_text(json.dumps(card | {"validations": []}))
    with pytest.raises(ConfigError, match=r"card.json: steers by own.py:Own, which is Python code"):
        load_config(tmp_path)
    assert not (tmp_path / "trace").exists()


# --- kernels -------------------------------------------------------------------------------------

KERNEL = """
import tiny
from ship_gym.physics import _kernel
assert tiny.double(1.5) == 3.0
print(_kernel._CACHE_FOLDER)
"""
TINY = """
from ship_gym.physics._kernel import kernel


@kernel
def double(x):
    return 2.0 * x
"""


@pytest.mark.slow
@pytest.mark.compiled
@pytest.mark.skipif(not hasattr(os, "getuid"), reason="owners and modes are of POSIX")
def test_no_payload_in_the_kernels_of_others_is_run(tmp_path):
    """numba's index is a pickle: in our own folder it runs, so that of others is not read."""
    (tmp_path / "tiny.py").write_text(TINY)
    cache, trace = tmp_path / "cache", tmp_path / "trace"
    env = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "XDG"))}
    env |= {"NUMBA_CACHE_DIR": str(cache), "HOME": str(tmp_path / "none")}
    env |= {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    (tmp_path / "tmp").mkdir()
    env |= {"TMPDIR": str(tmp_path / "tmp")}

    def used():
        done = subprocess.run(
            [sys.executable, "-c", KERNEL], env=env, capture_output=True, text=True, timeout=300
        )
        return Path((done.stdout.split() or ["none"])[-1])

    folder = used()
    assert folder.parent == cache / "ship_gym"
    (index,) = folder.rglob("tiny.double*.nbi")
    index.write_bytes(raw(trace))
    used()
    assert trace.exists(), "the trap must work"
    trace.unlink()
    folder.chmod(0o777)
    assert used().parent == tmp_path / "tmp" / f"ship_gym-{os.getuid()}"
    moved = tmp_path / "theirs"
    folder.rename(moved)
    moved.chmod(0o700)
    folder.symlink_to(moved)
    assert used() != folder
    if os.getuid() == 0:
        folder.unlink()
        shutil.move(moved, folder)
        os.chown(folder, 12345, 12345)
        assert used() != folder
    assert not trace.exists()


# --- the sources ---------------------------------------------------------------------------------


@functools.cache
def modules():
    """Name of each module and the calls in it, with the functions' dotted names."""
    return [
        (path.relative_to(package.parent).as_posix(), calls(ast.parse(path.read_bytes())))
        for package in PACKAGES
        for path in sorted(package.rglob("*.py"))
    ]


def dotted(node):
    """``np.load`` of a call's function; only its last name of a longer one."""
    if isinstance(node, ast.Attribute):
        before = dotted(node.value)
        return f"{before}.{node.attr}" if before else node.attr
    return node.id if isinstance(node, ast.Name) else ""


def calls(tree):
    return [(dotted(node.func), node) for node in ast.walk(tree) if isinstance(node, ast.Call)]


UNPICKLERS = ("pickle", "cloudpickle", "joblib", "dill", "shelve", "marshal", "jsonpickle")
# Two places: the pipe between a run and its own child, and a model that the user trusts in words.
UNPICKLES = {"ship_gym_agents/sb3/learner_process.py", "ship_gym_agents/sb3/sb3_zip.py"}
# Text that the package itself makes of its own tables of fields.
EVALUATES = {"ship_gym/gpu/rows.py", "ship_gym/physics/parameters.py"}


def test_nothing_else_unpickles_or_evaluates():
    unpickles, evaluates = set(), set()
    for name, called_there in modules():
        for called, node in called_there:
            first, _, last = called.rpartition(".")
            if first in UNPICKLERS and last in ("load", "loads", "Unpickler", "open"):
                unpickles.add(name)
            if last in ("load_from_pkl", "load_replay_buffer", "read_pickle") or called in (
                "algorithm.load",
                "VecNormalize.load",
            ):
                unpickles.add(name)
            if called in ("eval", "exec"):
                evaluates.add(name)
            keywords = {word.arg: getattr(word.value, "value", None) for word in node.keywords}
            if called == "torch.load":
                assert keywords.get("weights_only") is True, name
            assert keywords.get("allow_pickle") in (None, False), name
    assert unpickles == UNPICKLES and evaluates == EVALUATES


READING = (
    "open", "fdopen", "read_bytes", "read_text", "read_toml", "read_json", "read_xml", "read_npz",
    "read_npy", "npz_arrays", "read_keys", "read_csv", "read_run_card", "read_run_state", "ZipFile",
    "ParquetFile", "RrdReader", "load_mesh", "InferenceSession", "fromfile", "genfromtxt",
    "loadtxt", "memmap", "JournalFileBackend",
)  # fmt: skip
LIBRARIES = ("np", "numpy", "pickle", "torch", "json", "tomllib", "meshio", "trimesh", "av")
OWN, WRITTEN = "the package's own data", "what this process has written itself"
# Where files are read: the readers above that cover a module, or whose files they are.
READS = {
    "ship_gym/cosim/card.py": {"card of an FMU"},
    "ship_gym/cosim/write.py": {"FMU", "ship"},
    "ship_gym/csv_file.py": {"csv", "captive tests", "samples", "values of trials", "track csv"},
    "ship_gym/evaluation/episodes_table.py": {"results of a benchmark", "manoeuvres"},
    "ship_gym/evaluation/headroom.py": {"headroom"},
    "ship_gym/evaluation/run_folder.py": {"settings of a benchmark"},
    "ship_gym/evaluation/score.py": {"references"},
    "ship_gym/evaluation/suite.py": {"suite"},
    "ship_gym/identification/records.py": {"record of a free ship"},
    "ship_gym/identification/ship_text.py": {"ship"},
    "ship_gym/keys.py": {"settings of a benchmark", "card of a run"},
    "ship_gym/locks.py": "a lock file: a number and words of another process",
    "ship_gym/physics/_cache.py": "a lock file, nothing of it is read",
    "ship_gym/physics/_kernel.py": "source files, for their hash",
    "ship_gym/plain_csv.py": {"plain csv", "curve", "spectrum csv"},
    "ship_gym/plotting/figure.py": WRITTEN,
    "ship_gym/provenance.py": "any file, for its hash",
    "ship_gym/reading.py": {"table", "ship", "track GeoJSON", "route RTZ", "route GPX"},
    "ship_gym/recording/journal.py": {"journal"},
    "ship_gym/recording/rerun_export/program.py": WRITTEN,
    "ship_gym/recording/rerun_export/rrd_file.py": {"recording", "recording without a seal"},
    "ship_gym/recording/rerun_export/viewer.py": "files that were verified, shown by rerun",
    "ship_gym/recording/sealed.py": {"recording", "comparison"},
    "ship_gym/recording/trajectory.py": WRITTEN,
    "ship_gym/rendering/replay.py": WRITTEN,
    "ship_gym/reports/captive_file.py": {"captive tests"},
    "ship_gym/reports/speed.py": "a page of the checkout and /proc/cpuinfo, as text",
    "ship_gym/reports/speed_check.py": {"baseline of speed"},
    "ship_gym/reports/speed_child.py": "/proc",
    "ship_gym/reports/surrogate_printed.py": OWN,
    "ship_gym/reports/trials.py": {"values of trials", "ship"},
    "ship_gym/scenarios/scenario.py": {"scenario"},
    "ship_gym/sea/netcdf_file.py": {"spectrum netCDF"},
    "ship_gym/sea/sea_states.py": OWN,
    "ship_gym/sea/state.py": OWN,
    "ship_gym/sea/wave_table.py": {"wave table"},
    "ship_gym/sea/wind_coefficients.py": OWN,
    "ship_gym/seakeeping/database.py": {"cells of a wave table"},
    "ship_gym/seakeeping/hull_cad.py": {"mesh step", "mesh iges"},
    "ship_gym/seakeeping/hull_formats.py": {"mesh stl", "mesh obj", "mesh ply", "mesh vtk"},
    "ship_gym/seakeeping/hull_gdf.py": {"mesh gdf"},
    "ship_gym/seakeeping/hull_panels.py": {"mesh mar", "mesh hst", "mesh pnl"},
    "ship_gym/ships/files.py": {"ship"},
    "ship_gym/ships/four_quadrants.py": OWN,
    "ship_gym/ships/loader.py": {"ship"},
    "ship_gym/ships/open_water_entry.py": {"csv"},
    "ship_gym/surrogates/error_budget.py": OWN,
    "ship_gym/surrogates/fit.py": {"csv"},
    "ship_gym/surrogates/own.py": {"samples"},
    "ship_gym/surrogates/samples.py": OWN,
    "ship_gym/tables.py": {"table"},
    "ship_gym/tasks/course/task.py": OWN,
    "ship_gym/tasks/heading/task.py": OWN,
    "ship_gym/tasks/track/task.py": OWN,
    "ship_gym/tracks/geojson.py": {"track GeoJSON"},
    "ship_gym/tracks/gpx.py": {"route GPX"},
    "ship_gym/tracks/rtz.py": {"route RTZ"},
    "ship_gym/writing.py": "nothing: it looks whether there is room",
    "ship_gym_agents/cli/listing.py": OWN,
    "ship_gym_agents/cli/output.py": "the null device",
    "ship_gym_agents/cli/replace_read.py": {"gains", "card of a run"},
    "ship_gym_agents/cli/review/show.py": "a browser, at an address of this machine",
    "ship_gym_agents/datasets/read.py": {"metadata of a data set", "episodes of a data set"},
    "ship_gym_agents/gains_files.py": {"gains"},
    "ship_gym_agents/policies/old_zip.py": {"policy of version 0.1"},
    "ship_gym_agents/policies/onnx_check.py": {"ONNX"},
    "ship_gym_agents/policies/policy_file.py": {"policy", "card of a policy", "zip as a policy"},
    "ship_gym_agents/sb3/checkpoint.py": {"checkpoint"},
    "ship_gym_agents/sb3/config.py": {"card of a run", "recipe"},
    "ship_gym_agents/sb3/learner_process.py": "the pipes to its own child, docs/security.md",
    "ship_gym_agents/sb3/replay_file.py": {"replay buffer", "pickled replay buffer"},
    "ship_gym_agents/sb3/run_card.py": {"card of a run", "state of a run"},
    "ship_gym_agents/sb3/sb3_zip.py": {"model of stable-baselines3"},
    "ship_gym_agents/sb3/sections.py": {"hyperparameters"},
    "ship_gym_agents/training/agent_search.py": "JSON: read_keys, and Optuna's journal",
    "ship_gym_agents/training/curves.py": {"curve", "card of a run"},
    "ship_gym_agents/training/gauss_newton.py": {"table"},
    "ship_gym_agents/training/run_folder.py": {"card of a run", "state of a run"},
    "ship_gym_agents/training/search_confirm.py": "JSON: read_keys",
    "ship_gym_agents/training/search_result.py": WRITTEN,
    "ship_gym_agents/training/search_space.py": {"ranges of a search"},
}


def test_every_place_where_a_file_is_read_is_listed():
    found = set()
    for name, called_there in modules():
        for called, _ in called_there:
            first, _, last = called.rpartition(".")
            if last in READING or (last in ("load", "read") and first in LIBRARIES):
                found.add(name)
    assert found == set(READS), "a module that reads files, or reads none any more: edit READS"
    named = {name for covered in READS.values() if isinstance(covered, set) for name in covered}
    assert named <= set(READERS)


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory as on Linux")
def test_a_small_file_needs_no_room_for_a_large_one(tmp_path):
    import resource

    from ship_gym.reading import read_bytes

    (tmp_path / "a").write_bytes(b"abc")
    before = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 28), before[1]))
    try:
        assert read_bytes(tmp_path / "a", 1 << 34) == b"abc"
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


# --- sockets -------------------------------------------------------------------------------------

# modules that bind a socket: to 127.0.0.1, or where a flag says otherwise
BINDS = {
    "ship_gym/recording/rerun_export/program.py": "finds a free port of 127.0.0.1 for the viewer",
    "ship_gym_agents/serve/binding.py": "127.0.0.1, or --listen",
}
SERVERS = ("bind", "create_server", "start_server", "HTTPServer", "TCPServer", "UDPServer")


def test_every_place_that_listens_is_listed():
    found = {
        name
        for name, called_there in modules()
        for called, _ in called_there
        if called.rpartition(".")[2] in SERVERS
    }
    assert found == set(BINDS), "a module that binds a socket, or binds none any more: edit BINDS"


def test_sockets_are_bound_to_this_machine():
    pytest.importorskip("pynmea2")
    from ship_gym_agents.cli.serve import command
    from ship_gym_agents.serve.ports import Ports

    from ship_gym.recording.rerun_export.program import HOST

    listen = next(param for param in command.params if param.name == "listen")
    with Ports(port=0) as usual, Ports(listen.default, port=0) as by_command:
        bound = [address for ports in (usual, by_command) for _, address, _ in ports.bound]
        assert bound == ["127.0.0.1"] * 4 and HOST == "127.0.0.1"
        listening = [held for held in (usual._tcp, usual._udp) if held is not None]
        assert {held.getsockname()[0] for held in listening} == {"127.0.0.1"}
