import shutil
from pathlib import Path

import gymnasium as gym
import pytest

import ship_gym
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import attach_surrogate
from ship_gym.surrogates.samples import DATA as POINTS
from ship_gym.tables import Table

HEADING = "ShipGym/HeadingKeeping-v0"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A copy of the KCS model in ``mine`` and its printed points as one's own."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(DATA / "kcs_model", "mine")
    shutil.copy(POINTS / "kcs_propeller_rudder_cfd.csv", "points.csv")


def test_the_recipe(folder, recipe, sail):
    env = sail(recipe("CFD points")["env"])
    assert env.unwrapped.scenario.surrogate == "cfd"
    assert "cfd" in ship_gym.available_surrogates("mine/ship.toml")
    again = ship_gym.load_ship("mine/ship.toml", surrogate="cfd")
    assert again.surrogate_name == "cfd" and again.surrogate.card["made_for"]["ship"] == "mine"


def test_a_table_on_a_ship_in_memory(folder, recipe, sail):
    recipe("CFD points")
    table = Table.load("mine/surrogate_cfd.npz")
    for ship in ("mine/ship.toml", Path("mine/ship.toml"), ship_gym.load_ship("kcs_model")):
        made = attach_surrogate(ship, table, "cfd")
        assert made.surrogate_name == "cfd"
    sail(gym.make(HEADING, ship=made))


def test_an_export_of_a_german_excel_gives_the_same_table(folder, recipe):
    recipe("CFD points")
    plain = Table.load("mine/surrogate_cfd.npz").values
    lines = Path("points.csv").read_text("utf-8").splitlines()
    rows = [line.replace(",", ";").replace(".", ",") for line in lines if line[0] != "#"]
    remarks = [f'"{line}"' + ";" * 8 for line in lines if line[0] == "#"]
    Path("points.csv").write_bytes("\r\n".join([*remarks, *rows, ""]).encode("cp1252"))
    recipe("CFD points")
    assert (Table.load("mine/surrogate_cfd.npz").values == plain).all()
