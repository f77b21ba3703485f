import errno
import os
import shutil
import subprocess
import sys

import pytest

from ship_gym.config import ConfigError
from ship_gym.locks import check_own, held, locked


@pytest.mark.skipif(os.name == "nt", reason="links need a right there")
def test_links_out_of_a_folder_of_a_run_are_refused_and_others_are_not(tmp_path):
    precious, run = tmp_path / "precious", tmp_path / "run"
    precious.write_text("mine")
    run.mkdir()
    (run / "inside.csv").symlink_to("card.json")
    (tmp_path / "link").symlink_to(run)
    check_own(tmp_path / "link", ["inside.csv", "card.json"])
    (run / "card.json").symlink_to("../precious")
    with pytest.raises(ConfigError, match=r"card\.json: a link to \.\./precious"):
        check_own(run, ["card.json"])
    (run / "lock").symlink_to(precious)
    with pytest.raises(ConfigError, match="lock: a link"), locked(run / "lock", "trains"):
        pytest.fail("was let in")
    assert precious.read_text() == "mine"


def test_a_file_system_without_locks_is_told_of(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")

    def none(file, how):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    with (
        pytest.warns(UserWarning, match=r"a\.json: no lock: No locks"),
        held(tmp_path / "a.json", "works"),
    ):
        (tmp_path / "a.json").write_text("{}")
    assert os.listdir(tmp_path) == ["a.json"]


def test_a_file_is_held_by_one_process(tmp_path):
    path = tmp_path / "a.toml"
    with held(path, "tunes into this file"):
        with pytest.raises(ConfigError) as caught, held(path, "tunes into this file"):
            pytest.fail("was let in")
        assert str(caught.value).startswith(f"{path}: another process (pid {os.getpid()}) tunes")
    with held(path, "tunes into this file"):
        pass
    assert not os.listdir(tmp_path) or os.name == "nt"
    with pytest.raises(RuntimeError), held(tmp_path / "new" / "deeper" / "a.toml", "tunes"):
        raise RuntimeError("refused")
    assert not os.listdir(tmp_path) or os.name == "nt"


@pytest.mark.skipif(os.name == "nt", reason="removes no open file")
def test_a_lock_leaves_nothing_where_nothing_was_written(tmp_path):
    (tmp_path / "mine").mkdir()
    for folder in ("mine", "runs/new"):
        lock = tmp_path / folder / "lock"
        with locked(lock, "trains"):
            assert lock.is_file()
            with pytest.raises(ConfigError), locked(lock, "trains"):
                pytest.fail("was let in")
            assert lock.is_file(), "who is refused removes nothing"
    assert os.listdir(tmp_path) == ["mine"] and os.listdir(tmp_path / "mine") == []
    with locked(tmp_path / "runs/lock", "trains"):
        (tmp_path / "runs/card.json").write_text("{}")
    assert sorted(os.listdir(tmp_path / "runs")) == ["card.json", "lock"]
    with locked(lock, "trains"):  # another's, made since the folder was removed, stays
        shutil.rmtree(lock.parent)
        lock.parent.mkdir()
        lock.write_text("1\n")
    assert lock.read_text() == "1\n"


@pytest.mark.skipif(os.name == "nt", reason="removes no open file")
def test_many_who_take_a_lock_at_once_hold_it_one_by_one(tmp_path):
    take = (
        "import os, sys; from ship_gym.locks import locked; from ship_gym.config import "
        f"ConfigError\nheld = {str(tmp_path / 'held')!r}\n"
        "for _ in range(300):\n"
        "    try:\n"
        f"        with locked({str(tmp_path / 'run' / 'lock')!r}, 'trains'):\n"
        "            os.close(os.open(held, os.O_CREAT | os.O_EXCL)); os.unlink(held)\n"
        "    except ConfigError: pass\n"
    )
    both = [subprocess.Popen([sys.executable, "-c", take]) for _ in range(2)]
    assert [one.wait() for one in both] == [0, 0]
    # one who came between the other's last two steps leaves the folder that it has not made
    assert not [path for path in tmp_path.rglob("*") if path != tmp_path / "run"]
