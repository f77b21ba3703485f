import pytest
from ship_gym_agents.controllers import CONTROLLERS, pretrained

from ship_gym.config import ConfigError
from ship_gym.evaluation import headroom
from ship_gym.evaluation.suite import available_suites, load_suite, load_suites
from ship_gym.scenarios.scenario import available_scenarios
from ship_gym.ships import available_ships

GOOD = """
name = "mine"
version = "1"
title = "Mine"
ships = ["kcs"]
controllers = ["constant", "mine.py:LQR"]

[only]
"mine.py:LQR" = ["kcs"]

[[scenario]]
name = "heading_calm"
tier = "basic"

[[scenario]]
name = "rough.toml"
controllers = ["pid", "mine.py:PI"]
measure = "J_1"
control = "rudder+rpm"
"""


@pytest.fixture
def suite(tmp_path):
    def write(text=GOOD):
        (tmp_path / "mine.toml").write_text(text)
        return tmp_path / "mine.toml"

    return write


# What ShipBench-1 is. Another file is another benchmark: give it another version, do not edit this.
FROZEN = {
    "course": "aca80bf3340044bba1b1aa89826dc3845b32cda0eed08e9c8f141782051b39e4",
    "expert": "342054487daa1fd20420d197201825314df34232f5ca37756b9edd494b557eb2",
    "heading": "790365229a8155ffe982ca4ccd62564bb8a9f8e2ff0834a3994243404b78c86b",
    "manoeuvres": "341b9368bd5af6237675ba9a7849a15de081f2b87c90449f392d6fd4bed9e5dc",
    "track": "937273962da9894d69d6f8b255ac5d0ca5fda2d2e328444cc269bb0b34975d22",
}


def test_standard_suites_are_frozen():
    assert {name: load_suite(name).sha256 for name in available_suites()} == FROZEN


@pytest.mark.parametrize("name", available_suites())
def test_standard_suites_name_what_there_is(name):
    found = load_suite(name)
    assert found.name == name and found.version == "ShipBench-1" and len(found.sha256) == 64
    assert set(found.ships) <= set(available_ships())
    assert {entry.name for entry in found.scenario} <= set(available_scenarios())
    assert all(entry.tier for entry in found.scenario)
    for named in (found.controllers, *(entry.controllers for entry in found.scenario)):
        assert not named or named[0] == "constant"
        assert set(named) <= {*CONTROLLERS, *pretrained()}


def test_a_suite_of_ones_own_counts_its_files_from_its_folder(suite, tmp_path):
    found = load_suite(suite())
    assert [entry.name for entry in found.scenario] == [
        "heading_calm",
        str(tmp_path / "rough.toml"),
    ]
    assert found.controllers == ("constant", f"{tmp_path / 'mine.py'}:LQR")
    assert (found.scenario[1].measure, found.scenario[1].control) == ("J_1", "rudder+rpm")
    assert found.scenario[1].controllers == ("pid", f"{tmp_path / 'mine.py'}:PI")
    assert found.sails(found.controllers[1], "kcs") and found.sails("constant", "kvlcc2")
    assert not found.sails(found.controllers[1], "kvlcc2")


def test_all_is_every_suite_once(suite):
    names = [one.name for one in load_suites("all")]
    assert names == available_suites()
    assert load_suites(["track", "all"])[0].name == "track"
    assert len(load_suites(["track", "all", "track"])) == len(names)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('tier = "basic"', 'tier = "basi"', "did you mean 'basic'"),
        ('tier = "basic"', 'teir = "basic"', "unknown key 'teir'; did you mean 'tier'"),
        ('title = "Mine"', "", "missing key 'title'"),
        ('title = "Mine"', 'kind = "episode"\ntitle = ""', "did you mean 'episodes'"),
        ('["kcs"]\ncon', '["kcs", "kcs"]\ncon', "ships: 'kcs' is there twice"),
        ('["kcs"]\ncon', "[]\ncon", "ships: at least one is needed"),
        ('["kcs"]\ncon', '"kcs"\ncon', "must be a list"),
        ('name = "rough.toml"', 'name = "heading_calm"', ""),
        ('"mine.py:LQR" = ', "pd = ", "controller in [only] of suite mine: 'pd'"),
        ('["pid", "mine', '["pid", "pid", "mine', "'pid' is there twice"),
        ('name = "rough.toml"', "", "missing key 'name'"),
        ("[[scenario]]", "[[scenari]]", "unknown key 'scenari'"),
        ("version", "version = ", "not a valid TOML file"),
    ],
)
def test_wrong_files_are_refused(suite, old, new, words):
    if words:
        with pytest.raises(ConfigError) as caught:
            load_suite(suite(GOOD.replace(old, new)))
        assert words in str(caught.value)
    else:  # the same scenario with another control is another entry
        assert len(load_suite(suite(GOOD.replace(old, new))).scenario) == 2


def test_unknown_suites_are_refused(suite):
    with pytest.raises(ConfigError, match="unknown suite 'hedaing'; did you mean 'heading'"):
        load_suites("hedaing")
    with pytest.raises(ConfigError, match=r"none\.toml: no such file"):
        load_suites("none.toml")
    path = suite(GOOD.replace('"mine"\n', '"track"\n', 1))
    with pytest.raises(ConfigError, match="suites: 'track' is there twice"):
        load_suites(["track", path])


def test_standard_suites_hold_only_what_separates():
    """Best and second-best, or reference and optimum, differ by more than their interval."""
    cells = headroom.read()
    for suite in map(load_suite, available_suites()):
        for entry in suite.scenario:
            for ship in entry.ships or suite.ships:
                cell = cells[f"{entry.name}/{ship}"]
                assert cell["separates"], f"{entry.name}/{ship}"
                assert cell["measure"] == (entry.measure or cell["measure"])
