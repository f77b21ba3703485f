"""Where an artefact comes from."""

from __future__ import annotations

import functools
import hashlib
import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

_PACKAGES = ("numpy", "scipy", "numba", "gymnasium", "torch", "stable-baselines3", "rerun-sdk")


def versions() -> dict[str, str]:
    """Versions of Python, this package and the installed libraries that decide a result."""
    return dict(_versions())


@functools.cache  # what a process has imported stays what it is
def _versions() -> dict[str, str]:
    found = {"python": platform.python_version(), "ship-gym": _version("ship-gym")}
    for name in _PACKAGES:
        if (version := _version(name)) != "not installed":
            found[name] = version
    return found


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


@functools.cache  # git looks at every file of the checkout, for every artefact
def git_commit() -> str:
    """Commit of the checkout that this package runs from, with ``-dirty`` if it was edited.

    As it was when this process first asked: the code that runs does not change with later edits.

    Returns
    -------
    str
        Forty hex digits, or ``"no git checkout"`` for an installed wheel.
    """
    package = Path(__file__).resolve().parent
    command = ["git", "-C", str(package), "describe", "--always", "--abbrev=40", "--dirty"]
    try:
        top = subprocess.run(
            ["git", "-C", str(package), "rev-parse", "--show-toplevel"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
        if Path(top).resolve() != package.parent:  # a wheel inside somebody else's repository
            return "no git checkout"
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "no git checkout"


def provenance() -> dict[str, Any]:
    """Versions and commit, to be stored in every artefact beside its config and seed."""
    return {"versions": versions(), "git_commit": git_commit()}


def sha256(path: str | os.PathLike) -> str:
    """SHA-256 of a file's bytes, as hex digits."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()
