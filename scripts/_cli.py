"""What every script shares: parser with examples, one-line errors, progress bar, JSON output."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

# Where the checkout is not installed, find both packages in it. docs/ goes first: the package
# reproduce in it is named like scripts/reproduce.py.
_ROOT = Path(__file__).resolve().parents[1]
sys.path += [str(_ROOT), str(_ROOT / "agents")]
sys.path.insert(0, str(_ROOT / "docs"))

from ship_gym.config import ConfigError  # noqa: E402

_REFUSED = 2  # exit code of argparse, and ours: nothing was done, or it was broken off
_QUIET = 2.0  # seconds before a progress bar appears


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


def add_report(p: argparse.ArgumentParser) -> None:
    """Option ``--report [FILE.html]``; `report_page` says which file it means."""
    p.add_argument(
        "--report",
        type=Path,
        nargs="?",
        const=Path(),
        metavar="FILE.html",
        help="write a page with all pictures and tables (default beside the table file)",
    )


def report_page(wanted: Path | None, table: Path) -> Path | None:
    """File of the page: the one named, else beside the table; None without ``--report``."""
    return table.with_suffix(".html") if wanted == Path() else wanted


# library -> extra of ship-gym that brings it, and what for
_EXTRAS = {
    "rerun": ("rerun", "recordings"),
    "matplotlib": ("plot", "pictures"),
    "capytaine": ("bem", "wave tables"),
    "joblib": ("bem", "wave tables"),
}


def need(library: str) -> None:
    """Refuse, before any work, what a library that is not installed would break off later."""
    if find_spec(library) is None:
        extra, purpose = _EXTRAS[library]
        raise ImportError(f'{purpose} need {library}: pip install "ship-gym[{extra}]"')


def run(main: Callable[[], Any]) -> None:
    """Call `main` and exit; an error a user can mend is one line on stderr and exit code 2."""
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(_refuse("interrupted"))
    except (ConfigError, ImportError, OSError) as error:
        sys.exit(_refuse(f"error: {error}"))


def _refuse(message: str) -> int:
    print(" ".join(message.split()), file=sys.stderr)
    return _REFUSED


def progress(iterable: Iterable, description: str = "", total: int | None = None) -> Iterable:
    """The iterable with a tqdm bar on a terminal after 2 s, if tqdm is installed; else as it is."""
    try:
        from tqdm import tqdm
    except ImportError:
        return iterable
    # disable=None: no bar where stderr is no terminal
    return tqdm(iterable, description, total, leave=False, delay=_QUIET, disable=None)


def show(as_json: bool, data: Mapping[str, Any], text: str) -> None:
    """Print `data` as JSON (``--json``) or `text` for people, on stdout."""
    print(json.dumps(data, indent=2, allow_nan=False) if as_json else text)
