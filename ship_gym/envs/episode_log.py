"""Rows of some episodes of a batch while it sails, as the arrays of the batch hold them.

Row k is the instant at which action k is taken: time, state, waves and observation then, the action
and what it was made of, forces and flow at the start of the interval, its reward. The last row is
the final state: it repeats the last command and action, its forces are those that the next interval
would find, it has no reward.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ship_gym.envs.episodes import EpisodeBatch

_ROWS = 1024  # of a log that does not know yet how long its episodes become


class EpisodeLog:
    """Histories of chosen episodes, each in a place of its own.

    `before` and `after` stand around every interval of the batch (``EpisodeBatch.watch``).

    Parameters
    ----------
    batch : EpisodeBatch
    places : int
        How many episodes there is room for; it grows.
    rows : int, optional
        Intervals that there is room for; grows from some up to those of the scenario.

    Attributes
    ----------
    histories : dict
        By name, shape (rows, places, ...): ``time`` [s], ``states``, ``waves``, ``observations``
        (float32), what the task keeps (its ``history``), ``commands``, ``actions`` (as they were
        given, before any limit), ``forces``, ``flow``, ``terms``, ``rewards``.
    lengths : numpy.ndarray
        Intervals that each place holds so far, shape (places,).
    """

    def __init__(self, batch: EpisodeBatch, places: int, rows: int | None = None):
        sim = batch.sim
        self.batch = batch
        self._start: dict[str, np.ndarray] = {
            "time": sim.time,
            "states": sim.state,
            "waves": sim.waves,
            "observations": batch.observations,
            **{name: batch.tasks[name] for name in batch.task.history},
        }
        self._during: dict[str, np.ndarray] = {
            "commands": sim.commands,
            "forces": sim.forces,
            "flow": sim.flow,
            "actions": batch.actions,
        }
        self._earned: dict[str, np.ndarray] = {"terms": batch.terms, "rewards": batch.rewards}
        self.histories: dict[str, np.ndarray] = {}
        self.lengths = np.zeros(0, dtype=np.int64)
        self._ships = np.zeros(0, dtype=np.int64)  # of each place, -1: free
        self._active = np.zeros(0, dtype=np.int64)  # places that sail
        self._make_room(min(rows or _ROWS, batch.scenario.steps), places)

    def _make_room(self, rows: int, places: int) -> None:
        """Arrays for so many intervals and places, with what is there already."""
        for name, now in (*self._start.items(), *self._during.items(), *self._earned.items()):
            kind = np.float32 if now.dtype == np.float32 else np.float64
            made = np.zeros((rows + 1, places, *now.shape[1:]), kind)
            if name in self.histories:
                old = self.histories[name]
                made[: old.shape[0], : old.shape[1]] = old
            self.histories[name] = made
        more = places - len(self._ships)
        self._ships = np.append(self._ships, np.full(more, -1))
        self.lengths = np.append(self.lengths, np.zeros(more, dtype=np.int64))
        self._rows = rows
        self._pair()

    def _pair(self) -> None:
        """Histories beside the arrays of the batch that they follow."""
        kept = self.histories
        self._starts = [(kept[name], now) for name, now in self._start.items()]
        self._ends = [(kept[name], now) for name, now in (self._during | self._earned).items()]

    def begin(self, ships: np.ndarray) -> np.ndarray:
        """Follow some episodes from now on, each from its first row; returns their places."""
        free = np.flatnonzero(self._ships < 0)
        if len(free) < len(ships):
            self._make_room(self._rows, max(2 * len(self._ships), len(self._ships) + len(ships)))
            free = np.flatnonzero(self._ships < 0)
        places = free[: len(ships)]
        self._ships[places], self.lengths[places] = ships, 0
        self._follow(np.append(self._active, places))
        return places

    def _follow(self, places: np.ndarray) -> None:
        """The places that sail from now on, and for how many intervals there is room for all."""
        self._active = places
        one = len(places) == 1
        self._one = (places.item(), self._ships[places].item()) if one else None
        self._left = self._rows - int(self.lengths[places].max(initial=0))

    def before(self) -> None:
        """Keep what an interval starts from."""
        if len(self._active):
            if self._left == 0:
                rows = max(min(2 * self._rows, self.batch.scenario.steps), self._rows + 1)
                self._make_room(rows, len(self._ships))
                self._follow(self._active)
            at, of = self._at = self._where()
            for kept, now in self._starts:
                kept[at] = now[of]

    def after(self) -> None:
        """Keep what the interval was sailed with and what it has earned."""
        if len(self._active):
            at, of = self._at
            for kept, now in self._ends:
                kept[at] = now[of]
            self.lengths[self._active if self._one is None else self._one[0]] += 1
            self._left -= 1

    def _where(self) -> tuple[Any, Any]:
        """Index of the present rows in the histories, and in the arrays of the batch.

        Plain numbers and slices where they do: numpy takes a tenth of the time.
        """
        if self._one is not None:
            place, ship = self._one
            return (self.lengths.item(place), place), ship
        places = self._active
        rows, ships = self.lengths[places], self._ships[places]
        if len(places) == len(self._ships) == self.batch.n and (rows == rows[0]).all():
            if (places == ships).all() and (places[1:] > places[:-1]).all():
                return rows.item(0), slice(None)
        return (rows, places), ships

    def end(self, places: np.ndarray) -> None:
        """Write the last row of some episodes, from the batch as it is now, and follow no more."""
        ships, rows = self._ships[places], self.lengths[places]
        for kept, now in self._starts:
            kept[rows, places] = now[ships]
        for name in ("commands", "actions"):
            self.histories[name][rows, places] = self.histories[name][rows - 1, places]
        loads = self.batch.sim.loads_now(ships)
        for name, found in zip(("forces", "flow"), loads, strict=True):
            finite = np.where(np.isfinite(found), found, 0.0)  # also where a ship has diverged
            self.histories[name][rows, places] = finite
        for name in self._earned:
            self.histories[name][rows, places] = 0.0
        self._follow(np.setdiff1d(self._active, places))

    def drop(self, places: np.ndarray) -> None:
        """Forget some episodes; their places are free."""
        self._ships[places] = -1
        self._follow(np.setdiff1d(self._active, places))

    def part(self, place: int, first: int, stop: int) -> dict[str, np.ndarray]:
        """Rows from `first` up to `stop` of a place, by name."""
        return {name: kept[first:stop, place] for name, kept in self.histories.items()}

    def whole(self) -> dict[str, np.ndarray]:
        """The histories, those of what is earned without the last row, where nothing is."""
        return {
            name: kept[:-1] if name in self._earned else kept
            for name, kept in self.histories.items()
        }
