import dataclasses
import math
import pickle

import pytest

from ship_gym.config import ConfigError
from ship_gym.ships import available_ships, load_ship, scaled
from ship_gym.ships.files import DATA
from ship_gym.ships.particulars import HullForm
from ship_gym.ships.plausible import checked
from ship_gym.ships.scaling import _POWERS

WITH_FORM = [name for name in available_ships() if load_ship(name).form is not None]


def test_every_field_has_a_meaning_and_a_unit_that_scales():
    for field in dataclasses.fields(HullForm):
        assert field.metadata["meaning"] and field.metadata["unit"] in _POWERS


def test_the_ships_of_the_package_have_a_form():
    assert {"kcs", "kcs_model", "kvlcc2", "kvlcc2_model", "onrt", "onrt_model"} <= set(WITH_FORM)


@pytest.mark.parametrize("name", WITH_FORM)
def test_every_number_has_a_source_or_a_reason(name):
    ship = load_ship(name)
    for field in dataclasses.fields(HullForm):
        if field.name != "trim":  # 0 if it is not in the file
            assert ship.sources[f"form.{field.name}"].strip()
    assert pickle.loads(pickle.dumps(ship)).form == ship.form


@pytest.mark.parametrize("name", WITH_FORM)
def test_centre_of_buoyancy_below_the_centre_of_gravity(name):
    """A ship on even keel; printed numbers are rounded."""
    ship = load_ship(name)
    assert ship.form.x_B == pytest.approx(ship.hull.x_G, abs=0.001 * ship.hull.L)


def test_printed_numbers_arrive_in_si_and_scale():
    model, ship = load_ship("kcs_model"), load_ship("kcs")
    assert model.form.KG == 0.19 and model.form.k_xx == 0.171
    assert model.form.x_keel == pytest.approx(-0.455 * 3.057)
    ratio = 230.0 / 3.057
    assert ship.form.GM == pytest.approx(0.6, rel=0.001)  # SIMMAN 2020 case 3.2
    assert ship.form.C_wp == model.form.C_wp and ship.form.trim == 0.0
    assert ship.form.k_yy == pytest.approx(0.764 * ratio)
    back = scaled(ship, 3.057, friction_correction=False).form
    for field in dataclasses.fields(HullForm):
        value = getattr(model.form, field.name)
        assert getattr(back, field.name) == pytest.approx(value, abs=1e-15)


def test_onrt_radii_of_simman():
    ship = load_ship("onrt")
    assert ship.form.GM == pytest.approx(2.068, rel=1e-3)
    assert ship.form.k_xx == pytest.approx(0.344 * ship.hull.B, rel=1e-3)


def ship_file(tmp_path, change):
    """kcs_model's file with its text changed, beside its open-water points."""
    text = (DATA / "kcs_model" / "ship.toml").read_text().replace('default = "G2_SA"', "")
    points = "kp505_open_water.csv"
    (tmp_path / points).write_text((DATA / "kcs_model" / points).read_text())
    (tmp_path / "ship.toml").write_text(change(text))
    return str(tmp_path / "ship.toml")


def test_the_section_is_optional(tmp_path):
    def without(text):
        start = text.index("[form]")
        return text[:start] + text[text.index("[propeller]") :]

    path = ship_file(tmp_path, without)
    assert load_ship(path).form is None
    assert scaled(load_ship(path), 30.0).form is None


def test_a_scaled_ship_file_may_replace_a_number(tmp_path):
    lines = ['scaled_from = "kcs_model"', 'length = { value = 230.0, unit = "m" }', "[form]"]
    path = tmp_path / "ship.toml"
    path.write_text("\n".join([*lines, 'KG = { value = 14.0, unit = "m" }']))
    assert load_ship(str(path)).form.KG == 14.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("C_wp =", "C_vp =", "unknown key form.'C_vp'.*C_wp"),
        ("L_E =", "# L_E =", "missing key form.'L_E'"),
        (
            "KG = { value = 0.19,",
            "KG = { value = 19.0,",
            "form.KG = 19 m = 44.39 B: allowed is 0 to 1 B, here 0 to 0.428 m",
        ),
        ("C_m = { value = 0.985", "C_m = { value = 98.5", "form.C_m = 98.5: allowed is 0.4 to 1"),
        (
            "k_yy = { value = 0.764",
            "k_yy = { value = 76.4",
            "form.k_yy = 76.4 m = 24.99 L: allowed is",
        ),
        ("a_transom = { value = 0.01", "a_transom = { value = 0.0", "a transom needs both"),
    ],
)
def test_bad_numbers_are_refused(tmp_path, old, new, message):
    with pytest.raises(ConfigError, match=message):
        load_ship(ship_file(tmp_path, lambda text: text.replace(old, new)))


def test_checks_reach_the_scaled_ship():
    ship = load_ship("kcs")
    bad = dataclasses.replace(ship, form=dataclasses.replace(ship.form, GM=math.nan))
    with pytest.raises(ConfigError, match=r"form\.GM = nan"):
        checked(bad)
