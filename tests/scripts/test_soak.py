"""The soak: every chunk is another, a log goes on where it was, and what must not be is found."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

import ship_gym
from ship_gym.config import ConfigError

SCRIPTS = Path(__file__).parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))

import _soak  # noqa: E402
import soak  # noqa: E402


def test_chunks_have_every_ship_scenario_sea_helm_and_draw():
    chunks = [_soak.chunk_of(k) for k in range(1000)]
    assert len({chunk[1:] for chunk in chunks}) == 1000
    for field, values in {
        "ship": ship_gym.available_ships(),
        "scenario": _soak.scenarios(),
        "sea": _soak.SEAS,
        "helm": _soak.HELMS,
        "draw": _soak.DRAWS,
    }.items():
        seen = [getattr(chunk, field) for chunk in chunks]
        counts = [seen.count(value) for value in values]
        assert min(counts) > 0.8 * 1000 / len(values), field


@pytest.mark.parametrize("number", [2, 5, 12, 13])  # each helm
def test_a_chunk_tells_what_it_saw(number):
    chunk = _soak.chunk_of(number)
    line = _soak.sail(chunk, seed=0, n=4, intervals=20)
    assert line["steps"] == 80 and line["bad"] == {} and line["ship"] == chunk.ship
    assert line == _soak.sail(chunk, seed=0, n=4, intervals=20)


def spoiled(monkeypatch, name, value):
    """What is found where a step leaves a value behind."""
    sail = _soak.Watch.look

    def look(watch, observations, rewards, *rest):
        batch = watch._batch
        if name == "reward":
            rewards = rewards + value
        elif name == "observation":
            observations = observations + value
        elif name == "outcome":
            batch.outcomes[:] = value
        else:
            getattr(batch.sim, name)[0] = value
        sail(watch, observations, rewards, *rest)

    monkeypatch.setattr(_soak.Watch, "look", look)
    return _soak.sail(_soak.chunk_of(2), seed=0, n=4, intervals=1)["bad"]


@pytest.mark.parametrize(
    ("name", "value", "found"),
    [
        ("reward", np.nan, "reward not finite"),
        ("observation", np.nan, "observation outside its space"),
        ("observation", np.float32(9.0), "observation outside its space"),
        ("outcome", 1, "diverged, but goes on"),
        ("state", np.inf, "state not finite"),
        ("state", 2.0, "rudder over its limit"),
        ("state", 1e3, "propeller over its limit"),
        ("forces", np.nan, "forces not finite"),
    ],
)
def test_what_must_not_be_is_found(monkeypatch, name, value, found):
    assert found in spoiled(monkeypatch, name, value)


@pytest.fixture
def quick(monkeypatch):
    """Chunks that sail nothing; gives the numbers of those that were asked for."""
    asked = []

    def sail(chunk, seed):
        asked.append(chunk.number)
        if chunk.number == 3:
            raise ZeroDivisionError("here")
        counts = {"ended": 1, "diverged": 0, "fastest": 1.0, "turn": 0.5, "above": 0, "bad": {}}
        return chunk._asdict() | {"steps": _soak.STEPS} | counts

    monkeypatch.setattr(_soak, "sail", sail)
    return asked


def run(monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["soak.py", *map(str, words)])
    soak.main()


def test_a_killed_soak_goes_on_where_it_was(quick, monkeypatch, tmp_path, capsys):
    log = tmp_path / "log.jsonl"
    run(monkeypatch, "--steps", 2 * _soak.STEPS, "--log", log)
    with log.open("ab") as file:
        file.write(b'{"number": 2, "sh')  # torn by a kill
    run(monkeypatch, "--steps", 3 * _soak.STEPS, "--log", log, "--json")
    assert quick == [0, 1, 2]
    assert len(log.read_text().splitlines()) == 4
    told = json.loads(capsys.readouterr().out.split("jsonl\n", 1)[1])
    assert told["steps"] == 3 * _soak.STEPS and told["ended"] == 3


def test_an_exception_is_a_finding_with_its_chunk(quick, monkeypatch, tmp_path, capsys):
    with pytest.raises(SystemExit):
        run(monkeypatch, "--steps", 5 * _soak.STEPS, "--log", tmp_path / "log.jsonl")
    assert "chunk 3, " in (text := capsys.readouterr().out) and "ZeroDivisionError: here" in text
    assert quick == [0, 1, 2, 3, 4]


def test_figures_go_into_a_page(quick, monkeypatch, tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{soak.BEGIN}\nold\n{soak.END}\nafter\n")
    run(monkeypatch, "--steps", _soak.STEPS, "--log", tmp_path / "log.jsonl", "--page", page)
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith("after\n") and "old" not in text
    assert "100,000 ship-steps in 1 chunks" in text


@pytest.mark.parametrize("text", ["", "{}\n", "no log\n", '{"format": 1, "seed": 7}\n'])
def test_other_logs_are_refused(quick, monkeypatch, tmp_path, text):
    log = tmp_path / "log.jsonl"
    log.write_text(text)
    if not text:
        run(monkeypatch, "--steps", _soak.STEPS, "--log", log)
        return
    with pytest.raises(ConfigError, match="another --log"):
        run(monkeypatch, "--steps", _soak.STEPS, "--log", log)
    assert log.read_text() == text
