import functools

import pytest
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.entrants import entrant

from ship_gym.evaluation import metrics, rollout
from ship_gym.evaluation.suite import Entry
from ship_gym.evaluation.unit import Entrant, Unit, chunks, lost, sail
from tests.evaluation.benchmarking import own, write_suite

SEEDS = (2_000_000, 2_000_001, 2_000_002, 2_000_003)


@pytest.fixture
def unit(tmp_path):
    write_suite(tmp_path)

    def make(name="Good", scenario=None, seeds=SEEDS, patience=100.0, **entry):
        named = own(tmp_path, name)[0] if name[0].isupper() else name
        entry = Entry(scenario or str(tmp_path / "short.toml"), "seaway", **entry)
        return Unit("small", "1", entry, (), "kcs", entrant(named), tuple(seeds), patience)

    return make


def test_chunks_cover_the_seeds():
    assert [len(part) for part in chunks(range(40))] == [16, 16, 8]
    assert [seed for part in chunks(range(40)) for seed in part] == list(range(40))


def test_rows_are_the_metrics_of_a_rollout(unit):
    made = unit("pid", measure="J_1")
    rows = sail(made).rows
    sailed = rollout(make_controller("pid"), made.entry.name, seeds=SEEDS, ship="kcs")
    assert [row["seed"] for row in rows] == list(SEEDS)
    for i, row in enumerate(rows):
        found = metrics(sailed.trajectory(i))
        assert {name: row[name] for name in found} == found and row["value"] == found["J_1"]
        assert (row["outcome"], row["failed"], row["length"]) == ("end of time", False, 60)
        assert (row["kind"], row["error"], row["task"]) == ("classical", "", "heading_keeping")
        assert row["decision_ms"] > 0.0
        assert row["wave_height"] == sailed.weather["wave_height"][i]


@pytest.mark.parametrize(
    ("scenario", "angle"),
    [("heading_ss5_head", 180.0), ("heading_ss5_following", 0.0), ("heading_ss5_beam", 90.0)],
)
def test_encounter_angles_are_those_that_the_scenario_asks_for(unit, scenario, angle):
    for row in sail(unit("constant", scenario, SEEDS[:2])).rows:
        assert row["wave_encounter_deg"] == pytest.approx(angle, abs=1e-9)
        assert row["wind_encounter_deg"] == pytest.approx(angle, abs=1e-9)


def test_calm_water_has_no_encounter_angles(unit):
    row = sail(unit("constant", "heading_calm", SEEDS[:1])).rows[0]
    names = ("wave", "wind", "current")
    assert all(row[f"{name}_encounter_deg"] != row[f"{name}_encounter_deg"] for name in names)


@pytest.mark.parametrize(
    ("name", "error", "length"),
    [
        ("Raises", "interval 17: ValueError: to starboard (own.py:", 17),
        ("NotANumber", "interval 5: action = [nan]: must be finite, in [-1, 1]", 5),
    ],
)
def test_a_controller_that_fails_in_some_episodes_loses_those_alone(unit, name, error, length):
    seeds = range(2_000_000, 2_000_008)
    rows, good = sail(unit(name, seeds=seeds)).rows, sail(unit("Good", seeds=seeds)).rows
    bad = [row["seed"] for row in rows if row["error"]]
    assert 0 < len(bad) < 8
    for row, other in zip(rows, good, strict=True):
        if row["seed"] in bad:
            assert row["error"].startswith(error) and row["failed"] and "J_1" not in row
            assert (row["outcome"], row["length"]) == ("error", length)
            assert row["wave_height"] == other["wave_height"]
        else:
            same = {name: value for name, value in row.items() if name in other}
            assert same | {"controller": 0, "decision_ms": 0} == other | {
                "controller": 0,
                "decision_ms": 0,
            }


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("Shape", "interval 0: actions have shape (3,), allowed is (1, 1)"),
        ("Reset", "reset: RuntimeError: not today (own.py:"),
    ],
)
def test_a_controller_that_always_fails_loses_all(unit, name, error):
    rows = sail(unit(name)).rows
    assert len(rows) == len(SEEDS) and all(row["error"].startswith(error) for row in rows)
    assert all(row["decision_ms"] is None for row in rows)


def test_a_controller_that_steers_one_ship_only_is_sailed_alone(unit):
    rows, good = sail(unit("Alone")).rows, sail(unit("Good")).rows
    assert [row["J_1"] for row in rows] == [row["J_1"] for row in good]
    assert not any(row["error"] for row in rows)


def test_a_policy_refuses_what_it_was_not_made_for(unit):
    rows = sail(unit("ppo_kcs", "track_calm")).rows
    assert all("trained on 'heading_keeping'" in row["error"] for row in rows)
    assert all(row["kind"] == "policy" for row in rows)


def test_a_controller_slower_than_real_time_is_too_slow(unit):
    rows = sail(unit("Sleeps", patience=0.01)).rows
    assert all(row["error"].endswith("a decision takes more than 0.01 s") for row in rows)
    assert all(row["failed"] and row["decision_ms"] >= 20.0 for row in rows)
    assert not any(row["error"] for row in sail(unit("Sleeps", patience=2.0)).rows)


def test_a_controller_that_cannot_be_made_any_more_loses_its_episodes(unit):
    gone = Entrant("gone", "gone", functools.partial(int, "x"), "own")
    rows = sail(Unit("s", "1", Entry("heading_calm"), (), "kcs", gone, SEEDS[:2], 1.0)).rows
    assert all("ValueError" in row["error"] for row in rows)


def test_a_lost_unit_has_the_weather_of_its_episodes(unit):
    rows, good = lost(unit(), "its process ended").rows, sail(unit()).rows
    assert [row["error"] for row in rows] == ["reset: its process ended"] * len(SEEDS)
    for name in ("seed", "wave_height", "wave_encounter_deg", "current_speed", "measure"):
        assert [row[name] for row in rows] == [row[name] for row in good]


def test_entrants_say_what_they_are(tmp_path, monkeypatch):
    write_suite(tmp_path)
    monkeypatch.chdir(tmp_path)
    mine = entrant("own.py:Good")
    assert (mine.named, mine.name, mine.kind) == ("own.py:Good", "good", "own")
    monkeypatch.chdir("/")
    assert mine.make().name == "good" and len(mine.about["sha256"]) == 64
    policy = entrant("ppo_kcs")
    assert policy.kind == "policy" and policy.about["trained"]["ship"] == "kcs"
    assert policy.about["trained"]["samples"] > 0
    assert entrant("pid").kind == "classical" and "sha256" not in entrant("pid").about
