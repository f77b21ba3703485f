"""A form of a new ship gives way where no hull can be drawn from it, in what is estimated only."""

import dataclasses

import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping.estimated_form import with_estimated_form
from ship_gym.seakeeping.form_curves import CurveEnd, centre_range, fitted_curve
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.seakeeping.hydrostatics import hydrostatics
from ship_gym.ships.loader import load_ship
from ship_gym.ships.new_ship import new_ship
from ship_gym.ships.plausible import checked

# like, L, B, d, C_b, speed: none could be drawn with the other ship's form by dimension
SHIPS = {
    "tug": ("kvlcc2", 28.0, 10.5, 4.2, 0.55, 6.0),
    "pusher": ("kvlcc2", 110.0, 11.4, 2.8, 0.9, 4.0),
    "push barge": ("kvlcc2", 110.0, 11.4, 2.8, 0.94, 4.0),
    "laker": ("kvlcc2", 300.0, 32.0, 8.5, 0.9, 6.5),
    "cutter": ("kcs", 24.0, 6.4, 2.6, 0.5, 5.0),
    "yacht hull": ("kcs", 11.0, 3.4, 0.6, 0.4, 3.0),
    "cruise": ("onrt", 300.0, 37.0, 8.5, 0.65, 11.0),
    "patrol": ("onrt", 50.0, 8.0, 2.2, 0.45, 10.0),
}


def made(like, *numbers, fixed=None):
    given = dict(zip(("L", "B", "d", "C_b", "speed"), numbers, strict=True))
    return new_ship(like, "mine", given, fixed)


@pytest.mark.parametrize("name", SHIPS)
def test_a_hull_is_drawn_of_most_ships(name):
    before = made(*SHIPS[name])
    ship, why = with_estimated_form(before)
    assert not why
    found, h = hydrostatics(parametric_mesh(checked(ship))), ship.hull
    assert found.volume == pytest.approx(h.volume, rel=0.01)
    assert found.x_B == pytest.approx(ship.form.x_B, abs=0.002 * h.L)
    assert found.KM == pytest.approx(ship.form.KG + ship.form.GM)
    assert ship.form.GM >= before.form.GM * (1 - 1e-9) and ship.hull == before.hull
    for key, value in vars(ship.form).items():
        if value != getattr(before.form, key):
            assert key in ("x_F", "C_wp", "x_keel", "KG", "GM")
            assert ship.estimated[f"form.{key}"].startswith(before.estimated[f"form.{key}"])


def test_a_flat_hull_has_her_mass_not_above_what_a_ship_has():
    """With the GM of a tanker by B, KG of this one would be 5 draughts."""
    before = made("kvlcc2", 185.0, 22.8, 2.8, 0.9, 3.5)
    ship, why = with_estimated_form(before)
    assert not why and ship.form.KG == before.form.KG
    assert ship.form.GM > 3.0 * before.form.GM


def test_what_is_given_stays():
    fixed = {"form.x_F": 0.5, "form.KG": 2.4}
    ship, why = with_estimated_form(made(*SHIPS["tug"], fixed=fixed))
    assert not why and (ship.form.x_F, ship.form.KG) == (0.5, 2.4)
    KM = hydrostatics(parametric_mesh(ship)).KM
    assert ship.form.GM == pytest.approx(KM - 2.4)
    fixed |= {"form.GM": 1.0}
    ship, _ = with_estimated_form(made(*SHIPS["tug"], fixed=fixed))
    assert (ship.form.KG, ship.form.GM) == (2.4, 1.0)
    with pytest.raises(ConfigError, match=r"form.KG = 9 m: allowed is below .* the metacentre"):
        with_estimated_form(made(*SHIPS["tug"], fixed={"form.KG": 9.0}))
    ship, why = with_estimated_form(made(*SHIPS["laker"], fixed={"form.x_F": 30.0}))
    assert ship.form is None and "x_F / L = 0.1000: allowed is" in why
    assert not any(key.startswith("form.") for key in ship.estimated)


@pytest.mark.parametrize("name", ["kcs", "kvlcc2", "dtc", "onrt"])
def test_a_ship_of_the_package_keeps_her_form(name):
    """Her own numbers fit each other: nothing moves, and KM is hers within their rounding."""
    old = load_ship(name, surrogate="none")
    keys = ("L", "B", "d", "volume")
    given = {key: getattr(old.hull, key) for key in keys} | {"speed": old.speed}
    ship, why = with_estimated_form(new_ship(name, "same", given))
    assert not why
    for key, value in vars(ship.form).items():
        if key != "x_B":  # x_G, on even keel
            allowed = 0.01 * old.hull.B if key == "KG" else 2e-6 * old.hull.L
            assert value == pytest.approx(getattr(old.form, key), abs=allowed), key


def test_the_range_of_centres_is_that_of_the_curves():
    ends = CurveEnd(0.3, 1.0), CurveEnd(0.0, 1.2)
    low, high = centre_range(0.8, *ends, 0.05)
    for centre in (low + 1e-4, high - 1e-4):
        area, first = fitted_curve(0.8, centre, *ends, 0.05, ("a", "c")).moments()
        assert (area, first / area) == (pytest.approx(0.8), pytest.approx(centre))
    for centre in (low - 1e-4, high + 1e-4):
        with pytest.raises(ConfigError, match="c = "):
            fitted_curve(0.8, centre, *ends, 0.05, ("a", "c"))
    assert centre_range(0.999, *ends, 0.05) is None


def test_a_ship_like_one_without_a_form_has_none():
    bare = dataclasses.replace(load_ship("kvlcc2"), form=None)
    ship, why = with_estimated_form(made(bare, 246.0, 46.0, 14.5, 0.82, 7.7))
    assert ship.form is None and why
