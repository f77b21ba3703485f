"""Finds both packages where the checkout is not installed; the parser of what only it has."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

# Where the checkout is not installed, find both packages in it. docs/ goes first: the package
# reproduce in it is named like scripts/reproduce.py.
_ROOT = Path(__file__).resolve().parents[1]
sys.path += [str(_ROOT), str(_ROOT / "agents")]
sys.path.insert(0, str(_ROOT / "docs"))

from ship_gym_agents.cli import run_script  # noqa: E402
from ship_gym_agents.cli.output import progress, run, show  # noqa: E402

__all__ = ["parser", "progress", "run", "run_script", "show"]


def parser(description: str, examples: Sequence[str]) -> argparse.ArgumentParser:
    """Argument parser with ``--json`` whose ``--help`` ends with `examples` (command lines)."""
    lines = "".join(f"  {example}\n" for example in examples)
    made = argparse.ArgumentParser(
        description=description,
        epilog=f"examples:\n{lines}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    made.add_argument("--json", action="store_true", help="print the result as JSON on stdout")
    return made
