"""A wave table knows its hull: one of another hull in a ship's folder is refused, in one line."""

import dataclasses
import shutil

import pytest

from ship_gym.config import ConfigError
from ship_gym.sea.wave_hull import check_facts, differences, hull_facts
from ship_gym.sea.wave_response import wave_table_of
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import load_ship
from ship_gym.ships.scaling import scaled


def told(ship, card):
    return next(differences(card, ship), "")


@pytest.fixture
def kvlcc2():
    return load_ship("kvlcc2_model")


def test_the_same_hull_at_any_scale(kvlcc2):
    card = {"ship": "mine", "made_for": hull_facts(kvlcc2, drawn=True)}
    assert told(kvlcc2, card) == told(scaled(kvlcc2, 320.0), card) == ""


@pytest.mark.parametrize(
    ("part", "changes", "words"),
    [
        ("hull", {"B": 1.40}, "B / L = 0.1814; mine has 0.2000"),
        ("hull", {"d": 0.50}, "d / L = 0.0657; mine has 0.0714"),
        ("hull", {"volume": 3.0}, "C_b = 0.7996; mine has 0.7336"),
        ("form", {"C_wp": 0.80}, "form.C_wp = 0.8900; mine has 0.8000"),
        ("form", {"x_F": -0.2}, "form.x_F / L = 0.0050; mine has -0.0286"),
        ("form", {"k_xx": 0.40}, "form.k_xx / L = 0.0726; mine has 0.0571"),
    ],
)
@pytest.mark.parametrize("older", [False, True])
def test_another_hull_is_named(kvlcc2, part, changes, words, older):
    """Also by a card of the package that has L, B and d only: the rest is that of its ship."""
    made = hull_facts(kvlcc2, drawn=True)
    if older:
        made = {key: made[key] for key in ("L", "B", "d")}
    card = {"ship": "kvlcc2_model" if older else "yours", "made_for": made}
    other = dataclasses.replace(
        kvlcc2, name="mine", **{part: dataclasses.replace(getattr(kvlcc2, part), **changes)}
    )
    assert told(other, card) == words


def test_of_a_hull_from_a_file_the_form_counts_by_its_mass_only(kvlcc2):
    card = {"ship": "mine", "made_for": hull_facts(kvlcc2, drawn=False)}
    assert set(card["made_for"]["form"]) == {"KG", "GM", "k_xx", "k_yy"}
    form = dataclasses.replace(kvlcc2.form, C_wp=0.8)
    assert told(dataclasses.replace(kvlcc2, form=form), card) == ""
    assert "form.GM" in told(
        dataclasses.replace(kvlcc2, form=dataclasses.replace(form, GM=0.3)), card
    )
    assert told(dataclasses.replace(kvlcc2, form=None), card) == ""


def test_the_table_of_another_ship_in_the_folder_is_refused_in_one_line(kvlcc2):
    """DTC's hull with KVLCC2's table: today's drift would be off by a factor."""
    table = str(DATA / "kvlcc2_model" / "waves.npz")
    dtc = dataclasses.replace(load_ship("dtc_model"), name="mine", wave_table=table)
    with pytest.raises(ConfigError, match=r"made for kvlcc2_model with B / L .* build-wave-table"):
        wave_table_of(dtc)
    hull = dataclasses.replace(kvlcc2.hull, volume=2.6)
    slim = dataclasses.replace(kvlcc2, name="mine", hull=hull)
    with pytest.raises(ConfigError, match=r"with C_b = 0\.7996; mine has 0\.6358") as error:
        wave_table_of(slim)
    assert len(str(error.value).splitlines()) == 1
    assert wave_table_of(kvlcc2).card["ship"] == "kvlcc2_model"


def test_a_table_that_is_computed_anew_is_read_by_who_loads_the_ship_again(tmp_path):
    """In one process, as in a notebook: first another hull's table, then her own, then none."""
    model = DATA / "kvlcc2_model"
    own, table = tmp_path / "mine.toml", tmp_path / "waves_mine.npz"
    shutil.copy(model / "ship.toml", own)
    shutil.copy(DATA / "dtc_model" / "waves.npz", table)
    with pytest.raises(ConfigError, match="made for dtc_model"):
        wave_table_of(load_ship(own))
    shutil.copy(model / "waves.npz", table)
    ship = load_ship(own)
    first = wave_table_of(ship)
    assert first.card["ship"] == "kvlcc2_model" and wave_table_of(load_ship(own)) is first
    shutil.copy(DATA / "dtc_model" / "waves.npz", table)
    assert wave_table_of(ship) is first  # who sails keeps hers
    with pytest.raises(ConfigError, match="made for dtc_model"):
        wave_table_of(load_ship(own))
    table.unlink()
    assert wave_table_of(ship) is first
    with pytest.raises(ConfigError, match="has no wave table"):
        wave_table_of(load_ship(own))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"volume": -1.0}, "made_for.volume = -1.0"),
        ({"form": 3}, "made_for.form = 3"),
        ({"form": {"C_m": "x"}}, "must be a number"),
    ],
)
def test_facts_that_are_none_are_refused(kvlcc2, changes, words):
    with pytest.raises(ConfigError, match=words):
        check_facts({**hull_facts(kvlcc2, drawn=True), **changes})
