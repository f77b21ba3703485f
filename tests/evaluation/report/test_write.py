"""The whole report: one file that loads nothing, what it says, and its pages in Chromium."""

import re

import numpy as np
import pytest

from ship_gym.evaluation.report import judge, scenarios, write_markdown, write_report
from ship_gym.evaluation.report.events import events
from ship_gym.evaluation.score import OPTIMA, Reference, References
from ship_gym.evaluation.statistics import Estimate
from ship_gym.recording.trajectory import Trajectory

from .conftest import made_up


def sailed(episode):
    """A made-up recording; one controller cannot be sailed again."""
    if episode.controller == "mine" and episode.ship == "kvlcc2":
        return None
    t = np.arange(0.0, 60.0)
    wave = np.sin(0.1 * t)
    meta = {"ship": {"scale": 1.0, "L": 230.0}, "failed": False}
    return Trajectory({"t": t, "psi_error": 0.1 * wave, "delta": 0.2 * wave}, meta)


@pytest.fixture(scope="module")
def page(results, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(results, path, sail=sailed, pictures=8)
    return path


def test_the_page_loads_nothing_and_says_what_was_asked(page):
    text = page.read_text("utf-8")
    for outside in ("http:", "https:", "<link", "<script", "@import", "url(", "file:"):
        assert outside not in text
    for words in (
        "<h2>Leaderboard</h2>", "Scores by cell", "Where policies lose", "Performance profiles",
        "heading_ss6_quartering, kvlcc2 (seaway)", "a &lt;processor&gt; &amp; more",
        "2000000 to 2000007 (8)", "2 of 8 episodes broke off", "&lt;division&gt; by zero",
        "samples: 2000000", "time per decision", "0" * 64,
        "ship-gym record --controller lqg --scenario heading_keeping --ship kcs --seed",
        "The worst episode of mine, course_changing/kcs, seed",
    ):  # fmt: skip
        assert words in text, words


def test_the_optimum_and_its_headroom_stand_beside(results):
    event = events(results.table)[0]
    room = Estimate(18.0, 15.0, 21.0)
    cell = Reference(
        event.scenario, event.ship, event.measure, 80.0, 20.0, "lqg", 16.4, OPTIMA[0], 32, room
    )
    stored = References("ShipBench-1", (0, 64), {event.cell: cell}, {})
    found = judge(results, stored)
    (section, *_) = scenarios.scenarios(found, {})
    text = section.blocks[1].plain().replace("\n  ", " ")
    assert "Score 0 at 80.0, 100 at 20.0 (lqg, ShipBench-1)" in text
    assert "(gauss-newton plan, 32 seeds) has 16.4, a score of 114" in text  # 100 ln 4.88 / ln 4
    assert "headroom 18.0 [15.0, 21.0] % of the reference" in text


def test_links_lead_to_places_on_the_page(page):
    text = page.read_text("utf-8")
    places = re.findall(r'id="([^"]+)"', text)
    assert len(set(places)) == len(places)
    assert set(re.findall(r'href="#([^"]+)"', text)) <= set(places)


def test_two_reports_are_the_same(tmp_path):
    results = made_up(("constant", "pid"), ("heading_keeping",))
    files = [tmp_path / name for name in ("a.html", "b.html")]
    for file in files:
        write_report(results, file)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_markdown_with_its_pictures(results, tmp_path):
    files = write_markdown(results, tmp_path / "results.md", "ship-gym report x")
    text = files[0].read_text("utf-8")
    assert text.startswith("<!-- Written by `ship-gym report x`; run it again")
    for words in ("## Where policies lose", "| lqg | classical |", "\nship-gym report x\n```"):
        assert words in text
    shown = re.findall(r"\]\((results/[^)]+)\)", text)
    assert sorted(shown) == sorted(f"results/{file.name}" for file in files[1:])
    assert all(len(line) <= 100 for line in text.splitlines() if line[:1] not in ("|", "!"))


@pytest.mark.parametrize("width", [1280, 420])
def test_chromium_shows_every_picture_and_asks_for_nothing(page, browser, width):
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.get(page.as_uri())
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    pictures = browser.execute_script(
        "return [...document.images].map(i => [i.alt, i.naturalWidth, i.clientWidth, i.complete])"
    )
    assert len(pictures) > 20
    for alt, natural, shown, complete in pictures:
        assert complete and natural > 0 and 0 < shown <= width, alt
    assert browser.get_log("browser") == []
    asked = [entry["message"] for entry in browser.get_log("performance")]
    asked = [text for text in asked if '"Network.requestWillBeSent"' in text]
    urls = {url for text in asked for url in re.findall(r'"url":"([^"]+)"', text)}
    assert all(url.startswith(("file:", "data:")) for url in urls), urls
    # what is wide scrolls in itself, the page does not
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('p, td, th, figcaption, summary, a, pre')]"
        ".map(e => parseFloat(getComputedStyle(e).fontSize))"
    )
    assert min(sizes) >= 11.0
