"""Pages of the environments: they say what the code says, and the committed ones are up to date."""

from __future__ import annotations

import functools
import json
import re
from pathlib import Path

import gymnasium as gym
import pytest

from pages import environment_pages, scenario_page
from pages.environment_pages import (
    INDEX,
    SCENARIOS,
    env_ids,
    name_of,
    outdated,
    task_of,
    write_pages,
)
from ship_gym.envs.registration import ENVIRONMENTS
from ship_gym.scenarios import available_scenarios, load_scenario
from ship_gym.tasks import TASKS, observations_of

pages = functools.lru_cache(environment_pages.pages)

DOCS = Path(__file__).parents[2] / "docs" / "environments"
IDS = [env_id for env_id, task in ENVIRONMENTS.items() if task not in TASKS.outside()]
PAGES = [*(f"{name_of(env_id)}.md" for env_id in IDS), INDEX, SCENARIOS]


def rows_of(text, columns):
    """Rows of all tables with a number of columns, as lists of cells, without their headers."""
    below = False
    for line in text.splitlines():
        cells = re.split(r" (?<!\\)\| ", line[2:-2])
        if line.startswith("| ") and below and len(cells) == columns:
            yield cells
        below = line.startswith("| ") and (below or set(cells) == {"---"})


def dotted(values, prefix=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from dotted(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def test_committed_pages_are_up_to_date():
    assert outdated(DOCS) == [], "run: python scripts/build_docs.py"


def test_pages_are_the_same_when_made_again():
    assert environment_pages.pages() == pages()


def test_every_id_has_a_page_and_a_moment():
    assert env_ids() == IDS and all(task_of(env_id).moment for env_id in IDS)
    assert list(pages()) == [*PAGES[:-2], SCENARIOS, INDEX]


@pytest.mark.parametrize("name", PAGES)
def test_tables_have_full_rows(name):
    width = None
    for line in pages()[name].splitlines():
        if not line.startswith("|"):
            width = None
            continue
        bars = len(re.findall(r"(?<!\\)\|", line))
        width = width or bars
        assert bars == width and line.endswith("|")


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(name):
    links = re.findall(r"\]\(([^)]+)\)", pages()[name])
    assert links or name == SCENARIOS
    for link in links:
        target, _, anchor = link.partition("#")
        assert target in pages() or (DOCS / target).is_file()
        heads = re.findall(r"^#+ (.*)$", pages()[target], re.M) if anchor else [""]
        assert anchor in [head.lower().replace(" ", "-") for head in heads]


@pytest.mark.parametrize("env_id", IDS)
def test_page_holds_the_docstring_and_the_live_spaces(env_id):
    env = gym.make(env_id).unwrapped
    text = pages()[f"{name_of(env_id)}.md"]
    heads = re.findall(r"^ *(## .*)$", type(env).__doc__, re.M)
    assert len(heads) == 8 and all(f"\n{head}\n" in text for head in heads)
    facts = dict(rows_of(text, 2))
    assert f"`{env.action_space}`" in facts["Action space"]
    assert f"`{env.observation_space.shape}`" in facts["Observation space"]
    assert facts["Truncated"] == f"after {env.scenario.duration:g} s, {env.scenario.steps} steps"
    made = re.search(r"gym\.make\(\"(.*?)\"\)", facts["Make one"])[1]
    assert type(gym.make(made).unwrapped) is type(env)
    assert type(env).__name__ in facts["Make one"]


@pytest.mark.parametrize("env_id", IDS)
def test_page_lists_the_privileged_observation(env_id):
    env = gym.make(env_id, privileged=True).unwrapped
    rows = list(rows_of(pages()[f"{name_of(env_id)}.md"], 7))
    assert [int(row[0]) for row in rows] == list(range(env.observation_space.shape[0]))
    for row, entry in zip(rows, observations_of(env.scenario.task, True), strict=True):
        assert row[1:4] == [f"`{entry.name}`", entry.symbol, entry.unit]
        assert (float(row[4]), float(row[5])) == (entry.low, entry.high)


@pytest.mark.parametrize("env_id", IDS)
def test_every_info_key_is_listed_and_explained(env_id):
    _, info = gym.make(env_id).unwrapped.reset(seed=3)
    text = pages()[f"{name_of(env_id)}.md"]
    listed = text.partition("## Info")[2].partition("## Privileged")[0]
    table, _, words = listed.partition("In words")
    assert re.findall(r"^\| `(\w+)` \|", table, re.M) == list(info)
    assert set(info) <= set(re.findall(r"`(\w+)`", words))


@pytest.mark.parametrize("env_id", IDS)
def test_page_gives_the_defaults_of_the_scenario(env_id):
    values = dict(dotted(load_scenario(ENVIRONMENTS[env_id]).to_dict()))
    text = pages()[f"{name_of(env_id)}.md"].partition("\n## Scenario\n")[2]
    rows = {row[0].strip("`"): row[1].strip("`") for row in rows_of(text, 4)}
    assert {"task", "ship", "sea.states"} <= set(rows)
    assert {"limits.heading_error_deg", "limits.cross_track"} & set(rows)
    for name, shown in rows.items():
        assert json.loads(shown) == values[name]


def test_scenario_page_has_every_key_with_its_defaults():
    rows = {row[0].strip("`"): row[1] for row in rows_of(pages()[SCENARIOS], 4)}
    tasks = [ENVIRONMENTS[env_id] for env_id in IDS]
    every = {name for task in tasks for name, _ in dotted(load_scenario(task).to_dict())}
    assert set(rows) == every
    for task in tasks:
        for name, value in dotted(load_scenario(task).to_dict()):
            shown = rows[name]
            if re.match(r"(heading|course|track): ", shown):
                shown = re.search(rf"{task.partition('_')[0]}: (`.*?`|not set)", shown)[1]
            shown = shown.strip("`")
            assert value is None if shown == "not set" else json.loads(shown) == value


def test_scenario_page_has_every_scenario_with_a_comment():
    rows = {row[0].strip("`"): row[1:] for row in rows_of(pages()[SCENARIOS], 3)}
    assert list(rows) == [name for name in available_scenarios() if name not in TASKS.outside()]
    assert all(len(text) > 20 for _, text in rows.values())
    assert all(base.strip("`") in rows for base, _ in rows.values() if base)


def test_every_key_is_explained():
    silent = {name for name, key in scenario_page.all_keys().items() if not key.meaning}
    assert not silent


@pytest.mark.parametrize(
    ("name", "unit", "words"),
    [
        ("start.cross_track", "L", "first leg"),
        ("sea.wave_height", "m", "`wave_height`, `wave_height_min`: significant height"),
        ("sea.wave_encounter_deg", "deg", ""),
        ("sea.drift", "", "`mean`"),  # explained by Sea
        ("sea.spectrum", "", "bretschneider"),  # explained by WaveSystem
        ("sensors.yaw_rate_deg_s", "deg/s", "gyro"),
        ("track.points", "m", "way-points"),
        ("ship", "", "available_ships()"),
    ],
)
def test_units_and_meanings(name, unit, words):
    key = scenario_page.all_keys()[name]
    assert key.unit == unit and words in key.meaning and "``" not in key.meaning


def test_outdated_finds_what_is_wrong(tmp_path):
    written = write_pages(tmp_path)
    assert [path.name for path in written] == list(pages())
    for env_id in IDS[1:]:
        (tmp_path / f"{name_of(env_id)}.png").write_bytes(b"any")
    (tmp_path / INDEX).write_text("another text")
    (tmp_path / SCENARIOS).unlink()
    (tmp_path / "stranger.md").write_text("of no environment")
    assert outdated(tmp_path) == sorted([INDEX, SCENARIOS, "stranger.md", f"{name_of(IDS[0])}.png"])
