"""Every file that a user may write himself, in the encodings of his editor."""

import dataclasses
import json

import numpy as np
import pytest
from ship_gym_agents.gains_files import gains_path
from ship_gym_agents.pid import load_gains

from ship_gym.config import ConfigError
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import load_ship
from ship_gym.surrogates.own import own_data_set
from ship_gym.surrogates.samples import DATA as SAMPLES
from ship_gym.tracks import load_track

MARKED = ("utf-8", "utf-8-sig", "utf-16")
SCENARIO = '# Größe\nbase = "heading_keeping"\nduration = 300.0\n'
TRACK = {
    "type": "Feature",
    "properties": {"units": "m", "name": "Förde"},
    "geometry": {"type": "LineString", "coordinates": [[0, 0], [0, 3000], [2000, 5000]]},
}


def same_ship(path):
    ship = load_ship(path)
    return (ship.hull, ship.rudder, ship.title)


def same_track(path):
    return load_track(path).points.tolist()


def hyperparameters(path):
    pytest.importorskip("stable_baselines3")
    from ship_gym_agents.sb3.config import load_hyperparameters

    return load_hyperparameters("ppo", path)


def ppo_file():
    pytest.importorskip("stable_baselines3")
    from ship_gym_agents.sb3.sections import _FOLDER

    return (_FOLDER / "ppo.toml").read_text(encoding="utf-8")


FILES = {
    "ship.toml": (
        lambda: (DATA / "kvlcc2_model" / "ship.toml").read_text(encoding="utf-8") + "# Größe\n",
        same_ship,
    ),
    "scenario.toml": (lambda: SCENARIO, load_scenario),
    "gains.toml": (
        lambda: gains_path("kcs").read_text(encoding="utf-8") + "# Größe\n",
        lambda path: repr(dataclasses.astuple(load_gains(path))),
    ),
    "hyperparameters.toml": (lambda: ppo_file() + "# Größe\n", hyperparameters),
    "track.geojson": (lambda: json.dumps(TRACK, ensure_ascii=False), same_track),
}


@pytest.mark.parametrize("name", FILES)
def test_marked_files_are_read_and_others_say_what_to_do(tmp_path, name):
    text, read = FILES[name]
    path, found = tmp_path / name, []
    for encoding in MARKED:
        path.write_bytes(text().encode(encoding))
        found.append(read(path))
    assert found[0] == found[1] == found[2]
    for encoding, words in (("cp1252", "not in UTF-8"), ("utf-16-le", "without a byte order mark")):
        path.write_bytes(text().encode(encoding))
        with pytest.raises(ConfigError, match=f"{name}.*{words}.*save (it|the file) as UTF-8"):
            read(path)


def test_samples_exported_by_a_german_excel(tmp_path):
    """The printed points of KCS in semicolons, decimal commas, cp1252 and CRLF."""
    ship = load_ship("kcs_model", surrogate="none")
    original = SAMPLES / "kcs_propeller_rudder_cfd.csv"
    lines = original.read_text(encoding="utf-8").splitlines()
    rows = [line.replace(",", ";").replace(".", ",") for line in lines if line[0] != "#"]
    remarks = [f'"{line} Größe"' + ";" * 8 for line in lines if line[0] == "#"]
    path = tmp_path / "mine.csv"
    path.write_bytes("\r\n".join([*remarks, "# delta_deg: 35,0", *rows, ""]).encode("cp1252"))
    mine, printed = own_data_set(path, ship), own_data_set(original, ship)
    assert mine.box == printed.box and mine.training == printed.training
    a, b = (data.read(*data.choices[0]) for data in (mine, printed))
    np.testing.assert_array_equal(a.X, b.X)
    assert a.values.keys() == b.values.keys()
    for quantity, values in b.values.items():
        np.testing.assert_array_equal(a.values[quantity], values)
