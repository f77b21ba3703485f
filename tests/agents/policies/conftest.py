"""Small policies with random weights, one for each kind of network."""

import numpy as np
import pytest
from ship_gym_agents.forms.form import Form
from ship_gym_agents.policies.networks import Lstm, Mirror, Mlp
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.policies.policy import Policy

from ship_gym.scenarios import load_scenario
from ship_gym.ships import load_ship
from ship_gym.tasks.columns import observation_columns

COLUMNS = list(observation_columns(load_scenario()))
FEATURES = [f"observation.{name}" for name in COLUMNS]  # of the form direct, observation
SIGNS = np.array([1.0 if name in ("cos_error", "surge") else -1.0 for name in COLUMNS])
LEVELS = np.linspace(-1.0, 1.0, 7)[:, None]
KINDS = ("linear", "relu", "symmetric", "argmax", "lstm")


def random_mlp(sizes, seed=0, **options):
    """A perceptron with layers of these sizes, the first of them its inputs."""
    draw = np.random.default_rng(seed).normal
    shapes = list(zip(sizes[1:], sizes[:-1], strict=True))
    weights = tuple(draw(0.0, 0.5, shape) for shape in shapes)
    return Mlp(weights, tuple(draw(0.0, 0.2, shape[:1]) for shape in shapes), **options)


def random_network(kind):
    """A network of a kind for the features and one decision."""
    n = len(FEATURES)
    if kind == "linear":
        return random_mlp((n, 1))
    if kind == "relu":
        return random_mlp((n, 8, 6, 1), activation="relu", output="tanh")
    if kind == "symmetric":
        return random_mlp((n, 8, 1), mirror=Mirror(SIGNS, [-1.0]))
    if kind == "argmax":
        return random_mlp((n, 8, 7), output="argmax", levels=LEVELS)
    draw = np.random.default_rng(1).normal
    shapes = (20, n), (20, 5), (20,)
    return Lstm(*(draw(0.0, 0.6, shape) for shape in shapes), random_mlp((5, 4, 1)))


def random_policy(kind, form=None):
    """A policy for heading_keeping with the rudder alone."""
    draw = np.random.default_rng(2)
    n = len(FEATURES)
    scaling = Normaliser(draw.normal(0.0, 0.1, n), draw.uniform(0.1, 2.0, n), 10.0)
    card = {"name": f"tiny-{kind}", "features": FEATURES, "decisions": ["rudder"]}
    return Policy(form or Form(), scaling, random_network(kind), card)


def begun(policy, count=4, scenario=None):
    """The policy, ready to steer so many episodes with the KCS."""
    policy.reset(count, load_ship("kcs"), scenario or load_scenario())
    return policy


def observations(count=4, steps=5, seed=3):
    """Random observations, shape (steps, count, n)."""
    return np.random.default_rng(seed).normal(0.0, 0.3, (steps, count, len(FEATURES)))


def sailed(policy, seen):
    """Actions for observations (steps, count, n), interval by interval."""
    begun(policy, seen.shape[1])
    return np.stack([policy.act(row) for row in seen])


@pytest.fixture(params=KINDS)
def policy(request):
    return random_policy(request.param)
