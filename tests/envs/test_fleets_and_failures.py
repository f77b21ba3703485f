"""Mixed fleets, privileged observations, ships drawn by chance, failures, chosen rudder angles."""

import math
import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import SyncVectorEnv

import ship_gym
from ship_gym.config import ConfigError
from ship_gym.conventions import DELTA, N_STATES, N
from ship_gym.envs.discrete import ANGLES
from ship_gym.envs.randomisation import HULL, INTERACTION
from ship_gym.tasks import privileged

IDS = sorted(ship_gym.ENVIRONMENTS)
HEADING = "ShipGym/HeadingKeeping-v0"
FLEET = ["kcs", "kvlcc2_model", "onrt"]
SHORT = {"duration": 8.0}
DRAWN = {
    "randomisation.hull_std": 0.1,
    "randomisation.interaction_std": 0.1,
    "randomisation.loading": 0.1,
    "randomisation.gear": 0.2,
    "randomisation.sensors": 0.5,
}
ROUGH = {"sea.states": ["ss6"]}
FAILS_AT = 5  # [s], also the number of intervals until then
CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}


def native(env_id, n, **options):
    return ship_gym.ShipVectorEnv(n, scenario=ship_gym.ENVIRONMENTS[env_id], **options)


def assert_row(batch, i, alone):
    """Row i of a batched info is the info of the scalar environment, by the masks of its keys."""
    for key, value in alone.items():
        if isinstance(value, dict):
            assert_row(batch[key], i, value)
        else:
            np.testing.assert_array_equal(batch[key][i], value, err_msg=key)
    keys = {key for key in batch if not key.startswith(("_", "final_"))}
    assert {key for key in keys if batch[f"_{key}"][i]} == set(alone)


def assert_rows_are_scalars(env_id, ships, n, steps=20, seed=11, **options):
    """Row i of the vector environment is the scalar one of ship i with seed + i."""
    vector = native(env_id, n, ship=ships, **options)
    ships = [ships] if ships is None or isinstance(ships, str) else ships
    sync = [gym.make(env_id, ship=ships[i % len(ships)], **options) for i in range(n)]
    generator = np.random.default_rng(0)
    obs, info = vector.reset(seed=seed)
    first = [one.reset(seed=seed + i) for i, one in enumerate(sync)]
    for i, (alone, info_alone) in enumerate(first):
        np.testing.assert_array_equal(obs[i], alone, strict=True)
        assert_row(info, i, info_alone)
    ended, ends = np.zeros(n, bool), 0
    for _ in range(steps):
        actions = generator.uniform(-1.0, 1.0, vector.action_space.shape).astype(np.float32)
        obs, rewards, *flags, info = vector.step(actions)
        for i, one in enumerate(sync):
            if ended[i]:
                (alone, info_alone), reward, end = one.reset(), 0.0, (False, False)
            else:
                alone, reward, *end, info_alone = one.step(actions[i])
            np.testing.assert_array_equal(obs[i], alone, strict=True)
            assert (rewards[i], *(flag[i] for flag in flags)) == (reward, *end)
            assert_row(info, i, info_alone)
        ended = flags[0] | flags[1]
        ends += ended.sum()
    assert ends >= n


# --- mixed fleets --------------------------------------------------------------------------------


@pytest.mark.parametrize("control", ["rudder", "rudder+rpm"])
@pytest.mark.parametrize("env_id", IDS)
def test_a_row_of_a_mixed_fleet_is_the_scalar_environment_of_its_ship(env_id, control):
    """Ships of other size, time step, wave table and number of propellers; in waves and wind."""
    options = {"control": control, "overrides": SHORT}
    assert_rows_are_scalars(env_id, FLEET, 4, **options)


def test_loads_of_each_propeller_are_there_where_a_ship_has_two():
    env = native(HEADING, 3, ship=FLEET, overrides=SHORT)
    env.reset(seed=0)
    flow = env.step(np.ones((3, 1), np.float32))[-1]["flow"]
    assert flow["_thrust"].tolist() == [True] * 3
    assert flow["_thrust_port"].tolist() == [False, False, True]
    assert flow["thrust_port"][:2].tolist() == flow["thrust_starboard"][:2].tolist() == [0.0, 0.0]
    assert flow["thrust"][2] == flow["thrust_starboard"][2] + flow["thrust_port"][2] > 0.0
    alone = native(HEADING, 2, ship="kcs", overrides=SHORT)
    alone.reset(seed=0)
    assert "thrust_port" not in alone.step(np.ones((2, 1), np.float32))[-1]["flow"]


def test_a_mixed_fleet_in_one_sea_with_everything_on():
    """One sea state, ships and failure by chance, all observations."""
    failure = {"failure.time": 3.0, "failure.rudder_rate": 0.5, "failure.heading_bias_deg": 3.0}
    overrides = {**SHORT, **ROUGH, **DRAWN, **failure}
    assert_rows_are_scalars(HEADING, FLEET, 4, privileged=True, overrides=overrides)


def test_a_mixed_fleet_of_ship_objects_is_that_of_their_names():
    ships = [ship_gym.load_ship(name) for name in FLEET]
    a, b = (native(HEADING, 4, ship=fleet, overrides=SHORT) for fleet in (FLEET, ships))
    np.testing.assert_array_equal(a.reset(seed=0)[0], b.reset(seed=0)[0])
    assert [ship.name for ship in a.ships] == [*FLEET, FLEET[0]]
    for env in (a, b):
        with pytest.raises(ConfigError, match="kcs, kvlcc2_model, onrt"):
            _ = env.ship


def test_a_mixed_fleet_by_make_vec_is_the_sync_one():
    made = gym.make_vec(HEADING, num_envs=3, ship=FLEET)
    sync = SyncVectorEnv([lambda name=name: gym.make(HEADING, ship=name) for name in FLEET])
    np.testing.assert_array_equal(made.reset(seed=2)[0], sync.reset(seed=2)[0])
    actions = np.linspace(-1.0, 1.0, 3, dtype=np.float32)[:, None]
    for _ in range(5):
        np.testing.assert_array_equal(made.step(actions)[0], sync.step(actions)[0])


@pytest.mark.parametrize(
    ("fleet", "words"), [([], "ship = []"), (["kcs", "kcss"], "did you mean 'kcs'")]
)
def test_fleets_that_are_none(fleet, words):
    with pytest.raises(ConfigError) as error:
        native(HEADING, 2, ship=fleet)
    assert words in str(error.value)


# --- privileged observations ---------------------------------------------------------------------


@pytest.mark.parametrize("env_id", IDS)
def test_privileged_observations_are_appended_to_the_others(env_id):
    plain, more = (
        gym.make(env_id, overrides=ROUGH),
        gym.make(env_id, privileged=True, overrides=ROUGH),
    )
    count = plain.observation_space.shape[0]
    assert more.observation_space.shape == (count + len(privileged.OBSERVATIONS),)
    a, b = plain.reset(seed=4)[0], more.reset(seed=4)[0]
    for k in range(10):
        np.testing.assert_array_equal(b[:count], a)
        assert more.observation_space.contains(b)
        action = np.array([math.sin(k)], np.float32)
        (a, *_), (b, *_, info) = plain.step(action), more.step(action)
    row = dict(zip([row.symbol for row in privileged.OBSERVATIONS], b[count:], strict=True))
    ship = more.unwrapped.ship
    unit = 0.5 * ship.rho * ship.hull.L * ship.hull.d * ship.speed**2
    for name, axes in info["forces"].items():
        assert row[f"Y_{name}'"] == pytest.approx(axes[1] / unit, rel=1e-5, abs=1e-7)
    assert row["H_s / d"] > 0.0 and row["sin(mu)"] ** 2 + row["cos(mu)"] ** 2 == pytest.approx(1.0)
    assert math.hypot(row["u_w / U0"], row["v_w / U0"]) > 1.0


@pytest.mark.parametrize("env_id", IDS)
def test_check_env_with_privileged_observations_is_silent(env_id):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gym.make(env_id, privileged=True).unwrapped
        check_env(env, skip_render_check=True)


# --- ships drawn by chance -----------------------------------------------------------------------


@pytest.mark.parametrize("env_id", IDS)
def test_ships_drawn_by_chance_are_those_of_scalars(env_id):
    assert_rows_are_scalars(env_id, "kcs", 2, overrides={**SHORT, **DRAWN})


def test_what_is_drawn_is_in_info_by_name_and_of_the_seed():
    env = gym.make(HEADING, overrides={**SHORT, **DRAWN})
    first, again, other = (env.reset(seed=seed)[1]["randomisation"] for seed in (3, 3, 4))
    names = {f"hull.{name}" for name in HULL} | {f"interaction.{name}" for name in INTERACTION}
    assert set(first) == names | {"loading", "gear", "sensors"}
    assert first == again and all(first[name] != other[name] for name in first)
    assert env.step(np.ones(1, np.float32))[4]["randomisation"] == other
    assert env.reset()[1]["randomisation"] not in (first, other)
    ship = env.unwrapped.ship
    assert ship.hull.N_v == ship_gym.load_ship("kcs").hull.N_v  # the file's ship stays as it is


def test_what_is_drawn_has_the_distribution_asked_for():
    env = native(HEADING, 3000, overrides={**CALM, **DRAWN}, parallel=False)
    drawn = env.reset(seed=0)[1]["randomisation"]
    for name in ("hull.R_0", "hull.N_rrr", "interaction.wake"):
        assert drawn[name].mean() == pytest.approx(1.0, abs=4 * 0.1 / math.sqrt(3000))
        assert drawn[name].std() == pytest.approx(0.1, rel=0.05)
        assert np.abs(drawn[name] - 1.0).max() <= 0.3 + 1e-12
    for name, size in (("loading", 0.1), ("gear", 0.2), ("sensors", 0.5)):
        assert np.abs(drawn[name] - 1.0).max() <= size
        assert drawn[name].std() == pytest.approx(size / math.sqrt(3.0), rel=0.05)


def test_the_ship_that_sails_is_the_one_drawn():
    env = native(HEADING, 5, overrides={**CALM, **DRAWN})
    drawn = env.reset(seed=0)[1]["randomisation"]
    ship, record = env.ship, env.episodes.sim.records
    nominal = native(HEADING, 5, overrides=CALM).episodes.sim.records
    np.testing.assert_allclose(record["gear"]["rate"], ship.gear.rate * drawn["gear"])
    np.testing.assert_allclose(record["hull"]["d"], ship.hull.d * drawn["loading"])
    for section, field, name in (
        ("hull", "N_vvr", "hull.N_vvr"),
        ("propeller", "w_P0", "interaction.wake"),
        ("rudder", "gamma_R_n", "interaction.gamma_R"),
        ("inertia", "I_r", "loading"),
    ):
        np.testing.assert_allclose(record[section][field], nominal[section][field] * drawn[name])


# --- failures ------------------------------------------------------------------------------------


def pair(failure, at=float(FAILS_AT), control="rudder", ship="kcs", **overrides):
    """A healthy environment and one that fails, both at the start of the same episode."""
    given = {**ROUGH, **overrides}
    envs = [
        gym.make(HEADING, ship=ship, control=control, overrides={**given, **more})
        for more in ({}, {"failure.time": at, **failure})
    ]
    return (*envs, *(env.reset(seed=6) for env in envs))


def sail(env, steps, action):
    """States (steps, 8), observations and infos of an episode that has begun."""
    rows = []
    for _ in range(steps):
        obs, *_, info = env.step(np.array(action, np.float32))
        rows.append((env.unwrapped.episodes.sim.state[0].copy(), obs, info))
    states, seen, infos = zip(*rows, strict=True)
    return np.array(states).reshape(-1, N_STATES), np.array(seen), infos


FAILURES = [
    {"failure.rudder_rate": 0.0},
    {"failure.rudder_rate": 0.3},
    {"failure.propeller_speed": 0.5},
    {"failure.heading_bias_deg": 10.0},
]


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2_model"])
@pytest.mark.parametrize("failure", FAILURES)
def test_a_failure_begins_at_its_time_and_not_before(failure, ship):
    """A failure at 5 s: the first five intervals are sailed as by a healthy ship."""
    healthy, failing, first, other = pair(failure, ship=ship)
    np.testing.assert_array_equal(first[0], other[0])
    assert other[1]["failed"] is False and "failed" not in first[1]
    (a, seen_a, _), (b, seen_b, infos) = (sail(env, 12, [1.0]) for env in (healthy, failing))
    np.testing.assert_array_equal(a[:FAILS_AT], b[:FAILS_AT])
    np.testing.assert_array_equal(seen_a[: FAILS_AT - 1], seen_b[: FAILS_AT - 1])
    assert [info["failed"] for info in infos] == [False] * (FAILS_AT - 1) + [True] * 8
    assert (seen_a[FAILS_AT] != seen_b[FAILS_AT]).any()
    assert (a != b).any() == ("failure.heading_bias_deg" not in failure)


def test_a_stuck_rudder_stays_where_it_is():
    healthy, failing, *_ = pair({"failure.rudder_rate": 0.0})
    (a, *_), (b, *_) = (sail(env, 20, [1.0]) for env in (healthy, failing))
    assert a[FAILS_AT, DELTA] > a[FAILS_AT - 1, DELTA] > 0.0
    np.testing.assert_array_equal(b[FAILS_AT - 1 :, DELTA], b[FAILS_AT - 1, DELTA])


@pytest.mark.parametrize("ship", ["kcs", "kvlcc2_model", "onrt"])
@pytest.mark.parametrize("share", [0.25, 0.5])
def test_the_share_of_the_rudder_rate_that_is_left(share, ship):
    _, failing, *_ = pair({"failure.rudder_rate": share}, ship=ship)
    states, *_ = sail(failing, 12, [1.0])
    # of the intervals in which the rudder turns at its rate from beginning to end
    before, after = np.diff(states[:, DELTA])[[1, FAILS_AT]]
    assert after == pytest.approx(share * before, rel=1e-9) and before > 0.0


@pytest.mark.parametrize(("control", "action"), [("rudder", [0.0]), ("rudder+rpm", [0.0, 1.0])])
def test_a_loss_of_thrust_limits_the_propeller(control, action):
    _, failing, *_ = pair({"failure.propeller_speed": 0.5}, control=control, **CALM)
    episodes = failing.unwrapped.episodes
    order = episodes.tasks["n_order"][0]
    states, *_ = sail(failing, FAILS_AT, action)
    assert states[-1, N] >= 0.999 * order and episodes.sim.commands[0, 1] >= order
    states, *_ = sail(failing, 120, action)
    assert episodes.sim.commands[0, 1] == 0.5 * order
    assert states[-1, N] == pytest.approx(0.5 * order, rel=1e-3)
    assert (np.diff(states[:, N]) <= 1e-12).all()


def test_a_biased_compass_reads_too_much_to_starboard_and_moves_no_ship():
    healthy, failing, *_ = pair({"failure.heading_bias_deg": 10.0})
    (a, seen_a, _), (b, seen_b, _) = (sail(env, 12, [0.1]) for env in (healthy, failing))
    np.testing.assert_array_equal(a, b)
    error_a, error_b = (np.arctan2(seen[:, 0], seen[:, 1]) for seen in (seen_a, seen_b))
    np.testing.assert_array_equal(error_a[: FAILS_AT - 1], error_b[: FAILS_AT - 1])
    difference = np.degrees(error_b - error_a)[FAILS_AT - 1 :]
    np.testing.assert_allclose(difference, 10.0, atol=1e-4)
    np.testing.assert_array_equal(seen_a[:, 2:], seen_b[:, 2:])


@pytest.mark.parametrize("failure", FAILURES)
def test_the_next_episode_starts_healthy(failure):
    """Seeded again, an episode after a failure is the one before it, up to the failure."""
    healthy, failing, *_ = pair(failure)
    sail(failing, 12, [1.0])
    first, other = healthy.reset(seed=7), failing.reset(seed=7)
    np.testing.assert_array_equal(first[0], other[0])
    assert other[1]["failed"] is False
    (a, *_), (b, *_) = (sail(env, FAILS_AT, [-1.0]) for env in (healthy, failing))
    np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("env_id", IDS)
def test_failures_of_a_vector_environment_are_those_of_scalars(env_id):
    """Over the ends of episodes, where one row is healthy again and the others are not."""
    failure = {"failure.time": 3.0, "failure.rudder_rate": 0.2, "failure.propeller_speed": 0.3}
    overrides = {**SHORT, **failure, "failure.heading_bias_deg": -4.0}
    assert_rows_are_scalars(env_id, "kcs", 2, overrides=overrides)


@pytest.mark.parametrize("failure", FAILURES)
def test_a_failure_from_the_start_and_one_that_never_comes(failure):
    _, failing, *_, (_, info) = pair(failure, at=0.0)
    assert info["failed"] is True
    healthy, failing, *_ = pair(failure, at=1000.0, duration=10.0)
    (a, seen_a, _), (b, seen_b, infos) = (sail(env, 10, [1.0]) for env in (healthy, failing))
    np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(seen_a, seen_b)
    assert not any(info["failed"] for info in infos)


@pytest.mark.parametrize("at", [4.4, 4.5, 4.6])
def test_a_failure_between_two_commands_does_not_begin_too_early(at):
    """It is an interval that fails: the first one that begins at that time or later."""
    healthy, failing, *_ = pair({"failure.rudder_rate": 0.0}, at=at)
    (a, *_), (b, *_, infos) = (sail(env, FAILS_AT + 1, [1.0]) for env in (healthy, failing))
    np.testing.assert_array_equal(a[:FAILS_AT], b[:FAILS_AT])
    assert a[FAILS_AT, DELTA] != b[FAILS_AT, DELTA]
    assert [info["failed"] for info in infos] == [False] * (FAILS_AT - 1) + [True] * 2


def test_a_failing_rudder_keeps_the_rate_that_was_drawn():
    drawn = {"randomisation.gear": 0.5}
    env = gym.make(HEADING, overrides={**drawn, "failure.time": 2.0, "failure.rudder_rate": 0.5})
    factor = env.reset(seed=1)[1]["randomisation"]["gear"]
    states, *_ = sail(env, 4, [1.0])
    rate = env.unwrapped.ship.gear.rate
    assert np.diff(states[:, DELTA])[1] == pytest.approx(0.5 * factor * rate, rel=1e-6)


# --- chosen rudder angles ------------------------------------------------------------------------


@pytest.mark.parametrize("ship", ship_gym.available_ships())
def test_a_choice_is_its_rudder_angle(ship):
    env = ship_gym.DiscreteRudder(gym.make(HEADING, ship=ship))
    env.reset(seed=0)
    assert env.action_space == gym.spaces.Discrete(9)
    for choice, angle in enumerate(ANGLES):
        env.step(choice)
        assert env.unwrapped.episodes.sim.commands[0, 0] == pytest.approx(angle, abs=1e-7)
    env.step(np.int64(4))
    assert env.unwrapped.episodes.sim.commands[0, 0] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("env_id", IDS)
def test_check_env_takes_chosen_angles(env_id):
    with warnings.catch_warnings():
        warnings.simplefilter("error", append=True)
        warnings.filterwarnings("ignore", message=".*unwrapped version.*")
        check_env(ship_gym.DiscreteRudder(gym.make(env_id).unwrapped), skip_render_check=True)


def test_chosen_angles_in_a_sync_vector_environment():
    env = SyncVectorEnv([lambda: ship_gym.DiscreteRudder(gym.make(HEADING))] * 2)
    env.reset(seed=0)
    obs, *_ = env.step(np.array([0, 8]))
    assert obs[0, 7] == -obs[1, 7] < 0.0


@pytest.mark.parametrize(
    ("options", "angles", "words"),
    [
        ({"control": "rudder+rpm"}, ANGLES, "control = 'rudder'"),
        ({}, (0.1, -0.1), "increasing"),
        ({}, (0.1,), "two or more"),
        ({}, (-20.0, 0.0, 20.0), "angles"),
    ],
)
def test_choices_that_are_none(options, angles, words):
    with pytest.raises(ConfigError) as error:
        ship_gym.DiscreteRudder(gym.make(HEADING, **options), angles)
    assert words in str(error.value)


@pytest.mark.parametrize("choice", [-1, 9])
def test_choices_beyond_the_last_are_refused(choice):
    env = ship_gym.DiscreteRudder(gym.make(HEADING))
    env.reset(seed=0)
    with pytest.raises(ConfigError, match="allowed is 0 to 8"):
        env.step(choice)


def test_a_ship_named_often_has_one_set_of_tables():
    often = ship_gym.ShipVectorEnv(6, ship=["kcs", "onrt"] * 3)
    once = ship_gym.ShipVectorEnv(6, ship=["kcs", "onrt"])
    a, b = (envs.episodes.sim.water.waves.response for envs in (often, once))
    assert a.shape == b.shape and len(often.episodes.fleet) == 2
    (x, _), (y, _) = often.reset(seed=1), once.reset(seed=1)
    assert (x == y).all()
    assert ship_gym.ShipVectorEnv(2, ship=["kcs", "kcs"]).ship.name == "kcs"
