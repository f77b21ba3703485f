"""Put small faults into a copy of the packages and see whether a test notices; see --help."""

from __future__ import annotations

import hashlib
import json
import os
import queue
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from _cli import parser, run, show
from _mutants import AREAS, KINDS, Mutant, draw

from ship_gym.config import ConfigError
from ship_gym.keys import Keys
from ship_gym.reading import parsed_json, read_json, read_text, read_toml
from ship_gym.text import table as aligned
from ship_gym.writing import atomic_path, check_place

HELP = """\
Change one small thing in a copy of the packages (a sign, a constant, an index or comparison by
one, two arguments swapped, a limit removed), run the tests that execute the changed lines, and
count the changes that no test notices. Kernels run as Python (NUMBA_DISABLE_JIT=1), so nothing
is compiled again; tests that take too long that way, and slow ones, are left out. The first run
spends some minutes on finding out which test runs which line and keeps that beside --out.
"""
EXAMPLES = (
    "python scripts/mutate.py --count 100 --seed 0 --resume --report docs/mutation.md",
    "python scripts/mutate.py --count 10 --only 'ship_gym/physics/*.py'",
)
ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("ship_gym", "agents", "tests", "scripts")
# tests that may find a fault; those of reports, pictures and scripts do not look for one
TESTS = (
    "tests/physics",
    "tests/sea",
    "tests/tasks",
    "tests/tracks",
    "tests/ships/test_scaling.py",
    "tests/test_simulation.py",
    "tests/envs",
    "tests/evaluation",
    "tests/recording",
    "tests/scenarios",
    "tests/agents",
)
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.toml")
SLOWEST = 6.0  # longest test, as Python and under coverage [s]
BUDGET = 40.0  # most that the tests of one fault take, by their times in the first run [s]
STATES = ("killed", "survived", "timeout", "equivalent")


def main() -> None:
    args = parser(HELP, EXAMPLES)
    args.add_argument("--count", type=int, default=100, help="number of faults (default 100)")
    args.add_argument("--seed", type=int, default=0, help="of the draw (default 0)")
    args.add_argument("--only", metavar="GLOB", help="modules, e.g. 'ship_gym/sea/*.py'")
    args.add_argument("--out", type=Path, default=Path("runs/mutation.jsonl"), help="results")
    args.add_argument(
        "--resume",
        action="store_true",
        help="keep what --out holds; survivors are tried again if the tests have changed",
    )
    args.add_argument("--workers", type=int, default=1, help="faults at a time (default 1)")
    args.add_argument("--report", type=Path, metavar="FILE.md", help="page with score, survivors")
    args.add_argument("--list", action="store_true", help="print the faults and run nothing")
    args = args.parse_args()
    mutants = draw(ROOT, args.count, args.seed, args.only)
    if not mutants:
        raise ConfigError(f"--only {args.only!r}: no module with anything to change")
    if args.list:
        show(args.json, [m.key for m in mutants], "\n".join(f"{m.kind}: {m.key}" for m in mutants))
        return
    check_place(args.out, "--out")
    if args.report:
        check_place(args.report, "--report")
    results = judge(mutants, args)
    if args.report:
        with atomic_path(args.report) as temporary:
            temporary.write_text(page(results, args), encoding="utf-8")
    show(args.json, {"score": score(results), "mutants": results}, table(results))


# --- running ---------------------------------------------------------------------------------


def judge(mutants: list[Mutant], args) -> list[dict]:
    """One result for each fault, in their order; each is written to ``--out`` as it comes."""
    args.out.parent.mkdir(parents=True, exist_ok=True)
    tests, known = hash_of(TESTS), equivalents()
    done = finished(args.out, tests) if args.resume else {}
    if not args.resume:
        args.out.unlink(missing_ok=True)
    for m in mutants:
        if m.key in known:
            done[m.key] = record(m, "equivalent", 0.0, known[m.key], tests)
    left = [m for m in mutants if m.key not in done]
    if left:
        with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
            copies: queue.Queue[Path] = queue.Queue()
            for k in range(max(1, args.workers)):
                copies.put(copied(Path(folder) / str(k)))
            lines, times = baseline(copies, args)

            def one(mutant: Mutant) -> dict:
                copy = copies.get()
                try:
                    return tried(mutant, copy, chosen(mutant, lines, times), times, tests)
                finally:
                    copies.put(copy)

            with ThreadPoolExecutor(max(1, args.workers)) as pool:
                for k, found in enumerate(pool.map(one, left)):
                    done[found["key"]] = found
                    with open(args.out, "a") as stream:
                        stream.write(json.dumps(found) + "\n")
                    note(
                        f"[{k + 1}/{len(left)}] {found['state']} {found['s']:.0f} s {found['key']}"
                    )
    return [done[m.key] for m in mutants]


def note(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def record(m: Mutant, state: str, seconds: float, by: str, tests: str) -> dict:
    place = {"key": m.key, "area": m.area, "kind": m.kind, "path": m.path, "line": m.line}
    return place | {"state": state, "s": round(seconds, 1), "by": by, "tests": tests}


def hash_of(names) -> str:
    """Hash of files and of the Python files in folders, 16 hex digits."""
    digest = hashlib.sha256()
    for place in (ROOT / name for name in names):
        for file in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            if file.is_file():
                digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def equivalents() -> dict[str, str]:
    """Reasons by key of the faults that change nothing."""
    where = str(EQUIVALENT)
    listed = Keys(read_toml(EQUIVALENT), where).items("mutant", [])
    found = [Keys(one, where, f"mutant[{k}]") for k, one in enumerate(listed)]
    return {one.text("key"): one.text("reason") for one in found}


def finished(out: Path, tests: str) -> dict[str, dict]:
    """Results that still hold, by key."""
    lines = read_text(out).splitlines() if out.is_file() else []
    rows = [Keys(parsed_json(line, f"{out}:{k}"), f"{out}:{k}") for k, line in enumerate(lines, 1)]
    kept = [one for one in rows if one.text("state") == "killed" or one.text("tests") == tests]
    return {one.text("key"): dict(one.values) for one in kept}


def copied(folder: Path) -> Path:
    """The checkout's packages and tests in another place."""
    skip = shutil.ignore_patterns("__pycache__", "*.nb[ic]")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, folder / name, ignore=skip)
    shutil.copy(ROOT / "pyproject.toml", folder)
    return folder


def pytest(copy: Path, arguments: list[str], timeout: float | None = None, **env):
    """Run pytest in a copy; None if it took too long."""
    paths = [copy, copy / "agents", copy / "scripts"]
    settings = {
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "NUMBA_DISABLE_JIT": "1",
        "NUMBA_CACHE_DIR": str(copy / "numba"),
        "PYTHONDONTWRITEBYTECODE": "1",  # a stale .pyc would hide a fault of the same length
        "MPLBACKEND": "Agg",
        "COVERAGE_FILE": str(copy / ".coverage"),
    }
    command = [sys.executable, "-m", "pytest", "-q", "--no-header", "-p", "no:cacheprovider"]
    command += ["-p", "_mutation_plugin", *arguments]
    env = {**os.environ, **settings, **{k: str(v) for k, v in env.items()}}
    process = subprocess.Popen(
        command, cwd=copy, env=env, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    try:
        return process.communicate(timeout=timeout)[0], process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)  # its own children too
        process.wait()
        return None


def baseline(copies: queue.Queue, args) -> tuple[dict[str, dict[int, list[str]]], dict[str, float]]:
    """Which tests run each line of each module, and the time of each test [s], without a fault."""
    store = args.out.with_suffix(".baseline.json")
    stamp = hash_of([*TESTS, *(folder for folder, _ in AREAS.values())])
    if store.is_file() and (kept := read_json(store))["stamp"] == stamp:
        lines = {p: {int(k): v for k, v in of.items()} for p, of in kept["lines"].items()}
        return lines, kept["times"]
    note("Finding out which test runs which line, some minutes ...")
    copy, started = copies.get(), time.monotonic()
    tests = [name for name in TESTS if (ROOT / name).exists()]
    options = ["-m", "not slow and not compiled", "-n", str(args.workers), "--tb=line"]
    options += ["--cov=ship_gym", "--cov=agents", "--cov-context=test", "--cov-report="]
    output, _ = pytest(copy, [*options, *tests], MUTATE_LIMIT=SLOWEST, MUTATE_TIMES=copy / "times")
    rows = [line.split(" ", 1) for line in (copy / "times").read_text().splitlines()]
    times = {name: float(seconds) for seconds, name in rows}
    lines = executed(copy, times)
    copies.put(copy)
    note(f"{output.splitlines()[-1]}; {len(times)} tests used, {time.monotonic() - started:.0f} s")
    store.write_text(json.dumps({"stamp": stamp, "times": times, "lines": lines}))
    return lines, times


def executed(copy: Path, times: dict[str, float]) -> dict[str, dict[int, list[str]]]:
    """Names of tests by module and line, from the coverage data."""
    from coverage import CoverageData

    data = CoverageData(str(copy / ".coverage"))
    data.read()
    found: dict[str, dict[int, list[str]]] = {}
    for file in data.measured_files():
        of = {}
        for line, contexts in data.contexts_by_lineno(file).items():
            names = {context.split("|")[0] for context in contexts} & times.keys()
            if names:
                of[line] = sorted(names)
        found[Path(file).resolve().relative_to(copy.resolve()).as_posix()] = of
    return found


def chosen(mutant: Mutant, lines: dict, times: dict[str, float]) -> list[str]:
    """Tests for one fault: those that run its lines, else (constants) its module.

    First come those of the module's own folder of tests, the quick ones before the long ones; as
    many as `BUDGET` allows.
    """
    of = lines.get(mutant.path, {})
    first, last = mutant.lines
    names = {name for k in range(first, last + 1) for name in of.get(k, ())}
    names = names or {name for row in of.values() for name in row}
    if "/sb3/" not in mutant.path:  # tests of learning look at nothing else, and load torch
        names = {name for name in names if "/sb3/" not in name}
    own = "tests/" + "/".join(Path(mutant.path).parts[1:2])
    own = "tests/agents" if mutant.area == "agents" else own
    found, total = [], 0.0
    for name in sorted(names, key=lambda n: (not n.startswith(own), times[n], n)):
        if total + times[name] <= BUDGET:
            found.append(name)
            total += times[name]
    return found


def tried(m: Mutant, copy: Path, names: list[str], times: dict[str, float], tests: str) -> dict:
    """Put one fault into a copy, run its tests until one fails, take the fault out again."""
    if not names:
        return record(m, "survived", 0.0, "no test runs it", tests)
    file, order, started = copy / m.path, copy / "order", time.monotonic()
    source = file.read_bytes()
    order.write_text("\n".join(names))
    files = list(dict.fromkeys(name.split("::")[0] for name in names))
    timeout = 60.0 + 4.0 * sum(times[name] for name in names)
    try:
        file.write_bytes(m.applied(source))
        done = pytest(copy, ["-x", "--tb=line", "-n", "0", *files], timeout, MUTATE_TESTS=order)
    finally:
        file.write_bytes(source)
    seconds = time.monotonic() - started
    if done is None:
        return record(m, "timeout", seconds, f"more than {timeout:.0f} s", tests)
    output, code = done
    if code == 0:
        return record(m, "survived", seconds, f"{len(names)} tests", tests)
    failed = [s for s in output.splitlines() if s.startswith(("FAILED", "ERROR"))]
    return record(m, "killed", seconds, (failed or ["could not be imported"])[0][:160], tests)


# --- what is printed -------------------------------------------------------------------------


def score(results: list[dict]) -> float:
    """Share of the faults that a test noticed; without those that change nothing."""
    counted = [one for one in results if one["state"] != "equivalent"]
    return sum(one["state"] == "killed" for one in counted) / len(counted) if counted else 1.0


def rows(results: list[dict]) -> list[list[str]]:
    """Counts by area and by kind, and of all."""
    found = [["", *STATES, "score"]]
    groups = [("area", name) for name in AREAS] + [("kind", name) for name in KINDS]
    for key, name in groups:
        part = [one for one in results if one[key] == name]
        if part:
            found.append([name, *counts(part), f"{score(part):.0%}"])
    return [*found, ["all", *counts(results), f"{score(results):.0%}"]]


def counts(results: list[dict]) -> list[str]:
    count = Counter(one["state"] for one in results)
    return [str(count[state]) for state in STATES]


def table(results: list[dict]) -> str:
    head, *body = rows(results)
    lines = [aligned(head, body)]
    for state in STATES[1:]:
        part = [one for one in results if one["state"] == state]
        lines += [f"\n{state}:"] * bool(part)
        lines += [f"  {one['path']}:{one['line']}  {one['key'].split(' ', 1)[1]}" for one in part]
    return "\n".join(lines)


def page(results: list[dict], args) -> str:
    """The page of ``--report``."""
    head, *body = rows(results)
    lines = ["# Do the tests notice faults?", ""]
    lines += [
        f"{len(results)} small faults, drawn with seed {args.seed}, each put alone into a copy of "
        "the packages: a sign flipped, a constant changed by 10 % (a whole number by one), an "
        "index, range or comparison off by one, two arguments swapped, a limit removed. The tests "
        "that run the changed lines were run until one failed, kernels as Python. *score*: killed "
        "over all but the equivalent ones, which change nothing that can be seen; a *timeout* "
        "does not count as killed.",
        "",
        f"    python scripts/mutate.py --seed {args.seed} --count {args.count} --report FILE.md",
        "",
        f"**{score(results):.0%}** killed.",
        "",
        aligned(head, body, markdown=True),
    ]
    titles = {"survived": "Survivors", "timeout": "Timeouts", "equivalent": "Equivalent"}
    for state, title in titles.items():
        part = [one for one in results if one["state"] == state]
        lines += ["", f"## {title}", ""] if part else []
        for one in part:
            function, change = one["key"].split(" ", 1)[1].split(": ", 1)
            before, after = change.split(" -> ", 1)
            lines += [f"- `{one['path']}`, `{function}`, {one['kind']}: {one['by']}", ""]
            lines += [f"      - {before}", f"      + {after}"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    run(main)
