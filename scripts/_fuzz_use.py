"""What is done with an input: it is read as a user would, and a little is done with what came.

Each function takes the path of the input and the options of its seed. What is accepted must be
usable: a `Nonsense` is a finding, as is any error that is not told in words.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np

SETTINGS = {"suites": ["core"], "ships": ["kcs"], "controllers": {"pid": {}}, "seeds": [0, 2]}
_SAILED = 20.0  # [s]
_FASTEST = 3.0  # speeds above this many times that of the ship are nonsense


class Nonsense(AssertionError):
    """What was read was accepted and is of no use."""


def _finite(what: str, values: Any) -> None:
    if not np.isfinite(np.asarray(values, dtype=float)).all():
        raise Nonsense(f"{what}: not finite")


# --- ships, scenarios, tracks --------------------------------------------------------------------


def ship(path: Path, variant: str | None = None, **_: Any) -> None:
    """Load it, list what is estimated, and sail 20 s with the rudder hard over."""
    from ship_gym.ships.loader import load_ship

    path = path.with_name("ship.toml") if variant else path
    made = load_ship(path, variant=variant)
    made.describe()
    _sail(ship=made if variant else str(path), scenario="course_calm")


def scenario(path: Path, **_: Any) -> None:
    """An environment: a reset and five steps."""
    _sail(scenario=str(path), steps=5)


def sea(path: Path, state: bool = False, **_: Any) -> None:
    """The sea of a scenario, or a named sea as ``sea/states.toml`` holds it: five steps in it."""
    if not state:
        return _sail(scenario=str(path), steps=5)
    from ship_gym.config import build
    from ship_gym.reading import read_toml
    from ship_gym.sea.state import Sea
    from ship_gym.simulation import ShipSim

    sim = ShipSim("kcs", 1, build(Sea, read_toml(path), str(path)))
    sim.reset(0)
    _finite("state in this sea", sim.step(np.zeros((1, 2)), 1.0))
    return None


def _sail(steps: int = 0, **arguments: Any) -> None:
    from ship_gym.envs.env import ShipEnv

    env = ShipEnv(**arguments)
    try:
        observation, _ = env.reset(seed=0)
        _finite("first observation", observation)
        action = np.ones(env.action_space.shape, np.float32)
        fastest = _FASTEST * env.ship.speed + env.scenario.sea.current_speed
        for _ in range(steps or _intervals(env)):
            observation, reward, ended, cut, _ = env.step(action)
            _finite("observation", observation)
            _finite("reward", reward)
            _check_state(env, fastest)
            if ended or cut:
                break
        batch = env.episodes
        if batch.task.all_outcomes[int(batch.outcomes[0])].name == "diverged":
            raise Nonsense("an accepted ship or sea diverges within the first steps")
    finally:
        env.close()


def _intervals(env: Any) -> int:
    return int(np.clip(_SAILED / env.episodes.dt, 5, 200).max())


def _check_state(env: Any, fastest: float) -> None:
    state = env.episodes.sim.state
    _finite("state", state)
    if np.hypot(*state[0, :2]) > fastest:
        raise Nonsense("a speed above three times that of the ship")


def track(path: Path, **_: Any) -> None:
    """Way-points, and a reset of an environment that follows them."""
    from ship_gym.envs.env import ShipEnv
    from ship_gym.tracks.files import load_track

    load_track(path)
    env = ShipEnv(
        scenario="track_calm", overrides={"track.kind": "points", "track.file": str(path)}
    )
    _finite("first observation", env.reset(seed=0)[0])
    env.close()


# --- controllers, training, benchmarks -----------------------------------------------------------


def controller(path: Path, **_: Any) -> None:
    """A file of gains or a policy: one act in the task that it is for."""
    from ship_gym_agents import make_controller
    from ship_gym_agents.controllers import trained_for

    from ship_gym.envs.vector_env import ShipVectorEnv

    made = make_controller(path)
    task = "track_calm" if "los" in path.name or "track" in path.name else "heading_keeping"
    task = "course_calm" if "course" in path.name else task
    asked = {"scenario": task} | trained_for(made)
    env = ShipVectorEnv(2, **asked)
    observations, _ = env.reset(seed=0)
    made.reset(2, env.ship, env.scenario)
    _finite("action", made.act(observations))
    env.close()


def old_policy(path: Path, **_: Any) -> None:
    """A policy of version 0.1, as ``ship-gym export`` reads it; its network is run once."""
    from ship_gym_agents.policies.old_zip import is_old, load_old

    if is_old(path):
        made = load_old(path)
        scaled = made.normaliser(np.zeros((1, made.network.n_features)))
        _finite("decision", made.network(scaled))


def suite(path: Path, **_: Any) -> None:
    """A suite of a benchmark."""
    from ship_gym.evaluation.suite import load_suite

    load_suite(path)


def recipe(path: Path, **_: Any) -> None:
    """A recipe of training, resolved."""
    from ship_gym_agents.sb3.config import plain, run_config

    plain(run_config(recipe=path))


def hyperparameters(path: Path, algorithm: str = "ppo", **_: Any) -> None:
    """Hyperparameters of an algorithm."""
    from ship_gym_agents.sb3.sections import load_hyperparameters

    load_hyperparameters(algorithm, path)


def ranges(path: Path, algorithm: str = "ppo", **_: Any) -> None:
    """Ranges of a search."""
    from ship_gym_agents.training.search_space import load_ranges

    given = {"algorithm": algorithm, "recipe": "heading_gauss_newton"}
    symmetric = {} if algorithm not in ("dqn", "recurrent_ppo") else {"form.symmetric": False}
    load_ranges(algorithm, path, given | {"settings": symmetric})


def run_card(path: Path, state: bool = False, **_: Any) -> None:
    """The card of the run in a folder and its config; or what a checkpoint says of the run."""
    from ship_gym_agents.sb3.config import load_config, plain
    from ship_gym_agents.sb3.run_card import read_run_card, read_run_state

    if state:
        read_run_state(path)
    else:
        read_run_card(path)
        plain(load_config(path.parent))


def settings(path: Path, **_: Any) -> None:
    """Settings and first unit of a benchmark that goes on."""
    from ship_gym.evaluation.run_folder import RunFolder

    folder = RunFolder(path.parent)
    found = folder.settings()
    folder.kept(0, [0])
    if found is not None:
        folder.begin(SETTINGS, fresh=False)


def references(path: Path, **_: Any) -> None:
    """Reference values of a benchmark, and the score of its first cell."""
    from ship_gym.evaluation.score import cell_score, read_references

    for cell in list(read_references(path).cells.values())[:1]:
        cell_score([1.0, 2.0], cell)


def results(path: Path, **_: Any) -> None:
    """A table of a benchmark, its rows, and the scores that its page tells."""
    from ship_gym.evaluation.episodes_table import read_results
    from ship_gym.evaluation.report.benchmark import judge

    found = read_results(path)
    found.rows()
    judge(found)


# --- tables of numbers ---------------------------------------------------------------------------


@functools.cache
def _ship(name: str) -> Any:
    from ship_gym.ships.loader import load_ship

    return load_ship(name)


def captive(path: Path, **_: Any) -> None:
    """Measured captive tests."""
    from ship_gym.reports.captive_file import read_measured

    for run in read_measured(path, _ship("kvlcc2_model")):
        _finite("captive test", list(run.values.values()))


def samples(path: Path, **_: Any) -> None:
    """A user's samples of propeller and rudder, and what looks like a slip in them."""
    from ship_gym.surrogates.own import own_data_set

    data = own_data_set(path, "kcs_model")
    _finite("box of the samples", data.box)


def trials(path: Path, **_: Any) -> None:
    """Values of an earlier computation."""
    from ship_gym.reports.trials import read_values

    read_values(path)


def history(path: Path, **_: Any) -> None:
    """A measured time history."""
    from ship_gym.reports.histories import read_history

    found = read_history(path, _ship("kvlcc2_model"))
    _finite("time of the history", found.t)


def force_table(path: Path, ship: str, **_: Any) -> None:
    """A surrogate attached to its ship; a second of sailing."""
    from ship_gym.ships.loader import attach_surrogate
    from ship_gym.simulation import ShipSim
    from ship_gym.tables import Table

    sim = ShipSim(attach_surrogate(ship, Table.load(path), "own"), 1)
    sim.reset(0)
    _finite("state with this table", sim.step(np.array([[0.5, 10.0]]), 1.0))


def wave_table(path: Path, **_: Any) -> None:
    """A table beside its ship: an environment in waves, five steps."""
    _sail(ship=str(path.with_name("mine.toml")), scenario="heading_ss5_beam", steps=5)


# --- recordings, meshes --------------------------------------------------------------------------


def recording(path: Path, **_: Any) -> None:
    """A recording or journal, and its row in ``ship-gym review list``."""
    from ship_gym.recording import library
    from ship_gym.recording.trajectory import Trajectory

    library.read(path).columns()
    len(Trajectory.from_file(path))


def mesh(path: Path, **_: Any) -> None:
    """The hull of KCS."""
    from ship_gym.seakeeping.hull_file import read_hull

    _finite("vertices", read_hull(path, "kcs", panels=None).vertices)


def manoeuvres(path: Path, **_: Any) -> None:
    """A table of manoeuvres."""
    from ship_gym.evaluation.manoeuvres.table import read_manoeuvres

    read_manoeuvres(path)


def speed_baseline(path: Path, **_: Any) -> None:
    """Ratios that speed is compared with."""
    from ship_gym.reports.speed_check import load_baseline

    load_baseline(path)


def curve(path: Path, **_: Any) -> None:
    """The curve of a training."""
    from ship_gym_agents.training.curves import read_curve

    read_curve(path)
