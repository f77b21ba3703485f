"""Write the pages of the environments and the tables of units, or check that they are current."""

from __future__ import annotations

import sys
from pathlib import Path

from _cli import parser, progress, run, show
from ship_gym_agents import make_controller

from pages import unit_page
from pages.environment_pages import env_ids, name_of, outdated, task_of, write_pages
from pages.still import still
from ship_gym.writing import check_place

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


def check(folder: Path, as_json: bool) -> None:
    """Exit with code 1 if a page is not what it would be if it were written now."""
    old = outdated(folder)
    if folder.resolve() == FOLDER and unit_page.outdated():
        old.append(f"../{unit_page.PAGE.name}")
    text = f"not up to date in {folder}: {', '.join(old)}; run python scripts/build_docs.py"
    show(as_json, {"folder": str(folder), "outdated": old}, text if old else "up to date")
    sys.exit(1 if old else 0)


def main() -> None:
    args = arguments()
    if args.check:
        check(args.out, args.json)
    check_place(args.out, "--out", folder=True)
    if not args.no_pictures:
        from ship_gym.rendering.png import save_png  # first: its library may be missing
    files = write_pages(args.out)
    if args.out.resolve() == FOLDER:
        files.append(unit_page.write())
    for env_id in progress(() if args.no_pictures else env_ids(), "pictures"):
        files.append(args.out / f"{name_of(env_id)}.png")
        name, seed, intervals = task_of(env_id).moment
        save_png(still(make_controller(name), env_id, seed, intervals), files[-1])
    wrote = "\n".join(f"wrote {file}" for file in files)
    show(args.json, {"files": [str(file) for file in files]}, wrote)


if __name__ == "__main__":
    run(main)
