"""What a task is: everything that the environments, recordings, metrics and pages ask of it.

A task is one folder (or one file of a user) that makes a `Task` and registers it with
``ship_gym.register_task``. Nothing outside may know what a particular task does.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from ship_gym.config import ConfigError, check_fields

if TYPE_CHECKING:
    from ship_gym.recording.trajectory import Trajectory
    from ship_gym.ships.particulars import Ship


class Row(NamedTuple):
    """One entry of an observation: its name, the symbol and unit for people, bounds, meaning.

    `mirror` is what becomes of it when port and starboard change places: +1 it stays, -1 it
    changes its sign, None nobody has said; then no learner can use that symmetry.
    """

    name: str
    symbol: str
    unit: str
    low: float
    high: float
    meaning: str
    mirror: int | None = None


class Term(NamedTuple):
    """One term of the reward.

    Attributes
    ----------
    name : str
        In ``info["reward_terms"]``, and of its weight in the section ``reward``.
    form : str
        What the weight multiplies, with its sign left out, such as ``psi_e^2 [rad^2]``.
    meaning : str
        Of the weight, with its unit.
    default : float or None
        Of the weight; None: a scenario must state it.
    """

    name: str
    form: str
    meaning: str
    default: float | None = 0.0


class Outcome(NamedTuple):
    """Why an episode ended.

    Attributes
    ----------
    name : str
    failed : bool
        A limit was exceeded: `termination` is paid, what was not sailed counts as lost.
    reached : bool
        The aim of a task that has one: only this is a success.
    """

    name: str
    failed: bool = False
    reached: bool = False


class Metric(NamedTuple):
    """Unit, meaning and whether ``"lower"`` or ``"higher"`` is better."""

    unit: str
    meaning: str
    better: str


class Plot(NamedTuple):
    """A plot of the task's own in a recording: a name, a title with the unit, columns over time."""

    name: str
    title: str
    columns: tuple[str, ...]


class ErrorColumn(NamedTuple):
    """The column of a recording that the task judges, its name for people and its unit in SI."""

    column: str
    label: str
    unit: str


class Moment(NamedTuple):
    """What the picture of a page shows: who steers, which episode, after how many intervals."""

    controller: str
    seed: int
    intervals: int


def check_names(what: str, fields: tuple[str, ...], rows: Sequence[Row | Term]) -> None:
    """Refuse, at import, a named tuple of a kernel whose fields are not the rows of its table."""
    names = tuple(row.name for row in rows)
    if fields != names:
        raise ImportError(f"{what} are {', '.join(names)}; the kernel gives {', '.join(fields)}")


# Outcomes that every task has, with these indices.
RUNNING, DIVERGED = 0, 1
COMMON_OUTCOMES = (Outcome("running"), Outcome("diverged", failed=True))


@dataclasses.dataclass(frozen=True)
class Start:
    """Distribution of the start.

    Attributes
    ----------
    heading_error_deg : float
        Uniform within plus and minus this, of the ordered heading or the first leg.
    """

    heading_error_deg: float

    def __post_init__(self):
        check_fields("start", self, {"heading_error_deg": (0.0, 180.0, "deg")})


@dataclasses.dataclass(frozen=True)
class NoLimits:
    """What ends an episode as failed: nothing."""


class Plan(Protocol):
    """Makes the plans of episodes: orders, way-points.

    Attributes
    ----------
    shape : tuple of int
        Of one plan, (rows, columns).
    n_draws : int
        Uniform numbers for one.

    A plan may have ``meta``, a dict: further entries of the meta of every recording.
    """

    shape: tuple[int, int]
    n_draws: int

    def make(self, which, uniform, order, plans, tasks) -> tuple[np.ndarray, np.ndarray]:
        """Write plans of some episodes.

        Parameters
        ----------
        which : numpy.ndarray
            Indices, shape (m,).
        uniform : numpy.ndarray
            Numbers in [0, 1), shape (m, n_draws).
        order : numpy.ndarray
            First ordered heading or bearing [rad], shape (m,).
        plans : numpy.ndarray
            Written, shape ``(n, *shape)``.
        tasks : numpy.ndarray
            Records of the episodes, shape (n,); fields of the task's own may be written.

        Returns
        -------
        north, east : numpy.ndarray
            Where the ships start [m], shape (m,).
        """


class OneOrder:
    """A plan of one ordered heading, which is any: what a task has that needs no other."""

    shape, n_draws = (1, 1), 0

    def __init__(self, scenario: Any = None, ships: Sequence[Ship] = ()):
        del scenario, ships  # the same for all of them

    def make(self, which, uniform, order, plans, tasks):
        """See `Plan`."""
        plans[which, 0, 0] = order
        tasks["psi_ordered"][which] = order
        return np.zeros(len(which)), np.zeros(len(which))


def _nothing(*_: Any) -> dict[str, Any]:
    return {}


def _no_end(*_: Any) -> str:
    return ""


@dataclasses.dataclass(frozen=True, eq=False, kw_only=True)
class Task:
    """One task.

    Kernels are functions of one ship (``ship_gym.tasks.bridge`` has what they share;
    ``tasks/heading/kernels.py`` is the shortest example): they read and write rows and records of
    it, and whatever else a kernel calls is a kernel. The loop over ships is ``envs.interval``.

    Attributes
    ----------
    name : str
        As in the key ``task`` of a scenario; also the name of its default scenario, and, in camel
        case, of its environment id and class.
    version : int
        Of the environment id.
    title : str
        One line.
    sections : mapping
        Sections of the scenario that are the task's own, name to frozen dataclass; ``start`` and
        ``limits`` may be among them, else there is `Start` and `NoLimits`. Keys in its ``PATHS``
        are paths, which count from the folder of a scenario file.
    terms : tuple of Term
        Terms of the reward that are the task's own, before those of the costs.
    observations : tuple of Row
        Rows of the observation that are the task's own, behind those of the bridge.
    outcomes : tuple of Outcome
        Its own, with indices from 2 on, behind `COMMON_OUTCOMES`.
    fields : tuple
        What the record of an episode has beside the common fields, as (name, type) of a dtype.
    plan : callable
        ``plan(scenario, ships)``, a `Plan`.
    fill : callable
        ``fill(scenario, tasks)`` writes the task's own fields once; speed and length of the ship
        are in the records.
    begin : callable or None
        Kernel ``begin(task, plan)`` that begins an episode whose plan is written.
    observe : callable
        Kernel ``observe(state, waves, command, ship, sea, task, interval, row)`` that writes the
        rows of the bridge and its own, see ``bridge.observe_bridge``.
    judge : callable
        Kernel ``judge(state, before, sea, task, plan, terms, result)`` of the interval just sailed:
        states at its end and at its start; it ends with ``bridge.settle``, which writes `terms` and
        `result`. It may write to the record `task`, such as the next order.
    error : callable or None
        Kernel ``error(state, task)``: the error at the start of an episode, in the unit of that of
        `judge`.
    sees_position : bool
        Whether the observation needs the position, so that its noise is drawn.
    check : callable
        ``check(scenario)`` raises ConfigError for values that do not go together.
    info : callable
        ``info(episodes)``, a dict of arrays (n,): entries of the environments' info beside the
        common ones, as views that stay.
    info_text : str
        Clauses that explain them for the page, such as "`leg`, the active one".
    history : tuple of str
        Fields of the record that a recording needs at every interval.
    columns : callable
        ``columns(recorded, history, plan)``: further columns of a recording from those of the
        ship, the `history` by name, each (T,), and the plan of the episode.
    meta : callable
        ``meta(plan)``: further entries of the meta of a recording.
    plots : tuple of Plot
        Of its columns, in a recording.
    error_column : ErrorColumn or None
        Of its columns, the error that it judges.
    limits : callable
        ``limits(scenario, ship)``, a dict: what a picture draws beside that error and others, by
        name, in SI or, of a name that ends in ``_deg``, in degrees.
    metrics : mapping
        Name to `Metric` of the task's own, in the order of a table.
    measure : callable or None
        ``measure(trajectory)``, their values by name, nan where an episode has none; None: the task
        has no metrics.
    headline : str
        The metric that a benchmark scores and training reports; an episode may have none.
    controllers : tuple of str
        Default opponents, the reference first.
    scene : callable
        ``scene(episodes, i)``: what a picture shows of episode i, arguments of
        ``rendering.scene.Scene``.
    succeeds, fails : callable
        ``fails(scenario)``: in words, what ends an episode as reached and as failed, or "".
    page : str
        Markdown with sections "## Description", "## Observation Space" (what stands before the
        table), "## Rewards", "## Starting State", "## Episode End", "## Version History".
    example : mapping
        Overrides that the page shows.
    moment : Moment or None
        The picture of the page; None: it has none.
    scenario : mapping or None
        Default scenario of a task from outside the package, as a TOML file would hold it; None:
        the file of its name in ``ship_gym/scenarios``.
    """

    name: str
    title: str
    terms: tuple[Term, ...]
    observe: Callable
    judge: Callable
    version: int = 0
    sections: Mapping[str, type] = dataclasses.field(default_factory=dict)
    observations: tuple[Row, ...] = ()
    outcomes: tuple[Outcome, ...] = ()
    fields: tuple[tuple[str, Any], ...] = ()
    plan: Callable[..., Plan] = OneOrder
    fill: Callable[[Any, np.ndarray], Any] = _nothing
    begin: Callable | None = None
    error: Callable | None = None
    sees_position: bool = False
    check: Callable[[Any], Any] = _nothing
    info: Callable[[Any], dict[str, np.ndarray]] = _nothing
    info_text: str = ""
    history: tuple[str, ...] = ()
    columns: Callable[[Mapping, Mapping, np.ndarray], dict[str, np.ndarray]] = _nothing
    meta: Callable[[np.ndarray], dict[str, Any]] = _nothing
    plots: tuple[Plot, ...] = ()
    error_column: ErrorColumn | None = None
    limits: Callable[[Any, Any], dict[str, float]] = _nothing
    metrics: Mapping[str, Metric] = dataclasses.field(default_factory=dict)
    measure: Callable[[Trajectory], dict[str, float]] | None = None
    headline: str = "return"
    controllers: tuple[str, ...] = ("constant",)
    scene: Callable[[Any, int], dict[str, Any]] = _nothing
    succeeds: Callable[[Any], str] = _no_end
    fails: Callable[[Any], str] = _no_end
    page: str = ""
    example: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    moment: Moment | None = None
    scenario: Mapping[str, Any] | None = None

    def __post_init__(self):
        if not (self.name.isidentifier() and self.name == self.name.lower()):
            raise ConfigError(
                f"task name {self.name!r}: allowed are small letters, digits and underscores"
            )
        for kind, items in (("terms", self.terms), ("observations", self.observations)):
            names = [item.name for item in items]
            if len(set(names)) < len(names):
                raise ConfigError(f"task {self.name!r}: {kind} {names}: each needs its own name")
        if not self.terms:
            raise ConfigError(f"task {self.name!r}: terms: at least one is needed")
        if set(self.metrics) and self.measure is None:
            raise ConfigError(f"task {self.name!r}: metrics without `measure`, which gives them")

    def __reduce__(self):
        """Pickle by name: what a task is stands in its module, which the reader has too."""
        from ship_gym.tasks import TASKS

        return TASKS.__getitem__, (self.name,)

    def ends(self, scenario: Any) -> list[str]:
        """What terminates an episode, in words: its aim where it has one, and failure."""
        return [text for text in (self.succeeds(scenario), self.fails(scenario)) if text]

    @property
    def class_name(self) -> str:
        """Name of the environment class, ``HeadingKeeping`` of ``heading_keeping``."""
        return class_name(self.name)

    @property
    def env_id(self) -> str:
        """Environment id, ``ShipGym/HeadingKeeping-v0``."""
        return env_id(self.name, self.version)

    @property
    def all_outcomes(self) -> tuple[Outcome, ...]:
        """The common outcomes and its own: what an index of an outcome means."""
        return (*COMMON_OUTCOMES, *self.outcomes)


def class_name(name: str) -> str:
    """Name of the environment class of a task, by the task's name."""
    return "".join(part.capitalize() for part in name.split("_"))


def env_id(name: str, version: int) -> str:
    """Environment id of a task, by its name and version."""
    return f"ShipGym/{class_name(name)}-v{version}"
