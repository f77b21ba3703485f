"""Networks by hand, against torch, and in the mirror."""

import numpy as np
import pytest
from ship_gym_agents.policies.networks import Lstm, Mirror, Mlp, network_from
from ship_gym_agents.policies.normaliser import Normaliser, no_scaling

from ship_gym.config import ConfigError

from .conftest import KINDS, SIGNS, random_mlp, random_network


def test_a_perceptron_by_hand():
    weights = np.array([[1.0, -2.0]]), np.array([[0.5], [4.0]])
    net = Mlp(weights, (np.zeros(1), np.array([0.0, 0.25])), "relu")
    found = net(np.array([[0.5, 0.5], [1.0, 0.25]]))  # hidden: 0 and 0.5
    assert found.tolist() == [[0.0, 0.25], [0.25, 1.0]]
    net = Mlp((np.array([[0.5, 0.0]]),), (np.array([-0.25]),), output="tanh")
    np.testing.assert_allclose(net(np.array([[1.0, 7.0]])), np.tanh([[0.25]]))
    assert (net.n_features, net.n_decisions) == (2, 1)


def test_a_normaliser_by_hand():
    scaled = Normaliser(np.array([1.0, 2.0]), np.array([0.5, 4.0]), 3.0)
    found = scaled(np.array([[2.0, 0.0], [9.0, -99.0]]))
    assert found.tolist() == [[2.0, -0.5], [3.0, -3.0]]
    assert no_scaling(2)(np.array([[0.3, -0.7]])).tolist() == [[0.3, -0.7]]


def test_argmax_gives_the_level_of_the_largest_value():
    levels = np.array([[-1.0, 0.5], [0.0, 0.0], [1.0, -0.5]])
    net = Mlp((np.eye(3),), (np.zeros(3),), output="argmax", levels=levels)
    assert net.n_decisions == 2
    assert net(np.array([[0.0, 2.0, 1.0], [5.0, 2.0, 1.0]])).tolist() == [[0.0, 0.0], [-1.0, 0.5]]


def test_symmetric_networks_mirror_odd_decisions_and_keep_even_ones():
    signs = np.array([-1.0, 1.0, -1.0, 1.0])
    net = random_mlp((4, 8, 2), mirror=Mirror(signs, np.array([-1.0, 1.0])))
    x = np.random.default_rng(0).normal(size=(50, 4))
    here, there = net(x), net(x * signs)
    np.testing.assert_array_equal(there[:, 0], -here[:, 0])
    np.testing.assert_array_equal(there[:, 1], here[:, 1])
    assert np.ptp(here, axis=0).min() > 0.1
    plain = Mlp(net.weights, net.biases)
    bent = 0.5 * (plain._layers(x) - plain._layers(x * signs))
    np.testing.assert_allclose(here[:, 0], np.clip(bent[:, 0], -1.0, 1.0), atol=1e-15)


def test_weights_are_those_of_the_file():
    net = Mlp((np.array([[0.1]]),), (np.array([0.2]),))
    assert net.weights[0][0, 0] == np.float32(0.1) and net.weights[0].dtype == np.float64


@pytest.mark.parametrize("kind", KINDS)
def test_a_network_is_what_its_numbers_and_words_say(kind):
    net = random_network(kind)
    again = network_from(net.about(), net.tensors())
    x = np.random.default_rng(0).normal(size=(6, net.n_features))
    one, two = net.step(x, net.start(6)), again.step(x, again.start(6))
    np.testing.assert_array_equal(one[0], two[0])
    assert type(again) is type(net) and again.about() == net.about()
    assert one[0].shape == (6, net.n_decisions) and np.abs(one[0]).max() <= 1.0


def test_lstm_is_that_of_torch():
    torch = pytest.importorskip("torch")
    torch.manual_seed(0)
    theirs, head = torch.nn.LSTM(3, 5), torch.nn.Linear(5, 2)
    numbers = {name: p.detach().numpy() for name, p in theirs.named_parameters()}
    net = Lstm(
        numbers["weight_ih_l0"],
        numbers["weight_hh_l0"],
        numbers["bias_ih_l0"] + numbers["bias_hh_l0"],
        Mlp((head.weight.detach().numpy(),), (head.bias.detach().numpy(),), output="tanh"),
    )
    x = torch.randn(20, 4, 3)
    with torch.no_grad():
        wanted = torch.tanh(head(theirs(x)[0])).numpy()
    state, found = net.start(4), []
    for row in x.numpy().astype(np.float64):
        decision, state = net.step(row, state)
        found.append(decision)
    np.testing.assert_allclose(np.stack(found), wanted, atol=1e-6)


def test_large_values_do_not_overflow():
    net = random_network("lstm")
    with np.errstate(all="raise"):
        decision, state = net.step(np.full((2, net.n_features), 1e4), net.start(2))
    assert np.isfinite(decision).all() and np.isfinite(state).all()


ONE = (np.ones((1, 2)),)
WRONG = {
    "activation": (lambda: Mlp(ONE, (np.zeros(1),), "tanhh"), "did you mean 'tanh'"),
    "output": (lambda: Mlp(ONE, (np.zeros(1),), output="clp"), "did you mean 'clip'"),
    "nan": (lambda: Mlp((np.array([[np.nan]]),), (np.zeros(1),)), "weight_0 is not finite"),
    "bias": (lambda: Mlp(ONE, (np.zeros(2),)), "bias_0 has shape"),
    "layers": (lambda: Mlp((*ONE, *ONE), (np.zeros(1), np.zeros(1))), "weight_1 has shape"),
    "none": (lambda: Mlp((), ()), "0 weights"),
    "levels": (lambda: Mlp(ONE, (np.zeros(1),), output="argmax"), "needs levels"),
    "signs": (lambda: Mirror(np.zeros(2), np.ones(1)), "allowed are"),
    "mirror": (
        lambda: Mlp(ONE, (np.zeros(1),), mirror=Mirror(np.ones(3), np.ones(1))),
        "mirror_features has shape",
    ),
    "recurrent mirror": (
        lambda: Lstm(
            np.ones((8, 3)), np.ones((8, 2)), np.ones(8),
            Mlp(ONE, (np.zeros(1),), mirror=Mirror(np.ones(2), np.ones(1))),
        ),
        "cannot be symmetric",
    ),
    "gates": (
        lambda: Lstm(np.ones((4, 3)), np.ones((8, 2)), np.ones(8), Mlp(ONE, (np.zeros(1),))),
        "input_weight of shape",
    ),
    "scale": (lambda: Normaliser(np.zeros(2), np.array([1.0, 0.0])), "must be positive"),
    "mean": (lambda: Normaliser(np.array([np.inf]), np.ones(1)), "not finite"),
    "shapes": (lambda: Normaliser(np.zeros(2), np.ones(3)), "mean of shape"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_makes_no_network_is_refused(case):
    make, words = WRONG[case]
    with pytest.raises(ConfigError, match=words):
        make()


def test_kinds_of_networks_are_named():
    net = random_network("linear")
    with pytest.raises(ConfigError, match="did you mean 'lstm'"):
        network_from({**net.about(), "kind": "lst"}, net.tensors())
    assert set(SIGNS) == {-1.0, 1.0}
