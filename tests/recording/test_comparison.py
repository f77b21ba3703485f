"""Runs side by side: who can be compared, lines on one clock, differences, the card."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.recording import Trajectory
from ship_gym.recording.comparison import (
    COLOURS,
    difference,
    distance,
    labels,
    panels,
    quantities,
    runs_of,
)
from ship_gym.recording.comparison_card import comparison_card, content_hash, notes, sources, title
from tests.recording.runs import SHIP, run


def test_differences_are_at_the_times_of_the_first():
    first, other = runs_of([run(), run("lqg")])
    error, rudder, *_ = quantities([first, other])
    t, values = difference(other, first, error)
    assert t.tolist() == first.t.tolist()
    assert values == pytest.approx(np.degrees(0.1 * t))
    assert difference(other, first, rudder)[1] == pytest.approx(np.degrees(0.01 * t))
    assert distance(other, first)[1] == pytest.approx(math.sqrt(2.0) * t)


def test_runs_of_other_intervals_lengths_and_starts_are_aligned():
    first, other = runs_of([run(), run("lqg", step=0.7, end=10.0, start=100.0)])
    t, values = difference(other, first, quantities([first, other])[0])
    assert t.tolist() == list(range(10))  # what both have, from their first rows on
    assert values == pytest.approx(np.degrees(0.1 * t))


def test_angles_differ_the_shorter_way_round():
    one, two = run(), run("lqg")
    psi = {"psi": np.full(21, math.radians(179.0)), "psi_ordered": np.zeros(21)}
    other = {"psi": np.full(21, math.radians(-179.0)), "psi_ordered": np.zeros(21)}
    first, second = runs_of(
        [Trajectory(one.columns | psi, one.meta), Trajectory(two.columns | other, two.meta)]
    )
    values = difference(second, first, quantities([first, second])[0])[1]
    assert values == pytest.approx(2.0 * np.ones(21))


def test_plots_have_a_line_for_each_run_in_its_colour():
    runs = runs_of([run(), run("lqg"), run("mpc", end=5.0)])
    found, less = panels(runs)
    assert [panel.title for panel in found] == [
        "Heading error [deg]",
        "Rudder [deg], + turns to starboard",
        "Speed through the water [m/s]",
        "Reward so far, without what the end costs [-]",
    ]
    assert [series.color for series in found[0].series] == list(COLOURS[:3])
    assert [len(series.values) for series in found[0].series] == [21, 21, 6]
    assert less[0].title == "Distance to the ship of pid [m]"
    assert less[1].title == "Heading error, less that of pid [deg]"
    assert [series.label for series in less[0].series] == ["lqg", "mpc"]
    assert [len(series.values) for series in less[0].series] == [21, 6]
    reward = found[3].series[0].values
    assert reward[[0, 1, -1]].tolist() == [0.0, -1.0, -20.0]


def test_runs_without_an_error_have_their_heading_compared():
    bare = [run(), run("lqg")]
    bare = [
        Trajectory(
            {k: v for k, v in r.columns.items() if k not in ("psi_ordered", "reward")}, r.meta
        )
        for r in bare
    ]
    assert quantities(runs_of(bare))[0].name == "heading"


@pytest.mark.parametrize(
    ("runs", "message"),
    [
        ([run()], "1 recordings to compare: allowed are 2 to 8"),
        ([run(), run(task="track_following")], "different task are not compared"),
        ([run(), run(ship=SHIP | {"scale": 75.0})], "different scale of the ship"),
        ([run(), Trajectory({"t": [0.0]}, run().meta)], "without x, y, psi, u, v"),
    ],
)
def test_what_cannot_be_compared_is_refused(runs, message):
    with pytest.raises(ConfigError, match=message):
        runs_of(runs)


def test_names_say_what_tells_runs_apart():
    assert labels([run(), run("lqg")]) == ["pid", "lqg"]
    assert labels([run(), run(seed=4)]) == ["seed 3", "seed 4"]
    assert labels([run(), run("lqg", seed=4)]) == ["pid, seed 3", "lqg, seed 4"]
    assert labels([run(), run()]) == ["pid (1)", "pid (2)"]
    seas = [{"wave_height": 0.0}, {"wave_height": 4.0, "wave_period": 9.0}]
    assert labels([run(sea=sea) for sea in seas]) == [
        "pid, waves none",
        "pid, waves H 4 m, T 9 s, from 180\N{DEGREE SIGN}",
    ]
    assert [one.name for one in runs_of([run(), run()], ["old", "new"])] == ["old", "new"]
    with pytest.raises(ConfigError, match="1 names for 2"):
        runs_of([run(), run()], ["old"])


def test_notes_say_what_else_differs():
    assert [*notes(runs_of([run(), run("lqg")]))] == []
    other = run("lqg", step=0.5, seed=4, ship=SHIP | {"name": "kvlcc2"}, complete=False,
                config={"duration": 10.0, "sea": {"states": ["ss6"]}}, git_commit="a")  # fmt: skip
    text = "\n".join(notes(runs_of([run(), other])))
    for part in ("seeds differ", "ships differ", "differ in duration, sea.states", "commits",
                 "interpolated", "is incomplete"):  # fmt: skip
        assert part in text


def test_card_has_both_columns_of_metrics_and_their_difference():
    text = comparison_card(runs_of([run(), run("lqg", outcome="heading limit")]))
    assert text.splitlines()[0].endswith(": pid against lqg")
    assert "| Metric | Unit | pid | lqg | less pid |" in text
    assert "| J_1 | deg2 | 4 | 6 | +2 |" in text
    assert "| settling_time |  | - | - | - |" in text
    assert "| Outcome | end of time | heading limit |" in text
    assert "| Seed | 3 |" in text.split("The same in all")[1]
    alike = comparison_card(runs_of([run(), run()]))
    assert "| Outcome | end of time |" in alike.split("The same in all")[1]


def test_sources_have_the_hash_of_the_whole_content():
    one, two = sources(runs_of([run(), run("lqg")]))
    assert (one["controller"], one["seed"]) == ("pid", 3)
    assert one["content"] == content_hash(run()) != two["content"]
    changed = run()
    columns = {**changed.columns, "u": np.nextafter(changed["u"], 9.0)}
    assert content_hash(Trajectory(columns, changed.meta)) != content_hash(changed)
    assert content_hash(run(seed=4)) != content_hash(run())


def test_manoeuvres_have_no_seed_in_their_names():
    turn = {"config": {"manoeuvre": "turning_circle"}, "scenario": "turn", "seed": 0}
    found = labels([run(**turn), run(seed=7, scenario="sea")])
    assert not any("seed 0" in name for name in found), found


def test_title_says_what_all_share():
    assert title(runs_of([run(), run("lqg")])) == "heading_keeping, kcs, seed 3: pid against lqg"
    found = title(runs_of([run(), run(seed=4)]))
    assert found == "heading_keeping, kcs: seed 3 against seed 4"


def test_distances_to_a_route_say_their_side():
    sailed = [run(), run("lqg")]
    for one in sailed:
        one.columns["off_route"] = one["t"]
    assert quantities(runs_of(sailed))[0].title == "Distance to the route [m], + to starboard"
