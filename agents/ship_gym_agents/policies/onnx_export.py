"""A policy's network as an ONNX model, for programs that do not have this package.

Inputs are ``features`` (count, n_features), as the helm makes them and not yet scaled, and for a
network with memory ``hidden`` and ``cell`` (count, n_hidden), zero where an episode begins; outputs
are ``decision`` (count, n_decisions) in [-1, 1] and ``next_hidden``, ``next_cell``. All are
float32. What features and decisions mean is in the metadata, with the form and the whole card.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np

from ship_gym.writing import atomic_path
from ship_gym_agents.policies.networks import Lstm, Mlp
from ship_gym_agents.policies.policy import Policy

_OPSET = 17  # of 2022: what older programs read as well
_IR = 8
_COUNT = "count"  # name of the free dimension


def export_onnx(policy: Policy, path: str | Path) -> None:
    """Write the network of a policy, its normaliser included.

    Raises
    ------
    ImportError
        ONNX is not installed.
    """
    model = onnx_model(policy)
    with atomic_path(path) as temporary:
        temporary.write_bytes(model.SerializeToString())


def exported_card(path: str | Path) -> dict[str, Any]:
    """Card of the policy that a model was made of; whatever is wrong with the file is raised."""
    found = {one.key: one.value for one in _onnx().load(str(path)).metadata_props}
    return json.loads(found["card"])


def onnx_model(policy: Policy) -> Any:
    """The checked ``onnx.ModelProto`` of a policy."""
    onnx = _onnx()
    graph = _Graph(onnx)
    network, inputs = policy.network, {"features": policy.network.n_features}
    outputs: dict[str, int] = {}
    scaled = _scaled(graph, policy)
    if isinstance(network, Lstm):
        inputs |= dict.fromkeys(("hidden", "cell"), network.n_hidden)
        outputs |= dict.fromkeys(("next_hidden", "next_cell"), network.n_hidden)
        scaled = _remembered(graph, network, scaled)
        network = network.head
    graph.node("Identity", [_decided(graph, network, scaled)], name="decision")
    outputs = {"decision": network.n_decisions, **outputs}
    values = [
        [onnx.helper.make_tensor_value_info(k, onnx.TensorProto.FLOAT, [_COUNT, n]) for k, n in one]
        for one in (inputs.items(), outputs.items())
    ]
    made = onnx.helper.make_graph(graph.nodes, "policy", *values, graph.constants)
    opset = onnx.helper.make_opsetid("", _OPSET)
    model = onnx.helper.make_model(made, opset_imports=[opset], ir_version=_IR)
    model.producer_name = "ship-gym"
    onnx.helper.set_model_props(model, _metadata(policy))
    onnx.checker.check_model(model, full_check=True)
    return model


def _onnx() -> Any:
    try:
        import onnx
        import onnx.checker
        import onnx.helper
    except ModuleNotFoundError as error:
        raise ImportError(
            f'export to ONNX needs {error.name}: pip install "ship-gym[onnx]"'
        ) from error
    return onnx


class _Graph:
    """Nodes and constants of a model while it is made; each value has a name of its own."""

    def __init__(self, onnx: Any):
        self.onnx = onnx
        self.nodes: list[Any] = []
        self.constants: list[Any] = []

    def node(self, kind: str, inputs: list[str], name: str = "", **attributes: Any) -> str:
        """Add an operation; the name of its result."""
        name = name or f"{kind.lower()}_{len(self.nodes)}"
        self.nodes.append(self.onnx.helper.make_node(kind, inputs, [name], name, **attributes))
        return name

    def constant(self, array: Any, name: str = "") -> str:
        """Add numbers as float32; their name."""
        name = name or f"constant_{len(self.constants)}"
        array = np.array(array, dtype=np.float32, order="C")
        self.constants.append(self.onnx.numpy_helper.from_array(array, name))
        return name

    def linear(self, values: str, weight: np.ndarray, bias: np.ndarray | None = None) -> str:
        """``values @ weight.T + bias``."""
        found = self.node("MatMul", [values, self.constant(weight.T)])
        return found if bias is None else self.node("Add", [found, self.constant(bias)])

    def clip(self, values: str, limit: float) -> str:
        """``clip(values, -limit, limit)``."""
        return self.node("Clip", [values, self.constant(-limit), self.constant(limit)])


def _scaled(graph: _Graph, policy: Policy) -> str:
    normaliser = policy.normaliser
    away = graph.node("Sub", ["features", graph.constant(normaliser.mean, "mean")])
    scaled = graph.node("Div", [away, graph.constant(normaliser.scale, "scale")])
    return graph.clip(scaled, normaliser.limit)


def _remembered(graph: _Graph, network: Lstm, scaled: str) -> str:
    """The hidden values of a step of the memory; also writes the next state."""
    gates = graph.node(
        "Add",
        [
            graph.linear(scaled, network.input_weight, network.gate_bias),
            graph.linear("hidden", network.hidden_weight),
        ],
    )
    parts = [f"gate_{k}" for k in ("enter", "forget", "new", "leave")]
    graph.nodes.append(graph.onnx.helper.make_node("Split", [gates], parts, "gates", axis=1))
    enter, forget, leave = (graph.node("Sigmoid", [parts[k]]) for k in (0, 1, 3))
    kept = graph.node("Mul", [forget, "cell"])
    new = graph.node("Mul", [enter, graph.node("Tanh", [parts[2]])])
    cell = graph.node("Add", [kept, new], "next_cell")
    return graph.node("Mul", [leave, graph.node("Tanh", [cell])], "next_hidden")


def _decided(graph: _Graph, mlp: Mlp, scaled: str) -> str:
    found = _layers(graph, mlp, scaled)
    if mlp.mirror is not None:
        seen = graph.node("Mul", [scaled, graph.constant(mlp.mirror.features, "mirror_features")])
        other = _layers(graph, mlp, seen)
        signs = graph.constant(mlp.mirror.decisions, "mirror_decisions")
        both = graph.node("Add", [found, graph.node("Mul", [other, signs])])
        found = graph.node("Mul", [both, graph.constant(0.5)])
    if mlp.output == "argmax":
        best = graph.node("ArgMax", [found], axis=1, keepdims=0)
        return graph.node("Gather", [graph.constant(mlp.levels, "levels"), best], axis=0)
    return graph.node("Tanh", [found]) if mlp.output == "tanh" else graph.clip(found, 1.0)


def _layers(graph: _Graph, mlp: Mlp, values: str) -> str:
    last = len(mlp.weights) - 1
    kind = {"tanh": "Tanh", "relu": "Relu"}[mlp.activation]
    for k, (weight, bias) in enumerate(zip(mlp.weights, mlp.biases, strict=True)):
        values = graph.linear(values, weight, bias)
        values = graph.node(kind, [values]) if k < last else values
    return values


def _metadata(policy: Policy) -> dict[str, str]:
    """Text that a program finds in the model: names of features and decisions, form, card."""
    card = policy.card
    names: tuple[str, ...] = ("features", "decisions")
    found = {name: json.dumps(card[name]) for name in names if name in card}
    found |= {"form": json.dumps(dataclasses.asdict(policy.form)), "card": json.dumps(card)}
    return {"ship_gym_policy": policy.name, **found}
