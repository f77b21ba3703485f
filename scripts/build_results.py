"""Sail the standard suites and write the results page of the documentation with its pictures.

Finished episodes are kept in --run: killed, the same command goes on, and what was sailed before is
not sailed again.
"""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path

from _cli import parser, progress, run, show
from ship_gym_agents.entrants import entrant

from ship_gym.evaluation import benchmark
from ship_gym.evaluation.report import write_markdown
from ship_gym.writing import check_place

OUT = Path(__file__).resolve().parents[1] / "docs" / "results.md"
EXAMPLES = (
    "python scripts/build_results.py",
    "python scripts/build_results.py --suite heading track --seeds 32 --jobs 2",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument(
        "--suite", nargs="+", default=["heading", "course", "track", "expert"], help="names, files"
    )
    p.add_argument("--ships", nargs="+", default=[], help="default: the suite's")
    p.add_argument("--controllers", nargs="+", default=[], help="default: the suite's")
    p.add_argument("--seeds", type=int, default=64, help="evaluation seeds (default 64)")
    p.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    p.add_argument("--run", type=Path, default=Path("runs/results"), help="folder of the run")
    p.add_argument("--fresh", action="store_true", help="begin anew where a run is")
    p.add_argument("--out", type=Path, default=OUT, help="page (default docs/results.md)")
    return p.parse_args()


def main() -> None:
    args = arguments()
    check_place(args.out, "--out")
    check_place(args.run, "--run", folder=True)
    command = shlex.join(["python", "scripts/build_results.py", *sys.argv[1:]])
    results = benchmark(
        args.suite,
        entrant,
        ships=args.ships,
        controllers=args.controllers,
        seeds=args.seeds,
        jobs=args.jobs,
        out=args.run,
        fresh=args.fresh,
        progress=progress,
        command=command,
    )
    files = [str(file) for file in write_markdown(results, args.out, command)]
    wrote = "\n".join(f"wrote {file}" for file in files)
    show(args.json, {"episodes": len(results.table), "files": files}, wrote)


if __name__ == "__main__":
    run(main)
