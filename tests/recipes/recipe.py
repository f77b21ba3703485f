"""Apply a recipe of docs/extending.md to a copy of the packages, and run Python there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
EXTENDING = ROOT / "docs" / "extending.md"
_BLOCK = re.compile(r"^```(diff|python|toml)\n(.*?)^```$", re.M | re.S)


def copied(folder: Path) -> Path:
    """Copy both packages into `folder`, side by side."""
    for package in (ROOT / "ship_gym", ROOT / "agents" / "ship_gym_agents"):
        leave = shutil.ignore_patterns("__pycache__")
        shutil.copytree(package, folder / package.name, ignore=leave)
    return folder


def apply(section: str, folder: Path) -> set[str]:
    """Make the changes of a section of docs/extending.md in `folder`; gives the files touched."""
    text = EXTENDING.read_text(encoding="utf-8")
    (body,) = re.findall(rf"^## {re.escape(section)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    touched = set()
    for kind, block in _BLOCK.findall(body):
        first, rest = block.split("\n", 1)
        name = first.removeprefix("--- " if kind == "diff" else "# ")
        file = folder / name
        if kind != "diff":
            assert not file.exists(), f"{name} is there already"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(rest, encoding="utf-8")
        else:
            lines = rest.splitlines(keepends=True)
            old, new = ("".join(x[1:] for x in lines if x[0] != sign) for sign in "+-")
            before = file.read_text(encoding="utf-8")
            assert before.count(old) == 1, f"{name}: not once in it:\n{old}"
            file.write_text(before.replace(old, new), encoding="utf-8")
        touched.add(name)
    return touched


def run(code: str, folder: Path) -> str:
    """Standard output of `code` in a new process that has the copies; kernels are interpreted."""
    env = {**os.environ, "PYTHONPATH": str(folder), "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=env, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
