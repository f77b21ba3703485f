import os
import re
import shutil
import subprocess
import sys

import pytest
from ship_gym_agents.training.run_folder import TrainingFolder

from ship_gym.config import ConfigError

VALIDATION = {"samples": 1, "success": 1.0, "return": -1.0, "rudder_travel": 5.0}
STATE = {
    "samples": 1,
    "seconds": 1.0,
    "episodes": 16,
    "limit": None,
    "validated": 0.5,
    "validations": [VALIDATION],
}
CARD = {
    "status": "running",
    "config": {
        "algorithm": "ppo",
        "scenario": {"task": "heading_keeping", "ship": "kcs"},
        "seed": 0,
        "hyperparameters": {},
    },
    "budget": {"minutes": None, "steps": 10},
    "validations": [VALIDATION],
    "best": VALIDATION,
}


def state(samples):
    return {**STATE, "samples": samples}


def test_a_checkpoint_counts_when_it_is_complete(tmp_path):
    folder = TrainingFolder(tmp_path / "run")
    assert folder.card() is None and folder.checkpoint() is None and folder.state() is None
    for samples in (1, 2):
        with folder.new_checkpoint(state(samples)) as place:
            (place / "model").write_text(str(samples))
    with pytest.raises(RuntimeError), folder.new_checkpoint(state(3)) as place:
        (place / "model").write_text("half")
        raise RuntimeError("killed")
    assert folder.state() == state(2)
    assert (folder.checkpoint() / "model").read_text() == "2"
    with folder.new_checkpoint(state(3)) as place:
        assert not list(place.iterdir()), "what was left half is gone"
    assert folder.state() == state(3)
    assert len(list((tmp_path / "run" / "checkpoint").iterdir())) == 1, "older ones are gone"


def generation(folder, policy, **card):
    with folder.new_checkpoint(STATE, {**CARD, **card}) as place:
        (place / "policy.safetensors").write_text(policy)


def test_card_and_policy_change_with_the_checkpoint_and_not_before(tmp_path):
    folder = TrainingFolder(tmp_path)
    generation(folder, "first", status="running")
    with (
        pytest.raises(RuntimeError),
        folder.new_checkpoint(STATE, {**CARD, "status": "stopped"}) as place,
    ):
        (place / "policy.safetensors").write_text("of a checkpoint that never was")
        raise RuntimeError("killed")
    with folder.locked():  # as at the next start
        assert folder.policy.read_text() == "first"
        assert folder.card()["status"] == "running" and folder.card()["checkpoint"] == 1
    assert sorted(p.name for p in (tmp_path / "checkpoint").iterdir()) == ["000001"]


def test_a_kill_before_the_copies_were_made_is_mended_at_the_next_start(tmp_path, monkeypatch):
    folder = TrainingFolder(tmp_path)
    generation(folder, "first", status="running")
    monkeypatch.setattr(TrainingFolder, "publish", lambda _: None)  # killed there
    generation(folder, "second", status="complete")
    shutil.copytree(tmp_path / "checkpoint" / "000002", tmp_path / "checkpoint" / "000001")
    monkeypatch.undo()
    assert folder.policy.read_text() == "first" and folder.card()["status"] == "running"
    (tmp_path / ".card-abcd_123.ship_gym.tmp.json").write_text("{")  # of a writer that was killed
    with folder.locked():
        assert folder.policy.read_text() == "second" and folder.card()["status"] == "complete"
        assert sorted(p.name for p in (tmp_path / "checkpoint").iterdir()) == ["000002"]
        names = sorted(p.name for p in tmp_path.iterdir())
        assert names == ["card.json", "checkpoint", "curve.csv", "lock", "policy.safetensors"]
        folder.write_card({**CARD, "status": "stopped"})
    with folder.locked():
        assert folder.card()["status"] == "stopped", "what was said after it stays"


def test_a_copy_of_a_generation_is_none_and_stays(tmp_path):
    folder = TrainingFolder(tmp_path)
    generation(folder, "first")
    shutil.copytree(tmp_path / "checkpoint" / "000001", tmp_path / "checkpoint" / "000001.bak")
    with folder.locked():
        assert folder.checkpoint().name == "000001"
    generation(folder, "second")
    names = sorted(p.name for p in (tmp_path / "checkpoint").iterdir())
    assert names == ["000001.bak", "000002"]


@pytest.mark.skipif(os.name == "nt", reason="links need a right there")
@pytest.mark.parametrize("name", ["policy.safetensors", "curve.csv", "lock", "checkpoint"])
def test_a_folder_of_a_stranger_writes_nowhere_else(tmp_path, name):
    folder = TrainingFolder(tmp_path / "run")
    generation(folder, "echo harmful")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "000000").write_text("mine")
    if name == "checkpoint":
        (folder.path / name).rename(folder.path / "aside")
    (folder.path / name).unlink(missing_ok=True)
    (folder.path / name).symlink_to(
        tmp_path / "mine" if name == "checkpoint" else tmp_path / "mine" / "000000"
    )
    with pytest.raises(ConfigError, match=rf"{name}: a link"), folder.locked():
        pytest.fail("was let in")
    assert (tmp_path / "mine" / "000000").read_text() == "mine"


def test_a_good_copy_is_not_replaced_by_a_policy_that_was_damaged_since(tmp_path):
    folder = TrainingFolder(tmp_path)
    generation(folder, "stands for a policy")
    (tmp_path / "checkpoint" / "000001" / "policy.safetensors").write_text("flipped")
    with folder.locked():
        assert folder.policy.read_text() == "stands for a policy"


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
    with folder.new_checkpoint(STATE):
        pass
    for name in ("policy.safetensors", "curve.csv", "notes.txt"):
        (tmp_path / name).write_text("x")
    folder.write_card(CARD)
    folder.clear()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["card.json", "notes.txt"]
