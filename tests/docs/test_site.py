"""The documentation site: its links, its reference, and that it builds without a warning."""

import importlib.util
import posixpath
import re
import subprocess
import sys
from html import unescape

import pytest
import ship_gym_agents
from ship_gym_agents.cli import VERBS

import ship_gym
from tests.docs.blocks import ROOT
from website.links import faults

REFERENCE = "\n".join(page.read_text("utf-8") for page in (ROOT / "docs/api").glob("*.md"))
NOT_CODE = {"ENVIRONMENTS", "__version__", "CONTROLLERS", "PRETRAINED"}  # lists and a number

# row of the first page -> what the page that helps says
NEEDS = {
    "install": 'pip install ".[',
    "train": "ship-gym train",
    "judge": "ship-gym evaluate",
    "record": "ship-gym record",
    "add a controller": "ship-gym evaluate --controller",
    "add a ship": "ship-gym new-ship",
    "cite": "@software",
}


def site(folder, **pages):
    """A site of some pages with these bodies."""
    for name, body in pages.items():
        (folder / f"{name}.html").write_text(f"<html><body>{body}</body></html>", "utf-8")
    return folder


def test_links_that_lead_somewhere(tmp_path):
    (tmp_path / "a b.png").write_bytes(b"")
    there = '<h1 id="here">x</h1><img src="a%20b.png"><a href="#here">x</a>'
    to = '<a href="there.html#here">x</a><a href="https://example.org/lost">x</a>'
    assert faults(site(tmp_path, there=there, to=to)) == []


@pytest.mark.parametrize(
    "body, told",
    [
        ('<a href="gone.html">x</a>', "gone.html leads nowhere"),
        ('<a href="#gone">x</a>', "#gone leads nowhere"),
        ('<a href="there.html#gone">x</a>', "there.html#gone leads nowhere"),
        ('<img src="gone.png">', "gone.png leads nowhere"),
        ('<script src="https://cdn.example/x.js"></script>', "from elsewhere"),
        ('<link rel="stylesheet" href="//cdn.example/x.css">', "from elsewhere"),
    ],
)
def test_a_lost_link_is_told_with_its_page(tmp_path, body, told):
    (found,) = faults(site(tmp_path, there="", to=body))
    assert found.startswith("to.html: ") and told in found


def test_a_folder_without_pages_is_no_site(tmp_path):
    assert faults(tmp_path) == [f"{tmp_path}: no pages"]


def test_the_reference_has_every_public_name():
    for package in (ship_gym, ship_gym_agents):
        for name in sorted(set(package.__all__) - NOT_CODE - tasks()):
            entry = rf"auto\w+:: {package.__name__}\.{name}$"
            assert re.search(entry, REFERENCE, re.M), name


def tasks():
    """Classes made from the tasks, which the pages of the environments describe."""
    return {name.partition("/")[2].partition("-")[0] for name in ship_gym.ENVIRONMENTS}


@pytest.mark.slow
def test_it_builds_without_warning_or_network_and_its_links_hold(built):
    home = (built / "docs/index.html").read_text("utf-8")
    assert "tutorials/own_controller.html" in home and "install.html" in home


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The folder of the site, built without a network."""
    if importlib.util.find_spec("furo") is None:
        pytest.skip("the extra docs is not installed")
    folder = tmp_path_factory.mktemp("built") / "site"
    done = subprocess.run(
        ["bash", ROOT / "scripts/build_site.sh", folder],
        env={"PYTHON": sys.executable, "PATH": "/usr/bin:/bin", "http_proxy": "http://127.0.0.1:9"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("need", NEEDS)
def test_a_newcomer_finds_it_in_two_clicks(built, need):
    text = NEEDS[need]
    row = re.search(rf"<tr[^>]*><td><p>[^<]*\b{need}.*?</tr>", article(built, "docs/index"), re.S)
    assert row, f"no row of the first page names: {need}"
    near = leads(row[0], "docs/index.html")
    far = {there for page in near for there in leads(article(built, page), f"{page}.html")}
    seen = [page for page in near | far if text in words(article(built, page))]
    assert seen, f"{need}: {text!r} is on none of {sorted(near | far)}"


def article(site, page):
    """What a page of a site says, without menus."""
    return (
        (site / f"{page}.html")
        .read_text("utf-8")
        .partition("<article")[2]
        .partition("</article")[0]
    )


def words(html):
    """The text of a page as it is read."""
    return unescape(re.sub(r"<[^>]+>", "", html))


def leads(html, page):
    """Pages of the documentation that links lead to."""
    found = re.findall(r'<a class="reference internal" href="([^"#]+)\.html', html)
    places = [posixpath.normpath(posixpath.join(posixpath.dirname(page), link)) for link in found]
    return {place for place in places if not place.startswith("source/")}


def test_each_verb_is_on_one_page_of_the_command_line():
    pages = [page.read_text("utf-8") for page in (ROOT / "docs/cli").glob("*.md")]
    named = re.findall(r"^```\{verbs\} (.+)$", "\n".join(pages), re.M)
    assert sorted(" ".join(named).split()) == sorted(VERBS)


@pytest.mark.slow
@pytest.mark.parametrize("verb", VERBS)
def test_the_command_line_has_what_help_says(built, verb):
    from website.command_line import contexts, usage

    home = article(built, "docs/cli/index")
    (page,) = re.findall(rf'href="(\w+)\.html#ship-gym-{verb}"', home)
    html = article(built, f"docs/cli/{page}")
    said = " ".join(words(html).split())
    for context in contexts(verb):
        command = context.command
        told = [usage(context), *getattr(command, "examples", ()), getattr(command, "notes", "")]
        told += [command.help, command.epilog or ""]
        records = [param.get_help_record(context) for param in command.get_params(context)]
        told += [" ".join(record) for record in records if record and "--help" not in record[0]]
        for text in told:
            assert plain(text) in plain(said), f"{context.command_path}: {text}"


def plain(text):
    """Text without spaces."""
    return re.sub(r"\s", "", text)


def test_attributes_described_together_are_told_one_by_one():
    pytest.importorskip("sphinx")
    from website.members import divided

    docstring = ["Of a turn.", "", "Parameters", "----------", "a, b : int", "Attributes"]
    docstring += ["----------", "advance, transfer : float", "    At 90 deg.", "", "n : int"]
    assert divided(docstring) == [
        *docstring[:7],
        *("advance : float", "    At 90 deg.", ""),
        *("transfer : float", "    At 90 deg.", ""),
        "n : int",
    ]


@pytest.mark.slow
def test_the_reference_reads_docstrings_as_they_are_meant(built):
    turn = words(article(built, "docs/api/manoeuvres"))
    assert "advance (float)" in turn and "transfer (advance,)" not in turn
    said = " ".join(words(article(built, "docs/api/ships")).split())
    assert ship_gym.Ship.time_unit.__doc__.splitlines()[0].replace("'", "\u2019") in said
    assert "Alias for field" not in words(article(built, "docs/api/tasks"))


@pytest.mark.slow
def test_the_search_knows_options(built):
    found = (built / "searchindex.js").read_text("utf-8")
    assert '"ship-gym-simulate-wave-height","--wave-height"' in found


def test_a_folder_with_other_things_is_left_alone(tmp_path):
    if importlib.util.find_spec("furo") is None:
        pytest.skip("the extra docs is not installed")
    (tmp_path / "mine.txt").write_text("mine")
    done = subprocess.run(
        ["bash", ROOT / "scripts/build_site.sh", tmp_path],
        env={"PYTHON": sys.executable, "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2 and "is not empty" in done.stderr
    assert (tmp_path / "mine.txt").read_text() == "mine"
