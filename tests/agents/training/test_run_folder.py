import os
import re
import subprocess
import sys

import pytest
from ship_gym_agents.training.run_folder import TrainingFolder

from ship_gym.config import ConfigError


def test_a_checkpoint_counts_when_it_is_complete(tmp_path):
    folder = TrainingFolder(tmp_path / "run")
    assert folder.card() is None and folder.checkpoint() is None and folder.state() is None
    for samples in (1, 2):
        with folder.new_checkpoint({"samples": samples}) as place:
            (place / "model").write_text(str(samples))
    with pytest.raises(RuntimeError), folder.new_checkpoint({"samples": 3}) as place:
        (place / "model").write_text("half")
        raise RuntimeError("killed")
    assert folder.state() == {"samples": 2}
    assert (folder.checkpoint() / "model").read_text() == "2"
    with folder.new_checkpoint({"samples": 3}) as place:
        assert not list(place.iterdir()), "what was left half is gone"
    assert folder.state() == {"samples": 3}
    assert len(list((tmp_path / "run" / "checkpoint").iterdir())) == 1, "older ones are gone"


def test_one_of_several_seeds_is_named_with_its_run(tmp_path):
    assert TrainingFolder(tmp_path / "track").name == "track"
    assert TrainingFolder(tmp_path / "track" / "seed_3").name == "track-seed_3"


def test_two_processes_do_not_share_a_folder(tmp_path):
    folder = TrainingFolder(tmp_path / "run")
    hold = (
        "import sys, time; from ship_gym_agents.training.run_folder import TrainingFolder\n"
        f"with TrainingFolder({str(folder.path)!r}).locked():\n"
        "    print('held', flush=True); time.sleep(60)"
    )
    other = subprocess.Popen([sys.executable, "-c", hold], stdout=subprocess.PIPE, text=True)
    try:
        assert other.stdout.readline() == "held\n"
        with pytest.raises(ConfigError) as error, folder.locked():
            pass
        assert re.search(rf"another process \(pid {other.pid}\) trains into this", str(error.value))
    finally:
        other.kill()
        other.wait()
    with folder.locked():  # a dead process holds nothing
        assert (folder.path / "lock").read_text() == f"{os.getpid()}\n"


def test_a_damaged_card_is_one_clear_line(tmp_path):
    (tmp_path / "card.json").write_text("{")
    with pytest.raises(ConfigError, match=r"card\.json: not valid JSON"):
        TrainingFolder(tmp_path).card()


def test_clearing_removes_what_a_run_wrote_and_nothing_else(tmp_path):
    folder = TrainingFolder(tmp_path)
    with folder.new_checkpoint({}):
        pass
    for name in ("policy.safetensors", "curve.csv", "notes.txt"):
        (tmp_path / name).write_text("x")
    folder.write_card({"status": "running"})
    folder.clear()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["card.json", "notes.txt"]
