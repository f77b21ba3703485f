"""Fixed splits of seeds and ships: what is trained on, chosen by, tuned on and judged on.

A seed fixes an episode: its sea, its start, its orders or way-points, its failure. So splitting the
seeds splits the seas. Nothing but an evaluation uses the seeds of `test`.
Benchmarks look at those again and again; `final` is what a shipped policy is judged on, once.
"""

from __future__ import annotations

import dataclasses

from ship_gym.config import check_known, check_number


@dataclasses.dataclass(frozen=True)
class Split:
    """Seeds that serve one purpose.

    Attributes
    ----------
    name : str
    first, end : int
        The seeds are first to end - 1.
    use : str
        In words.
    """

    name: str
    first: int
    end: int
    use: str

    @property
    def size(self) -> int:
        """Number of seeds."""
        return self.end - self.first

    def __contains__(self, seed: int) -> bool:
        return self.first <= seed < self.end


# The hyperparameters of PPO were chosen with a look at seeds from 1_000_000 on, which is tuning.
SPLITS: dict[str, Split] = {
    split.name: split
    for split in (
        Split("training", 0, 400_000, "policies draw their episodes here"),
        Split("validation", 400_000, 500_000, "chooses the policy of a training run that is kept"),
        Split("tuning", 500_000, 2_000_000, "gains and hyperparameters"),
        Split("test", 2_000_000, 3_000_000, "evaluations and benchmarks, and nothing else"),
        Split("final", 3_000_000, 4_000_000, "one look at shipped policies"),
    )
}
TRAINING_SHIPS = ("kcs", "kvlcc2", "onrt")
HELD_OUT_SHIPS = ("s175", "dtc")

VALIDATION_SEED = SPLITS["validation"].first
JUDGING_SEED = 450_000  # from here on: the final evaluation of a run, not the choice of its policy
TUNING_SEED = SPLITS["tuning"].first
EVALUATION_SEED = SPLITS["test"].first


def seeds_of(split: str, n: int) -> list[int]:
    """The first `n` seeds of a split.

    Raises
    ------
    ConfigError
        An unknown split, or more seeds than it has.
    """
    found = SPLITS[check_known("split", split, SPLITS)]
    n = int(check_number("episodes", n, 1, found.size))
    return list(range(found.first, found.first + n))


def split_of(seed: int) -> str | None:
    """Name of the split of a seed; None beyond them all."""
    return next((split.name for split in SPLITS.values() if seed in split), None)


def evaluation_seeds(n: int) -> list[int]:
    """The first `n` seeds that are kept for evaluation, those of the split `test`."""
    return seeds_of("test", n)


def tuning_seeds(n: int) -> list[int]:
    """The first `n` seeds that are kept for tuning; disjoint from training and evaluation."""
    return seeds_of("tuning", n)
