"""The page of the manoeuvres: what it says, and that it needs nothing from outside."""

import re

import pytest

from ship_gym.evaluation.manoeuvres.report import write_manoeuvres_report
from ship_gym.evaluation.manoeuvres.table import rows_of

pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def file(sailed, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "manoeuvres.html"
    write_manoeuvres_report(path, sailed, rows_of(sailed), {"version": "ShipBench-1"})
    return path


@pytest.fixture(scope="module")
def page(file):
    return file.read_text("utf-8")


def test_it_says_limits_trials_sides_and_seas(page):
    for words in (
        "IMO MSC.137(76)", "above it", ">pass<", "Trials of the ship files", "in SD",
        "mean of 3 facilities: 35 deg to port, Fn 0.157", "Port beside starboard",
        "Forces in the steady turns", "Every measure", "kvlcc2: turning circle 35 deg to either",
        "Computed: calm, ss5.", "of the stop the track reach is the weakest",
    ):  # fmt: skip
        assert words in page, words


def test_it_loads_nothing_and_has_its_pictures(page):
    for outside in ("http:", "https:", "<link", "<script", "@import", "url(", "file:"):
        assert outside not in page
    assert len(re.findall(r'<img alt="[^"]+" src="data:image/png;base64,', page)) == 4
    places = re.findall(r'id="([^"]+)"', page)
    assert len(set(places)) == len(places)
    assert set(re.findall(r'href="#([^"]+)"', page)) <= set(places)


def test_the_difference_of_the_sides_is_port_less_starboard_of_their_mean(page, sailed):
    circle = {
        each.side: each.case.result.advance
        for each in sailed
        if each.ship.name == "kcs" and each.manoeuvre.kind == "turning" and each.trial is None
    }
    share = 200.0 * (circle["port"] - circle["starboard"]) / sum(circle.values())
    cells = [f"{circle['starboard']:.4g}", f"{circle['port']:.4g}", f"{share:+.1f} %"]
    row = '</td><td class="left">L</td><td>' + "</td><td>".join(cells)
    assert row in page


@pytest.mark.parametrize("width", [1280, 420])
def test_chromium_shows_every_picture(file, browser, width):
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.get(file.as_uri())
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    pictures = browser.execute_script(
        "return [...document.images].map(i => [i.alt, i.naturalWidth, i.clientWidth, i.complete])"
    )
    assert len(pictures) == 4
    for alt, natural, shown, complete in pictures:
        assert complete and natural > 0 and 0 < shown <= width, alt
    assert browser.get_log("browser") == []
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
