"""A ship from particulars: what is given, what is estimated and by what, and what is refused."""

import dataclasses
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.ships.doubts import doubts
from ship_gym.ships.estimates import MIDSHIP, WATERPLANE
from ship_gym.ships.estimators import estimated_hull
from ship_gym.ships.loader import load_ship
from ship_gym.ships.new_ship import new_ship, number_of
from ship_gym.ships.particulars import Hull
from ship_gym.ships.plausible import checked
from ship_gym.ships.powering import powering
from ship_gym.ships.ranges import RANGES
from ship_gym.ships.write_ship import ship_text
from ship_gym.simulation import ShipSim

TANKER = {"L": 246.0, "B": 46.0, "d": 14.5, "C_b": 0.82, "speed": 7.7}
BARGE = {"L": 80.0, "B": 16.0, "d": 3.0, "C_b": 1.0, "speed": 4.0, "x_G": 0.0}
FERRY = {"L": 160.0, "B": 25.0, "d": 6.2, "C_b": 0.58, "speed": 10.0, "propellers": 2, "z": 4}


def test_the_same_particulars_are_the_same_ship():
    """KVLCC2 with her own particulars: everything comes back but what is estimated anew."""
    old = load_ship("kvlcc2")
    h = old.hull
    new = new_ship(
        "kvlcc2", "same", {"L": h.L, "B": h.B, "d": h.d, "volume": h.volume, "speed": old.speed}
    )
    for name, table in RANGES.items():
        for key in table:
            if (name, key) in {("form", "x_B"), ("hull", "C_A")}:
                continue
            before, after = (getattr(getattr(s, name), key) for s in (old, new))
            assert after == pytest.approx(before, rel=2e-3), f"{name}.{key}"
    assert powering(new).n == pytest.approx(powering(old).n, rel=1e-3)


@pytest.mark.parametrize(
    ("like", "given"),
    [("kvlcc2", TANKER), ("kvlcc2", BARGE), ("kcs", FERRY), ("kcs_model", TANKER)],
)
def test_the_file_loads_without_edits_and_sails(like, given, tmp_path):
    made = new_ship(like, "mine", given)
    if given is BARGE:  # no hull can be drawn of it: see the verb
        made = _without_form(made)
    path = tmp_path / "mine" / "ship.toml"
    path.parent.mkdir()
    path.write_text(ship_text(made, "given"), encoding="utf-8")
    read = load_ship(path)
    for name, table in RANGES.items():
        for key in table if getattr(made, name) is not None else ():
            before, after = (getattr(getattr(s, name), key) for s in (made, read))
            assert after == pytest.approx(before, rel=1e-5), f"{name}.{key}"
    assert read.estimated.keys() >= {k for k in made.estimated if _nonzero(made, k)}
    assert not {"hull.L", "hull.B", "hull.d", "hull.volume"} & read.estimated.keys()
    sim = ShipSim(read, n=1)  # refuses what no ship does
    sim.reset(0, speed=read.speed)
    sim.step(np.array([[0.1, read.engine.n_max]]), 1.0)
    assert np.isfinite(sim.state).all()


def _without_form(ship):
    return dataclasses.replace(
        ship,
        form=None,
        estimated={k: v for k, v in ship.estimated.items() if not k.startswith("form.")},
    )


def _nonzero(ship, key):
    """Whether a number is written: those that are not used are not."""
    section, _, field = key.partition(".")
    if not field:
        return True
    value = getattr(getattr(ship, section), field)
    kind = type(getattr(ship, section))
    return math.isfinite(value) and value != kind.__dataclass_fields__[field].default


def test_derivatives_are_the_other_ships_if_near_else_regressions():
    old = load_ship("kvlcc2")
    near = new_ship("kvlcc2", "near", {**TANKER, "d": 16.0})
    assert near.hull.Y_v == old.hull.Y_v and "as kvlcc2" in near.estimated["hull.Y_v"]
    far = new_ship("kvlcc2", "far", {**TANKER, "C_b": 0.65, "x_G": 0.0})
    known = estimated_hull(246.0, 46.0, 14.5, 0.65 * 246.0 * 46.0 * 14.5, 0.0)
    assert {k: getattr(far.hull, k) for k in known} == {k: x for k, (x, _) in known.items()}
    assert "Yoshimura" in far.estimated["hull.Y_v"] and "hull.x_G" not in far.estimated


def test_a_regression_outside_what_ships_have_is_not_taken():
    """X_vv = 1.15 C_b B/L - 0.18 of a box barge would drive her when she drifts."""
    barge = new_ship("kvlcc2", "barge", {**BARGE, "L": 60.0})
    assert 1.15 * 16.0 / 60.0 - 0.18 > RANGES["hull"]["X_vv"].high
    assert barge.hull.X_vv == load_ship("kvlcc2").hull.X_vv
    assert "of no ship" in barge.estimated["hull.X_vv"]


def test_two_propellers_of_one():
    ferry, old = new_ship("kcs", "ferry", FERRY), load_ship("kcs", surrogate="none")
    assert ferry.propellers == 2 and ferry.rudder.y_R == ferry.propeller.y_P > 0.0
    assert ferry.propeller.w_P0 == pytest.approx(0.55 * 0.58 - 0.20)
    assert ferry.rudder.A_R / (160.0 * 6.2) == pytest.approx(
        0.5 * old.rudder.A_R / (old.hull.L * old.hull.d)
    )
    assert ferry.open_water.card["four_quadrants"]["blades"] == 4
    with pytest.raises(ConfigError, match="--like onrt: has two propellers"):
        new_ship("onrt", "one", {**FERRY, "propellers": 1})


def test_the_engine_keeps_its_margin():
    old, new = load_ship("kvlcc2"), new_ship("kvlcc2", "tanker", {**TANKER, "D_P": 7.0})
    margins = [s.engine.n_max / powering(s).n for s in (old, new)]
    assert margins[1] == pytest.approx(margins[0], rel=1e-3) and new.propeller.D == 7.0


def test_numbers_that_are_known_replace_estimates():
    made = new_ship("kvlcc2", "tanker", TANKER, {"form.KG": 12.5, "propeller.w_P0": 0.3})
    assert made.form.KG == 12.5 and made.propeller.w_P0 == 0.3
    assert not {"form.KG", "propeller.w_P0"} & made.estimated.keys()
    assert all(
        f"hull.{field}" in made.estimated
        for field in Hull.__dataclass_fields__
        if field not in ("L", "B", "d", "volume")
    )


def test_everything_that_is_wrong_is_told_at_once():
    with pytest.raises(ConfigError) as error:
        new_ship("kvlcc2", "x", {"L": 0.1, "B": "x", "C_b": 1.2}, {"hull.L": 3.0, "form.KG": "a"})
    lines = str(error.value).splitlines()
    told = (
        "--set hull.L: is the option --L",
        "--set form.KG = 'a'",
        "--L = 0.1",
        "--B = 'x'",
        "--C_b = 1.2",
    )
    assert all(any(words in line for line in lines) for words in told)
    assert lines[-1] == "missing --d, --speed" and len(lines) == 6, lines
    with pytest.raises(ConfigError, match="missing --L, --B, --d, --speed, --C_b"):
        new_ship("kvlcc2", "x", {})
    with pytest.raises(ConfigError, match="give one of them"):
        new_ship("kvlcc2", "x", {**TANKER, "volume": 1e5})
    with pytest.raises(ConfigError, match=r"--propellers = 1.5: must be a whole number"):
        new_ship("kvlcc2", "x", {**TANKER, "propellers": 1.5})
    bare = dataclasses.replace(load_ship("kvlcc2"), form=None)
    with pytest.raises(ConfigError, match=r"--set form.KG: kvlcc2 has no such section"):
        new_ship(bare, "x", TANKER, {"form.KG": 12.5})
    with pytest.raises(ConfigError, match="unknown particular 'Lpp'"):
        new_ship("kvlcc2", "x", {**TANKER, "Lpp": 1.0})


def test_what_no_ship_has_is_told_at_once():
    odd = new_ship("kvlcc2", "odd", {**TANKER, "B": 146.0, "speed": 0.1, "D_P": 2.0})
    with pytest.raises(ConfigError) as error:
        checked(odd)
    assert all(key in str(error.value) for key in ("hull.B", "speed = 0.1", "propeller.D"))


def test_an_engine_without_a_torque_limit_keeps_none():
    old = load_ship("kvlcc2")
    old = dataclasses.replace(
        old, engine=dataclasses.replace(old.engine, torque_max=math.inf, torque_brake=0.0)
    )
    made = new_ship(old, "tanker", TANKER)
    assert made.engine.torque_max == math.inf and made.engine.torque_brake == 0.0
    assert "torque_max" not in ship_text(made, "given")


def test_slopes_of_waterplane_and_midship_are_those_of_the_ships_of_the_package():
    ships = [load_ship(name, surrogate="none") for name in ("dtc", "kcs", "kvlcc2", "onrt", "s175")]
    C_b = [s.hull.volume / (s.hull.L * s.hull.B * s.hull.d) for s in ships]
    for key, slope in (("C_wp", WATERPLANE), ("C_m", MIDSHIP)):
        assert np.polyfit(C_b, [getattr(s.form, key) for s in ships], 1)[0] == pytest.approx(
            slope, abs=0.005
        )


def test_water_is_a_number_of_the_ship_too():
    fresh = new_ship("kvlcc2", "fresh", TANKER, {"rho": 1000.0, "nu": 1.1e-6})
    assert (fresh.rho, fresh.nu) == (1000.0, 1.1e-6)
    assert not {"rho", "nu"} & fresh.estimated.keys()
    salt = new_ship("kvlcc2", "salt", TANKER)
    assert fresh.engine.torque_max / salt.engine.torque_max == pytest.approx(
        1000.0 / salt.rho, rel=0.01
    )


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("7.7", "m/s", 7.7),
        ("15kn", "m/s", 15 * 1852 / 3600),
        ("90 rpm", "rev/s", 1.5),
        ("45deg", "rad", math.pi / 4),
        ("2.5e-1 m", "m", 0.25),
        ("246000mm", "m", "246000mm"),
        ("15 kn", "m", "15 kn"),
        ("1.2.3", "m", "1.2.3"),
        ("-", "-", "-"),
        ("nan", "m", "nan"),
    ],
)
def test_numbers_may_have_their_unit(text, unit, number):
    assert number_of(text, unit) == (
        number if isinstance(number, str) else pytest.approx(number, rel=1e-12)
    )


@pytest.mark.parametrize(
    ("given", "fixed", "words"),
    [
        ({}, {"propeller.w_P0": 40.0, "gear.delta_max": 0.01, "rho": 0.999}, 3 * [""]),
        ({}, {"propeller.t_P": 1.0}, ["propeller.t_P = 1: allowed"]),
        ({"D_P": 2.0}, {}, ["propeller.D = 2 m"]),
        ({}, {"wind.L_oa": -0.5}, ["wind.L_oa = -0.5"]),
    ],
)
def test_a_number_that_stops_the_estimates_is_told_itself(given, fixed, words):
    """No propeller speed drives her; what is wrong is the number, not the search for the speed."""
    with pytest.raises(ConfigError) as error:
        checked(new_ship("kvlcc2", "x", {**TANKER, **given}, fixed))
    text = str(error.value)
    assert all(key in text for key in fixed) and all(word in text for word in words)


def test_what_is_far_from_what_estimates_know_is_doubted():
    old = load_ship("kvlcc2")
    assert doubts(new_ship(old, "near", {**TANKER, "L": 255.0, "speed": 7.4}), old) == ()
    tug = {"L": 28.0, "B": 10.5, "d": 4.2, "C_b": 0.55, "speed": 6.0}
    found = " ".join(doubts(new_ship(old, "tug", tug), old))
    assert "C_b 0.55, kvlcc2's 0.80; her form makes less" in found
    assert "Fn 0.36, kvlcc2's 0.14" in found and "C_b 0.55" in found and "L/B 2.67" in found
    known = doubts(new_ship(old, "tug", tug, {"hull.R_0": 0.03, "hull.Y_v": -0.4}), old)
    assert not any(words in " ".join(known) for words in ("resistance", "derivatives"))
    pusher = {"L": 110.0, "B": 11.4, "d": 2.8, "C_b": 0.88, "speed": 4.0}
    assert "1.31 m is small" in " ".join(doubts(new_ship(old, "pusher", pusher), old))
    given = doubts(new_ship(old, "pusher", {**pusher, "D_P": 1.4}), old)
    assert "is small" not in " ".join(given)


def test_a_ship_that_is_not_strict_says_so_in_her_file(tmp_path):
    made = dataclasses.replace(_without_form(new_ship("kvlcc2", "b", BARGE)), strict=False)
    path = tmp_path / "b.toml"
    path.write_text(ship_text(made, "given"), encoding="utf-8")
    assert load_ship(path).strict is False


@pytest.mark.parametrize("size", [(80.0, 16.0, 3.0), (61.7, 12.3, 2.7), (57.3, 12.3, 2.3)])
def test_a_box_is_not_fuller_than_a_box_by_rounding(size, tmp_path):
    """C_b of the last two is 1 + 1e-6 in their files, whose numbers have six digits."""
    L, B, d = size
    made = _without_form(new_ship("kvlcc2", "b", {**BARGE, "L": L, "B": B, "d": d}))
    path = tmp_path / "b.toml"
    path.write_text(ship_text(made, "given"), encoding="utf-8")
    assert load_ship(path).hull.volume == pytest.approx(L * B * d, rel=1e-5)


def test_a_full_hull_has_its_centre_near_midship():
    """KVLCC2's 0.035 L forward is none of a hull with C_b 0.95; what is given stays."""
    pusher = {"L": 110.0, "B": 11.4, "d": 2.8, "C_b": 0.95, "speed": 4.0}
    made = new_ship("kvlcc2", "pusher", pusher)
    assert made.hull.x_G == pytest.approx(0.3 * 0.05 * 110.0) and made.form.x_B == made.hull.x_G
    assert "at most 0.3 (1 - C_b) L" in made.estimated["hull.x_G"]
    assert new_ship("kvlcc2", "pusher", {**pusher, "x_G": 2.5}).hull.x_G == 2.5
    assert new_ship("kvlcc2", "box", {**pusher, "C_b": 1.0}).hull.x_G == 0.0
    assert new_ship("kvlcc2", "t", TANKER).estimated["hull.x_G"] == "as kvlcc2, by L"
