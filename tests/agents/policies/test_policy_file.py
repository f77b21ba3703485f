"""Files of policies: what is written is read, what is damaged is refused, and no code is run."""

import io
import json
import pickle
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.numpy import load, save
from ship_gym_agents.entrants import entrant
from ship_gym_agents.forms.form import Form
from ship_gym_agents.gains_files import tuned_files
from ship_gym_agents.policies import policy_file
from ship_gym_agents.policies.networks import Mlp
from ship_gym_agents.policies.old_zip import is_old, load_old
from ship_gym_agents.policies.policy_file import (
    POLICY_FILE,
    load_policy,
    read_card,
    save_policy,
    seed_folders,
)
from ship_gym_agents.policies.reach import check_reach

from ship_gym.config import ConfigError

from .conftest import COLUMNS, FEATURES, observations, random_policy, sailed

FIXTURES = [HealthCheck.function_scoped_fixture]


@pytest.fixture
def file(tmp_path):
    save_policy(random_policy("symmetric"), tmp_path / POLICY_FILE)
    return tmp_path / POLICY_FILE


def test_a_read_policy_gives_the_same_actions(policy, tmp_path):
    save_policy(policy, tmp_path / "run" / POLICY_FILE)
    assert [path.name for path in (tmp_path / "run").iterdir()] == [POLICY_FILE]
    again, seen = load_policy(tmp_path / "run"), observations()
    np.testing.assert_array_equal(sailed(again, seen), sailed(policy, seen))
    assert again.name == policy.name and again.form == policy.form
    save_policy(again, tmp_path / "copy.safetensors")
    one, two = (tmp_path / name for name in (f"run/{POLICY_FILE}", "copy.safetensors"))
    assert one.read_bytes() == two.read_bytes()


def test_the_card_is_read_from_the_head_alone(file):
    card = read_card(file)
    assert card["name"] == "tiny-symmetric" and card["features"] == FEATURES
    assert card["form"]["action"] == "direct" and card["network"]["symmetric"]
    file.write_bytes(file.read_bytes()[:-8] + bytes(8))  # other numbers
    assert read_card(file) == card
    with pytest.raises(ConfigError, match="digest"):
        load_policy(file)


def test_a_card_without_names_is_not_written(tmp_path):
    policy = random_policy("linear")
    del policy.card["features"]
    with pytest.raises(ConfigError, match="lacks features"):
        save_policy(policy, tmp_path / POLICY_FILE)
    assert not list(tmp_path.iterdir())


# --- damage --------------------------------------------------------------------------------------


@settings(max_examples=150, suppress_health_check=FIXTURES)
@given(st.floats(0.0, 1.0, exclude_max=True))
def test_half_a_file_is_refused(file, share):
    whole = file.read_bytes()
    part = file.with_name("part.safetensors")
    part.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ConfigError, match="not a policy"):
        load_policy(part)


@settings(max_examples=300, suppress_health_check=FIXTURES)
@given(st.floats(0.0, 1.0, exclude_max=True), st.integers(1, 255))
def test_a_byte_that_changed_is_refused_or_changes_nothing(file, place, change):
    """In the padding of the header, a byte may be another space character."""
    whole = bytearray(file.read_bytes())
    whole[int(place * len(whole))] ^= change
    flipped = file.with_name("flipped.safetensors")
    flipped.write_bytes(whole)
    try:
        again = load_policy(flipped)
    except ConfigError as error:
        assert str(flipped) in str(error) and "\n" not in str(error)
    else:
        seen, wanted = observations(), load_policy(file)
        assert again.card == wanted.card
        np.testing.assert_array_equal(sailed(again, seen), sailed(wanted, seen))


def rewritten(file, change):
    """The file with another head or other arrays, its digest made to fit."""
    tensors, card = load(file.read_bytes()), read_card(file)
    head = {"format": 2, "card": card, "digest": None}
    change(head, tensors)
    if head["digest"] is None:
        head["digest"] = policy_file._digest(head["card"], tensors)
    text = head.get("text", json.dumps(head))
    file.write_bytes(save(tensors, metadata={head.get("mark", "ship_gym_policy"): text}))
    return file


def put(name, value):
    return lambda head, tensors: head["card"].update({name: value})


def nan(head, tensors):
    tensors["weight_0"][0, 0] = np.nan


def changed(key, value):
    return lambda head, tensors: head.update({key: value})


DAMAGE = {
    "no mark": (changed("mark", "other"), "arrays that are not a policy"),
    "format": (changed("format", 3), "of format 3; this version reads 2"),
    "no JSON": (changed("text", "{"), "not a policy, or damaged"),
    "a list": (changed("text", "[1]"), "not a policy, or damaged"),
    "deep": (changed("text", "[" * 100_000), "not a policy: nested too deep"),
    "card": (changed("card", [1]), "card = [1]: must be a table of keys"),
    "no card": (changed("text", '{"format": 2, "digest": "0"}'), "no 'card'"),
    "no digest": (changed("text", '{"format": 2, "card": {}}'), "no 'digest'"),
    "no format": (lambda head, tensors: head.pop("format"), "of format None; this version reads 2"),
    "name": (put("name", ["a"]), "card.name = ['a']: must be of type str"),
    "long name": (put("name", "a" * 300), "card.name = 'aaa"),
    "names": (put("features", 7), "card.features = 7: must be of type list"),
    "names of what": (put("decisions", [{}]), "card.decisions = [{}]: must be a list of names"),
    "no normaliser": (put("normaliser", {}), "card.normaliser has no 'limit'"),
    "limit": (put("normaliser", {"limit": float("nan")}), "normaliser.limit = None: must be a"),
    "text for limit": (put("normaliser", {"limit": "10"}), "normaliser.limit = '10': must be a"),
    "config": (put("config", [1]), "card.config = [1]: must be a table of keys"),
    "scenario": (put("config", {"scenario": 1}), "card.config.scenario must be a table"),
    "digest": (changed("digest", "0"), "digest"),
    "form": (put("form", {"action": "direct", "evry": 2}), "did you mean 'every'"),
    "features": (put("features", ["yaw_rate"]), "1 features"),
    "network": (put("network", {}), "card.network has no 'kind'"),
    "no array": (lambda head, tensors: tensors.pop("bias_1"), "no 'bias_1'"),
    "shape": (lambda head, tensors: tensors.update(bias_0=np.zeros(3)), "bias_0 has shape"),
    "numbers": (nan, "weight_0 is not finite"),
    "scale": (lambda head, tensors: tensors.update(scale=np.zeros(9)), "must be positive"),
    "no scale": (lambda head, tensors: tensors.pop("scale"), "no 'scale'"),
    "nan scale": (lambda head, tensors: tensors.update(scale=np.full(9, np.nan)), "not finite"),
    "huge mean": (lambda head, tensors: tensors.update(mean=np.full(9, 1e300)), "at most 1e+30"),
    "flags": (lambda head, tensors: tensors.update(mean=np.zeros(9, bool)), "mean is of type bool"),
    "hidden": (
        lambda head, tensors: head["card"]["network"].update(hidden=[1]),
        "hidden = [1]: its layers have",
    ),
}


@pytest.mark.parametrize("case", DAMAGE)
def test_wrong_contents_are_one_clear_line(file, case):
    change, words = DAMAGE[case]
    with pytest.raises(ConfigError) as error:
        load_policy(rewritten(file, change))
    assert words in str(error.value) and str(file) in str(error.value)


def test_paths_that_are_no_policy(tmp_path):
    with pytest.raises(ConfigError, match="no such policy; train one with: ship-gym train"):
        load_policy(tmp_path / "none.safetensors")
    with pytest.raises(ConfigError, match="no such policy"):
        load_policy(tmp_path)
    (tmp_path / "card.json").write_text("{}")
    with pytest.raises(ConfigError, match="no policy yet"):
        load_policy(tmp_path)
    for data in (b"", b"text", bytes(100), b"\xff" * 100):
        (tmp_path / "text").write_bytes(data)
        with pytest.raises(ConfigError, match="not a policy, or damaged"):
            load_policy(tmp_path / "text")


def test_folders_of_several_seeds(tmp_path, file):
    for k in (0, 2, 10):
        (tmp_path / "run" / f"seed_{k}").mkdir(parents=True)
        shutil.copy(file, tmp_path / "run" / f"seed_{k}")
    assert [folder.name for folder in seed_folders(tmp_path / "run")] == [
        "seed_0", "seed_2", "seed_10",
    ]  # fmt: skip
    with pytest.raises(ConfigError, match=r"name one of its 3 seeds, such as .*seed_0"):
        load_policy(tmp_path / "run")
    shutil.copy(file, tmp_path / "run")
    assert load_policy(tmp_path / "run").name == "tiny-symmetric"


@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_weights_that_could_reach_no_number_are_refused():
    rng = np.random.default_rng(0)
    weights = tuple(rng.choice([-3e38, 3e38], (8, 8)) for _ in range(9))
    network = Mlp(weights, (np.zeros(8),) * 9, "relu")
    assert np.isnan(network(rng.normal(size=(9, 8)))).any()
    with pytest.raises(ConfigError, match=r"weight_7 is so large that its layer can reach"):
        check_reach(network, 10.0)
    check_reach(Mlp(weights, (np.zeros(8),) * 9, "tanh"), 10.0)


def test_what_is_not_finite_in_a_card_is_none(file):
    """Validations may have no measure; JSON for others has no nan."""
    again = load_policy(rewritten(file, put("best", {"rms": float("nan"), "more": [np.inf, 1.0]})))
    assert again.card["best"] == {"rms": None, "more": [None, 1.0]} == read_card(file)["best"]


# --- code that a file may hold -------------------------------------------------------------------


class Harmful:
    """Unpickled, it leaves a file behind."""

    def __init__(self, trace):
        self.trace = trace

    def __reduce__(self):
        return Path.touch, (self.trace,)


def pickled_array(trace):
    held = io.BytesIO()
    array = np.empty(1, dtype=object)
    array[0] = Harmful(trace)
    np.savez(held, weight_0=array)
    return held.getvalue()


@pytest.mark.parametrize("name", ["policy.safetensors", "policy.zip", "model.pkl", "model.pt"])
@pytest.mark.parametrize("kind", ["pickle", "array", "stable-baselines3", "old"])
def test_nothing_in_a_file_is_run(tmp_path, name, kind):
    trace, harm = tmp_path / "trace", pickle.dumps(Harmful(tmp_path / "trace"))
    pickle.loads(harm)
    assert trace.exists(), "the trap must work"
    trace.unlink()
    held = {"pickle": harm, "array": pickled_array(trace)}.get(kind)
    if held is None:
        made = io.BytesIO()
        parts = {
            "stable-baselines3": {"data": harm, "policy.pth": harm, "pytorch_variables.pth": harm},
            "old": {
                "card.json": b'{"name": "a", "network": {"layers": 1}}',
                "actor.npz": pickled_array(trace),
                "normaliser.npz": pickled_array(trace),
            },
        }[kind]
        with zipfile.ZipFile(made, "w") as archive:
            for part, data in parts.items():
                archive.writestr(part, data)
        held = made.getvalue()
    (tmp_path / name).write_bytes(held)
    for read in (load_policy, read_card, load_old):
        with pytest.raises(ConfigError):
            read(tmp_path / name)
    with pytest.raises(ConfigError):
        load_policy(tmp_path)
    assert not trace.exists()


OWN = """
from pathlib import Path
from ship_gym_agents.pid import PID as Own
Path("trace").touch()
"""


@pytest.mark.parametrize("base", ["own.py:Own", "own.py:Own@kcs", "own.py@kcs", "own.toml"])
def test_no_python_file_that_a_card_names_is_run(tmp_path, monkeypatch, base):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.py").write_text(OWN)
    (tmp_path / "own.toml").write_text('controller = "own.py:Own"\n')
    save_policy(random_policy("linear", Form("residual", base, 0.1)), "policy.safetensors")
    with pytest.raises(ConfigError, match="Python code of its own, not run"):
        load_policy("policy.safetensors")
    with pytest.raises(ConfigError, match="Python code of its own, not run"):
        entrant("policy.safetensors")
    assert not (tmp_path / "trace").exists()


def test_gains_of_a_file_may_steer(tmp_path):
    gains = tuned_files("pid")[0]
    save_policy(random_policy("linear", Form("residual", str(gains), 0.1)), tmp_path / POLICY_FILE)
    sailed(load_policy(tmp_path), observations())


def test_an_onnx_export_is_no_policy(tmp_path):
    (tmp_path / "policy.onnx").write_bytes(b"")
    with pytest.raises(ConfigError, match="name the policy it was made from"):
        load_policy(tmp_path / "policy.onnx")


def test_zips_are_told_apart(tmp_path):
    def made(name, *parts):
        with zipfile.ZipFile(tmp_path / name, "w") as archive:
            for part in parts:
                archive.writestr(part, b"")
        return tmp_path / name

    with pytest.raises(
        ConfigError, match=r"earlier version; convert it: ship-gym export \S+old.zip"
    ):
        load_policy(made("old.zip", "card.json", "actor.npz", "normaliser.npz"))
    with pytest.raises(ConfigError, match=r"runs code .* --trust-sb3-zip --to safetensors"):
        load_policy(made("sb3.zip", "data", "policy.pth"))
    with pytest.raises(ConfigError, match="a zip archive, not a policy"):
        load_policy(made("other.zip", "text"))
    assert is_old(tmp_path / "old.zip") and not is_old(tmp_path / "sb3.zip")


# --- files of version 0.1 ------------------------------------------------------------------------


def npz(**arrays):
    held = io.BytesIO()
    np.savez(held, **arrays)
    return held.getvalue()


def test_an_old_file_gives_the_same_actions(tmp_path):
    policy = random_policy("relu")
    net, scaling = policy.network, policy.normaliser
    about = {"layers": 3, "activation": "relu", "output": "tanh"}
    card = {"name": "old", "format": 1, "network": about, "observations": COLUMNS}
    with zipfile.ZipFile(tmp_path / "policy.zip", "w") as archive:
        archive.writestr("card.json", json.dumps({**card, "config": {"seed": 3}}))
        archive.writestr("actor.npz", npz(**net.tensors()))
        limits = {"mean": scaling.mean, "scale": scaling.scale, "limit": scaling.limit}
        archive.writestr("normaliser.npz", npz(**limits))
    again, seen = load_old(tmp_path / "policy.zip"), observations()
    np.testing.assert_array_equal(sailed(again, seen), sailed(policy, seen))
    assert again.name == "old" and again.card["features"] == FEATURES
    save_policy(again, tmp_path / "new.safetensors")
    assert load_policy(tmp_path / "new.safetensors").about()["seed"] == 3
    with pytest.raises(ConfigError, match="earlier version"):
        load_policy(tmp_path)
