import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from ship_gym_agents.cli import main
from ship_gym_agents.forms.form import Form
from ship_gym_agents.policies.networks import Mlp
from ship_gym_agents.policies.normaliser import no_scaling
from ship_gym_agents.policies.policy import Policy
from ship_gym_agents.policies.policy_file import POLICY_FILE, save_policy

from ship_gym.tasks.bridge import OBSERVATIONS

SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.fixture
def cli(monkeypatch, tmp_path, capsys):
    """Run ship-gym in this process, in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        code = 0
        try:
            main([*map(str, arguments)])
        except SystemExit as stop:
            code = stop.code or 0
        return code, *capsys.readouterr()

    return call


@pytest.fixture
def call(monkeypatch, tmp_path, capsys):
    """Run a script in this process, in an empty folder; gives exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(SCRIPTS))

    def run(script: str, *arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", [script, *arguments])
        code = 0
        try:
            runpy.run_path(str(SCRIPTS / script), run_name="__main__")
        except SystemExit as end:
            code = end.code or 0
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def policy(tmp_path):
    """Folder of a policy that steers with rudder = -2 sin(psi_e) - r'."""
    weights = np.zeros((1, 9))
    weights[0, 0], weights[0, 2] = -2.0, -1.0
    features = [f"observation.{row[0]}" for row in OBSERVATIONS]
    card = {"name": "tiny", "features": features, "decisions": ["rudder"]}
    made = Policy(Form(), no_scaling(9), Mlp((weights,), (np.zeros(1),)), card)
    for folder in ("run", "run/seed_0", "run/seed_1"):
        save_policy(made, tmp_path / folder / POLICY_FILE)
    return "run"
