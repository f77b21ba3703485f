"""Files that readers of the pages have: each function makes one at the place it is given."""

import shutil
from pathlib import Path

import numpy as np

from tests.docs.blocks import ROOT, blocks_of
from tests.identification.own_files import HEAD, own_record


def file_in(page: str, name: str) -> str:
    """Text of a file that is a block of a page."""
    return next(block.code for block in blocks_of(ROOT / page) if block.file == name)


def controller(name: str) -> str:
    """A controller of one's own by that name, in ``mine.py``."""
    return file_in("docs/own.md", "mine.py").replace("Proportional", name)


def policy(place: Path) -> None:
    """Folder of a run: its policy steers by what is observed, -2 sin(psi_e) - r'."""
    from ship_gym_agents.forms.form import Form
    from ship_gym_agents.policies.networks import Mlp
    from ship_gym_agents.policies.normaliser import no_scaling
    from ship_gym_agents.policies.policy import Policy
    from ship_gym_agents.policies.policy_file import POLICY_FILE, save_policy

    from ship_gym.tasks.bridge import OBSERVATIONS

    weights = np.zeros((1, 9))
    weights[0, 0], weights[0, 2] = -2.0, -1.0
    card = {"name": "tiny", "features": [f"observation.{row[0]}" for row in OBSERVATIONS]}
    card["decisions"] = ["rudder"]
    mine = Policy(Form(), no_scaling(9), Mlp((weights,), (np.zeros(1),)), card)
    place.mkdir(parents=True)
    save_policy(mine, place / POLICY_FILE)


def ship(place: Path) -> None:
    """A ship of one's own: the file, with wave table and surrogates beside it."""
    from ship_gym.ships import DATA

    shutil.copytree(DATA / "kvlcc2_model", place.parent, dirs_exist_ok=True)
    (place.parent / "ship.toml").rename(place)


def captive(place: Path) -> None:
    """Captive tests of the ship, that of the file's name, in a tank without scatter."""
    from ship_gym.captive import measure, programme

    runs = programme("kvlcc2_model", place.stem)
    rows = measure("kvlcc2_model", runs)
    motions = {"beta [deg]": [np.degrees(run.beta) for run in runs]}
    motions |= {"yaw_rate [-]": [run.yaw_rate for run in runs]}
    motions |= {"frequency [1/s]": [run.omega / (2.0 * np.pi) for run in runs]}
    motions |= {"speed [m/s]": [run.speed for run in runs], "n [rev/s]": [run.n for run in runs]}
    table = motions | {f"{name} [-]": [row[name] for row in rows] for name in rows[0]}
    lines = [
        ",".join(table),
        *(",".join(map(repr, map(float, x))) for x in zip(*table.values(), strict=True)),
    ]
    place.write_text(HEAD + "\n".join(lines) + "\n")


def record(place: Path) -> None:
    """A free-running test as a tracker writes it, with a straight run ahead of it."""
    from ship_gym.manoeuvres import turning_circle, zigzag

    sail = {
        "turn": lambda: turning_circle("kvlcc2_model"),
        "zigzag": lambda: zigzag("kvlcc2_model"),
    }
    sail["other"] = lambda: turning_circle("kvlcc2_model", delta=-0.3)
    own_record(place, sail[place.stem]())
