"""What every classical autopilot must do, whatever its law."""

import math

import numpy as np
import pytest
from ship_gym_agents.adaptive import Adaptive
from ship_gym_agents.bang_bang import BangBang
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.gains_files import gains_type
from ship_gym_agents.lqg import LQG
from ship_gym_agents.mpc import MPC
from ship_gym_agents.tuning.ranges import ranges_of, with_leaves
from ship_gym_agents.tuning.structures import structures_of

from ship_gym import load_scenario, load_ship
from ship_gym.conventions import PSI
from ship_gym.evaluation.rollout import rollout, tuning_seeds

EVERYONE = {"lqg": LQG, "mpc": MPC, "adaptive": Adaptive, "bang_bang": BangBang}
# a relay swings about the course, in a storm widely
ROUGH = {"bang_bang": math.radians(25.0)}
# Filters wrap angles, which rounds; the plan is by iteration, to 1e-6 of the largest stroke.
MIRRORED = {"lqg": 1e-12, "mpc": 1e-7, "adaptive": 1e-12, "bang_bang": 0.0}
everyone = pytest.mark.parametrize("kind", EVERYONE)
# sin and cos of the heading error, yaw rate, surge, sway, rudder, propeller and commands
MIRROR = np.array([-1, 1, -1, 1, -1, -1, 1, -1, 1])


def started(kind, count, ship="kcs", control="rudder"):
    made = EVERYONE[kind](EVERYONE[kind].first_gains(load_ship(ship)))
    made.reset(
        count, load_ship(ship), load_scenario({"base": "heading_keeping", "control": control})
    )
    return made


def observations(count, seed):
    rng = np.random.default_rng(seed)
    psi = rng.uniform(-0.6, 0.6, count)
    columns = [np.sin(psi), np.cos(psi), rng.uniform(-0.3, 0.3, count)]
    columns += [rng.uniform(0.8, 1.1, count), rng.uniform(-0.1, 0.1, count)]
    columns += [rng.uniform(-0.9, 0.9, count) for _ in range(4)]
    return np.stack(columns, axis=1).astype(np.float32)


@everyone
def test_mirrored_observations_give_mirrored_actions(kind):
    here, there = started(kind, 16), started(kind, 16)
    for k in range(20):
        seen = observations(16, seed=k)
        ours, theirs = here.act(seen), -there.act(seen * MIRROR.astype(np.float32))
        assert ours == pytest.approx(theirs, rel=0.0, abs=MIRRORED[kind])


@everyone
def test_a_row_depends_on_its_row_only(kind):
    """The same bits alone, in a batch, and in another place of it."""
    batch, turned = started(kind, 6), started(kind, 6)
    single = [started(kind, 1) for _ in range(6)]
    for k in range(15):
        seen = observations(6, seed=k)
        rows = np.vstack([one.act(seen[i : i + 1]) for i, one in enumerate(single)])
        assert np.array_equal(batch.act(seen), rows)
        assert np.array_equal(turned.act(seen[::-1]), rows[::-1])


@everyone
def test_reset_forgets(kind):
    used = started(kind, 2)
    first = used.act(observations(2, 0))
    for k in range(10):
        used.act(observations(2, k))
    used.reset(2, load_ship("kcs"), load_scenario())
    assert np.array_equal(used.act(observations(2, 0)), first)


@everyone
def test_rudder_turns_towards_the_ordered_heading_and_stays_in_range(kind):
    for error in (-40.0, -20.0, 20.0, 40.0):
        one, seen = started(kind, 1), np.zeros((1, 9))
        seen[0, :2] = math.sin(math.radians(error)), math.cos(math.radians(error))
        rudder = one.act(seen)[0, 0]
        assert rudder * error < 0.0 and abs(rudder) <= 1.0


@everyone
def test_nothing_winds_up_while_the_rudder_is_hard_over(kind):
    """Held at 40 deg off for long with the rudder hard over, then on course: no large rudder."""
    one, far, near = started(kind, 1), np.zeros((1, 9)), np.zeros((1, 9))
    far[0, :2], far[0, 5] = (math.sin(0.7), math.cos(0.7)), -1.0
    near[0, 1] = 1.0
    for _ in range(60):
        one.act(far)
    for _ in range(120):
        left = one.act(near)[0, 0]
    assert abs(left) < 0.2


@everyone
@pytest.mark.parametrize("ship", ["kcs", "kvlcc2", "onrt", "kcs_model"])
def test_first_gains_hold_the_course(kind, ship):
    """Without tuning, in the sea of HeadingKeeping: no failure, a small error at the end."""
    made = EVERYONE[kind](EVERYONE[kind].first_gains(load_ship(ship)))
    sailed = rollout(made, seeds=tuning_seeds(4), ship=ship, parallel=False)
    late = [t["psi_error"][300:] for t in sailed.episodes]
    assert not sailed.failed.any()
    assert np.sqrt(np.mean(np.square(late))) < ROUGH.get(kind, math.radians(6.0))


@everyone
def test_a_scaled_ship_is_steered_as_the_full_one(kind):
    """The same gains for kcs and its model: rms error alike but for the friction's difference."""
    gains, errors = EVERYONE[kind].first_gains(load_ship("kcs")), []
    for ship in ("kcs", "kcs_model"):
        sailed = rollout(EVERYONE[kind](gains), seeds=tuning_seeds(6), ship=ship, parallel=False)
        errors.append(np.sqrt(np.mean(sailed.histories["states"][:, :, PSI] ** 2)))
    assert errors[1] == pytest.approx(errors[0], rel=0.1)


@everyone
def test_with_rpm_the_propeller_keeps_self_propulsion(kind):
    one = started(kind, 2, control="rudder+rpm")
    action = one.act(observations(2, 0))
    assert action.shape == (2, 2) and np.ptp(action[:, 1]) == 0.0 and action[0, 1] > -1.0


@everyone
def test_they_are_found_by_name_and_say_what_they_are(kind):
    made = make_controller(kind)
    made.reset(1, load_ship("kcs"), load_scenario())
    assert made.name == kind and made.KIND == kind
    assert made.about()["kind"] == "classical"
    gains = made.first_gains(load_ship("kcs"))
    assert isinstance(gains, gains_type(EVERYONE[kind]))
    found = {}
    for task in ("heading_keeping", "course_changing"):
        for gains, free in structures_of(EVERYONE[kind], load_ship("kcs"), task).values():
            ranges = ranges_of(EVERYONE[kind], gains, free)  # refuses a start outside
            assert with_leaves(gains, {name: r.start for name, r in ranges.items()}) is not None
            found |= ranges
    assert found.keys() == made.TUNED.keys()  # every range serves a structure
