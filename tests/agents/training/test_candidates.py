import numpy as np
import pytest
from ship_gym_agents.forms import Form, Helm
from ship_gym_agents.policies.normaliser import no_scaling
from ship_gym_agents.sb3.config import available_recipes, load_recipe, run_config
from ship_gym_agents.training.candidates import MOST_WEIGHTS, Layout, Voyages

from ship_gym.config import ConfigError
from ship_gym.scenarios import load_scenario
from ship_gym.ships import load_ship

RESIDUAL = {"action": "residual", "base": "pid", "scale": 0.3, "symmetric": True}
MIXED = ("observer", "speed", "products")


def helm_of(**form):
    helm = Helm(Form(**{**RESIDUAL, **form}))
    helm.reset(1, load_ship("kcs"), load_scenario("heading_keeping"))
    return helm


def config_of(ships=(), episodes=4, **options):
    hyper = {
        "form": {**RESIDUAL, "features": ["observer"]},
        "training": {"episode": 30.0, "ships": list(ships)},
        "algorithm": {"episodes": episodes, **options},
    }
    return run_config("gauss_newton", "heading_keeping", ship="kcs", hyperparameters=hyper)


def test_only_odd_features_of_a_symmetric_linear_network_are_free():
    helm = helm_of(features=MIXED)
    layout = Layout(helm, [], "tanh")
    assert layout.size == np.sum(helm.signs < 0.0) < len(helm.names)
    network = layout.network(np.random.default_rng(0).normal(size=layout.size))
    features = np.random.default_rng(1).normal(size=(20, len(helm.names)))
    np.testing.assert_array_equal(network(features * helm.signs), -network(features))
    assert np.all(network.weights[0][:, helm.signs > 0.0] == 0.0)


def test_without_symmetry_all_weights_and_biases_are_free():
    helm = helm_of(features=MIXED, symmetric=False)
    assert Layout(helm, [], "tanh").size == len(helm.names) + 1


@pytest.mark.parametrize("hidden", [[], [3]])
def test_vector_of_a_network_and_back(hidden):
    layout = Layout(helm_of(features=("observer",)), hidden, "tanh")
    vector = np.random.default_rng(0).normal(size=layout.size)
    np.testing.assert_allclose(layout.vector(layout.network(vector)), vector, rtol=1e-6)


def test_network_with_a_hidden_layer_begins_with_decision_zero_and_is_symmetric():
    helm = helm_of(features=MIXED)
    layout = Layout(helm, [4], "tanh")
    features = np.random.default_rng(1).normal(size=(20, len(helm.names)))
    first = layout.first(0)
    assert np.all(layout.network(first)(features) == 0.0)
    assert np.any(first != 0.0), "units that begin alike stay alike"
    network = layout.network(first + 0.3)
    np.testing.assert_allclose(network(features * helm.signs), -network(features), atol=1e-12)


def test_too_many_weights_are_refused():
    with pytest.raises(ConfigError, match=f"free weights .* allowed are {MOST_WEIGHTS}"):
        Layout(helm_of(features=MIXED), [64], "tanh")


def test_network_of_other_layers_is_refused():
    helm = helm_of(features=("observer",))
    other = Layout(helm, [3], "tanh")
    with pytest.raises(ConfigError, match="init: a network of layers"):
        Layout(helm, [], "tanh").vector(other.network(other.first(0)))


@pytest.fixture(scope="module")
def three():
    """Voyages of three candidates, the first of which leaves the base alone."""
    voyages = Voyages(config_of())
    layout = Layout(voyages.helm, [], "tanh")
    vectors = 0.2 * np.array([np.zeros(layout.size), np.ones(layout.size), -np.ones(layout.size)])
    networks = [layout.network(vector) for vector in vectors]
    scaling = no_scaling(len(voyages.helm.names))
    return voyages, networks, scaling, voyages.sail(networks, scaling)


def test_a_candidate_sails_the_same_whatever_sails_beside_it(three):
    voyages, networks, scaling, together = three
    for network, wanted in zip(networks, together, strict=True):
        np.testing.assert_array_equal(voyages.sail([network], scaling)[0], wanted)


def test_shapes_and_samples(three):
    voyages, _, _, together = three
    assert together.shape == (3, 4, 3 * 30) and together.dtype == np.float32
    assert voyages.samples >= 3 * 4 * 30
    assert not np.array_equal(together[0], together[1])


def test_seeds_are_those_of_training_and_of_the_run():
    config = config_of()
    seeds = Voyages(config).seeds
    assert seeds == Voyages(config).seeds and len(set(seeds)) == 4
    assert max(seeds) < 400_000


def test_scales_leave_odd_features_without_mean(three):
    voyages, networks, *_ = three
    found = voyages.scales(networks[0])
    assert np.all(found.mean == 0.0) and np.all(found.scale >= 0.05)
    assert np.any(found.scale > 0.06)


def test_several_ships_in_turn():
    voyages = Voyages(config_of(("kcs", "kvlcc2")))
    layout = Layout(voyages.helm, [], "tanh")
    zero = layout.network(np.zeros(layout.size))
    scaling = no_scaling(len(voyages.helm.names))
    mixed = voyages.sail([zero, zero], scaling)
    np.testing.assert_array_equal(mixed[0], mixed[1])
    alone = Voyages(config_of()).sail([zero], scaling)[0]
    np.testing.assert_array_equal(mixed[0, ::2], alone[::2])
    assert not np.array_equal(mixed[0, 1], alone[1])


def test_episodes_that_do_not_go_up_with_the_ships_are_refused():
    with pytest.raises(ConfigError, match=r"algorithm.episodes = 3: allowed are multiples of 2"):
        Voyages(config_of(("kcs", "kvlcc2"), episodes=3))


def test_propeller_answers_even_features_and_has_a_bias():
    form = {**RESIDUAL, "base": "just_in_time", "scale_rpm": 0.3}
    helm = Helm(Form(**form, features=("observer", "voyage")))
    helm.reset(1, load_ship("kcs"), load_scenario("track_economy"))
    assert helm.decisions == ("rudder", "rpm")
    layout = Layout(helm, [], "tanh")
    network = layout.network(np.ones(layout.size))
    odd = helm.signs < 0.0
    np.testing.assert_array_equal(network.weights[0], np.stack([odd, ~odd]).astype(float))
    np.testing.assert_array_equal(network.biases[0], [0.0, 1.0])


@pytest.mark.parametrize("recipe", available_recipes())
def test_recipes_fit_their_scenarios(recipe):
    if load_recipe(recipe)["algo"] != "gauss_newton":
        pytest.skip("sails no candidates")
    settings = {"algorithm.episodes": 3 if recipe == "generalist" else 2}  # one for each ship
    config = run_config(recipe=recipe, settings=settings)
    voyages = Voyages(config)
    network = config.hyperparameters.network
    layout = Layout(voyages.helm, network.hidden, network.activation)
    assert config.algorithm == "gauss_newton" and 0 < layout.size <= 60
