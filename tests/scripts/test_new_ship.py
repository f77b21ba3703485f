import json
import math

import pytest
from ship_gym_agents.cli import load_verb

from ship_gym.config import ConfigError
from ship_gym.ships.loader import load_ship

TANKER = ("--like kvlcc2 --L 246 --B 46 --d 14.5 --C_b 0.82 --speed 7.7").split()
BARGE = ("--like kvlcc2 --L 80 --B 16 --d 3 --C_b 1 --speed 4 --x_G 0").split()


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def new_ship(*words):
    load_verb("new-ship").main([*words], standalone_mode=False)


def test_it_writes_a_folder_and_says_what_to_do_next(folder, capsys):
    new_ship("tanker", *TANKER)
    said = capsys.readouterr().out
    assert "build-wave-table --ship tanker/ship.toml --quick" in said
    ship = load_ship("tanker/ship.toml")
    assert ship.name == "tanker" and ship.form is not None
    with pytest.raises(ConfigError, match="is there already; see --force"):
        new_ship("tanker", *TANKER)
    new_ship("tanker", *TANKER, "--force", "--set", "form.KG=12.5", "hull.k_zz=60", "--json")
    facts = json.loads(capsys.readouterr().out)
    assert "form.KG" not in facts["estimated"] and "hull.Y_v" in facts["estimated"]
    assert load_ship("tanker/ship.toml").hull.k_zz == 60.0


def test_a_hull_that_cannot_be_drawn_needs_a_file(folder, capsys):
    new_ship("barge", *BARGE)
    said = capsys.readouterr().out
    assert "no [form]" in said and "--mesh HULL_FILE" in said
    assert load_ship("barge/ship.toml").form is None


def test_nothing_is_written_where_something_is_wrong(folder):
    with pytest.raises(ConfigError, match="missing --L, --B, --d, --speed, --C_b"):
        new_ship("mine")
    with pytest.raises(ConfigError, match=r"allowed is 0\.05 to 0\.5 L"):
        new_ship("mine", *TANKER, "--B", "146")
    with pytest.raises(ConfigError, match="no ship does this"):  # she circles on the spot
        new_ship("mine", *BARGE, "--L", "60")
    assert list(folder.iterdir()) == []


def test_a_ship_like_no_other_is_written_if_she_is_meant(folder, capsys):
    with pytest.raises(ConfigError, match="if it is meant: --no-strict"):
        new_ship("broad", *BARGE, "--L", "60")
    new_ship("broad", *BARGE, "--L", "60", "--no-strict")
    said = capsys.readouterr().out
    assert "doubtful: hull derivatives: regressions at C_b 1.00" in said
    assert not load_ship("broad/ship.toml").strict
    first = (folder / "broad" / "ship.toml").read_text().splitlines()[0]
    assert first.startswith("# doubtful: resistance: C_b 1.00, kvlcc2's 0.80; her form makes more")


def test_units_of_a_brochure(folder, capsys):
    new_ship("knots", *TANKER, "--speed", "15kn", "--set", "gear.delta_max=45deg", "--json")
    assert json.loads(capsys.readouterr().out)["doubtful"] == []
    ship = load_ship("knots/ship.toml")
    assert ship.speed == pytest.approx(15 * 1852 / 3600, rel=1e-5)
    assert ship.gear.delta_max == pytest.approx(math.pi / 4, rel=1e-5)
    with pytest.raises(ConfigError) as error:
        new_ship("feet", *TANKER, "--L", "807ft", "--speed", "15mph")
    assert "--L = '807ft': must be a number [m]" in str(error.value)
    assert "--speed = '15mph': must be a number [m/s]" in str(error.value)
