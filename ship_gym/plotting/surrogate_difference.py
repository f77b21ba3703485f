"""Map of the difference of two surrogates over J and drift: Knight (2021) Figs. 3.14, 5.12."""

from __future__ import annotations

import os

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.plotting.figure import headline, picture
from ship_gym.plotting.surrogate_maps import SIGNED, TITLES, draw_map, map_axes, responses
from ship_gym.ships.particulars import Ship

_COUNT = 41  # points of a map along J and along beta
_SMALL = 0.05  # of the largest value: below it a percentage of the local value says nothing
_SHOWN = 95.0  # percentile of the sizes in the trained box at which the colours end


def difference(ship: Ship, other: Ship, count: int = _COUNT) -> tuple[tuple, dict[str, dict]]:
    """Difference of every force coefficient, in percent of the local value of `other`.

    Parameters
    ----------
    ship, other : Ship
        One ship with two surrogates.
    count : int
        Points along J and along beta.

    Returns
    -------
    tuple
        J [-] and beta [rad] of the maps, shapes (count,).
    dict
        Propeller and rudder to quantity to 100 (ship - other) / other [%], shape (count, count);
        nan where `other` is below a twentieth of its largest value.

    Raises
    ------
    ConfigError
        One has no surrogate, or they are not of the same propellers and rudders.
    """
    cards = []
    for one in (ship, other):
        if one.surrogate is None:
            raise ConfigError(f"{one.name}: has no surrogate to compare; name two, e.g. G2_SA")
        cards.append(one.surrogate.card)
    sides = [list(card["models"]) for card in cards]
    if sides[0] != sides[1]:
        raise ConfigError(f"surrogates of {sides[0]} and of {sides[1]}: cannot be compared")
    grid = map_axes(cards[0]["domain"], count)
    found: dict[str, dict] = {}
    for side in sides[0]:
        both = [responses(one, *grid, side) for one in (ship, other)]
        names = [k for k in ("K_T", "10K_Q", "C_Fx", "C_Fy") if _known(cards, side, k)]
        found[side] = {}
        for name in names:
            first, second = (np.array([[c[name] for c in row] for row in part]) for part in both)
            small = np.abs(second) < _SMALL * np.abs(second).max()
            found[side][name] = 100.0 * (first - second) / np.where(small, np.nan, second)
    return grid, found


def _known(cards, side: str, name: str) -> bool:
    """Whether both surrogates have the quantity; K_X stands for K_T, torque may follow from it."""
    other = {"K_T": "K_X"}.get(name, name)
    return all(name in c["models"][side] or other in c["models"][side] for c in cards)


def plot_difference(ship: Ship, other: Ship, path: str | os.PathLike) -> dict[str, dict]:
    """Draw `difference`; return the mean and largest size in the trained box [%].

    Parameters
    ----------
    ship, other : Ship
        As in `difference`.
    path : path-like
        PNG file; an interrupted write leaves an existing one as it was.

    Returns
    -------
    dict
        Propeller and rudder to quantity to ``mean`` and ``largest`` [%].
    """
    grid, found = difference(ship, other)
    assert ship.surrogate is not None
    box = ship.surrogate.card["domain"]
    inside = np.ix_(
        (grid[1] >= box["beta_min"]) & (grid[1] <= box["beta_max"]),
        (grid[0] >= box["J_min"]) & (grid[0] <= box["J_max"]),
    )
    columns = max(map(len, found.values()))
    with picture(path, 3.6 * columns, 0.7 + 3.3 * len(found)) as figure:
        headline(
            figure,
            f"{ship.name}: surrogate {ship.surrogate_name} less {other.surrogate_name}",
            f"in percent of the local value of {other.surrogate_name}; black frame: trained box; "
            "white: nearly zero there; the colours end at 95 % of the box",
        )
        for row, (side, maps) in enumerate(found.items()):
            for column, (name, values) in enumerate(maps.items()):
                place = row * columns + column + 1
                axes = figure.add_subplot(len(found), columns, place)
                limit = float(np.nanpercentile(np.abs(values[inside]), _SHOWN))
                shown = np.ma.masked_invalid(values)
                draw_map(figure, axes, grid, shown, box, SIGNED, bands=9, limit=limit)
                axes.set_title(TITLES[name] + ("" if side == "single" else f", {side}"))
    return {
        side: {
            name: {
                "mean": float(np.nanmean(np.abs(values[inside]))),
                "largest": float(np.nanmax(np.abs(values[inside]))),
            }
            for name, values in maps.items()
        }
        for side, maps in found.items()
    }
