"""The policy files of version 0.1: a zip archive of a card and two sets of arrays, no code."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError
from ship_gym_agents.forms.form import Form
from ship_gym_agents.policies.networks import Mlp
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.policies.policy import Policy

_NAMES = {"card.json", "actor.npz", "normaliser.npz"}


def is_old(path: str | Path) -> bool:
    """Whether a file is a policy of version 0.1."""
    if not zipfile.is_zipfile(path):
        return False
    with zipfile.ZipFile(path) as archive:
        return set(archive.namelist()) >= _NAMES


def load_old(path: str | Path) -> Policy:
    """Read one; it gives the same actions, those of the form direct on plain observations.

    Raises
    ------
    ConfigError
        Damaged.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            card = json.loads(archive.read("card.json"))
            layers = _arrays(archive.read("actor.npz"))
            scaling = _arrays(archive.read("normaliser.npz"))
        made = card.pop("network")
        order = range(made["layers"])
        network = Mlp(
            tuple(layers[f"weight_{k}"] for k in order),
            tuple(layers[f"bias_{k}"] for k in order),
            made["activation"],
            made["output"],
        )
        normaliser = Normaliser(scaling["mean"], scaling["scale"], float(scaling["limit"]))
        card["features"] = [f"observation.{name}" for name in card.pop("observations")]
        card["decisions"] = ["rudder", "rpm"][: network.n_decisions]
        del card["format"]
        return Policy(Form(), normaliser, network, card)
    except (zipfile.BadZipFile, KeyError, ValueError, TypeError, EOFError, OSError) as error:
        raise ConfigError(f"{path}: not a policy, or damaged: {error}") from error


def _arrays(data: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(data), allow_pickle=False) as found:
        return {name: found[name] for name in found.files}
