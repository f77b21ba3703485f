"""The documentation site: its links, its reference, and that it builds without a warning."""

import importlib.util
import re
import subprocess
import sys

import pytest
import ship_gym_agents

import ship_gym
from tests.docs.blocks import ROOT
from website.links import faults

REFERENCE = "\n".join(page.read_text("utf-8") for page in (ROOT / "docs/api").glob("*.md"))
NOT_CODE = {"ENVIRONMENTS", "__version__", "CONTROLLERS", "PRETRAINED"}  # lists and a number


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
def test_it_builds_without_warning_or_network_and_its_links_hold(tmp_path):
    if importlib.util.find_spec("furo") is None:
        pytest.skip("the extra docs is not installed")
    done = subprocess.run(
        ["bash", ROOT / "scripts/build_site.sh", tmp_path / "site"],
        env={"PYTHON": sys.executable, "PATH": "/usr/bin:/bin", "http_proxy": "http://127.0.0.1:9"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    home = (tmp_path / "site/docs/index.html").read_text("utf-8")
    assert "tutorials/own_controller.html" in home and "install.html" in home


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
