import shutil
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import pytest
from ship_gym_agents import make_controller
from ship_gym_agents.gains_files import gains_path
from ship_gym_agents.pid import PID
from ship_gym_agents.tuning import is_tuned

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.evaluation import rollout
from ship_gym.manoeuvres import imo_limits, turning_circle
from ship_gym.seakeeping.hull_form import parametric_mesh
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import available_variants, load_ship

ROOT = Path(__file__).resolve().parents[2]
HEADING = "ShipGym/HeadingKeeping-v0"


def changed(path, *pairs):
    """Replace some numbers of a ship file."""
    text = path.read_text("utf-8")
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, "utf-8")
    return path


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """``mine/ship.toml`` alone, with other numbers, in an empty working folder."""
    monkeypatch.chdir(tmp_path)
    Path("mine").mkdir()
    shutil.copy(DATA / "kvlcc2_model" / "ship.toml", "mine")
    return changed(Path("mine/ship.toml"), ("B = { value = 1.27", "B = { value = 1.40"))


def test_the_recipe(recipe, sail):
    env = sail(recipe("a ship")["env"])
    assert env.unwrapped.scenario.ship == "mine/ship.toml"
    changed(Path("mine/ship.toml"), ("x_G = { value = 0.25", "x_G = { value = 0.20"))
    sail(gym.make(HEADING, ship="mine/ship.toml"))
    assert load_ship("mine/ship.toml").hull.x_G == 0.20


def test_another_hull_needs_its_own_wave_table(recipe, sail):
    recipe("a ship")
    changed(Path("mine/ship.toml"), ("B = { value = 1.27", "B = { value = 1.40"))
    words = (
        r"waves.npz was made for kvlcc2_model with B / L = 0.1814; mine has 0.2000; compute it: "
        r"ship-gym build-wave-table --ship SHIP_FILE, or sail without waves"
    )
    with pytest.raises(ConfigError, match=words):
        sail(gym.make(HEADING, ship="mine/ship.toml"))
    sail(gym.make(HEADING, ship="mine/ship.toml", scenario="heading_slow_disturbance"))


def test_a_ship_file_alone(mine, sail):
    with pytest.raises(ConfigError, match=r"mine has no wave table, which .* sail without waves"):
        sail(gym.make(HEADING, ship="mine/ship.toml"))
    sail(gym.make(HEADING, ship="mine/ship.toml", scenario="heading_slow_disturbance"))
    calm = {"sea.states": [], "sea.gusts": False}
    sail(gym.make(HEADING, ship="mine/ship.toml", overrides=calm))


def test_its_wave_table_lies_beside_it(mine):
    """That of its name goes before ``waves.npz``, so two ship files may share a folder."""
    (mine.parent / "other.toml").write_bytes(mine.read_bytes())
    (mine.parent / "waves.npz").write_bytes(b"")
    (mine.parent / "waves_mine.npz").write_bytes(b"")
    assert load_ship(mine).wave_table.endswith("waves_mine.npz")
    other = load_ship(mine.parent / "other.toml")
    assert other.name == "other" and other.wave_table.endswith("waves.npz")


@pytest.mark.slow
def test_a_wave_table_of_its_own(mine, sail):
    pytest.importorskip("capytaine")
    pytest.importorskip("joblib")
    changed(mine, ("volume = { value = 3.27", "volume = { value = 3.605"))
    script = ROOT / "scripts" / "build_wave_table.py"
    options = ["--quick", "--panels", "200", "--jobs", "1"]
    command = [sys.executable, script, "--ship", "mine/ship.toml", *options]
    subprocess.run(command, check=True)
    assert [path.name for path in mine.parent.glob("*.npz")] == ["waves_mine.npz"]
    assert not Path("runs").exists()
    sail(gym.make(HEADING, ship="mine/ship.toml"))
    assert ship_gym.load_wave_table(mine).table.card["ship"] == "mine"


@pytest.mark.parametrize("kind", [str, Path], ids=["str", "Path"])
def test_text_and_path_work_alike(mine, kind):
    name = kind("mine/ship.toml")
    ship = load_ship(name)
    assert ship.name == "mine" and ship.hull.B == 1.40
    assert load_ship(ship) is ship
    assert ship_gym.available_surrogates(name) == ["none", "beaufoy"]
    assert available_variants(name) == []
    with pytest.raises(ConfigError, match="mine has no wave table"):
        ship_gym.load_wave_table(name)
    sim = ship_gym.ShipSim(name, n=2)
    assert sim.ships[0] is sim.ships[1] and sim.ships[0].name == "mine"
    fleet = ship_gym.ShipSim([name, "kcs", ship, name], n=4)
    assert [s.name for s in fleet.ships] == ["mine", "kcs", "mine", "mine"]
    assert fleet.ships[0] is fleet.ships[3]
    assert ship_gym.self_propulsion(name, 1.0) == ship_gym.self_propulsion(ship, 1.0)
    assert turning_circle(name).advance == turning_circle(ship).advance
    assert imo_limits(name, 1.179) == imo_limits(ship, 1.179)
    assert ship_gym.scaled(name, 320.0).name == "mine at 320 m"
    assert parametric_mesh(name).report == parametric_mesh(ship).report
    assert not is_tuned(PID, name, {})


def test_names_and_paths_that_are_none():
    with pytest.raises(ConfigError, match=r"a ship file ends in \.toml, as in 'mine/ship.toml'"):
        load_ship("mine/ship")
    with pytest.raises(ConfigError, match="unknown ship 'kcss'; did you mean 'kcs'"):
        load_ship(Path("kcss"))
    assert load_ship(Path("kcs")) is load_ship("kcs")
    with pytest.raises(ConfigError, match="no such file"):
        ship_gym.available_surrogates(Path("none/ship.toml"))
    with pytest.raises(ConfigError, match="ship = 5: must be a name, the path of a ship file"):
        load_ship(5)
    with pytest.raises(ConfigError, match="surrogate = 'gp': the ship given as an object"):
        load_ship(load_ship("kcs"), surrogate="gp")


@pytest.mark.parametrize("place", ["kvlcc2_model/ship.toml", "kvlcc2_model.toml"])
def test_a_copy_is_not_taken_for_the_ship_of_the_package(mine, place):
    """It would sail with the gains that were tuned for the other one."""
    path = Path("elsewhere") / place
    path.parent.mkdir(parents=True)
    path.write_bytes(mine.read_bytes())
    assert load_ship(path).name == "own_kvlcc2_model"
    assert load_ship(DATA / "kvlcc2_model" / "ship.toml").name == "kvlcc2_model"
    calm = {"scenario": "heading_slow_disturbance", "seeds": [2_000_000], "ship": str(path)}
    with pytest.raises(ConfigError, match="no pid gains for ship 'own_kvlcc2_model'"):
        rollout(PID(), **calm)


def test_the_pid_says_how_to_get_gains_and_takes_them_from_a_file(mine):
    calm = {"scenario": "heading_slow_disturbance", "seeds": [2_000_000], "ship": "mine/ship.toml"}
    words = r"no pid gains for ship 'mine' .*ship-gym tune --ship NAME_OR_FILE --out mine.toml"
    with pytest.raises(ConfigError, match=words):
        rollout(PID(), **calm)
    shutil.copy(gains_path("kvlcc2_model"), "mine.toml")
    sailed = rollout(make_controller("mine.toml"), **calm)
    assert len(sailed.episodes) == 1


def test_data_files_count_from_the_ship_file(tmp_path, monkeypatch):
    """Copied alone, KCS lacks its open-water points and then its surrogate: each is named."""
    monkeypatch.chdir(tmp_path)
    mine = tmp_path / "far" / "mine"
    mine.mkdir(parents=True)
    shutil.copy(DATA / "kcs_model" / "ship.toml", mine)
    with pytest.raises(ConfigError, match=r"open_water.points = 'kp505_open_water.csv': no such"):
        load_ship(mine / "ship.toml")
    shutil.copy(DATA / "kcs_model" / "kp505_open_water.csv", mine)
    with pytest.raises(ConfigError, match=r"surrogate.default = 'G2_SA': no surrogate_G2_SA.npz"):
        load_ship("far/mine/ship.toml")
    assert load_ship("far/mine/ship.toml", surrogate="none").name == "mine"
    shutil.copy(DATA / "kcs_model" / "surrogate_G2_SA.npz", mine)
    assert load_ship("far/mine/ship.toml").surrogate_name == "G2_SA"


def test_a_file_that_scales_another_one(mine):
    """The path of the other counts from the file, and a change of it is seen."""
    full = Path("full") / "ship.toml"
    full.parent.mkdir()
    full.write_text('scaled_from = "../mine/ship.toml"\nlength = { value = 320.0, unit = "m" }\n')
    assert load_ship(full).name == "full" and load_ship(full).hull.B == pytest.approx(64.0)
    assert ship_gym.available_surrogates(full) == ["none", "beaufoy"]
    changed(mine, ("B = { value = 1.40", "B = { value = 1.33"))
    assert load_ship(full).hull.B == pytest.approx(60.8)
    full.write_text('scaled_from = "ship.toml"\nlength = { value = 320.0, unit = "m" }\n')
    with pytest.raises(
        ConfigError, match=r"scaled_from goes in a circle: .*ship.toml -> .*ship.toml"
    ):
        load_ship(full)
    other = Path("full") / "other.toml"
    other.write_text('scaled_from = "ship.toml"\nlength = { value = 32.0, unit = "m" }\n')
    full.write_text('scaled_from = "other.toml"\nlength = { value = 320.0, unit = "m" }\n')
    with pytest.raises(ConfigError, match=r"circle: .*ship.toml -> .*other.toml -> .*ship.toml"):
        load_ship(full)
