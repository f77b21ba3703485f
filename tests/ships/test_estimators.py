"""Empirical estimators: the check numbers of the reference, and what is known to be poor."""

from __future__ import annotations

import dataclasses
import itertools

import pytest

from ship_gym.config import ConfigError
from ship_gym.ships import estimators as e
from ship_gym.ships.files import DATA
from ship_gym.ships.filled import FILLED, filled_hull
from ship_gym.ships.loader import load_ship
from ship_gym.ships.particulars import Hull
from ship_gym.ships.ranges import HULL

KCS = {"L": 230.0, "B": 32.2, "d": 10.8, "C_b": 0.651}  # SIMMAN 2020
KVLCC2 = {"L": 320.0, "B": 58.0, "d": 20.8, "C_b": 312600.0 / (320.0 * 58.0 * 20.8)}
KCS_X_G, KVLCC2_X_G = -3.404, 11.2

# table of the reference, shared/reference/empirical.md section 6: KCS, KVLCC2
TABLE = {
    "Y_v": ("-.275", "-.410"),
    "Y_r": (".0522", ".0965"),
    "Y_vvv": ("-1.801", "-1.501"),
    "Y_vrr": ("-.758", "-.383"),
    "N_v": ("-.0939", "-.130"),
    "N_r": ("-.0419", "-.0533"),
    "N_vvv": ("-.211", "-.101"),
    "N_vvr": ("-.619", "-.533"),
    "N_vrr": ("-.089", "+.019"),
    "N_rrr": ("-.0332", "-.0193"),
    "X_vv": ("-.075", "-.011"),
    "X_vr": ("-.061", "-.024"),
}
ADDED = ((KCS, ".0066 .1550 .0096"), (KVLCC2, ".0231 .2243 .0112"))


def printed(text: str):
    """Approximate a printed number to half a unit of its last digit."""
    return pytest.approx(float(text), abs=0.5 * 10.0 ** -len(text.split(".")[1]) + 1e-12)


def estimates(ship: dict[str, float], x_G: float) -> dict[str, tuple[float, str]]:
    volume = ship["C_b"] * ship["L"] * ship["B"] * ship["d"]
    return e.estimated_hull(ship["L"], ship["B"], ship["d"], volume, x_G)


@pytest.mark.parametrize(("ship", "text"), ADDED)
def test_added_masses_of_the_reference(ship, text):
    for value, number in zip(e.added_mass(**ship), text.split(), strict=True):
        assert value == printed(number)


@pytest.mark.parametrize(("column", "ship", "x_G"), [(0, KCS, KCS_X_G), (1, KVLCC2, KVLCC2_X_G)])
def test_derivatives_of_the_reference(column, ship, x_G):
    found = estimates(ship, x_G)
    for name, numbers in TABLE.items():
        assert found[name][0] == printed(numbers[column]), name


def test_constants_of_the_terms_that_the_table_leaves_out():
    found = estimates(KCS, KCS_X_G)
    c, m_y = 0.651 * 32.2 / 230.0, found["m_y"][0]
    assert found["X_vvvv"][0] == pytest.approx(-6.68 * c + 1.1)
    assert found["X_rr"][0] == pytest.approx(-0.085 * c + 0.008 + 0.0148 * m_y, rel=1e-6)
    assert (found["Y_vvr"][0], found["Y_rrr"][0]) == (-0.75, -0.051)


@pytest.mark.parametrize("name", ["kcs_model", "kvlcc2_model"])
def test_estimates_have_the_measured_sign_and_size_where_they_are_not_poor(name):
    hull = load_ship(name, surrogate="none").hull
    found = e.estimated_hull(hull.L, hull.B, hull.d, hull.volume, hull.x_G)
    for field in ("m_x", "m_y", "J_z"):
        assert found[field][0] == pytest.approx(getattr(hull, field), rel=0.08), field
    for field in ("Y_v", "N_v", "N_r", "Y_vvv", "Y_vrr"):
        assert found[field][0] == pytest.approx(getattr(hull, field), rel=0.31), field
    wrong = [k for k in TABLE if found[k][0] * getattr(hull, k) < 0.0]
    assert wrong == ([] if name == "kcs_model" else ["X_vr"])  # measured: +0.002


def test_estimated_hull_fills_every_derivative_and_says_why():
    found = estimates(KCS, KCS_X_G)
    fields = [f.name for f in dataclasses.fields(Hull)]
    assert sorted(found) == sorted(fields[fields.index("X_vv") :])
    assert found["Y_v"][1] == "Yoshimura & Masumoto (2012)"
    assert found["m_y"][1] == "Zhou et al. (1983)"
    poor = {name for name, (_, why) in found.items() if "poor" in why}
    assert poor == {"X_rr", "X_vvvv", "Y_vvr", "Y_rrr"}


def test_model_and_full_scale_agree():
    full, ratio = estimates(KVLCC2, KVLCC2_X_G), 45.7
    small = {k: v / (ratio if k != "C_b" else 1.0) for k, v in KVLCC2.items()}
    for name, (value, _) in estimates(small, KVLCC2_X_G / ratio).items():
        assert value == pytest.approx(full[name][0], rel=1e-12), name


def test_interaction_of_stern_2021():
    """Printed there for KCS: 0.2679, 0.4213, -1.2602."""
    C_b = e.block_coefficient(230.0, 32.2, 10.8, 52030.0)
    for value, text in zip(
        e.rudder_interaction(C_b, "stern_2021"), ("0.2679", "0.4213", "-1.2602"), strict=True
    ):
        assert value == printed(text)


def test_interaction_of_the_other_variants():
    assert e.rudder_interaction(0.651) == pytest.approx((0.26772, 0.255177, -0.4651))
    assert e.rudder_interaction(0.651, "kijima")[1] == pytest.approx(0.60835, abs=1e-5)
    with pytest.raises(ConfigError, match="kijima"):
        e.rudder_interaction(0.651, "kijma")


def test_fujii_gives_the_gradient_of_yasukawa_and_yoshimura():
    assert e.rudder_gradient(1.827) == printed("2.747")  # KVLCC2, YY15
    assert e.rudder_gradient(2.164) == printed("3.005")  # KCS, hull set A


def test_wetted_surface_wake_and_rudder_inflow():
    assert e.wetted_surface(230.0, 32.2, 10.8, 0.651) == pytest.approx(9424.0, rel=0.045)
    kvlcc2 = load_ship("kvlcc2_model").hull
    S = e.wetted_surface(kvlcc2.L, kvlcc2.B, kvlcc2.d, 0.810)
    assert S == pytest.approx(kvlcc2.S, rel=0.045)
    assert e.wake_fraction(0.81) == pytest.approx(0.355)
    assert e.race_share(320.0, 58.0, 0.81) == pytest.approx(0.43255)
    assert e.flow_straightening(320.0, 58.0, 0.81) == pytest.approx(0.44243, abs=1e-5)


@pytest.mark.parametrize(
    ("particulars", "message"),
    [
        ((0.0, 32.2, 10.8, 52030.0, 0.0), "L = 0"),
        ((230.0, 32.2, 10.8, 520300.0, 0.0), "block coefficient"),
        ((230.0, 32.2, 10.8, 52030.0, -150.0), "x_G"),
    ],
)
def test_impossible_particulars_are_refused(particulars, message):
    with pytest.raises(ConfigError, match=message):
        e.estimated_hull(*particulars)


def test_a_file_that_asks_for_estimates_needs_only_what_they_do_not_fill(tmp_path):
    """``estimate = true`` fills everything that it says: nothing more has to be in [hull]."""
    text = (DATA / "kvlcc2_model" / "ship.toml").read_text("utf-8")
    head, _, rest = text.partition("[hull]")
    given = [
        line
        for line in rest.partition("[form]")[0].splitlines()
        if line.split(" ")[0] in ("L", "B", "d", "volume", "x_G", "form_factor", "C_A", "R_0")
    ]
    file = tmp_path / "ship.toml"
    hull = "\n".join(["[hull]", "estimate = true", *given])
    file.write_text(f"{head}{hull}\n\n[form]{rest.partition('[form]')[2]}", "utf-8")
    ship, old = load_ship(file), load_ship("kvlcc2_model")
    assert {f"hull.{key}" for key in FILLED} <= ship.estimated.keys()
    assert ship.hull.S == e.wetted_surface(7.0, 1.27, 0.46, 3.27 / (7.0 * 1.27 * 0.46))
    assert ship.hull.k_zz == 0.25 * 7.0 and ship.hull.C_D == old.hull.C_D
    file.write_text(file.read_text("utf-8").replace("C_A =", "# C_A ="), "utf-8")
    with pytest.raises(ConfigError, match=r"missing key hull.'C_A'; .* S, k_zz and C_D only"):
        load_ship(file)


def test_what_is_filled_up_is_what_ships_have_whatever_her_proportions():
    """A tug's X_vv by the regression would drive her when she drifts: the loader refuses that."""
    for L_B, B_d, C_b in itertools.product(
        (2.7, 3.7, 5.0, 7.0, 10.0), (1.8, 3.0, 8.0), (0.4, 0.7, 1.0)
    ):
        B = 100.0 / L_B
        found = filled_hull(100.0, B, B / B_d, C_b * 100.0 * B * B / B_d, 0.0)
        for key, (value, _, _) in found.items():
            allowed = HULL[key]
            assert allowed.by or allowed.low <= value <= allowed.high, (key, L_B, B_d, C_b)
    L, B, d, C_b = 28.0, 10.5, 4.2, 0.65
    value, unit, why = filled_hull(L, B, d, C_b * L * B * d, 0.0)["X_vv"]
    assert (value, unit) == (HULL["X_vv"].published[1], "-")
    assert f"has {1.15 * C_b * B / L - 0.18:.3g}, of no ship" in why
    value, _, why = filled_hull(230.0, 32.2, 10.8, 52030.0, 0.0)["X_vv"]  # KCS: as it is
    assert value == pytest.approx(1.15 * 52030.0 / 230.0**2 / 10.8 - 0.18) and why == e.YM12
