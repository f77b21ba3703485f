"""Feed wrong files and command lines to every reader, and say what does not end in clear words."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from _cli import parser, progress, run, show

HELP = """\
Make wrong inputs from good ones (ships, scenarios, tables, recordings, policies, meshes, command
lines and more), use each as a user would, and judge: an error must be told in words, in lines of at
most 300 characters; what is accepted must be of use; nothing may hang, die or take over 1 GB; the
ships of a list that cannot exist must be refused. Findings are grouped by kind, the smallest input
of each is written into --out. Case K of a seed is always the same input. Exit code 1: findings.
"""
EXAMPLES = (
    "python scripts/fuzz.py --cases 2000 --seed 0 --jobs 2",
    "python scripts/fuzz.py --cases 10000 --format ship --out runs/ships --json",
    "python scripts/fuzz.py --cases 10000 --resume                # go on after a kill",
    "python scripts/fuzz.py --case 1234                          # one again",
)


def main() -> None:
    """Read the command line; run, resume, or look at one case."""
    made = parser(HELP, EXAMPLES)
    made.add_argument("--cases", type=int, default=2000, help="how many (default 2000)")
    made.add_argument("--seed", type=int, default=0, help="of the cases (default 0)")
    made.add_argument("--jobs", type=int, default=2, help="processes (default 2)")
    made.add_argument("--format", action="append", default=[], help="only this one; repeatable")
    made.add_argument(
        "--out", type=Path, default=Path("runs/fuzz"), help="folder (default runs/fuzz)"
    )
    made.add_argument("--resume", action="store_true", help="go on with the run in --out")
    made.add_argument(
        "--case", type=int, help="this case alone, in this process; nothing is written"
    )
    made.add_argument("--keep", action="store_true", help="with --case: write its files into --out")
    args = made.parse_args()
    _check(args)
    if args.case is not None:
        return _one(args)
    return _all(args)


def _check(args) -> None:
    from _fuzz_formats import FORMATS

    from ship_gym.config import check_known, check_number
    from ship_gym.writing import check_place

    for name, low, high in (("cases", 1, 10**8), ("seed", 0, 2**31), ("jobs", 1, 256)):
        check_number(f"--{name}", getattr(args, name), low, high)
    for name in args.format:
        check_known("format", name, FORMATS)
    if args.case is None:
        args.out.mkdir(parents=True, exist_ok=True)
        check_place(args.out / "cases.jsonl", "--out")


def _one(args) -> None:
    """One case again, with all that Python says of it."""
    import dataclasses
    import traceback

    from _fuzz_formats import FORMATS, case
    from _fuzz_judge import judged, written
    from _fuzz_minimise import differences

    made = case(args.seed, args.case)
    with tempfile.TemporaryDirectory() as folder:
        found = judged(made, Path(folder) / "c")
        if found.outcome == "traceback":
            main = written(made.files, Path(folder) / "again")
            try:
                FORMATS[made.kind].use(main, **made.options)
            except BaseException:
                traceback.print_exc()
    lines = [f"case {args.case} of seed {args.seed}: {made.kind}, from {made.seed}"]
    lines += [f"  {line}" for line in differences(made)]
    lines += [f"{found.kind}: {found.message}", *found.soft]
    if args.keep:
        written(made.files, args.out / f"case_{args.case}")
        lines.append(f"wrote {args.out / f'case_{args.case}'}")
    about = {"case": args.case, "format": made.kind, "from": made.seed}
    show(args.json, about | dataclasses.asdict(found), "\n".join(lines))
    sys.exit(1 if found.bad else 0)


def _all(args) -> None:
    from _fuzz_report import Run

    with Run(args.out, args.seed, args.cases, args.format, args.resume) as fuzzing:
        for _ in progress(fuzzing.cases(args.jobs), "cases", fuzzing.left):
            pass
        for _ in progress(fuzzing.minimised(args.jobs), "smallest inputs"):
            pass
        data = fuzzing.report()
    show(args.json, data, fuzzing.text())
    if data["findings"]:
        sys.exit(1)


if __name__ == "__main__":
    run(main)
