"""Damaged files of text: one clear line each, with the file's name, whatever the damage is."""

import itertools
import json
import re

import pytest
from ship_gym_agents.gains_files import gains_path
from ship_gym_agents.pid import load_gains
from ship_gym_agents.sb3.run_card import read_run_card

from ship_gym.config import LONGEST, ConfigError
from ship_gym.csv_file import read_csv
from ship_gym.evaluation.about import check_about
from ship_gym.evaluation.episodes_table import check_row
from ship_gym.evaluation.headroom import read as read_headroom
from ship_gym.evaluation.run_folder import RunFolder
from ship_gym.evaluation.score import FILE as REFERENCES
from ship_gym.evaluation.score import read_references
from ship_gym.evaluation.suite import load_suite
from ship_gym.keys import Keys
from ship_gym.plain_csv import read_plain_csv
from ship_gym.reading import parsed_toml
from ship_gym.reports.speed_check import load_baseline
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.tracks import load_track

SCENARIO = 'base = "heading_keeping"\nduration = 300.0\n[sea]\nwave_count = 20\n'
SUITE = """name = "mine"
version = "1"
title = "mine"
ships = ["kcs"]
controllers = ["pid"]
[only]
pid = ["kcs"]
[[scenario]]
name = "heading_keeping"
"""
TRACK = json.dumps(
    {
        "type": "Feature",
        "properties": {"units": "m"},
        "geometry": {"type": "LineString", "coordinates": [[0, 0], [0, 3000], [2000, 5000]]},
    }
)
DATA = """# title: t
# source: s
# obtained: o
# conventions: c
J [-],K_T [-]
0.5,0.2
0.6,0.1
"""
VALIDATION = {"success": 1.0, "return": -1.0, "rudder_travel": 5.0, "J_1": None}
CARD = {
    "name": "ppo-heading",
    "status": "running",
    "config": {
        "algorithm": "ppo",
        "scenario": {"task": "heading_keeping", "ship": "kcs"},
        "seed": 0,
        "hyperparameters": {},
    },
    "budget": {"minutes": 1.0, "steps": None},
    "used": 0.5,
    "validation_seeds": [1, 16],
    "measure": {"name": "J_1", "unit": "-"},
    "validations": [VALIDATION],
    "best": VALIDATION,
}
STATE = {
    "samples": 1000,
    "seconds": 5.0,
    "episodes": 16,
    "limit": 4.0,
    "validated": 1.0,
    "validations": [VALIDATION],
}


def read_card(path):
    from ship_gym_agents.sb3.run_card import read_run_card

    return read_run_card(path)


def read_state(path):
    from ship_gym_agents.sb3.run_card import read_run_state

    return read_run_state(path)


def read_ranges(path):
    from ship_gym_agents.training.search_space import load_ranges

    return load_ranges("ppo", path, {})


def read_recipe(path):
    from ship_gym_agents.sb3.config import load_recipe

    return load_recipe(path)


def read_curve(path):
    from ship_gym_agents.training.curves import read_curve

    return read_curve(path)


def numbers(path):
    table = read_plain_csv(path)
    return [table.numbers(name) for name in table.columns]


def references():
    whole = json.loads(REFERENCES.read_text(encoding="utf-8"))
    name = next(iter(whole["cells"]))
    return json.dumps({**whole, "cells": {name: whole["cells"][name]}})


READERS = {
    "scenario.toml": (lambda: SCENARIO, load_scenario),
    "suite.toml": (lambda: SUITE, load_suite),
    "gains.toml": (lambda: gains_path("kcs").read_text(encoding="utf-8"), load_gains),
    "recipe.toml": (lambda: 'algo = "ppo"\nseed = 1\n[training]\ngamma = 0.9\n', read_recipe),
    "track.geojson": (lambda: TRACK, load_track),
    "references.json": (references, read_references),
    "headroom.json": (references, read_headroom.__wrapped__),
    "baseline.json": (lambda: '{"ratios": {"a": 1.0}}', load_baseline),
    "card.json": (lambda: json.dumps(CARD), read_card),
    "state.json": (lambda: json.dumps(STATE), read_state),
    "settings.json": (lambda: '{"seeds": [1]}', lambda path: RunFolder(path.parent).settings()),
    "data.csv": (lambda: DATA, read_csv),
    "history.csv": (lambda: "t [s],x [m]\n0,1\n1,2\n", numbers),
}
DAMAGE = {
    "empty": lambda text: b"",
    "mark only": lambda text: b"\xef\xbb\xbf",
    "half a UTF-16": lambda text: b"\xff\xfe" + text.encode()[:31],
    "zero byte": lambda text: text.encode()[:5] + b"\0" + text.encode()[5:],
    "all bytes": lambda text: bytes(range(256)),
    "nested": lambda text: b"a = " + b"[" * 50_000,
    "nested and closed": lambda text: b"[" * 50_000 + b"]" * 50_000,
    "one long word": lambda text: b"a" * 100_000,
    "many parts of a key": lambda text: b".".join([b"a"] * 20_000) + b" = 1",
    "long number": lambda text: b'{"ratios": ' + b"9" * 5000 + b"}",
    "first line cut": lambda text: text.encode()[3:],
}


HARMLESS = {
    ("recipe.toml", "empty"),
    ("recipe.toml", "mark only"),
    ("history.csv", "first line cut"),
}


@pytest.mark.parametrize(
    ("name", "damage"),
    [case for case in itertools.product(READERS, DAMAGE) if case not in HARMLESS],
)
def test_whatever_a_parser_raises_is_one_line(tmp_path, name, damage):
    text, read = READERS[name]
    path = tmp_path / name
    path.write_bytes(DAMAGE[damage](text()))
    with pytest.raises(ConfigError) as told:
        read(path)
    assert name in str(told.value)
    assert all(len(line) <= LONGEST for line in str(told.value).splitlines())


@pytest.mark.parametrize("name", READERS)
def test_they_are_read_without_damage(tmp_path, name):
    text, read = READERS[name]
    path = tmp_path / name
    path.write_text(text(), encoding="utf-8")
    assert read(path) is not None


HUGE = "1" + "0" * 400
VALUES = [
    # a name or table of another kind
    ("scenario.toml", '"heading_keeping"', "[true]", "scenario = \\[True\\]: must be a name"),
    ("scenario.toml", 'base = "heading_keeping"', "task = {}", "unknown task {}"),
    ("scenario.toml", "duration = 300.0", "duration = 2020-01-02", "duration = .*must be a number"),
    ("scenario.toml", "duration = 300.0", "duration = nan", "duration = nan: must be finite"),
    ("scenario.toml", "duration = 300.0", f"duration = {HUGE}", "duration = an integer of 1329"),
    ("scenario.toml", "duration = 300.0", "duration = 1e-300", "duration = 1e-300: allowed"),
    ("scenario.toml", "wave_count = 20", "wave_count = 0x" + "f" * 5000, "less than 2\\^63"),
    ("scenario.toml", "wave_count = 20", "wave_count = true", "wave_count = True: must be of type"),
    ("scenario.toml", "[sea]\nwave_count = 20", "sea = 7", "sea = 7: must be a table of keys"),
    ("scenario.toml", "wave_count = 20", "drift = 'x'", "unknown drift 'x'"),
    ("suite.toml", 'pid = ["kcs"]', "pid = 7", "only.pid = 7: must be a list"),
    ("suite.toml", 'ships = ["kcs"]', "ships = [[]]", "ships = ..: must be of type str"),
    ("gains.toml", 'ship = "kcs"', "ship = [1]", "ship = .1.: must be of type str"),
    ("gains.toml", "\n[gains]", "\n[[gains]]", "gains = .*: must be a table of keys"),
    ("recipe.toml", "seed = 1", "seed = 'x'", "seed = 'x': must be of type int"),
    ("recipe.toml", "[training]\ngamma = 0.9", "training = 1", "must be a table of keys"),
    ("track.geojson", "[2000, 5000]", f"[{HUGE}, 0]", "way-point 2 = an integer of 1329 bits"),
    ("track.geojson", "[2000, 5000]", "[1e-300, 9]", "way-point 2 = 1e-300"),
    ("track.geojson", '"m"', "{}", "unknown units {}"),
    ("track.geojson", '"LineString"', "[[]]", "holds \\[\\[\\]\\]"),
    ("references.json", '"nothing"', '"nothink"', "did you mean 'nothing'"),
    ("references.json", '"version"', '"versio"', "missing key 'version'"),
    ("headroom.json", '"separates": true', '"separates": 1', "must be of type bool"),
    ("baseline.json", "1.0", "NaN", "NaN is no number of JSON"),
    ("baseline.json", "1.0", HUGE, "ratios.a = an integer of 1329 bits"),
    ("baseline.json", '{"a": 1.0}', "[1.0]", "ratios = \\[1.0\\]: must be a table of keys"),
    ("card.json", '"running"', '"runing"', "status = 'runing':.*did you mean 'running'"),
    ("card.json", '"status"', '"state"', "missing key 'status'"),
    ("card.json", "[1, 16]", "[1]", "validation_seeds = .1.0.: must be two numbers"),
    ("card.json", '"seed": 0', '"seed": -1', "config.seed = -1: allowed is 0 to"),
    ("card.json", '{"minutes": 1.0, "steps": null}', "null", "budget = null: must have a value"),
    ("card.json", '"success": 1.0', '"success": "x"', "validations.0..success = 'x'"),
    ("card.json", "[1, 16]", "[1, 1.5e300]", "validation_seeds.1. = 1.5e\\+300: allowed"),
    ("state.json", '"limit": 4.0, ', "", "missing key 'limit'"),
    ("state.json", '"samples": 1000', '"samples": 10.5', "samples = 10.5: must be a whole number"),
    ("data.csv", "0.6", "9" * 400, "data.csv:7: J = inf is not finite"),
    ("data.csv", "0.6", "1e300", r"data\.csv:7: J = 1e\+300: allowed is 0, or"),
    ("data.csv", "0.6,0.1", "0.6", "data.csv:7: 1 cells, but 2 columns"),
    ("data.csv", "K_T [-]", "J [-]", "data.csv:5: column 'J' is there twice"),
    ("history.csv", "1,2", "1,nan", "history.csv:3: x .m. = nan is not finite"),
    ("history.csv", "1,2", "1", "history.csv:3: 1 cells, but 2 columns"),
    ("history.csv", "1,2", '"1,2', "not a CSV file"),
    ("history.csv", "x [m]", "t [s]", "history.csv:1: column 't .s.' is there twice"),
]


def test_a_card_may_hold_means_that_are_nearly_zero(tmp_path):
    path = tmp_path / "card.json"
    path.write_text(json.dumps({**CARD, "validations": [{**VALIDATION, "J_1": 1e-33}]}))
    assert read_run_card(path)["validations"][0]["J_1"] == 1e-33


@pytest.mark.parametrize(("name", "old", "new", "words"), VALUES)
def test_a_wrong_value_is_named(tmp_path, name, old, new, words):
    text, read = READERS[name]
    path = tmp_path / name
    assert old in text()
    path.write_text(text().replace(old, new), encoding="utf-8")
    with pytest.raises(ConfigError) as told:
        read(path)
    assert name in str(told.value) and re.search(words, str(told.value))
    assert all(len(line) <= LONGEST for line in str(told.value).splitlines())


@pytest.mark.parametrize(
    ("one", "words"),
    [
        ("{ low = 0x" + "f" * 500 + ", high = 1 }", "low = an integer of 2000 bits"),
        ("{ low = 'x', high = 1 }", "low = 'x': must be a number"),
        ("{ choices = 7 }", "choices = 7: must be a list"),
        ("{ low = 0.9, high = 0.99, log = 3 }", "log = 3: must be true or false"),
        ("[1]", "training.gamma = \\[1\\]: must be low, high or choices"),
    ],
)
def test_a_wrong_range_of_a_search_is_named(tmp_path, one, words):
    (tmp_path / "ranges.toml").write_text(f"[training]\ngamma = {one}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=f"ranges.toml: training.gamma.*{words}|{words}"):
        read_ranges(tmp_path / "ranges.toml")


def test_a_curve_may_have_empty_cells_but_no_words(tmp_path):
    file = tmp_path / "curve.csv"
    file.write_text("samples,J_1\n0,\n10,2.5\n", encoding="utf-8")
    assert read_curve(file) == {"samples": [0.0, 10.0], "J_1": [None, 2.5]}
    file.write_text("samples,J_1\n", encoding="utf-8")
    assert read_curve(file) == {}
    file.write_text("samples,J_1\n0,x\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"curve.csv:2: J_1 = 'x' is not a number"):
        read_curve(file)


def test_a_damaged_unit_of_a_benchmark_is_sailed_again(tmp_path):
    folder = RunFolder(tmp_path)
    folder.begin({"seeds": [7]}, fresh=False)
    file = tmp_path / "units" / "00000.json"
    row = {"suite": "mine", "seed": 7, "value": 1e-40, "failed": False, "error": None}
    for seconds, rows, whole in (
        (1.0, [row], True),
        (-1.0, [row], False),
        (1.0, [], False),
        (1.0, [{**row, "seed": 8}], False),
        (1.0, [{**row, "value": "x"}], False),
        (1.0, [{**row, "failed": 0}], False),
        (1.0, [{**row, "valeu": 1.0}], False),
        (1.0, 7, False),
    ):
        file.write_text(json.dumps({"seconds": seconds, "rows": rows}), encoding="utf-8")
        assert (folder.kept(0, [7]) is not None) == whole


def test_a_row_of_an_episode_says_what_is_wrong_with_it():
    with pytest.raises(ConfigError, match=r"00000.json: rows.seed = 1.5: must be of type int64"):
        check_row({"seed": 1.5}, "00000.json")


@pytest.mark.parametrize(
    ("about", "words"),
    [
        ({"controllers": 7}, "results: controllers = 7: must be a table of keys"),
        ({"controllers": {"pid": []}}, r"controllers.pid = \[\]: must be a table of keys"),
        ({"suites": {"a": {"controls": {"b": 1}}}}, "suites.a.controls.b = 1: must be a text"),
        ({"refused": [{"why": "x"}]}, r"missing key 'controller' in refused\[0\]"),
        ({"recordings": {"files": {"a": 1}}}, "recordings.files.a = 1: must be a table"),
        ({"command": []}, r"command = \[\]: must be a text"),
    ],
)
def test_what_results_say_of_themselves_is_checked(about, words):
    with pytest.raises(ConfigError, match=words):
        check_about(about, "results")


def test_what_results_do_not_say_is_left_out():
    about = {"controllers": {"pid": {"named": None}}, "suites": None, "jobs": None}
    assert check_about(about, "results") == {"controllers": {"pid": {}}, "jobs": None}


def test_keys_name_where_they_stand():
    keys = Keys({"a": {"b": 1, "c": "x", "d": [1, "y"]}}, "f.json").table("a")
    assert keys.whole("b") == 1 and keys.text("e", "none") == "none"
    for take, words in (
        (lambda: keys.number("c"), "f.json: a.c = 'x': must be a number"),
        (lambda: keys.numbers("d"), "f.json: a.d[1] = 'y': must be a number"),
        (lambda: keys.known("c", ["y", "z"]), "f.json: a.c = 'x'"),
        (lambda: keys.table("b"), "f.json: a.b = 1: must be a table of keys"),
        (lambda: keys.text("bb"), "f.json: missing key 'bb' in a; did you mean 'b'?"),
        (lambda: keys.whole("b", 2, 3), "f.json: a.b = 1: allowed is 2 to 3"),
    ):
        with pytest.raises(ConfigError) as told:
            take()
        assert words in str(told.value)


def test_keys_of_many_parts_take_no_time():
    """The parser's time grows with the square of the parts of a key."""
    with pytest.raises(ConfigError, match="a key of more than 100 parts"):
        parsed_toml(".".join(["a"] * 50_000) + " = 1", "mine.toml")
    text = "a = [" + "1.5, " * 500 + ']\nb = "' + "..." * 500 + '"\n'
    assert len(parsed_toml(text, "mine.toml")["a"]) == 500
