"""The card of a training run: the one reader of ``card.json``, and what must stand in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError, shown
from ship_gym.keys import Keys, read_keys

CARD_FILE = "card.json"
STATUSES = ("running", "complete", "interrupted", "stopped")


def read_run_card(file: str | Path) -> dict[str, Any]:
    """The card of a run, all that the package takes from it checked.

    A run that has just begun has no validations yet, one of several seeds has ``runs`` in the end.

    Raises
    ------
    ConfigError
        No such file, no JSON, or a key that is missing or has another type; says which.
    """
    card = read_keys(file)
    card.text("name", "")
    card.known("status", STATUSES)
    config = card.table("config")
    config.text("algorithm")
    scenario = config.table("scenario")
    scenario.text("task")
    scenario.text("ship")
    config.whole("seed", 0, 2**32 - 1)
    config.table("hyperparameters")
    budget = card.table("budget")
    budget.number("minutes", 0.0, unit="min", instead=None)
    budget.whole("steps", 1, instead=None)
    card.whole("seeds", 2, 1000, instead=None)
    card.text("command", "")
    card.text("init", "")
    card.number("used", 0.0, 1e6, instead=None)
    _check_validations(card)
    _check_final(card)
    return dict(card.values)


def read_run_state(file: str | Path) -> dict[str, Any]:
    """What a checkpoint says of the run, checked as `read_run_card` checks a card."""
    state = read_keys(file)
    state.whole("samples", 0)
    state.number("seconds", 0.0, unit="s")
    state.whole("episodes", 1, 100_000)
    state.number("limit", 0.0, unit="deg/h", instead=None)
    state.number("validated", 0.0, unit="s")
    for number, one in enumerate(state.items("validations")):
        _check_validation(Keys(one, state.where, f"validations[{number}]"))
    if "limit" not in state.values:
        state.value("limit")  # says that it is missing
    return dict(state.values)


def _check_validations(card: Keys) -> None:
    seeds = card.numbers("validation_seeds", 0, 2**32 - 1, instead=[])
    if len(seeds) not in (0, 2):
        raise ConfigError(f"{card.label('validation_seeds')} = {shown(seeds)}: must be two numbers")
    if "measure" in card.values:
        card.table("measure").text("name")
        card.table("measure").text("unit")
    for number, one in enumerate(card.items("validations", [])):
        _check_validation(Keys(one, card.where, f"validations[{number}]"))
    one_seed = card.value("seeds", None) is None
    if card.value("best", None) is not None or (one_seed and card.text("status") == "complete"):
        _check_validation(card.table("best"))


def _check_validation(found: Keys) -> None:
    """Means of a validation: numbers or null, those by which policies are ranked among them."""
    for key in ("success", "return", "rudder_travel"):
        found.value(key)
    for key in found.values:
        found.number(key, instead=None)


def _check_final(card: Keys) -> None:
    """What the final evaluation tells: its text, and each policy's and reference's means."""
    if card.value("final", None) is None:
        return
    final = card.table("final")
    final.text("text", "")
    _check_validation(final.table("policy"))
    for _, reference in final.table("references", {}).tables():
        reference.table("validation", {})
        reference.table("difference").text("verdict")
