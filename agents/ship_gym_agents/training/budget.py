"""Budget: how long a training run may last, in time of training, in samples or both."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from ship_gym.config import ConfigError, check_number

DEFAULT_MINUTES = 2.0


def default_budget(minutes: float | None, steps: int | None) -> dict[str, float | int | None]:
    """The two limits as arguments of `train`; `DEFAULT_MINUTES` if neither is given."""
    if minutes is None and steps is None:
        minutes = DEFAULT_MINUTES
    return {"minutes": minutes, "steps": steps}


class Budget:
    """Share of a run that is used up; it sets the learning rate, the validations and the end.

    Only training is charged: the clock stands still until `start` and inside `uncharged`, where
    validations sail and files are written.

    Parameters
    ----------
    minutes : float, optional
        Time of training of the whole run.
    steps : int, optional
        Samples of the whole run, all environments together.
    seconds_before : float
        Charged to earlier parts of a resumed run [s].
    """

    def __init__(
        self, minutes: float | None = None, steps: int | None = None, seconds_before: float = 0.0
    ):
        if minutes is None and steps is None:
            raise ConfigError("a budget is needed: minutes, steps or both")
        if minutes is not None:
            check_number("minutes", minutes, 1e-3, 1e6)
        if steps is not None:
            check_number("steps", steps, 1, 1e12)
        self.minutes, self.steps = minutes, steps
        self._charged = seconds_before
        self._since: float | None = None  # when the clock began to run; None: it stands still

    def start(self) -> None:
        """Let the clock run."""
        self._since = time.monotonic()

    @contextlib.contextmanager
    def uncharged(self) -> Iterator[None]:
        """Stop the clock for the block."""
        ran, self._charged, self._since = self._since is not None, self.seconds, None
        try:
            yield
        finally:
            if ran:
                self.start()

    @property
    def seconds(self) -> float:
        """Time of training so far, earlier parts included [s]."""
        running = 0.0 if self._since is None else time.monotonic() - self._since
        return self._charged + running

    def used(self, samples: int) -> float:
        """Share used after `samples` samples, 0 to 1: of whichever limit is nearer."""
        shares = [0.0]
        if self.minutes is not None:
            shares.append(self.seconds / (60.0 * self.minutes))
        if self.steps is not None:
            shares.append(samples / self.steps)
        return min(1.0, max(shares))

    @property
    def time_is_up(self) -> bool:
        """Whether the time of training is used up."""
        return self.minutes is not None and self.seconds >= 60.0 * self.minutes
