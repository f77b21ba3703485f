"""``ship-gym tune``: several controllers and ships, what it says, a controller of one's own."""

import json
import tomllib

import pytest
from ship_gym_agents import gains_files, make_controller
from ship_gym_agents.gains_files import gains_path
from ship_gym_agents.tuning import search

OWN = """
import dataclasses
import numpy as np


@dataclasses.dataclass(frozen=True)
class Gains:
    K: float = 0.2


class P:
    KIND = "p"
    TUNED = {"K": (0.1, 0.5, 0.2)}

    def __init__(self, gains=None, name="p"):
        self.gains, self.name = gains or Gains(), name

    @classmethod
    def first_gains(cls, ship) -> Gains:
        return Gains()

    def reset(self, count, ship, scenario):
        pass

    def act(self, seen):
        return np.clip(-np.reshape(self.gains.K, (-1, 1)) * seen[:, :1], -1.0, 1.0)
"""
SMALL = ["--episodes", 2, "--generations", 1, "--candidates", 4, "--polish", 0]
SMALL += ["--set", "duration=30"]


@pytest.fixture
def checkout(monkeypatch, tmp_path):
    """A checkout whose package has the gains of the PID of kcs only."""
    folder = tmp_path / "agents" / "ship_gym_agents" / "gains"
    folder.mkdir(parents=True)
    (tmp_path / "pyproject.toml").write_text("")
    (folder / "pid_kcs.toml").write_bytes(gains_path("kcs").read_bytes())
    monkeypatch.setattr(gains_files, "GAINS", folder)
    return folder


def test_controllers_are_tuned_in_turn_and_resumed(cli, checkout):
    """A guidance begins at the PID that was tuned just before it."""
    pytest.importorskip("optuna")
    (checkout / "pid_kcs.toml").unlink()
    ilos, both = ["--controllers", "ilos"], ["--controllers", "pid", "ilos"]
    code, _, err = cli("tune", *ilos, "--ship", "kcs", *SMALL)
    assert code == 2 and "no pid gains for ship 'kcs'" in err
    code, out, err = cli("tune", *both, "--ship", "kcs", *SMALL)
    assert code == 0, err
    assert out.count("against the gains that tuning begins at: ") == 2
    assert "J_0.1" in out and "rms_route" in out and "--scenario track_following" in out
    pid, found = (tomllib.loads((checkout / f"{k}_kcs.toml").read_text()) for k in ("pid", "ilos"))
    assert found["controller"] == "ilos" and found["tuning"]["seeds_tuning"] == [500000, 500001]
    assert found["gains"]["K_i"] == pid["gains"]["K_i"]
    out = cli("tune", *both, "--ship", "kcs", *SMALL, "--resume")[1]
    assert "pid for kcs: tuned already" in out and "ilos for kcs: tuned already" in out


def test_gains_of_courses_go_beside_those_of_headings(cli, checkout):
    pytest.importorskip("optuna")
    before = (checkout / "pid_kcs.toml").read_bytes()
    options = ["--ship", "kcs", "--scenario", "course_changing", "--structure", "turn"]
    options += [*SMALL[:-1], "duration=60"]
    code, out, err = cli("tune", *options)
    assert code == 0, err
    made = checkout / "pid_kcs.course_changing.toml"
    assert f"wrote {made}" in out and "against pid_kcs.toml" in out
    assert "settling_time" in out and "overshoot" in out and "J_0.1" in out
    assert (checkout / "pid_kcs.toml").read_bytes() == before
    found = tomllib.loads(made.read_text())
    assert found["task"] == "course_changing" and "settling time" in found["tuning"]["objective"]
    out = cli("tune", *options, "--resume")[1]
    assert "pid for kcs: tuned already" in out


def test_a_controller_of_ones_own(cli, tmp_path):
    """Tuned into a file that makes it; the range of its gain is too small, which is told."""
    pytest.importorskip("optuna")
    (tmp_path / "mine.py").write_text(OWN)
    own = ["tune", "--controllers", "mine.py:P", "--ship", "kcs", "--episodes", 4]
    code, _, err = cli(*own)
    assert code == 2 and "your own needs a file for its gains: --out" in err
    own += ["--generations", 5, "--set", "duration=90", "--out", "p.toml"]
    code, out, err = cli(*own)
    assert code == 0, err
    assert "WARNING: K lies at the bound 0.5 of its range" in out
    assert ": better, 12 validation seeds" in out
    assert make_controller("p.toml").gains.K == pytest.approx(0.5, rel=0.01)
    code, out, err = cli(*own, "--json")
    found = json.loads(out)["mine.py:P/kcs"]
    assert found["tuning"]["at_bounds"] == ["K"] and found["tuning"]["gained"][2] < 0.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--controllers", "constant"], "'constant' has no gains; allowed are pid"),
        (["--controllers", "pidd"], "did you mean 'pid'"),
        (["--structure", "PDD", "--ship", "kcs"], "did you mean 'PD'"),
        (["--ship", "kcs", "kcz"], "did you mean 'kcs'"),
        (["--candidates", "2"], "--candidates = 2: allowed is 4 to 10000"),
        (["--ship", "kcs", "kvlcc2", "--out", "x.toml"], "name one controller and one ship"),
    ],
)
def test_what_cannot_be_tuned_is_refused(cli, checkout, arguments, words):
    pytest.importorskip("optuna")
    code, out, err = cli("tune", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and words in err


def test_without_optuna_nothing_begins(cli, monkeypatch):
    monkeypatch.setattr(search, "find_spec", lambda name: None)
    code, out, err = cli("tune", "--ship", "kcs")
    assert (code, out) == (2, "") and 'pip install "ship-gym[tune]"' in err
