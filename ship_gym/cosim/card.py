"""The card in the resources of an FMU: what `write_fmu` was told, and the unit that it makes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ship_gym.cosim.guarded import GuardedUnit
from ship_gym.cosim.unit import ShipUnit
from ship_gym.keys import Keys, read_keys

CARD = "unit.json"  # in the resources
SHIPS = "ships"  # there too: own ship files
FORMAT = 1


def opened(resources: Path, log: Callable[[str], None]) -> tuple[GuardedUnit, Keys]:
    """The unit of the resources of an FMU, and their card.

    Parameters
    ----------
    resources : Path
    log : callable
        Takes a line, as an error.

    Raises
    ------
    ConfigError
        The card is of another version, or damaged.
    """
    card = read_keys(resources / CARD)
    card.whole("format", low=FORMAT, high=FORMAT)
    propellers = card.whole("propellers", 1, 2)
    unit = ShipUnit(card.table("values").values, propellers, resources / SHIPS)
    return GuardedUnit(unit, log), card


def state_from_bytes(stored: bytes) -> dict[str, Any]:
    """A state that pythonfmu made bytes of; an empty one, which no unit takes, if it is none."""
    try:
        found = json.loads(stored)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}
