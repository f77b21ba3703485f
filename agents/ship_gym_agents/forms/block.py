"""What a block of features is."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ship_gym.tasks.columns import observation_columns
from ship_gym_agents.forms.look import Look, Sailing

LIMIT = 5.0


class Block:
    """Some features that belong together.

    Attributes
    ----------
    FEATURES : dict
        Name to mirror sign.
    needs : tuple of str
        Columns of the observation.
    on_base : bool
        Whether a classical controller is needed.
    """

    FEATURES: ClassVar[dict[str, float]] = {}
    needs: ClassVar[tuple[str, ...]] = ()
    on_base: ClassVar[bool] = False

    def __init__(self, sailing: Sailing):
        who = f"the block {self.name()!r} of form.features"
        observation_columns(sailing.scenario).require(self.needs, who)
        self.features = dict(self.FEATURES)

    @classmethod
    def name(cls) -> str:
        """As in ``form.features``."""
        return cls.__name__.lower()

    def __call__(self, look: Look) -> np.ndarray:
        """Features, shape (count, features); once an interval."""
        found = np.empty((len(look.observations), len(self.features)))
        for k, value in enumerate(self.values(look)):
            found[:, k] = value
        return np.clip(found, -LIMIT, LIMIT, out=found)

    def values(self, look: Look) -> tuple:
        """The features one by one, in the order of `features`."""
        raise NotImplementedError

    def restart(self, rows: np.ndarray) -> None:
        """Begin anew in these rows with the next look."""
