"""docs/training.md: its recipe can be used, its commands name what there is."""

import contextlib
import re
import shlex
from pathlib import Path

import pytest
from ship_gym_agents.cli import main
from ship_gym_agents.sb3.config import OPTIONS, available_recipes, run_config

PAGE = (Path(__file__).parents[3] / "docs" / "training.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = [
    line for kind, text in BLOCKS if kind == "bash" for line in text.splitlines() if line.strip()
]


def test_the_recipe_can_be_used(tmp_path):
    (text,) = (text for kind, text in BLOCKS if kind == "toml" and "algo =" in text)
    file = tmp_path / "mine.toml"
    file.write_text(text)
    config = run_config(recipe=file)
    assert config.algorithm == "ppo" and config.hyperparameters.form.base == "pid"
    assert config.hyperparameters.training.gamma == 0.98


@pytest.mark.parametrize("line", [c for c in COMMANDS if c.startswith("ship-gym train")])
def test_what_commands_set_is_known(line):
    words = shlex.split(line, comments=True)
    for recipe in (words[k + 1] for k, word in enumerate(words) if word == "--recipe"):
        assert recipe in available_recipes() or recipe == "mine.toml"
    for key in (word.partition("=")[0] for word in words if re.match(r"[a-z]+\.[a-z_]+=", word)):
        section, name = key.split(".")
        form = {"action": "residual", "base": "pid"}
        hyper = run_config(hyperparameters={"form": form}).hyperparameters
        assert hasattr(getattr(hyper, section), name), key


@pytest.mark.parametrize("line", COMMANDS)
def test_options_of_commands_exist(line, monkeypatch, capsys):
    words = shlex.split(line, comments=True)
    monkeypatch.setattr("sys.argv", [*words[:2], "--help"])
    with contextlib.suppress(SystemExit):
        main()
    told = capsys.readouterr().out
    assert len(COMMANDS) >= 6
    for option in (word for word in words if word.startswith("--")):
        assert option in told, option


def test_every_algorithm_is_in_the_table():
    for name in OPTIONS:
        assert re.search(rf"^\|.*`{name}`.*\|", PAGE, re.MULTILINE), name
