"""The option ``--seeds``: how many evaluation seeds, a range of seeds, or a list of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click

MOST = 1000  # seeds of one call
_LARGEST = 2**63 - 1
_ALLOWED = "allowed is a number of evaluation seeds, FIRST..LAST, or several seeds"


def seeds_of(
    ctx: click.Context, param: click.Parameter, given: Sequence[str]
) -> tuple[int, ...] | None:
    """Seeds of the words behind an option, as a callback of click; None without the option.

    A word alone is how many of the evaluation seeds, as in the other verbs; ``FIRST..LAST`` is a
    range with both its ends; several words are seeds or ranges themselves.
    """
    if not given:
        return None
    option = param.opts[0]
    if len(given) == 1 and ".." not in given[0]:
        return _first(option, given[0], ctx)
    found = [seed for word in given for seed in _range(option, word, ctx)]
    if len(found) > MOST:
        raise click.UsageError(f"{option}: {len(found)} seeds; allowed are {MOST} at most", ctx)
    if double := sorted({seed for seed in found if found.count(seed) > 1}):
        raise click.UsageError(f"{option}: seed {double[0]} is there twice", ctx)
    return tuple(found)


def _first(option: str, word: str, ctx: click.Context) -> tuple[int, ...]:
    """The first evaluation seeds, as many as the word says."""
    from ship_gym.evaluation.splits import evaluation_seeds

    count = _whole(option, word, ctx)
    if not 1 <= count <= MOST:
        raise click.UsageError(
            f"{option} = {word}: alone it is a number of evaluation seeds, 1 to {MOST}; one "
            "seed is --seed",
            ctx,
        )
    return tuple(evaluation_seeds(count))


def _range(option: str, word: str, ctx: click.Context) -> Any:
    """The seeds of ``FIRST..LAST``, both ends included, or the one seed of the word."""
    first, dots, last = word.partition("..")
    low = _whole(option, first, ctx, word)
    high = _whole(option, last, ctx, word) if dots else low
    if not 0 <= low <= high <= _LARGEST:
        raise click.UsageError(f"{option} = {word}: allowed is 0 <= FIRST <= LAST < 2^63", ctx)
    if high - low >= MOST:
        raise click.UsageError(
            f"{option} = {word}: {high - low + 1} seeds; allowed are {MOST} at most", ctx
        )
    return range(low, high + 1)


def _whole(option: str, text: str, ctx: click.Context, word: str | None = None) -> int:
    try:
        return int(text)
    except ValueError:
        raise click.UsageError(f"{option} = {word or text}: {_ALLOWED}", ctx) from None
