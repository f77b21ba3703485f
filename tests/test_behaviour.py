"""Own ships sail a few short runs before anything uses them; what no ship does is refused."""

import dataclasses
import math

import gymnasium as gym
import pytest

from ship_gym import behaviour
from ship_gym.behaviour import RUNS, by_size, check_behaviour, findings, sailed
from ship_gym.config import ConfigError
from ship_gym.manoeuvres import turning_circle
from ship_gym.ships import loader
from ship_gym.ships.files import DATA, available_ships
from ship_gym.ships.loader import available_surrogates, available_variants, load_ship
from ship_gym.simulation import ShipSim, _Trial

pytestmark = pytest.mark.filterwarnings("ignore::ship_gym.config.ImplausibleShip")
KVLCC2 = load_ship("kvlcc2_model")


def mine(ship, section, **changes):
    """A ship of an own file with ``strict = false``: not one of the package's names."""
    changed = dataclasses.replace(getattr(ship, section), **changes)
    return dataclasses.replace(ship, name="mine", strict=False, **{section: changed})


@pytest.mark.parametrize("name", available_ships())
def test_the_ships_of_the_package_behave(name):
    assert findings(load_ship(name), _Trial) == ()


@pytest.mark.slow
@pytest.mark.parametrize("name", available_ships())
def test_so_do_their_hulls_and_surrogates(name):
    for surrogate in available_surrogates(name):
        assert findings(load_ship(name, surrogate=surrogate), _Trial) == (), surrogate
    for variant in available_variants(name):
        assert findings(load_ship(name, variant=variant), _Trial) == (), variant


def test_the_nearest_ships_of_the_package_are_those_that_the_limits_name():
    """Figures beside the limits in the module."""
    measured = {}
    for name in available_ships():
        ship = load_ship(name)
        sim = _Trial(ship, len(RUNS))
        sim.reset(0, speed=ship.speed)
        sim.set_interval(behaviour._EVERY * ship.hull.L / ship.speed)
        measured[name] = by_size(ship, sailed(ship, sim))
    early = behaviour._EARLY
    off = {name: math.degrees(abs(m.turned[early, :3]).max()) for name, m in measured.items()}
    assert max(off, key=off.get) == "kvlcc2_model" and off["kvlcc2_model"] == pytest.approx(8, 0.1)
    turn = {name: math.degrees(m.turned[early, 3:5].min()) for name, m in measured.items()}
    assert min(turn, key=turn.get) == "s175" and turn["s175"] == pytest.approx(67, 0.02)
    wide = {
        name: (2.0 * m.speed[-1, 14:] / abs(m.r[-1, 14:])).min() for name, m in measured.items()
    }
    assert min(wide, key=wide.get) == "dtc_model" and wide["dtc_model"] == pytest.approx(2.2, 0.02)
    yaw = {name: abs(m.r[:, 5:7]).max() for name, m in measured.items()}
    assert max(yaw, key=yaw.get) == "onrt_model" and yaw["onrt_model"] == pytest.approx(0.48, 0.02)
    bare = load_ship("onrt_model", surrogate="none")
    sim = _Trial(bare, len(RUNS))
    sim.reset(0, speed=bare.speed)
    sim.set_interval(behaviour._EVERY * bare.hull.L / bare.speed)
    yaw = abs(by_size(bare, sailed(bare, sim)).r[:, 5:7]).max()
    assert yaw == pytest.approx(0.74, 0.02) and behaviour._MOST_YAW > 2.0 * yaw
    fast = {name: m.speed[:, 5:9].max() for name, m in measured.items()}
    assert max(fast, key=fast.get) == "kcs_model" and fast["kcs_model"] == pytest.approx(1.12, 0.01)
    assert max(m.speed[:, :3].max() for m in measured.values()) < 1.001
    assert all((m.energy[1:, 9:14] < m.energy[:-1, 9:14]).all() for m in measured.values())


USES = {
    "environment": lambda ship: gym.make("ShipGym/HeadingKeeping-v0", ship=ship),
    "vector": lambda ship: gym.make_vec("ShipGym/TrackFollowing-v0", 2, ship=ship),
    "manoeuvre": turning_circle,
}
HULL, RUDDER = KVLCC2.hull, KVLCC2.rudder
IMPOSSIBLE = {
    "turns the wrong way": (("rudder", {"epsilon": -1.0}), "75 deg to the OTHER side"),
    "sucked into drift": (("hull", {"Y_v": -HULL.Y_v}), "held 3 deg across the flow"),
    "turns on by herself": (("hull", {"N_r": -HULL.N_r}), "146 deg off her course"),
    "spins": (
        ("rudder", {"x_R": 45.7 * RUDDER.x_R}),
        r"she spins at r L/U0 = 1.\d+; allowed is up",
    ),
    "rudder at the bow": (("rudder", {"x_R": -RUDDER.x_R}), "10 deg to the OTHER side"),
    "spins by her hull": (("rudder", {"a_H": 90.0}), "she spins at"),
    "cannot go": (("propeller", {"t_P": 0.95}), "cannot hold 1.179 m/s"),
    "explodes": (("propeller", {"D": 9.86}), "no finite number .* in 16 of 16 runs"),
}


@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_what_no_ship_does_is_refused(what, monkeypatch):
    """Also what the ranges of single numbers refuse, which are off here."""
    monkeypatch.setattr(loader, "checked", lambda ship: ship)
    (section, changes), words = IMPOSSIBLE[what]
    with pytest.raises(ConfigError, match=f"mine: .*{words}"):
        ShipSim(mine(KVLCC2, section, **changes))


@pytest.mark.parametrize(
    ("area", "lift", "angle"), [(1.0, 1.3, 45), (1.0, 1.5, 45), (1.2, 1.5, 70)]
)
@pytest.mark.parametrize("name", ["kcs", "s175", "kvlcc2"])
def test_a_rudder_of_high_lift_may_turn_her_on_the_spot(name, area, lift, angle):
    """Becker's and Schilling's: within the ranges, and with next to no speed ahead in the turn."""
    ship = load_ship(name, surrogate="none")
    rudder = dataclasses.replace(
        ship.rudder, A_R=area * ship.rudder.A_R, f_alpha=lift * ship.rudder.f_alpha
    )
    gear = dataclasses.replace(ship.gear, delta_max=math.radians(angle))
    ShipSim(dataclasses.replace(ship, name="mine", rudder=rudder, gear=gear))


def test_a_circle_below_a_length_is_asked_about():
    """Within the ranges, but no ship's at 35 deg of rudder, unless her file says that it is."""
    rudder = dataclasses.replace(RUDDER, A_R=4.0 * RUDDER.A_R, f_alpha=5.0)
    bad = dataclasses.replace(KVLCC2, name="mine", rudder=rudder)
    with pytest.raises(
        ConfigError, match=r"35 deg of rudder to .*(astern|L wide; allowed is from 1)"
    ):
        ShipSim(bad)
    ShipSim(dataclasses.replace(bad, strict=False))


def test_a_file_that_is_not_strict_is_not_let_off(tmp_path):
    file = tmp_path / "mine.toml"
    text = (DATA / "kvlcc2_model" / "ship.toml").read_text("utf-8")
    assert "N_r = -0.049" in text
    file.write_text("strict = false\n" + text.replace("N_r = -0.049", "N_r = 0.049"), "utf-8")
    load_ship(file)  # to look at her
    words = r"mine: no ship does this: held in a turn of r L/U0 = 0.1: her hull turns on by itself"
    for use in USES.values():
        with pytest.raises(ConfigError, match=words):
            use(str(file))


def test_a_ship_wins_no_energy_by_drifting():
    ship = load_ship("onrt_model")
    bad = mine(ship, "hull", Y_vvv=-ship.hull.Y_vvv)
    with pytest.raises(ConfigError, match=r"drifting: her energy rises by \S+ % without thrust"):
        ShipSim(bad)


@pytest.mark.parametrize("name", ["kcs", "onrt_model"])
def test_a_flipped_sign_of_damping_is_found_also_where_rudders_hide_it(name):
    hull = load_ship(name).hull
    for symbol in ("Y_v", "N_r"):
        bad = mine(load_ship(name), "hull", **{symbol: -getattr(hull, symbol)})
        assert any(symbol in line and "held" in line for line in findings(bad, _Trial))


def test_all_is_said_at_once():
    bad = mine(KVLCC2, "hull", N_r=-HULL.N_r)
    with pytest.raises(ConfigError) as refused:
        ShipSim(bad)
    lines = str(refused.value).splitlines()
    assert len(lines) > 3 and all(line.startswith("mine: no ship does this: ") for line in lines)


@pytest.mark.parametrize("use", USES.values(), ids=USES)
def test_nothing_sails_without(use):
    with pytest.raises(ConfigError, match="no ship does this"):
        use(mine(KVLCC2, "hull", N_r=-HULL.N_r))


def test_a_ship_of_the_package_that_was_changed_keeps_her_name_but_is_looked_at():
    bow = dataclasses.replace(RUDDER, x_R=-RUDDER.x_R, x_H=-RUDDER.x_H)
    with pytest.raises(ConfigError, match=r"kvlcc2_model: no ship does this: .* to the OTHER side"):
        ShipSim(dataclasses.replace(KVLCC2, strict=False, rudder=bow))


def test_every_ship_of_the_package_is_known_by_her_numbers():
    for name in available_ships():
        for variant in (None, *available_variants(name)):
            for surrogate in available_surrogates(name)[:3]:
                ship = load_ship(name, surrogate=surrogate, variant=variant)
                assert behaviour._of_the_package(ship) and behaviour._of_the_package(
                    ship.at_share(0.37)
                )


def test_equal_ships_are_looked_at_once(monkeypatch):
    made = []

    class Counted(_Trial):
        def __init__(self, *given):
            made.append(given)
            super().__init__(*given)

    other = mine(KVLCC2, "hull", x_G=0.2)
    for ship in (other, mine(KVLCC2, "hull", x_G=0.2), other.at_share(0.5)):
        check_behaviour(ship, Counted)
    assert len(made) == 1
    check_behaviour(mine(KVLCC2, "hull", x_G=0.21), Counted)
    assert len(made) == 2
    check_behaviour(KVLCC2, Counted)  # of the package
    assert len(made) == 2
