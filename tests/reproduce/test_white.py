"""White (2020): what he prints of turns in waves, met or a gap that is shown."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from reproduce import white
from seaway import trial_rows, write_tables

PAGE = Path(__file__).parents[2] / "docs" / "seaway.md"
QUARTERS = [
    (ship, f"wave yaw moment from {start} to {start + 90} deg, by its largest", into)
    for ship in ("DTC", "KCS")
    for start, into in ((0, True), (90, False), (360, True), (450, False))
]
BOUNDS = [
    ("DTC", "sway force, waves over rudder"),
    ("DTC", "yaw moment, waves over rudder, after"),
    ("DTC", "off the approach course after 1 L [L]"),
    ("KCS", "drift over that of DTC"),
]
NUMBERS = {  # section 5.1, Figures 3.20 and 3.22, sections 4.3 and 4.4
    ("DTC", "heading at 110 s [deg]"): 630.0,
    ("DTC", "hull, share of surge force at 2 s"): 1.0 / 3.0,
    ("DTC", "rudder, share of surge force at 2 s"): 1.0 / 3.0,
    ("DTC", "wave, share of surge force at 2 s"): 1.0 / 3.0,
    ("DTC", "yaw moment, hull over rudder, up to 10 s"): 2.0,
    ("DTC", "yaw moment, waves over rudder, before the rudder is over"): 1.0,
    ("KCS", "propeller force over resistance at first, in waves"): 1.04,
    ("KCS", "forward speed lost in the calm turn"): 0.65,
}


@pytest.fixture(scope="module")
def cases():
    return white.circle("dtc_model"), white.circle("kcs_model"), white.kcs_in_calm_water()


@pytest.fixture(scope="module")
def found(cases):
    return {(f.ship, f.what): f for f in white.findings(*cases)}


@pytest.mark.slow
@pytest.mark.parametrize(("ship", "what", "into"), QUARTERS)
def test_wave_yaw_moment_acts_into_the_turn_out_of_head_seas_and_out_of_it_after(
    found, ship, what, into
):
    moment = found[ship, what].ours
    assert (moment > 0.05) if into else (moment < -0.05)
    assert found[ship, what].met


@pytest.mark.parametrize(("ship", "what"), BOUNDS)
def test_bounds_that_are_kept(found, ship, what):
    assert found[ship, what].met


@pytest.mark.parametrize(("key", "printed"), NUMBERS.items())
def test_numbers_are_those_printed_and_agree_within_5_percent_or_are_a_gap(found, key, printed):
    finding = found[key]
    assert float(finding.printed) == pytest.approx(printed, abs=5e-4)
    assert 0.0 < finding.ours < math.inf
    assert finding.met == (abs(finding.ours / float(finding.printed) - 1.0) <= 0.05)


def test_computed_from_the_runs(cases, found):
    """By hand: the shares make one, the heading is that of the track, the loss that of the turn."""
    dtc, kcs, calm = cases
    parts = ("hull", "rudder", "wave")
    shares = [found["DTC", f"{name}, share of surge force at 2 s"].ours for name in parts]
    assert sum(shares) == pytest.approx(1.0, abs=1e-3)
    t = dtc.result.trajectory
    row = int((t["t"] >= 110.0).argmax())
    heading = found["DTC", "heading at 110 s [deg]"].ours
    assert heading == pytest.approx(math.degrees(t["psi"][row]), abs=0.2)
    last = calm.result.trajectory["u"][-1] / calm.speed
    loss = found["KCS", "forward speed lost in the calm turn"].ours
    assert loss == pytest.approx(1.0 - last, abs=0.002)
    assert kcs.n == 13.2 and kcs.trial is not None  # Knight's trial has the same waves


def test_every_finding_is_a_row_of_the_page(found):
    """Printed values only; ours are written by python docs/seaway.py."""
    text = PAGE.read_text("utf-8")
    for ship, what, place, printed, *_ in white.rows(list(found.values())):
        assert f"| {ship} | {what} | {place} | {printed} |" in text


def test_findings_as_numbers_and_text(monkeypatch, cases, found):
    """What python scripts/reproduce.py white prints."""
    by_name = dict(zip(("dtc_model", "kcs_model"), cases, strict=False))
    monkeypatch.setattr(white, "circle", by_name.get)
    monkeypatch.setattr(white, "kcs_in_calm_water", lambda: cases[2])
    data = white.as_dict()
    assert data["of"] == len(found) == len(data["findings"])
    assert data["met"] == sum(f.met for f in found.values())
    text = white.as_text(data)
    assert f"{data['met']} of {data['of']} agree" in text and "heading at 110 s [deg]" in text


def test_trials_in_waves_are_on_the_page_beside_ours():
    rows = trial_rows(("onrt_model",))
    assert [row[2] for row in rows] == ["3.00", "0.34", "93"]
    assert "0.29 (CFD, G1/2 SST)" in rows[1][-1]
    text = PAGE.read_text("utf-8")
    assert all(re.search(rf"\| {re.escape(row[1])} \| {row[2]} \|", text) for row in rows)


def test_tables_go_between_their_marks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("before\n\n<!-- a -->\n\nold\n\n<!-- /a -->\n\nafter\n")
    write_tables(page, {"a": "new"})
    assert page.read_text() == "before\n\n<!-- a -->\n\nnew\n\n<!-- /a -->\n\nafter\n"
    with pytest.raises(ValueError, match="no marks <!-- b -->"):
        write_tables(page, {"b": "new"})
