"""Blocks of features: their values by an independent count, their mirror signs, every ship."""

import math

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.forms import Form, Helm
from ship_gym_agents.forms.features import BLOCKS, PRODUCTS, pairs
from ship_gym_agents.forms.ship_blocks import Ship, constants
from ship_gym_agents.rudder_effect import RudderEffect

from ship_gym import load_scenario, load_ship
from ship_gym.linear import linearise
from ship_gym.ships import available_ships
from ship_gym.tasks import TASKS, observations_of
from ship_gym.tasks.columns import observation_columns
from tests.agents.measurements import measurements

COUNT, LENGTH = 6, 40
TRACK = tuple(name for name in BLOCKS if name not in ("drift", "voyage"))
# base -> scenario and blocks: every block somewhere
CASES = {
    "pid": ("heading_keeping", tuple(n for n in TRACK if n not in ("route", "turn"))),
    "drift_los": ("track_following", (*TRACK, "drift", PRODUCTS)),
    "just_in_time": ("track_economy", (*TRACK, "voyage")),
}


def features(base, scenario, blocks, seen, action="residual"):
    """Features by name, each (length, count), and the helm."""
    helm, found = Helm(Form(action, base, 0.2, features=blocks)), []
    helm.reset(seen.shape[1], load_ship("kcs"), load_scenario(scenario))
    for s in seen:
        found.append(helm.look(s))
        helm.act()
    return dict(zip(helm.names, np.moveaxis(found, 2, 0), strict=True)), helm


def columns(scenario, seen):
    names = observation_columns(load_scenario(scenario))
    return {name: seen[:, :, k] for k, name in enumerate(names)}


def test_every_block_is_tried_here():
    assert {name for _, blocks in CASES.values() for name in blocks} == {*BLOCKS, PRODUCTS}


@pytest.mark.parametrize("task", TASKS.own())
def test_every_column_of_the_package_has_a_mirror_sign(task):
    assert all(row.mirror in (-1, 1) for row in observations_of(task, True))


@pytest.mark.parametrize("base", CASES)
@pytest.mark.parametrize("action", ["residual", "guidance"])
def test_mirrored_observations_give_mirrored_features(base, action):
    scenario, blocks = CASES[base]
    seen = measurements(load_scenario(scenario), COUNT, LENGTH, seed=1)
    signs = np.array([row.mirror for row in observations_of(load_scenario(scenario).task)])
    ours, helm = features(base, scenario, blocks, seen, action)
    theirs, _ = features(base, scenario, blocks, seen * signs, action)
    for name, sign in zip(helm.names, helm.signs, strict=True):
        assert abs(sign) == 1.0
        assert theirs[name] == pytest.approx(sign * ours[name], rel=0.0, abs=1e-9), name


@pytest.mark.parametrize("base", CASES)
def test_values_are_finite_and_of_the_order_of_1(base):
    scenario, blocks = CASES[base]
    blocks = tuple(name for name in blocks if name != "observation")
    found, _ = features(
        base, scenario, blocks, measurements(load_scenario(scenario), COUNT, LENGTH, seed=2)
    )
    for name, value in found.items():
        assert np.isfinite(value).all() and np.abs(value).max() <= 5.0, name
        assert 1e-3 < np.sqrt(np.mean(value**2)) or name.startswith(("ship.", "reference.")), name


def test_observer_and_reference_are_what_the_base_makes_of_it():
    scenario = load_scenario("track_following")
    seen = measurements(scenario, COUNT, LENGTH, seed=3)
    found, _ = features("ilos", "track_following", ("observer", "reference"), seen)
    alone = make_controller("ilos")
    alone.reset(COUNT, load_ship("kcs"), scenario)
    for k, s in enumerate(seen):
        perceived = alone.perceive(s)
        order = alone.steer(perceived)[:, 0]
        psi, r, v, bias = perceived.motion
        expected = {
            "observer.psi": 2.0 * psi,
            "observer.yaw_rate": 3.0 * r,
            "observer.sway": 8.0 * v,
            "observer.bias": 6.0 * bias,
            "observer.own_rudder": 2.0 * order,
            "reference.psi": 4.0 * np.angle(np.exp(1j * (psi - alone.followed[0]))),
            "reference.yaw_rate": 3.0 * (r - alone.followed[1]),
            "reference.wanted": 2.0 * perceived.wanted,
        }
        for name, value in expected.items():
            assert found[name][k] == pytest.approx(np.clip(value, -5.0, 5.0), abs=1e-12), name


def test_with_guidance_the_reference_is_that_of_the_interval_before():
    """The heading that the base leads to is not known before the decision; an order moves it."""
    scenario = load_scenario("track_following")
    seen = measurements(scenario, COUNT, LENGTH, seed=4)
    found, helm = features(
        "drift_los", "track_following", ("observer", "reference"), seen, "guidance"
    )
    assert "observer.own_rudder" not in helm.names
    alone, before = make_controller("drift_los"), None
    alone.reset(COUNT, load_ship("kcs"), scenario)
    for k, s in enumerate(seen):
        perceived = alone.perceive(s)
        psi = perceived.motion[0]
        then = psi if before is None else before + perceived.jump
        expected = 4.0 * np.angle(np.exp(1j * (psi - then)))
        assert found["reference.psi"][k] == pytest.approx(np.clip(expected, -5, 5), abs=1e-12)
        alone.steer(perceived)
        before = alone.followed[0]


def test_route_drift_speed_and_effect():
    scenario = load_scenario("track_following")
    seen = measurements(scenario, COUNT, LENGTH, seed=5)
    found, _ = features("drift_los", "track_following", ("route", "drift", "speed", "effect"), seen)
    column, alone = columns("track_following", seen), make_controller("drift_los")
    alone.reset(COUNT, load_ship("kcs"), scenario)
    effect = RudderEffect(load_ship("kcs"), 1.0 * load_ship("kcs").speed / load_ship("kcs").hull.L)
    near = np.exp(-np.clip(column["to_go"], 0.0, None) / 3.0)
    turn = math.pi * column["next_turn"]
    assert found["route.cross_track"] == pytest.approx(column["cross_track"])
    assert found["route.near"] == pytest.approx(2.0 * near)
    assert found["route.turn"] == pytest.approx(turn)
    assert found["route.turn_near"] == pytest.approx(2.0 * near * turn)
    assert found["route.size_near"] == pytest.approx(np.abs(2.0 * near * turn))
    assert found["speed.surge"] == pytest.approx(8.0 * (column["surge"] - 0.95))
    for k, s in enumerate(seen):
        alone.act(s)
        assert found["drift.along"][k] == pytest.approx(np.clip(5.0 * alone.drift[0], -5, 5))
        assert found["drift.across"][k] == pytest.approx(np.clip(5.0 * alone.drift[1], -5, 5))
        seen_now = observation_columns(scenario).view(s)
        assert found["effect.effect"][k] == pytest.approx(
            np.clip(4.0 * (effect(seen_now) - 1.0), -5.0, 5.0)
        )


def test_hold_is_the_mean_rudder_of_the_nominal_ship():
    """By hand: plain mean of the first 1.5 L/U0, then a low pass of that time constant."""
    scenario, ship = load_scenario("drill_thrust_loss"), load_ship("kcs")
    seen = measurements(scenario, COUNT, 2 * LENGTH, seed=7)
    found, _ = features("adaptive", "drill_thrust_loss", ("hold",), seen)
    step = 1.0 * ship.speed / ship.hull.L
    effect, mean, view = RudderEffect(ship, step), 0.0, observation_columns(scenario).view
    for k, s in enumerate(seen):
        held = view(s).rudder * effect(view(s))
        mean = mean + max(step / 1.5, 1.0 / (k + 1)) * (held - mean)
        assert found["hold.rudder"][k] == pytest.approx(2.0 * mean)
        # hard is 1 where 0.24 of the rudder at nominal speed are far surpassed
        assert found["hold.hard"][k] == pytest.approx(np.tanh((mean / 0.24) ** 3))
    assert 1.5 / step < 2 * LENGTH


def test_turn_is_the_way_along_an_arc_into_the_next_leg():
    """By hand: an arc of 2.5 L, 90 deg to starboard, and the headings along it."""
    scenario, R = load_scenario("track_following"), 2.5
    seen = measurements(scenario, 4, 1, seed=6)
    names = list(observation_columns(scenario))
    on_arc = math.radians(30.0)
    places = [  # to go, cross-track error, error from the path, bearing of the path there
        (8.0, 0.3, 0.3, 0.0),  # long before the turn
        (R - R * math.sin(on_arc), R - R * math.cos(on_arc), 0.0, on_arc),
        (R - 0.9 * R * math.sin(on_arc), R - 0.9 * R * math.cos(on_arc), 0.1 * R, on_arc),
        (0.2, 4.0, 0.2, 0.5 * math.pi),  # beyond the turn: 0.2 L to starboard of the next leg
    ]
    for name, values in zip(("to_go", "cross_track"), np.transpose(places)[:2], strict=True):
        seen[0][:, names.index(name)] = values
    seen[0][:, names.index("next_turn")] = 0.5
    seen[0][:, names.index("sin_error")], seen[0][:, names.index("cos_error")] = 0.0, 1.0
    found, _ = features("drift_los", "track_following", ("turn", "observer"), seen)
    error, bearing = np.transpose(places)[2:]
    psi = found["observer.psi"][0] / 2.0
    ahead = np.clip(bearing + 0.5 / R, 0.0, 0.5 * math.pi) * (bearing > 0.0)
    assert found["turn.cross_arc"][0] == pytest.approx(error, abs=1e-6)
    assert found["turn.soft_cross_arc"][0] == pytest.approx(np.tanh(4.0 * error), abs=1e-6)
    assert found["turn.bearing"][0] == pytest.approx(2.0 * (psi - ahead), abs=1e-6)
    to_go = np.transpose(places)[0]
    assert found["turn.at"][0] == pytest.approx(math.pi * np.exp(-to_go / 1.2), abs=1e-6)
    assert found["turn.cross_next"][0] == pytest.approx(np.tanh(to_go), abs=1e-6)


def test_the_sea_is_what_the_filter_leaves():
    """Plain means while fewer than the time constant have been taken."""
    scenario = load_scenario("heading_keeping")
    seen = measurements(scenario, COUNT, 25, seed=6)
    found, helm = features("pid", "heading_keeping", ("observer", "sea"), seen)
    column, kcs = columns("heading_keeping", seen), load_ship("kcs")
    assert 25 < 2.0 * kcs.hull.L / kcs.speed  # intervals of 1 s in the shorter time constant
    wave = column["yaw_rate"] - found["observer.yaw_rate"] / 3.0
    bias = found["observer.bias"] / 6.0
    assert found["sea.yaw_rate"] == pytest.approx(np.clip(5.0 * wave, -5, 5))
    for k in (0, 5, 24):
        rms = 15.0 * np.sqrt(np.mean(wave[: k + 1] ** 2, axis=0))
        slow = 6.0 * np.mean(bias[: k + 1], axis=0)
        assert found["sea.yaw_rate_rms"][k] == pytest.approx(np.clip(rms, 0, 5))
        for name in ("sea.slow_bias", "sea.long_bias"):
            assert found[name][k] == pytest.approx(np.clip(slow, -5, 5))
    quick = np.diff(wave, axis=0, prepend=wave[:1]) ** 2
    ratio = np.mean(quick, axis=0) / (np.mean(wave**2, axis=0) + 1e-8)
    assert found["sea.quickness"][24] == pytest.approx(np.clip(ratio, 0.0, 4.0) - 1.0)
    assert set(helm.names) > {"sea.coupling", "sea.psi_rms", "sea.long_surge"}


def test_a_voyage_knows_the_time_that_is_left():
    scenario, kcs = load_scenario("track_economy"), load_ship("kcs")
    seen = measurements(scenario, COUNT, 20, seed=7)
    found, _ = features("just_in_time", "track_economy", ("voyage",), seen)
    to_go = columns("track_economy", seen)["to_go"]
    for k in (0, 19):
        left = scenario.duration - k * scenario.control_interval
        needed = to_go[k] * kcs.hull.L / left / kcs.speed
        assert found["voyage.time_left"][k] == pytest.approx(left / scenario.duration)
        assert found["voyage.needed"][k] == pytest.approx(4.0 * (needed - 0.8))


@pytest.mark.parametrize("ship", available_ships())
def test_constants_of_every_ship(ship):
    found = constants(load_ship(ship))
    linear = linearise(load_ship(ship)).steering
    assert found[:6] == (
        linear.Y_v,
        linear.Y_r,
        linear.Y_delta,
        linear.N_v,
        linear.N_r,
        linear.N_delta,
    )
    helm = Helm(Form(features=("ship",)))
    helm.reset(2, load_ship(ship), load_scenario({"base": "heading_keeping", "ship": ship}))
    row = helm.look(np.zeros((2, 9)))
    assert np.isfinite(row).all() and (np.abs(row) < 3.5).all() and (row[0] == row[1]).all()
    assert (helm.signs == 1.0).all()


def test_time_of_a_ship_is_full_scale_and_what_gains_change_with():
    kcs, model = load_ship("kcs"), load_ship("kcs_model")
    assert constants(kcs)[-1] == pytest.approx(kcs.hull.L / kcs.speed)
    assert constants(model)[-1] == pytest.approx(constants(kcs)[-1], rel=1e-6)
    names = ["observer.psi", "observer.own_rudder", *(f"ship.{name}" for name in Ship.USUAL)]
    time = names.index("ship.time")
    assert pairs(names) == [(0, time), (1, time)]


def test_ships_differ_and_a_model_is_nearly_its_ship():
    rows = {name: np.array(constants(load_ship(name))) for name in ("kcs", "kcs_model", "kvlcc2")}
    assert rows["kcs_model"][6:10] == pytest.approx(rows["kcs"][6:10], rel=1e-3)
    assert np.abs(rows["kvlcc2"] - rows["kcs"]).max() > 0.5


def test_products_are_odd():
    seen = measurements(load_scenario("heading_keeping"), COUNT, LENGTH, seed=8)
    blocks = ("observer", "soft", "sea", "speed", PRODUCTS)
    found, helm = features("pid", "heading_keeping", blocks, seen)
    products = [n for n in helm.names if n.startswith("products.")]
    assert len(products) == 20
    for name in products:
        odd, even = name.removeprefix("products.").split("*")
        assert found[name] == pytest.approx(np.clip(found[odd] * found[even], -5.0, 5.0))
        signs = dict(zip(helm.names, helm.signs, strict=True))
        assert (signs[odd], signs[even], signs[name]) == (-1.0, 1.0, -1.0)
