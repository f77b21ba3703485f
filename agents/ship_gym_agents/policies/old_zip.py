"""The policy files of version 0.1: a zip archive of a card and two sets of arrays, no code."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

from ship_gym.config import shown, told_of
from ship_gym.reading import check_unpacked, npz_arrays, parsed_json, read_as, read_bytes
from ship_gym_agents.forms.form import Form
from ship_gym_agents.policies.cards import checked_card
from ship_gym_agents.policies.networks import network_from
from ship_gym_agents.policies.normaliser import Normaliser
from ship_gym_agents.policies.policy import Policy
from ship_gym_agents.policies.reach import check_reach

_NAMES = {"card.json", "actor.npz", "normaliser.npz"}


def is_old(path: str | Path) -> bool:
    """Whether a file is a policy of version 0.1."""
    if not zipfile.is_zipfile(path):
        return False
    with read_as(path, "a zip archive"), zipfile.ZipFile(path) as archive:
        return set(archive.namelist()) >= _NAMES


def load_old(path: str | Path) -> Policy:
    """Read one; it gives the same actions, those of the form direct on plain observations.

    Raises
    ------
    ConfigError
        Damaged.
    """
    data = read_bytes(path)
    with told_of(path), read_as(path, "a policy"):
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            check_unpacked(archive)
            parts = {name: archive.read(name) for name in sorted(_NAMES)}
        card = parsed_json(parts["card.json"], path)
        layers = npz_arrays(parts["actor.npz"], f"{path}: actor.npz")
        scaling = npz_arrays(parts["normaliser.npz"], f"{path}: normaliser.npz")
        if card.pop("format") != 1:
            raise ValueError("its format is not 1")
        made = card.pop("network")
        if not 1 <= made["layers"] <= len(layers):
            raise ValueError(f"layers = {shown(made['layers'])}: it has {len(layers)} arrays")
        hidden = [len(layers[f"bias_{k}"]) for k in range(made["layers"] - 1)]
        about = {"kind": "mlp", "hidden": hidden, "symmetric": False}
        about |= {key: made[key] for key in ("activation", "output")}
        network = network_from(about, layers)
        limit = float(scaling["limit"])
        normaliser = Normaliser(scaling["mean"], scaling["scale"], limit)
        check_reach(network, limit)
        card["features"] = [f"observation.{name}" for name in card.pop("observations")]
        card["decisions"] = ["rudder", "rpm"][: network.n_decisions]
        card_now = {**card, "form": {}, "network": about, "normaliser": {"limit": limit}}
        checked_card(card_now)
        return Policy(Form(), normaliser, network, card)
