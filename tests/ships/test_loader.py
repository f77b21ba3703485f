import dataclasses
import math
import pickle
import shutil

import pytest

from ship_gym.config import ConfigError
from ship_gym.ships import available_surrogates, available_variants, load_ship
from ship_gym.ships.files import DATA
from ship_gym.ships.loader import attach_surrogate, with_beaufoy
from ship_gym.ships.plausible import checked
from ship_gym.ships.records import anchored


def test_every_number_has_a_source(ship):
    assert all(source.strip() for source in ship.sources.values())
    for section in ("hull", "propeller", "rudder", "gear", "engine"):
        assert any(name.startswith(section) for name in ship.sources)
    assert set(ship.estimated) <= set(ship.sources) | {"open_water"}
    text = ship.describe()
    assert ship.title in text and all(name in text for name in ship.estimated)


def test_printed_numbers_arrive_in_si():
    ship = load_ship("kcs_model", surrogate="none")
    assert ship.hull.L == 3.057
    assert ship.rudder.x_H == pytest.approx(-0.436 * 3.057)  # unit L
    assert ship.gear.rate == pytest.approx(math.radians(20.1))
    assert load_ship("kcs").gear.rate == pytest.approx(math.radians(2.32))
    assert load_ship("kcs").hull.L == pytest.approx(230.0)


def test_a_ship_pickles(ship):
    again = pickle.loads(pickle.dumps(ship))
    assert again.hull == ship.hull and again.sources == ship.sources
    assert (again.open_water.values == ship.open_water.values).all()


def test_hull_variants_are_the_published_sets():
    assert available_variants("kcs_model") == ["hull_a", "hull_c"] == available_variants("kcs")
    a = load_ship("kcs_model", variant="hull_a", surrogate="none")
    assert (a.variant, a.hull.Y_vrr, a.hull.R_0) == ("A", -0.8341, 0.0167)
    c = load_ship("kcs", variant="hull_c")
    assert (c.variant, c.hull.Y_r) == ("C", 0.0306)


@pytest.mark.parametrize("variant", [None, "hull_a", "hull_c"])
def test_a_ship_with_a_captive_set_keeps_it_whole_beside_a_surrogate(variant):
    ship = load_ship("kcs_model", variant=variant)
    assert ship.rudder == load_ship("kcs_model", variant=variant, surrogate="none").rudder
    assert ship.surrogate.card["anchored"] and ship.rudder.t_R > 0.2
    assert ship.surrogate.card["domain"]["S_R"] == 0.0096  # the samples' area, of every set


def test_a_ship_with_estimates_takes_the_law_that_was_fitted_with_the_surrogate():
    ship, bare = load_ship("onrt_model"), load_ship("onrt_model", surrogate="none")
    law = ship.surrogate.card["effective_inflow"]
    assert ship.rudder.epsilon == law["epsilon"] != bare.rudder.epsilon
    assert (ship.rudder.gamma_R_p, ship.rudder.gamma_R_n) == tuple(law["gamma_R"].values())
    assert ship.rudder.t_R == 0.0 and not ship.surrogate.card["anchored"]
    assert "CFD samples" in ship.sources["rudder.kappa"]


def test_one_estimate_is_enough_to_take_the_fitted_law():
    """A single rudder keeps the ship's own ratio to port: the samples are of starboard turns."""
    bare = load_ship("kcs_model", surrogate="none")
    table = load_ship("kcs_model").surrogate
    doubted = dataclasses.replace(bare, estimated={"rudder.kappa": "a guess"})
    ship, law = attach_surrogate(doubted, table, "own"), table.card["effective_inflow"]
    assert (ship.rudder.kappa, ship.rudder.t_R) == (law["kappa"], 0.0)
    ratio = bare.rudder.gamma_R_n / bare.rudder.gamma_R_p
    assert ship.rudder.gamma_R_n == pytest.approx(law["gamma_R"]["single"] * ratio)
    assert not ship.surrogate.card["anchored"]


def test_a_surrogate_of_large_drift_only_is_not_shifted_by_a_point_it_does_not_know():
    bare, whole = (load_ship("kcs_model", surrogate=k) for k in ("none", None))
    epsilon, drift = whole.surrogate.axes
    away = dataclasses.replace(drift, start=math.radians(10.0))
    table = dataclasses.replace(whole.surrogate, axes=(epsilon, away))
    ship = attach_surrogate(bare, table, "own")
    assert not ship.surrogate.card["anchored"] and anchored(ship) is ship.surrogate
    assert ship.rudder == bare.rudder  # her captive set is measured all the same


@pytest.mark.parametrize(
    ("part", "changes", "words"),
    [
        ("domain", None, "its card has no 'domain'"),
        ("domain", {"delta": None}, "domain: missing key 'delta'"),
        ("domain", {"J_max": -1.0}, "domain.J_max = -1.0: allowed is 0.2 to 10"),
        ("made_for", {"L": 0.0}, "made_for.L = 0.0: allowed"),
        ("made_for", {"f_alpha": 300.0}, "made_for.f_alpha = 300.0: allowed"),
        ("effective_inflow", {"gamma_R": {}}, "gamma_R is empty"),
        ("effective_inflow", {"epsilon": float("nan")}, "epsilon = nan"),
    ],
)
def test_a_surrogate_whose_card_lacks_what_sailing_needs_is_refused(part, changes, words):
    table = load_ship("kcs_model").surrogate
    wanted = {**table.card[part], **(changes or {})}
    card = {**table.card, part: {k: v for k, v in wanted.items() if v is not None}}
    if changes is None:
        del card[part]
    with pytest.raises(ConfigError) as error:
        attach_surrogate("kcs_model", dataclasses.replace(table, card=card), "own")
    assert words in str(error.value) and str(error.value).startswith("surrogate own: ")


def test_a_surrogate_of_other_quantities_or_sizes_is_refused():
    table = load_ship("kcs_model").surrogate
    huge = dataclasses.replace(table, values=table.values * 1e3)
    with pytest.raises(ConfigError, match=r"surrogate own: C_T\[.* allowed is -10 to 10"):
        attach_surrogate("kcs_model", huge, "own")
    with pytest.raises(ConfigError, match=r"needed are C_T, C_Q"):
        attach_surrogate("kcs_model", dataclasses.replace(table, names=tuple("abcdefghijk")), "own")
    epsilon, drift = table.axes
    axes = (dataclasses.replace(epsilon, start=-1.0), drift)
    with pytest.raises(ConfigError, match=r"axis 'advance angle' reaches -1: allowed is 0 to 1.57"):
        attach_surrogate("kcs_model", dataclasses.replace(table, axes=axes), "own")


def test_a_table_of_the_model_fits_the_full_scale_ship_and_no_other():
    table = load_ship("kcs_model").surrogate
    full = load_ship("kcs")
    again = attach_surrogate(load_ship("kcs", surrogate="none"), table, "G2_SA")
    assert again.surrogate.card["domain"]["S_R"] == pytest.approx(0.0096 * (230.0 / 3.057) ** 2)
    assert again.rudder.A_R == pytest.approx(full.rudder.A_R)
    assert again.rudder.gamma_R_n == pytest.approx(full.rudder.gamma_R_n)
    with pytest.raises(ConfigError, match=r"made for kcs_model with D / L = 0.0343; kvlcc2_model"):
        attach_surrogate(load_ship("kvlcc2_model"), table, "G2_SA")


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: load_ship("kcss"), "did you mean 'kcs'"),
        (lambda: load_ship("kcs", surrogate="G2_SB"), "did you mean 'G2_SA'"),
        (lambda: load_ship("kcs", variant="hull_b"), "hull variant"),
        (lambda: load_ship("nowhere/ship.toml"), "no such file"),
    ],
)
def test_unknown_names(call, word):
    with pytest.raises(ConfigError) as error:
        call()
    assert word in str(error.value)


def test_surrogates_of_every_ship():
    fitted = ["G1_SA", "G2_SA", "G2_SST", "G3_SA", "gp", "nn"]
    assert available_surrogates("kcs") == ["none", "beaufoy", *fitted]
    onrt = ["none", "G1_SA", "G2_SA", "G2_SA_16", "G2_SST", "G3_SA", "gp", "nn"]
    assert available_surrogates("onrt") == onrt
    assert available_surrogates("kvlcc2") == ["none", "beaufoy"]


def test_the_family_regression_is_the_ships_default():
    assert load_ship("kcs", surrogate="regression").surrogate_name == "G2_SA"
    assert load_ship("kvlcc2", surrogate="regression").surrogate is None


def test_beaufoys_formula_is_for_one_rudder():
    assert load_ship("kcs", surrogate="beaufoy").rudder.beaufoy == 1.0
    with pytest.raises(ConfigError, match="one propeller and one rudder"):
        with_beaufoy(load_ship("onrt_model", surrogate="none"))


def test_a_surrogate_knows_for_how_many_propellers_it_was_made():
    ship = load_ship("onrt_model", surrogate="none")
    single = dataclasses.replace(ship, propeller=dataclasses.replace(ship.propeller, y_P=0.0))
    with pytest.raises(ConfigError, match="made for 2 propellers; onrt_model has 1"):
        attach_surrogate(single, load_ship("onrt_model").surrogate, "G2_SA")


def test_hull_estimate_fills_up_and_marks_what_a_file_leaves_out(own_ship):
    text = own_ship.read_text()
    own_ship.write_text(text.replace("N_vvr = -0.294\n", ""))
    with pytest.raises(ConfigError, match=r"missing key hull.'N_vvr'; hull.estimate = true"):
        load_ship(str(own_ship))
    own_ship.write_text(own_ship.read_text().replace("[hull]", "[hull]\nestimate = true"))
    ship = load_ship(str(own_ship))
    C_b = ship.hull.volume / (ship.hull.L * ship.hull.B * ship.hull.d)
    assert ship.hull.N_vvr == pytest.approx(1.55 * C_b * 1.27 / 7.0 - 0.76)
    assert ship.estimated["hull.N_vvr"] == "Yoshimura & Masumoto (2012)"
    assert ship.hull.N_vvv == -0.030 and "hull.N_vvv" not in ship.estimated  # the file's own
    own_ship.write_text(own_ship.read_text().replace("estimate = true", "estimate = 1"))
    with pytest.raises(ConfigError, match="allowed is true or false"):
        load_ship(str(own_ship))


@pytest.fixture
def own_ship(tmp_path):
    """A user's ship file in a folder of its own."""
    shutil.copytree(DATA / "kvlcc2_model", tmp_path / "mine")
    return tmp_path / "mine" / "ship.toml"


def test_a_ship_file_from_outside_the_package(own_ship):
    ship = load_ship(str(own_ship))
    assert ship.hull == load_ship("kvlcc2_model").hull and ship.name == "mine"
    own_ship.write_text(own_ship.read_text().replace("m_y = 0.223", "m_y = 0.300"))
    assert load_ship(str(own_ship)).hull.m_y == 0.300  # an edited file is read again
    renamed = own_ship.rename(own_ship.with_name("tanker.toml"))
    assert load_ship(str(renamed)).name == "tanker"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("m_y = 0.223", "m_Y = 0.223", ["hull.'m_Y'", "m_y"]),
        ("m_y = 0.223\n", "", ["missing key hull.'m_y'"]),
        ("m_y = 0.223", "m_y = inf", ["hull.m_y"]),
        ("m_y = 0.223", "m_y = true", ["hull.m_y"]),
        ('value = 35.0, unit = "deg"', 'value = 35.0, unit = "rad"', ["looks like degrees"]),
        ('value = 7.00, unit = "m"', 'value = 7.00, unit = "kg"', ["hull.L", "allowed is m"]),
        (
            'value = 3.27, unit = "m3"',
            'value = 32.7, unit = "m3"',
            ["hull.volume = 32.7 m3", "0.25 to 1 L B d"],
        ),
        (
            'value = 0.0539, unit = "m2" }',
            'value = -1.0, unit = "m2" }',
            ["rudder.A_R = -1 m2", "0.004 to 0.1 L d"],
        ),
        ("t_P = 0.220", "t_p = 0.220", ["t_p", "did you mean 't_P'"]),
        ("[gear]", "[gears]", ["gears", "did you mean 'gear'"]),
        ("J_range = [0.0, 0.8]\n", "", ["open_water", "J_range"]),
        ("K_T = [0.2931, -0.2753, -0.1385]", "K_T = 0.3", ["open_water.K_T", "list"]),
        ("pitch_ratio = 0.721", "pitch = 0.721", ["open_water.b_series", "pitch_ratio"]),
    ],
)
def test_a_wrong_ship_file_names_the_field(own_ship, old, new, words):
    text = own_ship.read_text()
    assert old in text
    own_ship.write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigError) as error:
        load_ship(str(own_ship))
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize(
    ("name", "field", "value", "message"),
    [
        ("onrt_model", "neutral", 0.01, "rudder.neutral = 0.01 rad: allowed is 0 with two"),
        ("kcs_model", "gamma_R_over", -0.1, "rudder.gamma_R_over = -0.1"),
    ],
)
def test_a_rudder_law_out_of_range_is_refused(name, field, value, message):
    ship = load_ship(name)
    bad = dataclasses.replace(ship, rudder=dataclasses.replace(ship.rudder, **{field: value}))
    with pytest.raises(ConfigError, match=message):
        checked(bad)
