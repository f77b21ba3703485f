"""The helm: actions of every kind, episodes that begin anew, lags, mixed fleets, refusals."""

import dataclasses

import numpy as np
import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.forms import Form, Helm, form_from
from ship_gym_agents.pid import PID

from ship_gym import load_scenario, load_ship
from ship_gym.config import ConfigError
from ship_gym.simulation import self_propulsion
from ship_gym.tasks import TASKS
from tests.agents.measurements import measurements

COUNT, LENGTH = 4, 30
MOTION = ("observation", "observer", "reference", "soft", "sea", "speed", "effect", "hold", "ship")
TRACK = (*MOTION, "route", "turn")
# base -> scenario and blocks
BASES = {
    "pid": ("heading_keeping", (*MOTION, "products")),
    "lqg": ("course_changing", MOTION),
    "adaptive": ("course_changing", MOTION),
    "bang_bang": ("heading_keeping", MOTION),
    "los_pid": ("track_following", TRACK),
    "ilos": ("track_following", TRACK),
    "drift_los": ("track_following", (*TRACK, "drift", "products")),
    "just_in_time": ("track_economy", (*TRACK, "voyage")),
}
KINDS = {(0, 2, 3): "kcs", (1, 4): "kvlcc2"}  # rows of a mixed fleet
bases = pytest.mark.parametrize("base", BASES)


def begun(form, scenario, count=COUNT, ship="kcs"):
    helm = Helm(form)
    helm.reset(count, load_ship(ship), load_scenario(scenario))
    return helm


def sailed(helm, seen, decisions):
    """Features and actions of every interval."""
    found = [(helm.look(s), helm.act(d)) for s, d in zip(seen, decisions, strict=True)]
    return (np.array(x) for x in zip(*found, strict=True))


def decisions(size, every=1, seed=0, count=COUNT):
    rng = np.random.default_rng(seed)
    made = rng.uniform(-1.0, 1.0, (LENGTH, count, size))
    return [d if k % every == 0 else None for k, d in enumerate(made)]


@bases
@pytest.mark.parametrize("action", ["residual", "guidance"])
def test_decision_0_is_the_base_alone(base, action):
    scenario, blocks = BASES[base]
    helm = begun(Form(action, base, 0.3, features=blocks), scenario)
    alone = make_controller(base)
    alone.reset(COUNT, load_ship("kcs"), load_scenario(scenario))
    zero = np.zeros((COUNT, 1))
    for k, seen in enumerate(measurements(load_scenario(scenario), COUNT, LENGTH, seed=1)):
        helm.look(seen)
        expected = alone.act(seen)
        assert np.array_equal(helm.act(None if k < 3 else zero), expected)


@bases
@pytest.mark.parametrize("action", ["direct", "increment", "residual", "guidance"])
def test_a_restarted_row_is_as_new(base, action):
    """Features, memory of earlier decisions and actions, for all blocks."""
    scenario, blocks = BASES[base]
    scale = 1.0 if action == "direct" else 0.4
    form = Form(action, base, scale, every=2, features=blocks, lags=(1, 3))
    seen = measurements(load_scenario(scenario), COUNT, LENGTH, seed=2)
    batch, late = begun(form, scenario), begun(form, scenario)
    made = decisions(len(batch.decisions), every=2)
    before, _ = sailed(batch, seen[:9], made[:9])
    batch.restart(np.array([1, 3]))
    ours, acts = sailed(batch, seen[9:], made[9:])
    theirs, expected = sailed(late, seen[9:], made[9:])
    assert np.array_equal(ours[:, [1, 3]], theirs[:, [1, 3]])
    assert np.array_equal(acts[:, [1, 3]], expected[:, [1, 3]])
    assert not np.array_equal(ours[:, [0, 2]], theirs[:, [0, 2]])
    whole, _ = sailed(begun(form, scenario), seen, made)
    sailed_on = np.concatenate([before, ours])[:, [0, 2]]
    assert np.array_equal(sailed_on, whole[:, [0, 2]])


@bases
@pytest.mark.parametrize("action", ["residual", "guidance"])
def test_peek_shows_the_features_and_changes_nothing(base, action):
    scenario, blocks = BASES[base]
    form = Form(action, base, 0.4, features=blocks, lags=(2,))
    seen = measurements(load_scenario(scenario), COUNT, LENGTH, seed=3)
    other = measurements(load_scenario(scenario), COUNT, LENGTH, seed=4)
    plain, peeked = begun(form, scenario), begun(form, scenario)
    for k, d in enumerate(decisions(1)):
        peeked.peek(other[k])
        shown = peeked.peek(seen[k])
        features = plain.look(seen[k])
        assert np.array_equal(shown, features)
        assert np.array_equal(peeked.look(seen[k]), features)
        if k == 12:
            peeked.restart(np.array([2]))
            plain.restart(np.array([2]))
            peeked.peek(other[k])
        assert np.array_equal(peeked.act(d), plain.act(d))


def test_direct_is_the_decision_and_until_then_nothing():
    helm = begun(Form(), {"base": "heading_keeping", "control": "rudder+rpm"})
    seen = measurements(load_scenario("heading_keeping"), COUNT, 4, seed=1)
    ship = load_ship("kcs")
    assert helm.decisions == ("rudder", "rpm") and helm.decision_signs.tolist() == [-1.0, 1.0]
    assert np.array_equal(helm.look(seen[0]), seen[0])
    first = helm.act()
    assert (first[:, 0] == 0.0).all()
    assert first[:, 1] == pytest.approx(
        2.0 * self_propulsion(ship, ship.speed) / ship.engine.n_max - 1
    )
    helm.look(seen[1])
    assert np.array_equal(
        helm.act(np.full((COUNT, 2), [0.3, -2.0])), np.full((COUNT, 2), [0.3, -1])
    )
    helm.restart(np.array([1]))
    helm.look(seen[2])
    held = helm.act()
    assert held[0].tolist() == [0.3, -1.0] and np.array_equal(held[1], first[1])


def test_increments_move_the_order_by_the_stroke_of_the_gear():
    form = Form("increment", scale=0.5, every=3)
    helm, ship = begun(form, "heading_keeping"), load_ship("kcs")
    stroke = ship.gear.rate * 1.0 / ship.gear.delta_max  # an interval is 1 s
    orders = []
    for k in range(9):
        helm.look(np.zeros((COUNT, 9)))
        orders.append(helm.act(np.full((COUNT, 1), [1.0]) if k % 3 == 0 else None)[0, 0])
    step = 0.5 * 3 * stroke
    assert orders == pytest.approx([step] * 3 + [2 * step] * 3 + [3 * step] * 3)
    for _ in range(200):
        helm.look(np.zeros((COUNT, 9)))
        last = helm.act(np.ones((COUNT, 1)))
    assert (last == 1.0).all()  # no farther than hard over


def test_residual_adds_its_share_and_stays_within_the_action():
    form = Form("residual", "pid", 0.25, features=("observer",))
    helm, alone = begun(form, "heading_keeping"), make_controller("pid")
    alone.reset(COUNT, load_ship("kcs"), load_scenario("heading_keeping"))
    for seen in measurements(load_scenario("heading_keeping"), COUNT, LENGTH, seed=5):
        helm.look(seen)
        expected = np.clip(alone.act(seen) + 0.25, -1.0, 1.0)
        assert helm.act(np.full((COUNT, 1), 7.0)) == pytest.approx(expected)  # 7 counts as 1


def test_guidance_holds_its_offset_and_the_base_steers_every_interval():
    form = Form("guidance", "drift_los", 0.5, every=3, features=("route", "drift"))
    helm, alone = begun(form, "track_following"), make_controller("drift_los")
    alone.reset(COUNT, load_ship("kcs"), load_scenario("track_following"))
    made = decisions(1, every=3, seed=6)
    for k, seen in enumerate(measurements(load_scenario("track_following"), COUNT, LENGTH, 6)):
        d, held = made[k], made[k - k % 3]
        helm.look(seen)
        expected = alone.steer(alone.perceive(seen), 0.5 * held[:, 0])
        assert np.array_equal(helm.act(d), expected)


def test_filter_noise_is_that_of_the_gains_of_the_base():
    """The same bits as a base whose gains say so."""
    gains = PID.gains_for(load_ship("kcs"), "heading_keeping")
    noises = {k: 0.3 * getattr(gains.observer, k) for k in ("sway_noise", "yaw_noise")}
    observer = dataclasses.replace(gains.observer, **noises)
    alone = PID(dataclasses.replace(gains, observer=observer))
    alone.reset(COUNT, load_ship("kcs"), load_scenario("heading_keeping"))
    form = Form("residual", "pid", 0.3, features=("observer",), filter_noise=0.3)
    helm, other = begun(form, "heading_keeping"), 0.0
    quick = begun(dataclasses.replace(form, filter_noise=1.0), "heading_keeping")
    for seen in measurements(load_scenario("heading_keeping"), COUNT, LENGTH, seed=8):
        helm.look(seen), quick.look(seen)
        action = helm.act()
        assert np.array_equal(action, alone.act(seen))
        other = max(other, np.abs(action - quick.act()).max())
    assert other > 1e-3


def test_filter_noise_needs_an_observer():
    form = Form("residual", "bang_bang", 0.3, features=("observer",), filter_noise=0.3)
    with pytest.raises(ConfigError, match="bang_bang has no observer here; allowed is 1"):
        begun(form, "heading_keeping")


@pytest.mark.parametrize("action", ["residual", "guidance"])
def test_rpm_is_added_to_that_of_the_base(action):
    blocks = ("observer", "voyage")
    form = Form(action, "just_in_time", 0.3, scale_rpm=0.1, features=blocks)
    helm, alone = begun(form, "track_economy"), make_controller("just_in_time")
    alone.reset(COUNT, load_ship("kcs"), load_scenario("track_economy"))
    assert helm.decisions == ("heading" if action == "guidance" else "rudder", "rpm")
    assert helm.decision_signs.tolist() == [-1.0, 1.0]
    for seen in measurements(load_scenario("track_economy"), COUNT, LENGTH, seed=7):
        helm.look(seen)
        expected = alone.act(seen)
        found = helm.act(np.full((COUNT, 2), [0.0, 0.5]))
        assert np.array_equal(found[:, 0], expected[:, 0])
        assert found[:, 1] == pytest.approx(np.clip(expected[:, 1] + 0.05, -1.0, 1.0))


def test_lags_are_the_features_of_earlier_decisions():
    form = Form(every=2, features=("observation",), lags=(1, 3))
    helm = begun(form, "heading_keeping")
    seen = measurements(load_scenario("heading_keeping"), COUNT, LENGTH, seed=8)
    assert helm.names[9] == "observation.sin_error@1"
    assert len(helm.names) == 27 and np.array_equal(helm.signs[:9], helm.signs[18:])
    past = []
    for k, d in enumerate(decisions(1, every=2)):
        features = helm.look(seen[k])
        for place, lag in ((9, 1), (18, 3)):
            then = past[-lag] if len(past) >= lag else seen[0]
            assert np.array_equal(features[:, place : place + 9], then)
        helm.act(d)
        if d is not None:
            past.append(seen[k])


def test_privileged_columns_are_cut_off():
    form = Form("residual", "pid", 0.2, features=("observation", "observer"))
    plain = begun(form, "heading_keeping")
    more = begun(form, {"base": "heading_keeping", "privileged": True})
    seen = measurements(load_scenario("heading_keeping"), COUNT, 3, seed=9)
    assert plain.names == more.names
    for s in seen:
        assert np.array_equal(plain.look(s), more.look(np.hstack([s, np.ones((COUNT, 26))])))
        assert np.array_equal(plain.act(), more.act())


def test_a_mixed_fleet_sails_as_each_kind_alone():
    form = Form("residual", "pid", 0.2, features=("observer", "ship"), lags=(1,))
    scenario = load_scenario("heading_keeping")
    kcs, tanker = load_ship("kcs"), load_ship("kvlcc2")
    helm = Helm(form)
    helm.reset(5, [kcs, tanker, kcs, kcs, tanker], scenario)
    seen, made = measurements(scenario, 5, LENGTH, seed=10), decisions(1, count=5)
    alone = {rows: begun(form, "heading_keeping", len(rows), ship) for rows, ship in KINDS.items()}
    for k in range(LENGTH):
        if k == 7:
            helm.restart(np.array([0, 4]))
            for rows, one in alone.items():
                one.restart(np.array([i for i, row in enumerate(rows) if row in (0, 4)]))
        features, action = helm.look(seen[k]), helm.act(made[k])
        for rows, one in alone.items():
            rows = list(rows)
            assert np.array_equal(features[rows], one.look(seen[k][rows]))
            assert np.array_equal(action[rows], one.act(made[k][rows]))


@pytest.mark.parametrize(
    ("values", "scenario", "message"),
    [
        (
            {"base": "mpc", "action": "residual"},
            "heading_keeping",
            "form.base = 'mpc': allowed are",
        ),
        ({"base": "constant", "action": "residual"}, "heading_keeping", "begin one episode while"),
        ({"base": "pidd", "action": "residual"}, "heading_keeping", "did you mean 'pid'"),
        ({"base": "drift_los"}, "heading_keeping", "controller drift_los needs cross_track"),
        ({"base": "pid", "features": ["route"]}, "heading_keeping", "the block 'route' of form.f"),
        ({"base": "ilos", "features": ["drift"]}, "track_following", "what drift_los estimates"),
        ({"features": ["voyage"]}, "track_zigzag", "on a track of one leg only"),
        ({"features": ["ship", "products"]}, "heading_keeping", "these have none of them"),
        (
            {"base": "pid", "action": "residual", "scale_rpm": 0.1},
            "heading_keeping",
            "form.scale_rpm = 0.1: needs control = 'rudder+rpm'",
        ),
    ],
)
def test_a_form_that_does_not_fit_the_scenario_is_refused(values, scenario, message):
    with pytest.raises(ConfigError) as told:
        begun(form_from(values), scenario)
    assert message in str(told.value)


def test_one_look_for_one_act():
    helm = begun(Form(), "heading_keeping")
    with pytest.raises(ConfigError, match="act without a look"):
        helm.act()
    helm.look(np.zeros((COUNT, 9)))
    helm.act()
    with pytest.raises(ConfigError, match="act without a look"):
        helm.act()
    with pytest.raises(ConfigError, match="2 ships for 3 episodes"):
        Helm(Form()).reset(3, [load_ship("kcs")] * 2, load_scenario("heading_keeping"))


def test_symmetry_needs_the_mirror_sign_of_every_column(monkeypatch):
    task = TASKS["track_following"]
    rows = tuple(
        row._replace(mirror=None) if row.name == "to_go" else row for row in task.observations
    )
    monkeypatch.setitem(TASKS._known, task.name, dataclasses.replace(task, observations=rows))
    assert np.isnan(begun(Form(), "track_following").signs).sum() == 1
    with pytest.raises(ConfigError, match=r"the mirror sign of observation.to_go is not known"):
        begun(Form(symmetric=True), "track_following")
