"""Ships as numpy records, the form the kernels read; fields are those of `SECTIONS`."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Hashable, Sequence
from typing import TypeVar

import numpy as np

from ship_gym.config import ConfigError
from ship_gym.physics.parameters import SECTIONS
from ship_gym.physics.quantities import record_type
from ship_gym.ships.particulars import OpenWater, Ship, Surrogate
from ship_gym.tables import Table

T = TypeVar("T", bound=Hashable)

# thrust, torque, side force (to port), rudder normal and chordwise force, weight; then the standard
# deviations of the first five
STD_CHANNELS = ("C_T_std", "C_Q_std", "C_S_std", "C_N_std", "C_A_std")
CHANNELS = ("C_T", "C_Q", "C_S", "C_N", "C_A", "trust", *STD_CHANNELS)


def surrogate_names(units: int) -> tuple[str, ...]:
    """Names of a surrogate table of one or two propellers; of two, the leeward one comes first."""
    return CHANNELS if units == 1 else (*CHANNELS, *(f"{name} windward" for name in CHANNELS))


SHIP_DTYPE = record_type(
    [
        ("rho", np.float64),
        ("kind", np.int64),
        *(
            (name, record_type([(field, np.float64) for field in part._fields]))
            for name, part in SECTIONS.items()
        ),
    ]
)


def surrogate_section(table: Table | None) -> Surrogate:
    """Axes and trained box of a surrogate table; all zero without one."""
    if table is None:
        return Surrogate()
    known = table.names in (surrogate_names(1), surrogate_names(2))
    if not known or len(table.axes) not in (2, 3):
        raise ConfigError(f"surrogate table has {table.names}, needs {CHANNELS}, fit it again")
    *planes, epsilon, beta = table.axes
    delta, step = table.card["domain"]["delta"], 1.0
    if planes:  # the domain names the largest of several rudder angles
        delta, step = planes[0].start, planes[0].step
    return Surrogate(
        **table.card["domain"] | {"delta": delta, "delta_step": step},
        sin_delta=math.sin(delta),
        cos_delta=math.cos(delta),
        law_std=0.01 * table.card["effective_inflow"]["rms_error_percent"],
        epsilon_start=epsilon.start,
        epsilon_step=epsilon.step,
        beta_start=beta.start,
        beta_step=beta.step,
    )


@dataclasses.dataclass(frozen=True)
class Fleet:
    """Records and tables of n ships.

    Attributes
    ----------
    records : numpy.ndarray
        SHIP_DTYPE, shape (n,). Domain randomisation is a write to one of its columns.
    open_water, deflected : numpy.ndarray
        Tables of each kind of ship, shapes (kinds, count, 2) and (kinds, 2, count, count, 11): the
        only propeller and rudder or, of two, the leeward and the windward one. Of several rudder
        angles (kinds, 2, planes, count, count, 11).
    """

    records: np.ndarray
    open_water: np.ndarray
    deflected: np.ndarray


def fleet(ships: list[Ship]) -> Fleet:
    """Records of `ships`, one row each; ships of one kind share their tables."""
    kinds, numbers = numbered(ships)
    made = np.zeros(len(kinds), SHIP_DTYPE)
    for kind, ship in enumerate(kinds):
        _fill(made[kind], ship, kind)
    records = made[numbers]
    open_water = _stacked([ship.open_water.values for ship in kinds], "open-water")
    present = [_by_unit(anchored(ship)) for ship in kinds if ship.surrogate is not None]
    blank = np.zeros_like(present[0]) if present else np.zeros((2, 2, 2, len(CHANNELS)))
    rest = iter(present)
    tables = [blank if ship.surrogate is None else next(rest) for ship in kinds]
    return Fleet(records, open_water, _stacked(tables, "surrogate"))


def numbered(things: Sequence[T]) -> tuple[list[T], list[int]]:
    """The different ones of some ships or seas, and for each thing which of them it is.

    Equal things are one, whether or not they are one object.

    Returns
    -------
    different : list
        In the order of their first appearance.
    numbers : list of int
        Place in `different` of every thing.
    """
    places: dict[T, int] = {}
    objects: dict[int, int] = {}  # spares hashing the same ship thousands of times
    numbers = []
    for thing in things:
        if id(thing) not in objects:
            objects[id(thing)] = places.setdefault(thing, len(places))
        numbers.append(objects[id(thing)])
    return list(places), numbers


def anchored(ship: Ship) -> Table:
    """Surrogate of a ship, its thrust and torque shifted to the known point straight ahead.

    At zero drift they become those of the open-water curve in the ship's wake; the shift is the
    same at every drift angle. K_T is nearly a line in J (1 - w), so that is a shift of the wake:
    how much of it drift takes away is the samples', how much there is straight ahead the tank's.
    (A process through the samples has a length scale of 162 deg of drift for K_T: within the
    trained 45 deg a deviation does not die out.) Done here, at the ship's scale, because the wake
    depends on it. The table as it stands if its card does not say ``anchored``.
    """
    table = ship.surrogate
    assert table is not None
    if not table.card.get("anchored"):
        return table
    axis = ship.open_water.axes[0]
    places = np.ix_(*(one.points for one in table.axes[:-1]))  # all but the drift
    tangent = np.tan(places[-1])
    ratio = 1.0 - ship.propeller.w_P0
    at = np.arctan(ratio * tangent)
    # starred coefficients are of u^2 + (0.7 pi n D)^2, u in the wake there and without here
    square = (1.0 + (ratio * tangent) ** 2) / (1.0 + tangent**2)
    ahead = table(*places, 0.0)
    values = table.values.copy()
    for k, name in enumerate(table.names):
        channel = name.split()[0]
        if channel in ("C_T", "C_Q"):
            known = np.interp(at, axis.points, ship.open_water.values[:, CHANNELS.index(channel)])
            values[..., k] += (square * known - ahead[..., k])[..., None]
    return dataclasses.replace(table, values=values)


def as_computed(ship: Ship) -> Ship:
    """The ship with its surrogate as the samples have it: no shift by `anchored`."""
    table = ship.surrogate
    assert table is not None
    card = {**table.card, "anchored": False}
    return dataclasses.replace(ship, surrogate=dataclasses.replace(table, card=card))


def _by_unit(table: Table) -> np.ndarray:
    """Values as (2, ..., 11), leeward before windward; a single one stands in both."""
    units = len(table.names) // len(CHANNELS)
    parts = np.split(table.values, units, axis=-1)
    return np.stack([parts[0], parts[-1]])


def _fill(record: np.record, ship: Ship, kind: int) -> None:
    axis = ship.open_water.axes[0]
    parts = {
        **{name: getattr(ship, name) for name in ("hull", "propeller", "rudder", "gear", "engine")},
        "inertia": ship.inertia,
        "open_water": OpenWater(axis.start, axis.step),
        "surrogate": surrogate_section(ship.surrogate),
    }
    record["rho"], record["kind"] = ship.rho, kind
    for name, section in SECTIONS.items():
        for field in section._fields:
            record[name][field] = getattr(parts[name], field)


def _stacked(tables: list[np.ndarray], name: str) -> np.ndarray:
    shapes = {table.shape for table in tables}
    if len(shapes) > 1:
        raise ConfigError(
            f"the {name} tables of one fleet must have one grid, got {sorted(shapes)}"
        )
    return np.stack(tables)
