"""Write the pages of the environments, or check that they say what the code says."""

from __future__ import annotations

import sys
from pathlib import Path

from _cli import parser, progress, run, show

from agents import make_controller
from ship_gym import ENVIRONMENTS
from ship_gym.reports.environment_pages import name_of, outdated, picture, write_pages

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "environments"
EXAMPLES = (
    "python scripts/build_docs.py           # pages and pictures",
    "python scripts/build_docs.py --check   # nothing is written; exit code 1 if a page is old",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--out", type=Path, default=FOLDER, help="folder (default docs/environments)")
    what = p.add_mutually_exclusive_group()
    what.add_argument("--check", action="store_true", help="compare texts with those in --out")
    what.add_argument("--no-pictures", action="store_true", help="write the texts only")
    return p.parse_args()


def write_pictures(folder: Path) -> list[Path]:
    """One picture for each id, steered by the PID."""
    from ship_gym.rendering.png import save_png

    paths = []
    for env_id in progress(ENVIRONMENTS, "pictures"):
        paths.append(folder / f"{name_of(env_id)}.png")
        save_png(picture(env_id, make_controller("pid")), paths[-1])
    return paths


def main() -> None:
    args = arguments()
    if args.check:
        old = outdated(args.out)
        text = f"not up to date in {args.out}: {', '.join(old)}; run python scripts/build_docs.py"
        show(args.json, {"folder": str(args.out), "outdated": old}, text if old else "up to date")
        sys.exit(1 if old else 0)
    files = [] if args.no_pictures else write_pictures(args.out)
    files += write_pages(args.out)
    wrote = "\n".join(f"wrote {file}" for file in files)
    show(args.json, {"files": [str(file) for file in files]}, wrote)


if __name__ == "__main__":
    run(main)
