"""Progress of a run on a bar: share of the budget, samples a second, the last validation."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from ship_gym_agents.training.run import Run

_EVERY = 0.5  # seconds between two texts


class Progress:
    """Moves a bar like tqdm's, which itself shows the time left.

    Parameters
    ----------
    run : Run
    bar : object, optional
        With ``n``, ``total`` and ``update(increment)``; with ``set_postfix_str`` it gets a text.
    """

    def __init__(self, run: Run, bar: Any = None):
        self._run, self._bar = run, bar
        self._begun, self._shown = run.samples, 0.0
        self._before = run.budget.seconds

    def show(self, samples: int, learner: Callable[[], dict[str, float]] = dict) -> None:
        """Show where the run is after `samples` samples."""
        if self._bar is None:
            return
        used = self._run.budget.used(samples)
        self._bar.update(int(used * self._bar.total) - self._bar.n)
        if time.monotonic() - self._shown < _EVERY or not hasattr(self._bar, "set_postfix_str"):
            return
        self._shown = time.monotonic()
        self._bar.set_postfix_str(self.text(samples, learner()))

    def text(self, samples: int, learner: dict[str, float]) -> str:
        """Samples a second, score and rudder travel of the last validation, the learner's own."""
        seconds = self._run.budget.seconds - self._before
        parts = [f"{(samples - self._begun) / max(seconds, 1e-9):,.0f} samples/s"]
        last, score = self._run.last or {}, self._run.score
        for name, unit in ((score.name, score.unit), ("rudder_travel", "deg/h")):
            if last.get(name) is not None:
                parts.append(f"{name} {last[name]:.4g} {unit}")
        parts += [f"{name} {value:.3g}" for name, value in learner.items()]
        return ", ".join(parts)
