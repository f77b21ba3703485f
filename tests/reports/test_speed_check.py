"""Ratios against a baseline, on made-up numbers."""

from __future__ import annotations

import json

import pytest

from ship_gym.config import ConfigError
from ship_gym.reports import speed_check
from ship_gym.reports.speed_child import MEASURES

SECONDS = {
    "calm": 2.0, "waves": 4.0, "heading": 5.0, "scalar": 25.0, "NumPy reference": 0.1,
    "CartPole vector": 0.05, "CartPole scalar": 5.0,
}  # fmt: skip


def test_ratios_are_numerator_by_denominator():
    found = speed_check.ratios(SECONDS)
    assert found["waves to calm"] == 2.0
    assert found["environment to CartPole's vector step"] == pytest.approx(100.0)
    assert found["scalar to vector"] == 5.0
    assert list(found) == list(speed_check.RATIOS)


def test_every_ratio_is_of_something_that_is_measured():
    assert {name for pair in speed_check.RATIOS.values() for name in pair} <= set(MEASURES)


@pytest.mark.parametrize(
    ("now", "verdict"),
    [(1.0, "as before"), (1.49, "as before"), (1.51, "slower"), (0.68, "as before"),
     (0.66, "faster")],
)  # fmt: skip
def test_verdict_at_the_margin(now, verdict):
    row = speed_check.compare({"a": now}, {"a": 1.0})[0]
    assert row["verdict"] == verdict and row["factor"] == pytest.approx(now)


def test_a_slower_machine_changes_nothing_a_slower_kernel_does():
    before = speed_check.ratios(SECONDS)
    twice = {name: 2.0 * value for name, value in SECONDS.items()}
    rows = speed_check.compare(speed_check.ratios(twice), before)
    assert {row["verdict"] for row in rows} == {"as before"}
    rows = speed_check.compare(speed_check.ratios(SECONDS | {"heading": 10.0}), before)
    assert {row["name"]: row["verdict"] for row in rows} == {
        "calm to NumPy": "as before",
        "waves to NumPy": "as before",
        "environment to NumPy": "slower",
        "environment to CartPole's vector step": "slower",
        "scalar step to CartPole's": "as before",
        "waves to calm": "as before",
        "environment to physics": "slower",
        "scalar to vector": "faster",
    }
    assert "slower by more than 1.5 times: environment to NumPy" in speed_check.as_text(rows)


def test_run_keeps_the_least_of_all_rounds(monkeypatch):
    given = iter(range(1000, 0, -1))
    monkeypatch.setattr(speed_check, "measure", lambda *_: {"seconds": float(next(given))})
    found = speed_check.run(rounds=3)
    assert set(found) == set(SECONDS)
    assert min(found.values()) == 1000 - 3 * len(SECONDS) + 1


def test_refuses_what_is_no_baseline(tmp_path):
    with pytest.raises(ConfigError, match="not in both"):
        speed_check.compare({"a": 1.0}, {"b": 1.0})
    with pytest.raises(ConfigError, match="margin"):
        speed_check.compare({"a": 1.0}, {"a": 1.0}, 0.9)
    for text in ("{", "[]", "{}", json.dumps({"ratios": {"a": -1.0}})):
        (tmp_path / "b.json").write_text(text)
        with pytest.raises(ConfigError):
            speed_check.load_baseline(tmp_path / "b.json")
    with pytest.raises(ConfigError, match=r"none\.json"):
        speed_check.load_baseline(tmp_path / "none.json")
