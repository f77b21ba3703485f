"""The scripts benchmark_speed and check_speed: what they print, write and refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ship_gym.reports import speed, speed_against, speed_check, speed_peers

SCRIPTS = Path(__file__).parents[2] / "scripts"
TIMES = {"seconds": 1e-3, "processor": 1e-3, "wall": 2e-3, "spread_percent": 3.0}


@pytest.fixture
def timeless(monkeypatch):
    """Every measurement made up, so that nothing is compiled or timed."""

    def measured(job, repeats, seconds):
        told = {"table": job.table, "name": job.name, "n": job.n, "threads": job.threads}
        return {**told, **TIMES}

    peers = [
        {"name": "Ship Gym, kvlcc2", "what": "a step", "seconds": 2e-6},
        {"name": "other", "what": "its step", "seconds": None, "reason": "not installed (there)"},
    ]
    overhead = {"scenario": "heading_keeping", "n": 64, "physics": 1e-4, "step": 2e-4}
    monkeypatch.setattr(speed, "measure", measured)
    monkeypatch.setattr(speed, "overhead", lambda *_, **__: overhead | {"percent": 100.0})
    monkeypatch.setattr(speed_against, "memory", lambda n, **_: {"batch": 2000.0, "resident": None})
    monkeypatch.setattr(speed_peers, "measure_peers", lambda *_: peers)


@pytest.mark.parametrize("script", ["benchmark_speed.py", "check_speed.py"])
def test_help_shows_examples(call, script):
    code, out, _ = call(script, "--help")
    assert code == 0
    assert f"python scripts/{script}" in out


def test_text_has_every_table(call, timeless):
    code, out, _ = call("benchmark_speed.py", "--quick")
    assert code == 0
    for words in (
        "physics, waves, one core",
        "against the number of ships",
        "against the number of waves",
        "cost 100 % of the physics",
        "batch 2,000",
        "not installed (there)",
    ):
        assert words in out, words
    row = next(line for line in out.splitlines() if line.startswith("physics, calm, one core"))
    assert row.split()[-6:] == ["1", "1,000", "1000", "2000", "3", "%"]


def test_json_picture_and_page(call, timeless):
    Path("p.md").write_text(f"# Speed\n\n{speed.BEGIN}\nbefore this run\n{speed.END}\n\nend\n")
    arguments = ("--quick", "--json", "--plot", "s.png", "--page", "p.md")
    code, out, _ = call("benchmark_speed.py", *arguments)
    data = json.loads(out)
    assert code == 0 and data["files"] == ["s.png", "p.md"]
    assert Path("s.png").read_bytes()[:4] == b"\x89PNG"
    page = Path("p.md").read_text()
    assert "before this run" not in page and page.endswith("\n\nend\n") and "physics, calm" in page
    assert {row["n"] for row in data["growth"]} == {1, 256, 1024}
    assert [row["n"] for row in data["waves"]] == [0, 60]
    assert data["training"] == {} and data["machine"]["cores"] >= 1


def test_training_alone(call, monkeypatch):
    throughput = pytest.importorskip("ship_gym_agents.sb3.throughput")
    plain = {"samples": 10, "samples_per_second": 1000.0, "learning_percent": 20.0, "ratio": 7.5}
    found = {
        "algorithm": "ppo", "envs": 256, "threads": 1, "cores": 2, "epochs": 8, "samples": 100,
        "samples_per_second": 7500.0, "sailing_percent": 50.0, "learning_percent": 90.0,
        "side_by_side": True, "load": None, "plain": plain,
    }  # fmt: skip
    monkeypatch.setattr(throughput, "throughput", lambda *_, **__: found)
    code, out, _ = call("benchmark_speed.py", "--training")
    assert code == 0
    for words in ("7,500 samples/s", "learning 90 %, side by side", "1,000", "7.5 times as fast"):
        assert words in out, words
    assert "physics" not in out
    code, out, _ = call("benchmark_speed.py", "--training", "--json")
    assert json.loads(out)["training"]["plain"]["ratio"] == 7.5


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--quick", "--full"), ("--quick", "--full")),
        (("--only", "calm"), ("--only", "--against")),
        (("--training", "--quick"), ("--training", "--quick")),
        (("--against", "nowhere"), ("--against nowhere", "ship_gym/__init__.py")),
        (("--page", "none.md", "--quick"), ("none.md", "marks")),
        (("--ship", "kcz", "--quick"), ("kcz", "kcs")),
    ],
)
def test_refuses_in_one_line(call, monkeypatch, arguments, words):
    monkeypatch.setattr(speed, "measure", lambda *_: pytest.fail("measured before it refused"))
    code, out, err = call("benchmark_speed.py", *arguments)
    assert code == 2 and out == ""
    assert len(err.strip().splitlines()) == 1
    assert all(word in err for word in words), err


def seconds(**changes: float) -> dict[str, float]:
    names = {name for pair in speed_check.RATIOS.values() for name in pair}
    return dict.fromkeys(names, 1.0) | changes


def test_check_writes_a_baseline_and_fails_beyond_its_margin(call, monkeypatch):
    monkeypatch.setattr(speed_check, "run", lambda **_: seconds())
    code, out, _ = call("check_speed.py", "--write", "--baseline", "b.json")
    assert code == 0 and "wrote b.json" in out
    code, out, _ = call("check_speed.py", "--baseline", "b.json")
    assert code == 0 and "all within 1.5 times" in out
    monkeypatch.setattr(speed_check, "run", lambda **_: seconds(waves=1.6))
    code, out, _ = call("check_speed.py", "--baseline", "b.json", "--json")
    found = {row["name"]: row["verdict"] for row in json.loads(out)["compared"]}
    assert code == 1
    assert [name for name, verdict in found.items() if verdict == "slower"] == [
        "waves to NumPy",
        "waves to calm",
    ]
    assert call("check_speed.py", "--baseline", "b.json", "--margin", "2")[0] == 0
    for arguments in (("--margin", "0.5"), ("--baseline", "none.json")):
        code, _, err = call("check_speed.py", *arguments)
        assert code == 2 and len(err.strip().splitlines()) == 1


def test_the_baseline_of_the_repository_is_one():
    found = speed_check.load_baseline(SCRIPTS / "speed_baseline.json")
    assert list(found) == list(speed_check.RATIOS)
