"""ship-gym dataset."""

import json

import pytest

pytest.importorskip("minari")
SHORT = ["--set", "duration=60", "--episodes", 2]


def test_by_default_it_is_the_autopilot_of_the_task_in_runs(cli, tmp_path, monkeypatch):
    monkeypatch.delenv("MINARI_DATASETS_PATH", raising=False)
    code, out, err = cli("dataset", *SHORT)
    assert (code, err) == (0, "")
    folder = tmp_path / "runs" / "datasets" / "ShipGym" / "HeadingKeeping" / "pid-kcs-v0"
    assert sorted(path.name for path in folder.iterdir()) == ["README.md", "card.json", "data"]
    assert "wrote runs/datasets/ShipGym/HeadingKeeping/pid-kcs-v0\nnext: python -c" in out
    command = out.splitlines()[-1].partition("python -c ")[2].strip('"')
    exec(compile(command, "next", "exec"))
    code, _, err = cli("dataset", *SHORT)
    assert (code, err.count("\n")) == (2, 1) and "--force replaces it" in err
    assert cli("dataset", *SHORT, "--force")[0] == 0


def test_mixtures_as_json(cli, tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "sets"))
    options = ["--controllers", "pid", "heading_kcs", "random", "--noise", 0, 0.2, *SHORT]
    more = ["--author", "A. Sailor", "--email", "a@b.example", "--license", "CC0-1.0", "--no-infos"]
    code, out, err = cli("dataset", *options, *more, "--name", "mine/all-v1", "--json")
    assert code == 0, err
    card = json.loads(out)["card"]
    assert [(row["controller"], row["noise"]) for row in card["entries"]] == [
        (name, std) for name in ("pid", "heading_kcs", "random") for std in (0.0, 0.2)
    ]
    assert card["author"] == "A. Sailor" and card["license"] == "CC0-1.0"
    assert card["controllers"]["heading_kcs"]["sha256"]
    from ship_gym_agents.datasets import load_set

    dataset = load_set("mine/all-v1")
    assert len(dataset) == 12 and dataset.storage.metadata["author_email"] == {"a@b.example"}


def test_scenario_and_ship_files_travel_with_the_set(cli, tmp_path):
    text = 'base = "heading_keeping"\nduration = 60.0\nship = "onrt"\n'
    (tmp_path / "mine.toml").write_text(text)
    code, _, err = cli("dataset", "--scenario", "mine.toml", "--episodes", 1, "--out", "sets")
    assert code == 0, err
    (tmp_path / "mine.toml").unlink()
    from ship_gym_agents.datasets import load_set

    dataset = load_set("ShipGym/HeadingKeeping/mine-pid-onrt-v0", "sets")
    env = dataset.recover_environment().unwrapped
    assert env.scenario.duration == 60.0 and env.ship.name == "onrt"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--controllers", "pit"], "did you mean 'pid'"),
        (["--controllers"], "name at least one"),
        (["--noise", "3"], "--noise = 3: allowed is 0 to 2"),
        (["--noise-time", "-1"], "--noise-time = -1: allowed is"),
        (["--name", "pid"], "name = 'pid': allowed is"),
        (["--name", "../pid-v0"], "allowed is"),
        (["--task", "track_following", "--scenario", "heading_keeping"], "is of task"),
        (["--seed", "399999", "--episodes", "2"], "others of validation"),
        (["--set", "duratio=3"], "unknown key 'duratio'"),
    ],
)
def test_what_cannot_be_is_one_line(cli, tmp_path, arguments, words):
    code, out, err = cli("dataset", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and words in err and len(err) <= 300
    assert not list(tmp_path.iterdir())
