"""Files of policies: one ``.safetensors`` with all numbers, and its card as JSON in the header.

Reading one runs no code that it may hold: there are arrays and text only, and an autopilot to steer
by is one of the package, never a Python file that the card names. A digest over both tells
a damaged file from a whole one. The header has one key, whose JSON holds format, digest and card;
with several, safetensors writes them in changing order, and equal policies would be other bytes.

The card holds at least ``name``, ``form``, ``network``, ``normaliser`` (its limit), ``features``
and ``decisions``; a policy that was trained has ``config``, ``validations``, ``versions`` and
``git_commit`` as well, and ``command``, which made it.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from safetensors.numpy import load, save

from ship_gym.config import ConfigError, shown, told_of
from ship_gym.reading import read_as, read_bytes
from ship_gym.writing import atomic_path
from ship_gym_agents.forms.form import form_from
from ship_gym_agents.plugins import check_no_code
from ship_gym_agents.policies.cards import checked_card
from ship_gym_agents.policies.networks import network_from
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.policies.policy import Policy
from ship_gym_agents.policies.reach import check_reach

POLICY_FILE = "policy.safetensors"
FORMAT = 2
_MARK = "ship_gym_policy"  # key of the header
_SEEDS = "seed_*"  # folders of a run with several seeds


def save_policy(policy: Policy, path: str | Path) -> None:
    """Write a policy as one file, whole or not at all.

    Raises
    ------
    ConfigError
        Its card does not name features and decisions.
    """
    if missing := [name for name in ("features", "decisions") if name not in policy.card]:
        raise ConfigError(f"policy {policy.name}: its card lacks {' and '.join(missing)}")
    made = {
        "form": dataclasses.asdict(policy.form),
        "network": policy.network.about(),
        "normaliser": {"limit": policy.normaliser.limit},
    }
    card = policy.card | made
    tensors = {k: w.astype(np.float32) for k, w in policy.network.tensors().items()}
    tensors |= {"mean": policy.normaliser.mean, "scale": policy.normaliser.scale}
    tensors = {name: np.ascontiguousarray(array) for name, array in tensors.items()}
    head = {"format": FORMAT, "digest": _digest(card, tensors), "card": card}
    with atomic_path(path) as temporary:
        temporary.write_bytes(save(tensors, metadata={_MARK: json.dumps(head)}))


def load_policy(path: str | Path) -> Policy:
    """Read a policy.

    Parameters
    ----------
    path : str or path
        The file, or the folder of a run.

    Raises
    ------
    ConfigError
        No such file, no policy, damaged, of another format, or steering by Python code of its own.
    """
    file = policy_path(path)
    data = read_bytes(file)
    with told_of(file), read_as(file, "a policy"):
        tensors = load(data)
        head = _head(data, file)
        if _digest(head["card"], tensors) != head["digest"]:
            raise ValueError("its digest is not that of what it holds")
        card = checked_card(head["card"])
        normaliser = Normaliser(
            tensors["mean"], tensors["scale"], float(card["normaliser"]["limit"])
        )
        network = network_from(card["network"], tensors)
        check_reach(network, normaliser.limit)
        made = Policy(form_from(card["form"]), normaliser, network, card)
    instead = "make the controller in Python: Policy(form, normaliser, network, card)"
    check_no_code(made.form.base, file, instead)
    made.file = file
    return made


def read_card(path: str | Path) -> dict[str, Any]:
    """The card of a policy, without its numbers.

    Raises
    ------
    ConfigError
        As `load_policy`, as far as the head of the file tells.
    """
    file = policy_path(path)
    head = _head(read_bytes(file), file)
    with told_of(file):
        return checked_card(head.get("card"))


def policy_path(path: str | Path) -> Path:
    """The file of a policy that a path means: itself, or that in the folder of a run.

    Raises
    ------
    ConfigError
        There is none; the message says what there is instead.
    """
    path = Path(path)
    if path.is_dir():
        return _in_folder(path)
    if not path.is_file():
        raise ConfigError(f"{path}: no such policy; train one with: ship-gym train")
    if path.suffix == ".onnx":
        raise ConfigError(f"{path}: an export for other programs; name the policy it was made from")
    if zipfile.is_zipfile(path):
        raise ConfigError(f"{path}: {_zip_in_words(path)}")
    return path


def seed_folders(path: str | Path) -> list[Path]:
    """Folders of the seeds of a run that have a policy, in order; empty if it has but one seed."""
    found = [folder for folder in Path(path).glob(_SEEDS) if (folder / POLICY_FILE).is_file()]
    return sorted(found, key=lambda folder: (len(folder.name), folder.name))


def _in_folder(folder: Path) -> Path:
    file = folder / POLICY_FILE
    if file.is_file():
        return file
    if (folder / "policy.zip").is_file():
        return policy_path(folder / "policy.zip")
    if seeds := seed_folders(folder):
        raise ConfigError(
            f"{folder}: no {POLICY_FILE} of the whole run yet; name one of its {len(seeds)} seeds, "
            f"such as {seeds[0]}"
        )
    if (folder / "card.json").is_file():
        raise ConfigError(f"{folder}: this run has no policy yet; the first validation writes one")
    raise ConfigError(f"{file}: no such policy; train one with: ship-gym train")


def _head(data: bytes, file: Path) -> dict[str, Any]:
    """Format, digest and card in the header of a file, the format checked."""
    with read_as(file, "a policy"):
        size = int.from_bytes(data[:8], "little")
        text = (json.loads(data[8 : 8 + size]).get("__metadata__") or {}).get(_MARK)
        head = {} if text is None else json.loads(text)
        made_for = head.get("format")
    if text is None:
        raise ConfigError(f"{file}: arrays that are not a policy of Ship Gym")
    if made_for != FORMAT:
        raise ConfigError(f"{file}: of format {shown(made_for)}; this version reads {FORMAT}")
    return head


def _digest(card: Mapping[str, Any], tensors: Mapping[str, np.ndarray]) -> str:
    """SHA-256 over card and numbers."""
    found = hashlib.sha256()
    for part in _parts(json.dumps(card, sort_keys=True), tensors):
        found.update(len(part).to_bytes(8, "little") + part)
    return found.hexdigest()


def _parts(card: str, tensors: Mapping[str, np.ndarray]) -> Iterator[bytes]:
    yield card.encode()
    for name in sorted(tensors):
        array = tensors[name]
        yield f"{name} {array.dtype.str} {array.shape}".encode()
        yield array.tobytes()


def _zip_in_words(file: Path) -> str:
    """What a zip archive that is no policy file is, and what to do with it."""
    try:
        with zipfile.ZipFile(file) as archive:
            names = set(archive.namelist())
    except (zipfile.BadZipFile, OSError):
        names = set()
    if {"card.json", "actor.npz"} <= names:
        return (
            "a policy of an earlier version; convert it: ship-gym export "
            f"{file} --to safetensors --out {file.with_suffix('.safetensors')}"
        )
    if {"data", "policy.pth"} <= names:
        return (
            "a model of stable-baselines3, not loaded since that runs code which the file may "
            "hold; if you trust it, convert it: ship-gym export "
            f"{file} --trust-sb3-zip --to safetensors --out {file.with_suffix('.safetensors')}"
        )
    return "a zip archive, not a policy"
