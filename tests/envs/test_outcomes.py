"""Episodes end as they should, with the right flags; observations stay inside their bounds."""

import functools
import operator

import gymnasium as gym
import numpy as np
import pytest
from ship_gym_agents.los import ILOS, LOSPID
from ship_gym_agents.pid import PID

import ship_gym
from ship_gym.evaluation import rollout
from ship_gym.evaluation.controller import ConstantController
from ship_gym.evaluation.rollout import tuning_seeds
from ship_gym.scenarios import load_scenario
from ship_gym.tasks.base import DIVERGED, RUNNING
from ship_gym.tasks.columns import observation_columns
from ship_gym.tasks.course.kernels import OVERSHOOT_LIMIT
from ship_gym.tasks.heading.kernels import HEADING_LIMIT
from ship_gym.tasks.track.kernels import ARRIVED, STRAYED, TRACK_LIMIT

IDS = sorted(ship_gym.ENVIRONMENTS)
HARD_TRACKS = ("track_corridor", "track_sharp")


@pytest.mark.slow
@pytest.mark.parametrize("env_id", IDS)
def test_a_million_random_steps_stay_inside_the_declared_bounds(env_id):
    """Half of the ships change their action every step, half hold it for half a minute.

    With the privileged entries, behind which the others stand unchanged.
    """
    envs = gym.make_vec(env_id, num_envs=2000, control="rudder+rpm", privileged=True)
    rng = np.random.default_rng(0)
    observations, _ = envs.reset(seed=0)
    actions = rng.uniform(-1.0, 1.0, (2000, 2))
    ended = 0
    for k in range(500):
        fresh = rng.uniform(-1.0, 1.0, (2000, 2))
        actions[:1000] = fresh[:1000]
        if k % 30 == 0:
            actions[1000:] = fresh[1000:]
        observations, rewards, terminated, truncated, _ = envs.step(actions)
        assert envs.observation_space.contains(observations)
        assert np.isfinite(rewards).all() and (rewards <= 0.0).all()
        ended += terminated.sum() + truncated.sum()
    assert ended > 100


@pytest.mark.parametrize("env_id", IDS)
def test_terms_sum_to_the_reward_bit_for_bit(env_id):
    envs = gym.make_vec(env_id, num_envs=50, control="rudder+rpm")
    envs.reset(seed=3)
    rng = np.random.default_rng(1)
    for _ in range(60):
        _, rewards, _, _, info = envs.step(rng.uniform(-1.0, 1.0, (50, 2)))
        terms = [v for k, v in info["reward_terms"].items() if not k.startswith("_")]
        total = functools.reduce(operator.add, terms)
        begun = info["time"] > 0.0  # a reset pays nothing
        assert (total[begun] == rewards[begun]).all()


def outcome(controller, scenario, seeds=range(8), **overrides):
    sailed = rollout(controller, scenario, seeds=list(seeds), overrides=overrides)
    return sailed.outcomes, sailed


def test_a_frozen_rudder_loses_the_heading_or_runs_out_of_time():
    outcomes, sailed = outcome(ConstantController(), "heading_keeping")
    assert set(outcomes.tolist()) <= {RUNNING, HEADING_LIMIT} and (outcomes == HEADING_LIMIT).any()
    for i, o in enumerate(outcomes):
        meta = sailed.trajectory(i).meta
        assert meta["failed"] == meta["terminated"] == (o == HEADING_LIMIT)
        assert meta["truncated"] == (o == RUNNING)
        assert (sailed.lengths[i] == 600) == (o == RUNNING)


def test_a_frozen_rudder_leaves_the_track_at_its_first_turn():
    outcomes, _ = outcome(ConstantController(), "track_square", **{"duration": 1500.0})
    assert (outcomes == TRACK_LIMIT).all()


def test_a_rudder_hard_over_turns_past_the_limit_and_circles_beside_the_track():
    overrides = {"sea.states": ["ss3"]}
    outcomes, _ = outcome(ConstantController(1.0), "heading_keeping", **overrides)
    assert (outcomes == HEADING_LIMIT).all()
    # a circle of 3 L stays within 5 L of the track, but does not arrive
    outcomes, sailed = outcome(ConstantController(1.0), "track_calm")
    assert (outcomes == RUNNING).all() and (sailed.lengths == 3600).all()
    assert sailed.trajectory(0).meta["outcome"] == "end of time"


class BangBang:
    """Rudder at 20 deg to one side or the other, by the sign of the error and its rate."""

    name = "bang-bang"

    def reset(self, count, ship, scenario):
        self.size = np.radians(20.0) / ship.gear.delta_max
        self.columns = observation_columns(scenario)
        self.error = "sin_look_ahead" if "sin_look_ahead" in self.columns else "sin_error"

    def act(self, observations):
        seen = self.columns.view(observations)
        seen = getattr(seen, self.error) + 1.5 * seen.yaw_rate
        return -self.size * np.sign(seen)[:, None]


@pytest.mark.parametrize("scenario", ["heading_keeping", "course_changing", "track_following"])
def test_bang_bang_steers_badly_but_to_the_end(scenario):
    outcomes, sailed = outcome(BangBang(), scenario, **{"sea.states": ["ss4"]})
    if scenario == "track_following":  # nor does it keep the corridor: no success
        assert (outcomes == STRAYED).sum() >= 6 and ARRIVED not in outcomes
    else:
        assert (outcomes == RUNNING).all()
    travel = np.abs(np.diff(sailed.histories["states"][:600, :, 6], axis=0)).sum(axis=0)
    assert (travel > 5.0).all()  # rad: it works the gear


def test_random_actions_end_by_a_limit_or_by_time_and_hardly_ever_arrive():
    envs = gym.make_vec(IDS[-1], num_envs=40, autoreset_mode="SameStep")
    envs.reset(seed=0)
    rng = np.random.default_rng(0)
    seen = []
    for k in range(3600):
        if k % 60 == 0:
            actions = rng.uniform(-1.0, 1.0, (40, 1))
        _, _, terminated, truncated, info = envs.step(actions)
        done = terminated | truncated
        if done.any():
            arrived = info["final_info"]["outcome"][done] == ARRIVED
            assert (info["final_info"]["is_success"][done] == arrived).all()
            seen += info["final_info"]["outcome"][done].tolist()
    assert len(seen) > 40 and DIVERGED not in seen and TRACK_LIMIT in seen
    assert seen.count(ARRIVED) < 0.05 * len(seen)


@pytest.mark.parametrize("env_id", IDS)
def test_an_episode_seeded_twice_is_the_same_record(env_id, tmp_path):
    pytest.importorskip("rerun")
    name = ship_gym.ENVIRONMENTS[env_id]
    runs = []
    for k in range(2):
        one = rollout(BangBang(), name, seeds=[7], overrides={"duration": 120.0}).trajectory(0)
        one.to_rrd(tmp_path / f"{k}.rrd")
        runs.append(ship_gym.Trajectory.from_rrd(tmp_path / f"{k}.rrd"))
    assert runs[0].meta == runs[1].meta and list(runs[0].columns) == list(runs[1].columns)
    for column in runs[0].columns:
        assert (runs[0][column] == runs[1][column]).all(), column


@pytest.mark.slow
@pytest.mark.parametrize("name", ship_gym.available_scenarios())
def test_classical_autopilots_complete_every_scenario(name):
    """On a random track in sea state 6 (wind to 22 m/s) one ship in twenty may be driven off.

    Tracks are sailed to their end; where keeping the corridor is not the difficulty itself, it is
    kept nine times in ten. Without an integral a narrow one is missed. In the highest of its seas a
    ship at constant rpm is late for the deadline of track_economy. The limit of course_overshoot is
    the difficulty itself: no other failure is allowed there.
    """
    seeds = tuning_seeds(32)
    if load_scenario(name).task == "track_following":
        for controller in (ILOS(),) if name == "track_corridor" else (LOSPID(), ILOS()):
            outcomes = outcome(controller, name, seeds)[0]
            at_end = np.isin(outcomes, (STRAYED, ARRIVED)).mean()
            assert at_end >= (0.95 if name in ("track_following", "track_economy") else 1.0)
            assert name in HARD_TRACKS or (outcomes == ARRIVED).mean() >= 0.9
    else:
        allowed = (RUNNING, OVERSHOOT_LIMIT) if name == "course_overshoot" else (RUNNING,)
        outcomes = outcome(PID(), name, seeds)[0]
        assert np.isin(outcomes, allowed).all() and (outcomes == RUNNING).mean() > 0.5


@pytest.mark.slow
@pytest.mark.parametrize("ship", ship_gym.available_ships())
def test_classical_autopilots_sail_every_ship(ship):
    seeds = tuning_seeds(16)
    for controller, name, end in (
        (PID(), "heading_keeping", RUNNING),
        (PID(), "course_changing", RUNNING),
        (ILOS(), "track_following", ARRIVED),
    ):
        sailed = rollout(controller, name, seeds=seeds, ship=ship)
        assert (sailed.outcomes == end).mean() >= 15 / 16


def test_classical_autopilots_complete_every_task():
    for name in ("heading_keeping", "course_changing"):
        assert (outcome(PID(), name)[0] == RUNNING).all()
    assert (outcome(ILOS(), "track_following")[0] == ARRIVED).all()
