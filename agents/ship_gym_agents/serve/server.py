"""The loop over time: say what the instruments show, hear orders, sail an interval."""

from __future__ import annotations

import datetime
import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ship_gym.charts import Chart
from ship_gym_agents.serve.counts import Counts
from ship_gym_agents.serve.instruments import Seen, plain
from ship_gym_agents.serve.nmea import Dropped, made, read
from ship_gym_agents.serve.orders import Order, order_of
from ship_gym_agents.serve.ports import Line, Ports
from ship_gym_agents.serve.talk import RATES, TALKERS, Fix, sentences_of
from ship_gym_agents.serve.vessel import SteeredShip
from ship_gym_agents.serve.voyage import Voyage

EPOCH = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)  # of a voyage in lockstep
_MOST_ORDERS = 1000  # that wait in lockstep
_BEHIND = 1.0  # [s] that the clock may run ahead of the ship; what is more is not made up for
_LISTEN = 3600.0  # [s] of one wait
_PLACED, _ON_ROUTE = {"RMC", "GGA"}, {"XTE", "APB"}  # sentences with a place, and with a leg


class Server:
    """Sails a ship for clients.

    Parameters
    ----------
    vessel : SteeredShip
    ports : Ports
    chart : Chart
        Of the plane she sails in.
    voyage : Voyage, optional
        Her route; without it there is no XTE and APB.
    speed_up : float
        Seconds of the ship in a second.
    lockstep : bool
        Time stands still until an order comes: one order, one interval.
    patience : float
        Seconds that lockstep waits for one before it ends; None: for ever.
    rates : mapping
        Kind to sentences in a second of the ship, 0: none; those of `talk.RATES` for the rest.
    talkers : mapping
        Kind to two letters, likewise.
    start : datetime, optional
        UTC at the start; default: now, in lockstep `EPOCH`.
    apb : bool
        Whether the heading to steer of APB is an order.
    simulated : bool
        Whether positions are marked as a simulator's.

    Attributes
    ----------
    counts : Counts
    sailed : int
        Intervals.
    """

    def __init__(
        self,
        vessel: SteeredShip,
        ports: Ports,
        chart: Chart,
        voyage: Voyage | None = None,
        *,
        speed_up: float = 1.0,
        lockstep: bool = False,
        patience: float | None = None,
        rates: Mapping[str, float] | None = None,
        talkers: Mapping[str, str] | None = None,
        start: datetime.datetime | None = None,
        apb: bool = False,
        simulated: bool = False,
    ):
        self._vessel, self._ports, self._chart, self._voyage = vessel, ports, chart, voyage
        self._lockstep, self._speed_up = lockstep, speed_up
        self._patience = math.inf if patience is None else patience
        self._talkers = TALKERS | dict(talkers or {})
        self._every = periods(RATES | dict(rates or {}), vessel.interval)
        now = EPOCH if lockstep else datetime.datetime.now(datetime.UTC)
        self._start, self._simulated, self._apb = start or now, simulated, apb
        self._orders: deque[Order] = deque()
        self._last: list[str] = []  # sentences of this instant
        self._stopped = False
        self.counts, self.sailed, self.why = Counts(), 0, "end of time"
        self._began = self._ended = 0.0
        chart.place(0.0, 0.0)  # loads what it needs now, and not while a clock runs

    def stop(self) -> None:
        """End after this interval; may be called by a handler of a signal."""
        self._stopped = True
        self._ports.wake()

    def run(self, progress: Callable[[Iterable], Iterable] = iter) -> None:
        """Sail to the end of the voyage, to `stop`, or until lockstep loses its patience."""
        try:
            self._run(progress)
        finally:
            self._ended = time.monotonic()

    def _run(self, progress: Callable[[Iterable], Iterable]) -> None:
        self._began = begun = time.monotonic()
        per_interval = self._vessel.interval / self._speed_up
        for k in progress(range(self._vessel.steps)):
            self._say()
            if self._lockstep:
                heard = self._wait_for_order()
            else:
                begun = self._listen_until(begun, k, per_interval)
                heard = True
            if self._stopped or not heard:
                self.why = "stopped" if self._stopped else "no order came"
                return
            while self._orders:
                self._vessel.obey(self._orders.popleft())
                if self._lockstep:
                    break
            self._vessel.sail()
            self.sailed += 1
        self._say()

    def _wait_for_order(self) -> bool:
        """Hear until there is an order; False: none came in time, or the voyage is stopped."""
        end = time.monotonic() + self._patience
        while not self._orders and not self._stopped:
            left = end - time.monotonic()
            if left <= 0.0:
                return False
            self._hear(min(left, _LISTEN))
        return bool(self._orders)

    def _listen_until(self, begun: float, k: int, per_interval: float) -> float:
        """Hear until interval k + 1 is due; returns when the voyage began, later if she lags."""
        due = begun + (k + 1) * per_interval
        late = time.monotonic() - due
        if late > 0.0:
            self.counts.late += 1
            self._hear(0.0)
            return begun + max(late - _BEHIND, 0.0)
        while not self._stopped and (left := due - time.monotonic()) > 0.0:
            self._hear(left)
        return begun

    def _hear(self, timeout: float) -> None:
        for line in self._ports.receive(timeout):
            self._take(line)
        for peer in self._ports.newcomers():
            self.counts.clients[peer.kind] += 1
            if self._lockstep:  # else he would wait for the instruments, and the ship for him
                self._ports.send(self._last, peer)

    def _take(self, line: Line) -> None:
        """Count a line; its order, if it is one, waits for the next interval."""
        try:
            sentence = read(line.data.strip())
            order = order_of(sentence, self._apb)
            if order is not None and len(self._orders) >= _MOST_ORDERS:
                raise Dropped("too many", f"{_MOST_ORDERS} orders wait already")
        except Dropped as why:
            return self.counts.drop(line.data, why)
        self._ports.welcome(line.peer)
        kind = sentence if isinstance(sentence, str) else kind_of(sentence)
        if order is None:
            self.counts.ignored[kind] += 1
        else:
            self.counts.orders[kind] += 1
            self._orders.append(order)
        return None

    def _say(self) -> None:
        """Send what is due of the instruments."""
        due = [kind for kind, every in self._every.items() if self.sailed % every == 0]
        now = self._vessel.seen()
        if self._voyage is not None:
            self._voyage.follow(now)
        fix = self._fix(now, due)
        self._last = []
        for kind in due:
            for fields in sentences_of(kind, fix):
                self._last.append(made(self._talkers[kind], kind, fields))
                self.counts.sent[kind] += 1
        self._ports.send(self._last)

    def _fix(self, now: Seen, due: list[str]) -> Fix:
        """What is said of an instant; geodesy only where a sentence needs it."""
        place: Any = (0.0, 0.0)
        leg = None
        if not _PLACED.isdisjoint(due):
            on = None if self._voyage is None else self._voyage.leg
            place = self._chart.place(now.north, now.east, on)
        if self._voyage is not None and not _ON_ROUTE.isdisjoint(due):
            leg = self._voyage.at(now)
        utc = self._start + datetime.timedelta(seconds=now.time)
        return Fix(now, float(place[0]), float(place[1]), utc, leg, self._simulated)

    def plain(self) -> dict[str, Any]:
        """Statistics for JSON."""
        vessel, seconds = self._vessel, self._ended - self._began
        found = {"intervals": self.sailed, "interval": vessel.interval, "ended": self.why}
        found["seconds"] = round(seconds, 3)
        found["speed_up"] = round(self.sailed * vessel.interval / max(seconds, 1e-3), 2)
        refused = {key: count for key, count in self._ports.refused.items() if count}
        counted = self.counts.plain()
        counted["clients"] |= refused
        return found | counted | {"now": plain(vessel.seen()), "steered_by": vessel.order.what}


def periods(rates: Mapping[str, float], interval: float) -> dict[str, int]:
    """Every how many intervals of so many seconds a sentence is due, of those that are wanted."""
    wanted = {kind: rates[kind] for kind in TALKERS if rates[kind] > 0.0}
    return {kind: max(1, round(1.0 / (rate * interval))) for kind, rate in wanted.items()}


def kind_of(sentence: Any) -> str:
    """Three letters of a sentence, or who made it where it is a proprietary one."""
    for name in ("sentence_type", "manufacturer"):
        if text := getattr(sentence, name, ""):
            return str(text)
    return "other"
