"""Pages of the environments in Markdown, from docstrings, spaces and scenario files.

Nothing is typed here that a class, a space or a scenario says itself.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium as gym

from pages import scenario_page
from pages.docstrings import returned, table
from pages.headroom import headroom_table
from ship_gym.conventions import KNOT
from ship_gym.envs.docstring import observation_table
from ship_gym.envs.env import ShipEnv
from ship_gym.envs.episodes import EpisodeBatch
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.evaluation import metrics_of
from ship_gym.tasks import TASKS, privileged
from ship_gym.tasks.base import Task
from ship_gym.tasks.columns import ACTIONS
from ship_gym.writing import atomic_path

INDEX, SCENARIOS = "README.md", "scenarios.md"
_NOTE = "<!-- Written by scripts/build_docs.py from the code: change that, then run it. -->\n\n"


def env_ids() -> list[str]:
    """Ids of the package's own tasks, each of which has a page."""
    return [env_id for env_id, task in ENVIRONMENTS.items() if task in TASKS.own()]


def task_of(env_id: str) -> Task:
    """The task of an id."""
    return TASKS[ENVIRONMENTS[env_id]]


def name_of(env_id: str) -> str:
    """Name of an id's files, without suffix: ``heading_keeping_v0``."""
    return f"{ENVIRONMENTS[env_id]}_{env_id.rpartition('-')[2]}"


def pages() -> dict[str, str]:
    """Text of every page by file name, without the pictures they show."""
    texts = {f"{name_of(env_id)}.md": page(env_id) for env_id in env_ids()}
    texts |= {SCENARIOS: scenario_page.page(), INDEX: index()}
    return {name: _NOTE + text for name, text in texts.items()}


def write_pages(folder: str | os.PathLike) -> list[Path]:
    """Write every page, each whole or not at all; returns their paths."""
    paths = []
    for name, text in pages().items():
        with atomic_path(Path(folder) / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
        paths.append(Path(folder) / name)
    return paths


def outdated(folder: str | os.PathLike) -> list[str]:
    """Names of the files in a folder that are not as they should be, sorted.

    Pages whose text differs, files that are missing (a picture counts by being there) and pages
    that belong to no environment.
    """
    folder, texts = Path(folder), pages()
    there = {path.name for path in folder.glob("*.md")}
    wrong = there ^ set(texts)
    wrong |= {n for n in there & set(texts) if (folder / n).read_text("utf-8") != texts[n]}
    pictures = {f"{name_of(env_id)}.png" for env_id in env_ids()}
    return sorted(wrong | {name for name in pictures if not (folder / name).is_file()})


def index() -> str:
    """Page that leads to the others."""
    rows = []
    for env_id in env_ids():
        env = gym.make(env_id).unwrapped
        link = f"[`{env_id}`]({name_of(env_id)}.md)"
        size = str(env.observation_space.shape[0])
        rows.append([link, _headline(env), size, _span(env.scenario.duration), _failure(env)])
    parts = [
        "# Environments",
        table(("Id", "Task", "Observation", "At most", "Fails at"), rows),
        "Action: the rudder, or rudder and propeller speed. Every default of an id is a key of its "
        f"scenario: [scenarios and their keys]({SCENARIOS}). Times are those of the full-scale "
        "ship; a model gets them Froude-scaled.",
        *(f"[![{env_id}]({name_of(env_id)}.png)]({name_of(env_id)}.md)" for env_id in env_ids()),
    ]
    return "\n\n".join(parts) + "\n"


def page(env_id: str) -> str:
    """Page of one id."""
    env = gym.make(env_id).unwrapped
    _, info = env.reset(seed=0)
    task = task_of(env_id)
    moment = task.moment
    after = _span(moment.intervals * env.scenario.control_interval)
    sections = inspect.getdoc(type(env)).partition("\n\n")[2]
    parts = [
        f"# {env_id}",
        _headline(env),
        f"![{env_id} under way]({name_of(env_id)}.png)",
        f"*`env.render()`, episode of seed {moment.seed} after {after}, controller "
        f"`{moment.controller}`.*",
        table(("What", "Here"), [[key, text] for key, text in _summary(env_id, env).items()]),
        sections.strip(),
        "## Info",
        "What `step` and `reset` return as `info`:",
        _info_keys(info),
        "In words, for the n ships of a vector environment; for one ship, n rows are a plain row:",
        "\n".join(f"- {text}" for text in (*returned(EpisodeBatch.info), *_own_info(task))),
        f"Outcomes: {', '.join(f'{k} {end.name}' for k, end in enumerate(task.all_outcomes))}.",
        "## Privileged Observation",
        "What no bridge knows. With `privileged=True` it follows the observation above.",
        observation_table(privileged.OBSERVATIONS, env.observation_space.shape[0]),
        "## Metrics",
        f"A benchmark scores `{task.headline}`. Every episode has these, computed from its "
        "recording; angles are in degrees, times at full scale.",
        _metrics(task),
        "## Headroom",
        headroom_table([env.scenario_name]),
        f"[What these are, and those of other scenarios]({SCENARIOS}#headroom).",
        "## Scenario",
        f"Keys that `{env.scenario_name}` and its bases state; `overrides` replaces any of them. "
        f"[All keys]({SCENARIOS}#every-key), [other scenarios]({SCENARIOS}).",
        _stated(env),
    ]
    return "\n\n".join(parts) + "\n"


def _headline(env: ShipEnv) -> str:
    return inspect.getdoc(type(env)).partition("\n")[0]


def _summary(env_id: str, env: ShipEnv) -> dict[str, str]:
    """What the live environment is, by name."""
    scenario, ship = env.scenario, env.ship
    actions = [f"`{_made(env_id, control=c).action_space}` for `control={c!r}`" for c in ACTIONS]
    more = _made(env_id, privileged=True).observation_space.shape[0]
    space = env.observation_space
    modes = " or ".join(f"`{mode!r}`" for mode in env.metadata["render_modes"])
    size = f"L {ship.hull.L:.4g} m, U0 {ship.speed / KNOT:.3g} kn"
    return {
        "Import": "`import gymnasium as gym, ship_gym`",
        "Make one": f'`gym.make("{env_id}")`, a `ship_gym.{type(env).__name__}`',
        "Make many": f'`gym.make_vec("{env_id}", num_envs=64)`, a `ship_gym.ShipVectorEnv`',
        "Action space": ", ".join(actions),
        "Observation space": f"`Box` of shape `{space.shape}`, `{space.dtype}`; `({more},)` with "
        "`privileged=True`",
        "Scenario": f"`{env.scenario_name}`",
        "Ship": f"`{scenario.ship}`: {ship.title}, {size}; any other by `ship=`",
        "Control": f"`{scenario.control}`",
        "Control interval": _span(scenario.control_interval),
        "Truncated": f"after {_span(scenario.duration)}, {scenario.steps} steps",
        "Terminated": _limits(env),
        "Render modes": modes,
    }


def _made(env_id: str, **arguments: Any) -> ShipEnv:
    return gym.make(env_id, **arguments).unwrapped


def _span(seconds: float) -> str:
    return f"{seconds:g} s"


def _failure(env: ShipEnv) -> str:
    return TASKS[env.scenario.task].fails(env.scenario)


def _limits(env: ShipEnv) -> str:
    """What terminates an episode: its aim reached, where it has one, and failure."""
    return "; ".join(TASKS[env.scenario.task].ends(env.scenario))


def _own_info(task: Task) -> list[str]:
    return [task.info_text] if task.info_text else []


def _info_keys(info: Mapping[str, Any]) -> str:
    """Table of the keys in an info and of what is under them."""
    rows = []
    for key, value in info.items():
        nested = isinstance(value, Mapping)
        holds = ", ".join(f"`{k}`" for k in value) if nested else type(value).__name__
        rows.append([f"`{key}`", holds])
    return table(("Key", "Holds"), rows)


def _metrics(task: Task) -> str:
    """Table of the metrics of a task."""
    rows = [[f"`{k}`", m.unit, m.better, m.meaning] for k, m in metrics_of(task.name).items()]
    return table(("Metric", "Unit", "Better", "Meaning"), rows)


def _stated(env: ShipEnv) -> str:
    """Table of the keys that the scenario of an id states."""
    keys, rows = scenario_page.all_keys(), []
    for name in scenario_page.stated_keys(env.scenario_name):
        value = scenario_page.shown(scenario_page.value_of(env.scenario, name))
        rows.append([f"`{name}`", value, keys[name].unit, keys[name].meaning])
    return table(("Key", "Default", "Unit", "Meaning"), rows)
