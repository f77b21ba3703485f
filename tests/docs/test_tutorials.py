"""The tour and the tutorials, block by block in one empty folder, as a reader would.

A block in Python whose first line is ``# name.py`` is that file; the others share their names.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.blocks import ROOT, SHELL, blocks_of, commands

ELSEWHERE = {"own_ship", "barge", "tanker_mesh", "ferry"}  # tests/recipes/test_ship_tutorials.py
TUTORIALS = [
    "docs/tour.md",
    "docs/cite.md",
    "docs/physics.md",
    *(
        f"docs/tutorials/{page.name}"
        for page in sorted((ROOT / "docs/tutorials").glob("*.md"))
        if page.stem not in ELSEWHERE
    ),
]
SHORTER = {"--minutes 2": "--minutes 0.1"}  # what takes a reader's time, not a test's


def environment():
    """Commands and packages of this checkout, first in every path."""
    mine = os.pathsep.join(str(ROOT / name) for name in (".", "agents"))
    programs = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    return {**os.environ, "PYTHONPATH": mine, "PATH": programs, "SHIP_GYM_ONE_VERSION": "1"}


SHIP_GYM = "from ship_gym_agents.cli import main; main()"


def script_of(page):
    """One script in Python that runs a page in its folder."""
    lines = ["import pathlib, shlex, subprocess, sys"]
    for block in blocks_of(ROOT / page):
        if block.why:
            continue
        if block.file:
            lines.append(f"pathlib.Path({block.file!r}).write_text({block.code!r})")
        elif block.language == "python":
            lines.append(f"exec(compile({block.code!r}, {str(block)!r}, 'exec'), globals())")
        elif block.language in SHELL:
            lines += [command_of(line) for line in commands(block.code)]
    return "\n".join(lines)


def command_of(line):
    """A call of a command, its own time made shorter; pages that run have no others than ours."""
    for long, short in SHORTER.items():
        line = re.sub(rf"{long}(?![.\d])", short, line)
    program, *words = shlex.split(line, comments=True)
    assert program == "ship-gym", line
    return f"subprocess.run([sys.executable, '-c', {SHIP_GYM!r}, *{words!r}], check=True)"


@pytest.mark.slow
@pytest.mark.parametrize("page", TUTORIALS)
def test_a_page_runs_from_top_to_bottom(page, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", script_of(page)],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
