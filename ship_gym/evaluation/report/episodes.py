"""Best, median and worst episodes: which they are, the commands that record them, pictures."""

from __future__ import annotations

import dataclasses
import shlex
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ship_gym.evaluation import choice
from ship_gym.evaluation.report import words
from ship_gym.evaluation.report.benchmark import Benchmark
from ship_gym.evaluation.report.events import NOTHING, Event, Run, slug
from ship_gym.plotting.benchmark_episode import plot_episode
from ship_gym.plotting.figure import for_page
from ship_gym.recording.trajectory import Trajectory
from ship_gym.reports.page import Block, Cell, Command, Grid, Picture, Row

WHICH = choice.EXTREMES


@dataclasses.dataclass(frozen=True)
class Episode:
    """One episode of the results.

    Attributes
    ----------
    scenario, ship : str
    controller : str
        As ``make_controller`` takes it: a name or a file.
    seed : int
    control : str or None
        Instead of the scenario's.
    task : str or None
        File of the scenario's task, if it is one's own.
    """

    scenario: str
    ship: str
    controller: str
    seed: int
    control: str | None = None
    task: str | None = None

    @property
    def command(self) -> str:
        """The command that records it."""
        parts = ["ship-gym", "record", "--controller", self.controller]
        parts += ["--scenario", self.scenario, "--ship", self.ship]
        parts += ["--control", self.control] if self.control else []
        parts += ["--task", self.task] if self.task else []
        return shlex.join([*parts, "--seed", str(self.seed)])


# What sails an episode again; None for one that it cannot sail, such as a policy that is gone.
Sail = Callable[[Episode], Trajectory | None]


def extremes(event: Event, run: Run) -> dict[str, int]:
    """Seeds of the best, the median and the worst episode of a run, as ``choice.ranked`` has them.

    Those that the controller broke off with an error cannot be sailed again: they are none of them.
    """
    there = np.flatnonzero(~run.broken)
    values, failed = run.values[there].tolist(), run.columns["failed"][there].tolist()
    found = choice.extremes(run.seeds[there].tolist(), values, event.metric.better, failed)
    return {which: one["seed"] for which, one in found.items()}


def worst_of(event: Event) -> tuple[str, int] | None:
    """Controller and seed of the worst episode of an event, not of the one that does nothing."""
    found = [
        (name, seeds["worst"])
        for name, run in event.runs.items()
        if name != NOTHING and (seeds := extremes(event, run))
    ]
    at = [event.runs[name].at(np.array([seed]), key)[0]
          for key in ("value", "failed") for name, seed in found]  # fmt: skip
    order = choice.ranked(at[: len(found)], event.metric.better, at[len(found) :])
    return found[order[-1]] if order else None


def episode(found: Benchmark, event: Event, controller: str, seed: int) -> Episode:
    """An episode of an event, with the names that what sails it again needs."""
    named = found.about.get("controllers", {}).get(controller, {}).get("named", controller)
    suite = found.about.get("suites", {}).get(event.suite, {})
    control = suite.get("controls", {}).get(event.scenario)
    task = suite.get("tasks", {}).get(event.task)
    return Episode(event.scenario, event.ship, named, seed, control, task)


def recording(found: Benchmark, event: Event, controller: str) -> str | None:
    """File of the worst episode, from the folder of the run, where the benchmark recorded it."""
    files = found.about.get("recordings", {}).get("files", {})
    for key in (event.suite, event.scenario, event.ship):
        files = files.get(key, {})
    return files.get(controller)


def blocks(found: Benchmark, event: Event) -> list[Block]:
    """Table of the episodes of an event, and the commands."""
    rows, commands = [], []
    for name, run in event.runs.items():
        seeds = extremes(event, run)
        if not seeds:
            continue
        value = dict(zip(run.seeds.tolist(), run.values.tolist(), strict=True))
        cells = {w: f"{seed}: {words.number(value[seed])}" for w, seed in seeds.items()}
        row: dict[str, str | Cell] = {**cells}
        if file := recording(found, event, name):
            row["worst"] = Cell(cells["worst"], file=file)
        rows.append([name, *row.values()])
        for which, seed in seeds.items():
            commands.append(f"{episode(found, event, name, seed).command}  # {which}")
    caption = f"seed: {event.measure} [{event.metric.unit}]"
    if any(isinstance(row[-1], Cell) for row in rows):
        caption += "; the worst as a recording: ship-gym review show FILE"
    return [Grid(caption, ["controller", *WHICH], rows), Command("\n".join(commands))]


def shown(found: Benchmark, count: int) -> list[tuple[Event, str, str, int]]:
    """The episodes to draw as (event, controller, which, seed), at most `count`.

    First best, median and worst of one controller in the first event of every task, then the worst
    of every event, by turns over the ships. The controller is the policy where one sailed, else the
    best classical one.
    """
    first: list[tuple[Event, str, str, int]] = []
    rest: list[tuple[Event, str, str, int]] = []
    tasks: set[str] = set()
    for event in _by_turns(found.events):
        name = _subject(found, event)
        if name is None:
            continue
        seeds = extremes(event, event.runs[name])
        chosen = [(event, name, which, seed) for which, seed in seeds.items()]
        new = event.task not in tasks
        tasks.add(event.task)
        (first if new else rest).extend(chosen if new else chosen[-1:])
    return [*first, *rest][:count]


def _by_turns(among: Sequence[Event]) -> list[Event]:
    """One ship of every scenario first, then the next ship, so that few pictures show many."""
    met: dict[tuple[str, str], int] = {}
    turns = []
    for event in among:
        key = event.suite, event.scenario
        turns.append(met.get(key, 0))
        met[key] = turns[-1] + 1
    order = sorted(range(len(among)), key=lambda i: (turns[i], i))
    return [among[i] for i in order]


def _subject(found: Benchmark, event: Event) -> str | None:
    """The first controller that is not classical and has episodes, else the best classical one."""
    for name in event.runs:
        if found.controllers[name] != "classical" and extremes(event, event.runs[name]):
            return name
    return event.best_classical


def pictures(found: Benchmark, sail: Sail, count: int, progress=iter) -> dict[Event, Row]:
    """Pictures of episodes by event, sailed again, at most `count`.

    The best classical controller on the same seed is drawn beside.
    """
    made: dict[Event, list[Picture]] = {}
    for event, name, which, seed in progress(shown(found, count)):
        beside = [name, event.best_classical] if event.best_classical else [name]
        sailed = {}
        for each in dict.fromkeys(beside):
            trajectory = sail(episode(found, event, each, seed))
            if trajectory is not None:
                sailed[each] = trajectory
        if name in sailed:
            made.setdefault(event, []).append(_picture(found, event, name, which, seed, sailed))
    return {event: Row(drawn) for event, drawn in made.items()}


def _picture(
    found: Benchmark,
    event: Event,
    name: str,
    which: str,
    seed: int,
    sailed: Mapping[str, Trajectory],
) -> Picture:
    run = event.runs[name]
    value = words.number(float(run.at(np.array([seed]))[0]))
    caption = f"The {which} episode of {name}, {event.cell}, seed {seed}: {event.measure} {value}"
    caption += f" {event.metric.unit}."
    if len(sailed) > 1:
        caption += " The best classical controller on the same seed beside."
    title = f"{event.cell}, seed {seed}"
    return for_page(
        caption,
        lambda path: plot_episode(sailed, found.look, path, title),
        slug(f"{which}_{name}_{event.anchor}"),
    )
