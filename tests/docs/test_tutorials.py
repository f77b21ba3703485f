"""The tour and the tutorials, block by block in one empty folder, as a reader would.

Each in a process of its own: a task that it registers is gone with it.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.blocks import ROOT

SHIPS = {"own_ship", "barge", "tanker_mesh", "ferry"}  # tests/recipes/test_ship_tutorials.py
TUTORIALS = [
    "docs/tour.md",
    "docs/cite.md",
    "docs/physics.md",
    *(
        f"docs/tutorials/{page.name}"
        for page in sorted((ROOT / "docs/tutorials").glob("*.md"))
        if page.stem not in SHIPS
    ),
]


def environment():
    """Commands and packages of this checkout, first in every path."""
    mine = os.pathsep.join(str(ROOT / name) for name in (".", "agents"))
    programs = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    return {**os.environ, "PYTHONPATH": mine, "PATH": programs, "SHIP_GYM_ONE_VERSION": "1"}


@pytest.mark.slow
@pytest.mark.parametrize("page", TUTORIALS)
def test_a_page_runs_from_top_to_bottom(page, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", f"from tests.docs.running import run_page; run_page({page!r})"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
