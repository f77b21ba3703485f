"""What went over the wire, counted: orders, what was passed over, why sentences were dropped."""

from __future__ import annotations

from collections import Counter
from typing import Any

from ship_gym_agents.serve.nmea import Dropped

_LONGEST = 100  # characters of an example


class Counts:
    """Statistics of a run.

    Attributes
    ----------
    sent, orders, ignored : Counter
        Sentences by kind: made, each once for all clients; orders that steered or wait to; valid
        ones that order nothing.
    dropped : dict
        By reason: count, and the latest of them with what was wrong.
    clients : Counter
        ``tcp`` and ``udp``: how many came; ``left``: dropped since they read too slowly.
    late : int
        Intervals that began later than the clock asked for.
    """

    def __init__(self):
        self.sent: Counter[str] = Counter()
        self.orders: Counter[str] = Counter()
        self.ignored: Counter[str] = Counter()
        self.dropped: dict[str, dict[str, Any]] = {}
        self.clients: Counter[str] = Counter()
        self.late = 0

    def drop(self, line: bytes, why: Dropped) -> None:
        """Count a sentence that was dropped."""
        text = line[:_LONGEST].decode("ascii", "backslashreplace")
        found = self.dropped.setdefault(why.why, {"count": 0})
        found |= {"count": found["count"] + 1, "latest": text, "what": str(why)}

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        counters = ("sent", "orders", "ignored", "clients")
        found: dict[str, Any] = {
            name: dict(sorted(getattr(self, name).items())) for name in counters
        }
        return found | {"dropped": self.dropped, "late_intervals": self.late}
