"""Whole mirrored episodes: with an odd network a ship steers the mirrored course.

Calm water, sensors without noise, a ship whose two sides are alike; rounding is all that differs.
"""

import numpy as np
import pytest
from ship_gym_agents.forms import Form, Helm

from ship_gym import load_ship
from ship_gym.conventions import DELTA, PSI, Y
from ship_gym.envs.vector_env import ShipVectorEnv
from tests.conftest import symmetric

HEADING = (
    "observation",
    "observer",
    "reference",
    "soft",
    "sea",
    "speed",
    "effect",
    "hold",
    "products",
)
TRACK = ("observation", "observer", "reference", "route", "drift", "speed")
CALM = {"sea.states": [], "sea.gusts": False, "sea.current_speed": 0.0, "sensors.noise": False}
POINTS = np.array([[0.0, 0.0], [1200.0, 0.0], [2400.0, 900.0], [4000.0, 900.0]])
SIDES = np.array([1.0, -1.0])
# form, scenario, and what is mirrored: heading error at the start [deg], points
CASES = {
    "direct": (Form(features=("observation",), symmetric=True), "heading_keeping"),
    "increment": (Form("increment", scale=0.5, every=2, symmetric=True), "heading_keeping"),
    "residual": (
        Form("residual", "pid", 0.2, every=2, features=HEADING, lags=(1, 4), symmetric=True),
        "heading_keeping",
    ),
    "guidance": (
        Form("guidance", "drift_los", 0.4, every=5, features=TRACK, symmetric=True),
        "track_following",
    ),
}


def odd_network(helm):
    """A network of random weights, made odd under the mirror."""
    rng, inputs = np.random.default_rng(0), len(helm.names)
    W = rng.normal(0.0, 0.3, (inputs, 16))
    b, out = rng.normal(0.0, 0.3, 16), rng.normal(0.0, 0.3, (16, len(helm.decisions)))

    def plain(x):
        return np.tanh(x @ W + b) @ out

    return lambda x: 0.5 * (plain(x) + helm.decision_signs * plain(x * helm.signs))


def sail(form, scenario, side, intervals=250):
    overrides = CALM | {"start.heading_error_deg": 0.0}
    if "track" in scenario:
        points = POINTS * [1.0, side]
        overrides |= {"track.kind": "points", "track.points": points.tolist()}
        overrides |= {"start.cross_track": 0.0}
    env = ShipVectorEnv(
        1, symmetric(load_ship("kcs")), scenario=scenario, overrides=overrides, parallel=False
    )
    helm, states, actions = Helm(form), [], []
    seen, _ = env.reset(seed=1, options={"heading_error_deg": 15.0 * side})
    helm.reset(1, env.ship, env.scenario)
    network = odd_network(helm)
    for k in range(intervals):
        features = helm.look(seen)
        action = helm.act(network(features) if k % form.every == 0 else None)
        seen, *_ = env.step(action)
        states.append(env.episodes.sim.state[0].copy())
        actions.append(action[0])
    return np.array(states), np.array(actions)


@pytest.mark.parametrize("kind", CASES)
def test_a_mirrored_episode_is_steered_in_the_mirror(kind):
    form, scenario = CASES[kind]
    (here, ours), (there, theirs) = (sail(form, scenario, side) for side in SIDES)
    assert np.ptp(ours) > 0.05  # it does something
    assert theirs[:, 0] == pytest.approx(-ours[:, 0], abs=1e-9)
    assert there[:, DELTA] == pytest.approx(-here[:, DELTA], abs=1e-9)
    if "track" in scenario:
        assert there[:, PSI] == pytest.approx(-here[:, PSI], abs=1e-9)
        assert there[:, Y] == pytest.approx(-here[:, Y], abs=1e-6)
        assert np.ptp(here[:, PSI]) > 0.3  # with a way-point in it
    else:
        order = 0.5 * (here[0, PSI] + there[0, PSI])
        assert there[:, PSI] - order == pytest.approx(-(here[:, PSI] - order), abs=1e-9)
