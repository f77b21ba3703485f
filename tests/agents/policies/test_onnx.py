"""Exported models give what the policy gives, computed by onnxruntime."""

import json
import sys

import numpy as np
import pytest
from ship_gym_agents.policies.onnx_check import largest_difference
from ship_gym_agents.policies.onnx_export import export_onnx, onnx_model

from .conftest import FEATURES, random_policy

onnx = pytest.importorskip("onnx")
pytest.importorskip("onnxruntime")


def test_a_model_decides_as_the_policy_does(policy, tmp_path):
    export_onnx(policy, tmp_path / "policy.onnx")
    assert largest_difference(policy, tmp_path / "policy.onnx") < 1e-5
    assert [path.name for path in tmp_path.iterdir()] == ["policy.onnx"]


def test_the_comparison_can_fail(tmp_path):
    export_onnx(random_policy("lstm"), tmp_path / "policy.onnx")
    other = random_policy("lstm")
    other.network.gate_bias[0] += 0.1
    assert largest_difference(other, tmp_path / "policy.onnx") > 1e-4


def test_names_and_metadata():
    model = onnx_model(random_policy("lstm"))
    shapes = {
        value.name: [d.dim_param or d.dim_value for d in value.type.tensor_type.shape.dim]
        for value in (*model.graph.input, *model.graph.output)
    }
    assert shapes == {
        "features": ["count", 9], "hidden": ["count", 5], "cell": ["count", 5],
        "decision": ["count", 1], "next_hidden": ["count", 5], "next_cell": ["count", 5],
    }  # fmt: skip
    told = {entry.key: entry.value for entry in model.metadata_props}
    assert json.loads(told["features"]) == FEATURES and json.loads(told["decisions"]) == ["rudder"]
    assert told["ship_gym_policy"] == "tiny-lstm" and json.loads(told["form"])["action"] == "direct"
    assert json.loads(told["card"])["name"] == "tiny-lstm"


def test_a_single_row(tmp_path):
    import onnxruntime

    policy = random_policy("symmetric")
    export_onnx(policy, tmp_path / "policy.onnx")
    session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
    seen = np.full((1, 9), 0.1, dtype=np.float32)
    (found,) = session.run(["decision"], {"features": seen})
    wanted = policy.network(policy.normaliser(seen.astype(np.float64)))
    np.testing.assert_allclose(found, wanted, atol=1e-6)


def test_without_onnx_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(ImportError, match=r'pip install "ship-gym\[onnx\]"'):
        onnx_model(random_policy("linear"))


def test_without_onnxruntime_nothing_is_compared(monkeypatch, tmp_path):
    export_onnx(random_policy("linear"), tmp_path / "policy.onnx")
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    assert largest_difference(random_policy("linear"), tmp_path / "policy.onnx") is None
