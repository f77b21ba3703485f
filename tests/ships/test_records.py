"""Ships found by value: what is equal is one, and shares its tables."""

import dataclasses

import numpy as np

from ship_gym.sea.state import Sea, irregular_sea
from ship_gym.ships import load_ship
from ship_gym.ships.records import fleet, numbered
from ship_gym.tables import Table


def copied(ship):
    """An equal ship that shares no object with it."""
    tables = {
        name: dataclasses.replace(table, values=table.values.copy(), card=dict(table.card))
        for name in ("open_water", "surrogate")
        if (table := getattr(ship, name)) is not None
    }
    return dataclasses.replace(ship, **tables, hull=dataclasses.replace(ship.hull))


def test_equal_ships_and_seas_are_one():
    kcs, onrt = load_ship("kcs"), load_ship("onrt")
    slower = dataclasses.replace(kcs, speed=0.9 * kcs.speed)
    again = copied(kcs)
    assert again is not kcs and again == kcs and hash(again) == hash(kcs)
    different, numbers = numbered([kcs, onrt, again, slower, kcs])
    assert different == [kcs, onrt, slower] and different[0] is kcs
    assert numbers == [0, 1, 0, 2, 0]
    assert numbered([Sea(), irregular_sea(2.0, 8.0), Sea()])[1] == [0, 1, 0]
    assert Sea(waves=list(irregular_sea(2.0, 8.0).waves)).waves == irregular_sea(2.0, 8.0).waves


def test_a_changed_number_or_table_is_another_ship():
    kcs = load_ship("kcs")
    table = kcs.open_water
    other = Table(table.axes, table.names, 1.001 * table.values, table.card)
    assert table != other and table == Table(table.axes, table.names, table.values, table.card)
    assert dataclasses.replace(kcs, open_water=other) != kcs
    assert table != "open water"
    thicker = dataclasses.replace(kcs, hull=dataclasses.replace(kcs.hull, d=1.001 * kcs.hull.d))
    assert numbered([kcs, thicker])[1] == [0, 1]


def test_a_ship_named_often_is_filled_in_once():
    kcs, onrt = load_ship("kcs"), load_ship("onrt")
    many = [kcs, onrt, copied(kcs)] * 64
    made = fleet(many)
    assert len(made.open_water) == len(made.deflected) == 2
    np.testing.assert_array_equal(made.records["kind"], [0, 1, 0] * 64)
    np.testing.assert_array_equal(made.records["hull"]["L"], [s.hull.L for s in many])
