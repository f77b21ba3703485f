"""The card of a policy, as a file may give it: the keys that are needed, and their kinds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ship_gym.config import ConfigError, check_number, shown

_MOST_LETTERS = 200  # of a name
_NETWORK = {"kind": str, "hidden": list, "activation": str, "output": str, "symmetric": bool}
_MAPPINGS = ("config", "best", "final", "versions", "budget", "measure", "source")


def checked_card(card: Any) -> dict[str, Any]:
    """A card with what loading and sailing a policy need, else a ConfigError that names the key.

    Numbers that are not finite, such as a measure of a validation that had none, become None.
    """
    if not isinstance(card, dict):
        raise ConfigError(f"card = {shown(card)}: must be a table of keys")
    card = _without_nan(card)
    wanted = {"name": str, "form": dict, "network": dict, "normaliser": dict}
    _check_kinds("card", card, wanted | {"features": list, "decisions": list})
    if not 0 < len(card["name"]) <= _MOST_LETTERS or not card["name"].isprintable():
        raise ConfigError(f"card.name = {shown(card['name'])}: allowed are 1 to 200 letters")
    for key in ("features", "decisions"):
        if not all(isinstance(name, str) for name in card[key]):
            raise ConfigError(f"card.{key} = {shown(card[key])}: must be a list of names")
    _check_kinds("card.network", card["network"], _NETWORK)
    if "limit" not in card["normaliser"]:
        raise ConfigError("card.normaliser has no 'limit'")
    check_number("card.normaliser.limit", card["normaliser"]["limit"], 0.0, math.inf)
    for key in _MAPPINGS:
        if not isinstance(card.get(key, {}), dict):
            raise ConfigError(f"card.{key} = {shown(card[key])}: must be a table of keys")
    if not isinstance(card.get("config", {}).get("scenario", {}), dict):
        raise ConfigError("card.config.scenario must be a table of keys")
    return card


def _check_kinds(where: str, values: Mapping[str, Any], kinds: Mapping[str, type]) -> None:
    for key, kind in kinds.items():
        if key not in values:
            raise ConfigError(f"{where} has no {key!r}")
        if not isinstance(values[key], kind):
            raise ConfigError(
                f"{where}.{key} = {shown(values[key])}: must be of type {kind.__name__}"
            )


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_without_nan(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
