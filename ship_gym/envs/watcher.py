"""What follows a batch of episodes while it sails, such as a recording."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np


class Watcher(Protocol):
    """What follows a batch, see ``EpisodeBatch.watch``."""

    def leave(self, which: np.ndarray) -> None:
        """Some episodes, shape (m,), are about to begin anew; their ships are where they were."""

    def begin(self, which: np.ndarray, given: Mapping[str, np.ndarray]) -> None:
        """They have begun, with the options `given` (``EpisodeBatch.start``)."""

    def before(self) -> None:
        """An interval begins; ``actions`` are those of it, all else is of its start."""

    def after(self) -> None:
        """It has been sailed; no episode that it ended has begun anew yet."""
