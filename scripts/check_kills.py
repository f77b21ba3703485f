"""Kill training, tuning, benchmarks, recordings and table builds, and look at what is left."""

from __future__ import annotations

import functools
import json
import os
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from _cli import parser, run, show

HELP = """\
Each case: begin a tiny run of a kind of work, kill it (SIGKILL) at a random moment or just before
a random change of a file, and look whether the folder is consistent; let it go on, kill that
sometimes, too; let the last one come to its end, and compare with a run that was never killed.
Every outcome goes into a log at once: killed itself, the same command goes on. Exit code 1:
something that must not be. Needs a system that forks (Linux, macOS).
"""
EXAMPLES = (
    "python scripts/check_kills.py --kills 20",
    "python scripts/check_kills.py --kills 200 --jobs 2 --log runs/kills.jsonl",
    "python scripts/check_kills.py --works train record --fresh --json",
)
GOOD = "goes on, and equals the run that was not killed"
_AGAIN = 0.4  # chance that what goes on is killed, too


class Known(NamedTuple):
    """Of a run that was never killed: its result, files, changes of files and time [s]."""

    result: Any
    names: list[str]
    changes: int
    seconds: float


def main() -> None:
    # one thread: a fork of a process with OpenMP's threads waits for them for ever
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}  # before they are loaded
    from _kill_works import works

    from ship_gym.config import check_known, check_number
    from ship_gym.locks import held
    from ship_gym.text import table
    from ship_gym.writing import check_place

    made = parser(HELP, EXAMPLES)
    made.add_argument(
        "--kills",
        type=int,
        default=20,
        help="cases of each kind of work (default 20); some are killed more than once",
    )
    made.add_argument("--works", nargs="*", metavar="NAME", help=f"of {', '.join(works())}")
    made.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    made.add_argument("--seed", type=int, default=0, help="of the moments (default 0)")
    made.add_argument("--log", type=Path, default=Path("runs/kills.jsonl"), help="outcomes so far")
    made.add_argument("--fresh", action="store_true", help="begin the log anew")
    args = made.parse_args()
    check_number("kills", args.kills, 1, 10**5)
    check_number("jobs", args.jobs, 1, 64)
    check_number("seed", args.seed, 0, 10**6)
    names = [check_known("work", name, works()) for name in args.works or works()]
    check_place(args.log, "--log")
    with held(args.log, "kills into this log"):
        _begin(args)
        for name in names:
            _kill_all(name, works()[name], args)
        rows = [row for row in _logged(args) if row["work"] in names]
    found = {name: Counter(row["outcome"] for row in rows if row["work"] == name) for name in names}
    kills = {name: sum(row["kills"] for row in rows if row["work"] == name) for name in names}
    lines = [
        [name, outcome, str(count), "" if outcome == GOOD else "BAD"]
        for name, counts in found.items()
        for outcome, count in counts.most_common()
    ]
    bad = sum(int(line[2]) for line in lines if line[3])
    data = {name: dict(counts) for name, counts in found.items()}
    data |= {"kills": kills, "bad": bad, "log": str(args.log)}
    text = table(["work", "outcome", "cases", ""], lines, 2)
    killed = ", ".join(f"{name} {count}" for name, count in kills.items())
    text += f"\n\nkills: {killed}\nwrote {args.log}"
    show(args.json, data, text)
    if bad:
        sys.exit(1)


# --- the log ----------------------------------------------------------------------------------


def _begin(args) -> None:
    """Begin the log, or go on with it where it is of this code and these moments."""
    from ship_gym.provenance import git_commit

    head = {"commit": git_commit(), "seed": args.seed}
    lines = args.log.read_text().splitlines(keepends=True) if args.log.is_file() else []
    if args.fresh or not lines or json.loads(lines[0]) != head:
        args.log.parent.mkdir(parents=True, exist_ok=True)
        lines = [json.dumps(head) + "\n"]
    whole = [line for line in lines if line.endswith("\n")]  # the last may be half a line
    args.log.write_text("".join(whole))


def _logged(args) -> list[dict[str, Any]]:
    rows = [json.loads(line) for line in args.log.read_text().splitlines()[1:]]
    return [row for row in rows if row["number"] < args.kills]


# --- the kills --------------------------------------------------------------------------------


def _kill_all(name: str, work: Any, args) -> None:
    """All cases of one work that are not in the log yet, in so many processes."""
    done = {row["number"] for row in _logged(args) if row["work"] == name}
    todo = [number for number in range(args.kills) if number not in done]
    if not todo:
        return
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        known = _known(work, Path(folder))
        print(f"{name}: {known.changes} changes of files, {known.seconds:.2f} s", file=sys.stderr)
        one = functools.partial(_case_logged, name, work, known, args, Path(folder))
        _shared(todo, args.jobs, one)
    spent = time.monotonic() - begun
    print(f"{name}: {len(todo)} cases in {spent:.0f} s", file=sys.stderr)


def _shared(todo: list[int], jobs: int, one: Any) -> None:
    """Cases in forked processes, each with its share of them."""
    children = []
    for place in range(jobs):
        child = os.fork()
        if child == 0:
            try:
                for number in todo[place::jobs]:
                    one(number)
            except BaseException as error:
                print(f"{type(error).__name__}: {error}", file=sys.stderr, flush=True)
                os._exit(1)
            os._exit(0)
        children.append(child)
    codes = [os.waitpid(child, 0)[1] for child in children]
    if any(codes):
        raise ChildProcessError("a process that kills others ended early; call again to go on")


def _known(work: Any, folder: Path) -> Known:
    """Load and compile all that is needed here, then run twice in processes of their own."""
    from _kill_works import names_in
    from _kills import forked

    places = [folder / name / "case" for name in ("warm", "first", "second")]
    for place in places:
        place.mkdir(parents=True)
    before = Path.cwd()
    os.chdir(places[0])
    try:
        _silently(work.warm or work.run)
    finally:
        os.chdir(before)
    runs = [forked(work.run, place) for place in places[1:]]
    if said := [f"{one.how}: {one.said}" for one in runs if one.how != "done"]:
        raise ChildProcessError(f"a run that is not killed does not come to its end: {said[0]}")
    result, again = (work.result(place) for place in places[1:])
    if different := _differing(result, again):
        raise ChildProcessError(f"two runs that are not killed differ: {different}")
    return Known(result, names_in(places[1]), runs[1].changes, runs[1].seconds)


def _silently(run: Any) -> None:
    """Run without a word, unless it is refused."""
    kept = os.dup(1), os.dup(2)
    with tempfile.TemporaryFile("w+") as said:
        sys.stdout.flush()
        os.dup2(said.fileno(), 1)
        os.dup2(said.fileno(), 2)
        try:
            run()
        except SystemExit:
            sys.stderr.flush()
            said.seek(0)
            last = said.read().strip().splitlines()[-1:]
            raise ChildProcessError(f"a run that is not killed is refused: {last}") from None
        finally:
            sys.stdout.flush()
            os.dup2(kept[0], 1)
            os.dup2(kept[1], 2)
            os.close(kept[0])
            os.close(kept[1])


def _case_logged(name: str, work: Any, known: Known, args, folder: Path, number: int) -> None:
    rng = np.random.default_rng([args.seed, number, *name.encode()])
    with tempfile.TemporaryDirectory(dir=folder) as place:
        case = Path(place) / "case"
        case.mkdir()
        outcome, moments = _case(work, known, case, rng)
    row = {"work": name, "number": number, "outcome": outcome}
    row |= {"kills": sum(moment.startswith("killed") for moment in moments)}
    with args.log.open("a") as log:  # one short line in one go: others write here, too
        log.write(json.dumps(row | {"moments": moments}) + "\n")


def _case(work: Any, known: Known, case: Path, rng: np.random.Generator) -> tuple[str, list[str]]:
    """Kill, once or several times, and let it end: what came of it, and the moments."""
    from _kill_works import names_in
    from _kills import forked

    moments = []
    while not moments or rng.random() < _AGAIN:
        moment = _moment(known, rng)
        ended = forked(work.run, case, **moment)
        moments.append(f"{ended.how} {moment}")
        if ended.how not in ("killed", "done") and (not work.over or work.over not in ended.said):
            return f"does not go on: {ended.how}: {ended.said}", moments
        if broken := _looked(work, case, known):
            return f"inconsistent: {broken}", moments
    ended = forked(work.run, case)
    if ended.how != "done" and (not work.over or work.over not in ended.said):
        return f"does not come to its end: {ended.how}: {ended.said}", moments
    if different := _differing(known.result, work.result(case)):
        return f"differs: {different}", moments
    if (names := names_in(case)) != known.names:
        more, less = set(names) - set(known.names), set(known.names) - set(names)
        return f"leaves {sorted(more)}, lacks {sorted(less)}", moments
    return GOOD, moments


def _moment(known: Known, rng: np.random.Generator) -> dict[str, Any]:
    """Before a change of a file in two of three cases, else any time."""
    if rng.random() < 2.0 / 3.0:
        return {"change": int(rng.integers(1, known.changes + 1))}
    return {"after": round(float(rng.uniform(0.0, known.seconds)), 4)}


def _looked(work: Any, case: Path, known: Known) -> str:
    try:
        return work.broken(case, known.result)
    except Exception as error:  # whatever cannot be read is not consistent
        return f"{type(error).__name__}: {error}"


def _differing(one: Any, other: Any) -> str:
    """The first place where two results differ; empty where they do not."""
    one, other = (json.dumps(each, default=str, sort_keys=True) for each in (one, other))
    if one == other:
        return ""
    at = next((i for i, pair in enumerate(zip(one, other, strict=False)) if pair[0] != pair[1]), 0)
    return f"{one[max(0, at - 40) : at + 20]} and {other[max(0, at - 40) : at + 20]}"


if __name__ == "__main__":
    run(main)
