"""What is killed by check_kills.py: five kinds of work, tiny, and what their folders must hold."""

from __future__ import annotations

import dataclasses
import functools
import json
import re
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

SUITE = """\
name = "kills"
version = "kills-1"
title = "Short episodes"
ships = ["kcs"]
controllers = ["pid"]
tasks = []

[[scenario]]
name = "short.toml"
"""
SHORT = 'base = "heading_keeping"\nduration = 60.0\n'


class Work(NamedTuple):
    """A kind of work that is killed, in an empty folder that is its current one.

    Attributes
    ----------
    run : callable
        Begins, and goes on with what a kill left.
    broken : callable
        What is wrong with a folder after a kill; empty if nothing is.
    result : callable
        What a finished folder holds, to be compared with that of a run that was never killed.
    over : str
        What a finished run says when it is to go on, where that is an error.
    warm : callable, optional
        Loads and compiles what `run` needs before processes are forked; `run` itself if omitted.
    """

    run: Callable[[], None]
    broken: Callable[[Path, Any], str]
    result: Callable[[Path], Any]
    over: str = ""
    warm: Callable[[], None] | None = None


def works() -> dict[str, Work]:
    """All works by name that the installed libraries allow."""
    made = {
        "train": Work(_train, _broken_run, _result_of_run, "used up"),
        "seeds": Work(_train_seeds, _broken_seeds, _result_of_seeds),
        "tune": Work(_tune, _broken_gains, _gains),
        "benchmark": Work(_benchmark, _broken_benchmark, _rows),
        "record": Work(_record, _broken_recordings, _recordings, warm=_record_csv),
        "table": Work(_table, _broken_table, _arrays),
    }
    if find_spec("stable_baselines3") is not None:
        made["train_ppo"] = Work(_train_ppo, _broken_run, _end_of_run, "used up")
    return made


def names_in(folder: Path) -> list[str]:
    """Files in a folder but logs of TensorBoard; a generation of a run by no number."""
    paths = (str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    plain = {re.sub(r"checkpoint/\d+", "checkpoint/*", path) for path in paths}
    return sorted(path for path in plain if "tensorboard" not in path)  # one log of each part


def _ship_gym(*words: Any) -> None:
    """A command of ship-gym, in this process."""
    from ship_gym_agents.cli import main

    main([str(word) for word in words])


# --- training ---------------------------------------------------------------------------------


@functools.cache
def _config(algorithm: str) -> Any:
    from ship_gym_agents.sb3.config import run_config

    form = {"action": "residual", "base": "pid", "scale": 0.3, "symmetric": True}
    training = {"validations": 4, "checkpoint": 0.0, "threads": 1, "record": 0}
    if algorithm == "ppo":
        training |= {"envs": 8, "episode": 20.0, "validations": 2}
        own = {"n_steps": 16, "batch_size": 64, "n_epochs": 1}
        hyper = {"network": {"hidden": [8, 8]}, "training": training, "algorithm": own}
        return run_config("ppo", overrides={"duration": 20.0}, hyperparameters=hyper)
    hyper = {
        "form": form | {"features": ["observer"]},
        "network": {"hidden": []},
        "training": training | {"episode": 0.0},
        "algorithm": {"episodes": 4, "iterations": 3, "relative": False, "price": 0.0},
    }
    return run_config("gauss_newton", overrides={"duration": 60.0}, hyperparameters=hyper)


def _train(algorithm: str = "gauss_newton", steps: int = 3000) -> None:
    from ship_gym_agents.cli.output import run
    from ship_gym_agents.training.train import train

    from ship_gym.config import ConfigError

    assert issubclass(ConfigError, ValueError)  # loaded before the fork
    run(lambda: train(_config(algorithm), "run", steps=steps, resume=True, final=False))


def _train_ppo() -> None:
    _train("ppo", 512)


def _generation(run: Path) -> Path | None:
    return max(run.glob("checkpoint/[0-9]*"), default=None)


def _broken_run(folder: Path, _: Any, name: str = "run") -> str:
    """The last generation is whole and of one moment; the copies can be read."""
    from ship_gym_agents.policies.policy_file import load_policy

    run = folder / name
    last = _generation(run)
    if (run / "card.json").is_file():
        json.loads((run / "card.json").read_text())
    elif last is not None:
        return "a checkpoint without a card"
    if (run / "policy.safetensors").is_file():
        load_policy(run)
    if last is None:
        return ""
    state, card = (json.loads((last / name).read_text()) for name in ("run.json", "card.json"))
    best = load_policy(last / "policy.safetensors").card["best"]
    for name in ("samples", "validations"):
        if state[name] != card[name]:
            return f"card and checkpoint differ in {name}"
    if best != card["best"] or best not in state["validations"]:
        return "the policy is not the best of its checkpoint"
    for file in last.glob("*.np?"):
        with np.load(file) as arrays:
            list(arrays.values())
    return ""


def _end_of_run(folder: Path, name: str = "run") -> Any:
    """What any complete run has: the copies are those of its last generation."""
    run = folder / name
    last = _generation(run)
    card = json.loads((run / "card.json").read_text())
    same = all(
        (run / name).read_bytes() == (last / name).read_bytes()
        for name in ("card.json", "policy.safetensors")
    )
    return {"status": card["status"], "copies": same, "enough": card["used"] >= 1.0}


def _result_of_run(folder: Path, name: str = "run") -> Any:
    """Weights, samples and validations; Gauss-Newton goes on exactly where it was."""
    from ship_gym_agents.policies.policy_file import load_policy

    card = json.loads((folder / name / "card.json").read_text())
    found = [{k: v for k, v in one.items() if k != "seconds"} for one in card["validations"]]
    weights = load_policy(folder / name).network.tensors()
    weights = {name: array.tolist() for name, array in weights.items()}
    about = {"weights": weights, "validations": found, "samples": card["samples"]}
    return about | {k: v for k, v in _end_of_run(folder, name).items() if k != "enough"}


def _train_seeds() -> None:
    from ship_gym_agents.training import run as validations
    from ship_gym_agents.training.seeds import train_seeds

    validations.EPISODES = (4,)
    train_seeds(_config("gauss_newton"), "run", 2, steps=1500, resume=True, final=False)


def _seed_folders(folder: Path) -> list[Path]:
    return sorted(path for path in folder.glob("run/seed_*") if path.is_dir())


def _broken_seeds(folder: Path, _: Any) -> str:
    """Each seed as a run, and what is of all agrees with them where it is complete."""
    from ship_gym_agents.policies.policy_file import load_policy

    found = [_broken_run(seed, None, "") for seed in _seed_folders(folder)]
    card = folder / "run" / "card.json"
    if card.is_file() and json.loads(card.read_text())["status"] == "complete":
        _result_of_seeds(folder)
    if (folder / "run" / "policy.safetensors").is_file():
        load_policy(folder / "run")
    return "; ".join(filter(None, found))


def _result_of_seeds(folder: Path) -> Any:
    run = folder / "run"
    card, told = (json.loads((run / name).read_text()) for name in ("card.json", "summary.json"))
    seeds = _seed_folders(folder)
    kept = (seeds[card["median"]["place"]] / "policy.safetensors").read_bytes()
    same = kept == (run / "policy.safetensors").read_bytes() and card["runs"] == told["runs"]
    runs = [{k: v for k, v in one.items() if k != "seconds"} for one in card["runs"]]
    found = [_result_of_run(seed, "") for seed in seeds]
    return {"status": card["status"], "copies": same, "runs": runs, "seeds": found}


# --- tuning -----------------------------------------------------------------------------------


def _tune() -> None:
    small = ("--episodes", 2, "--generations", 1, "--candidates", 4, "--polish", 0)
    what = ("--ship", "kcs", "--controller", "lqg", "--set", "duration=60")
    _ship_gym("tune", *what, *small, "--out", "lqg.toml")


def _gains(folder: Path) -> Any:
    return (folder / "lqg.toml").read_text()


def _broken_gains(folder: Path, whole: Any) -> str:
    there = (folder / "lqg.toml").is_file()
    return "gains that are not whole" if there and _gains(folder) != whole else ""


# --- benchmark --------------------------------------------------------------------------------


def _benchmark() -> None:
    if not Path("suite.toml").is_file():
        Path("short.toml").write_text(SHORT)
        Path("suite.toml").write_text(SUITE)
    plain = ("--seeds", 32, "--jobs", 1, "--no-report", "--out", "run")
    _ship_gym("benchmark", "--suite", "suite.toml", "--controllers", "pid", *plain)


_CLOCK = ("decision_ms",)  # columns that a clock measured


def _rows(folder: Path) -> Any:
    """Rows without what a clock measured."""
    from ship_gym.evaluation import read_results

    rows = read_results(folder / "run").rows()
    return [{name: row[name] for name in row if name not in _CLOCK} for row in rows]


def _broken_benchmark(folder: Path, whole: Any) -> str:
    run = folder / "run"
    for file in (*run.glob("settings.json"), *run.glob("units/*.json")):
        if not file.name.startswith("."):
            json.loads(file.read_text())
    there = (run / "episodes.parquet").is_file()
    return "a table that is not whole" if there and _rows(folder) != whole else ""


# --- recordings -------------------------------------------------------------------------------


def _record(out: str = "out") -> None:
    _ship_gym("record", "--controller", "pid", "--seeds", 2, "--set", "duration=60", "--out", out)


def _record_csv() -> None:
    """The same without rerun, which a process that has used it must not be forked with."""
    import rerun  # noqa: F401, loaded only

    _record("out.csv")


def _recordings(folder: Path) -> Any:
    from ship_gym.recording import Trajectory

    found = {}
    for file in sorted(folder.glob("out/[!.]*.rrd")):
        run = Trajectory.from_file(file)
        found[file.name] = {name: run[name].tolist() for name in run.names}
    return found


def _broken_recordings(folder: Path, whole: Any) -> str:
    """Files are whole; journals hold the first rows, or less than a chunk of them."""
    from ship_gym.recording import DamagedRecording, Trajectory

    for name, columns in _recordings(folder).items():
        if columns != whole[name]:
            return f"{name} is not whole"
    for file in folder.glob("out/*.partial"):
        try:
            run = Trajectory.from_file(file)
        except DamagedRecording as error:
            if "before its first whole chunk" not in str(error):
                return str(error)
            continue
        expected = whole[file.name.removesuffix(".partial")]
        if any(run[name].tolist() != expected[name][: len(run)] for name in run.names):
            return f"{file.name} has other rows"
    return ""


# --- wave table -------------------------------------------------------------------------------


def _table() -> None:
    from ship_gym import load_ship
    from ship_gym.seakeeping.database import Grid, build
    from ship_gym.seakeeping.hull_form import parametric_mesh

    ship = load_ship("kcs_model")
    grid = Grid((0.0, 0.2), 3, 2, longest=6.0, shortest=1.0, encounter=4, encounter_max=4.0)
    build(ship, parametric_mesh(ship, 16, 4), Path("waves.npz").absolute(), grid)


def _arrays(folder: Path) -> Any:
    from ship_gym.sea.wave_table import WaveTable

    table = WaveTable.load(folder / "waves.npz")
    names = [field.name for field in dataclasses.fields(table) if field.name != "card"]
    return {name: np.asarray(getattr(table, name)).tolist() for name in names}


def _broken_table(folder: Path, whole: Any) -> str:
    if (folder / "waves.npz").is_file() and _arrays(folder) != whole:
        return "a table that is not whole"
    for file in folder.glob("waves-*/[!.]*.npy"):
        np.load(file)
    return ""
