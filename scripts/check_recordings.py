"""Flip bits of a recording, cut it, kill it, fill its disk, and count what comes of it."""

from __future__ import annotations

import os
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from _cli import parser, progress, run, show

HELP = """\
Record an episode, then change single bits of the file, cut it, kill the process that records it
at random moments, and record onto a full disk and into a read-only folder. Prints what came of
each. Exit code 1: something that must not be. The disk is a small file system in memory where the
user may mount one (root), else a limit of the size of files.
"""
EXAMPLES = (
    "python scripts/check_recordings.py",
    "python scripts/check_recordings.py --flips 1000 --cuts 200 --kills 100 --json",
)
ALLOWED = {
    "flips": ("one clear error",),
    "flips of a journal": ("one clear error", "first rows, marked incomplete"),
    "cuts": ("one clear error", "first rows, marked incomplete"),
    "kills": (
        "journal, at most one chunk lost",
        # of one that was killed in the few milliseconds in which it wrote; nothing lists it
        "journal, at most one chunk lost, and a hidden temporary file",
        "whole file",
    ),
    "full disk": ("one clear error, journal reads", "one clear error, nothing left"),
    "read-only folder": ("refused before the run", "not tried: the user may write anywhere"),
}


def main() -> None:
    from ship_gym.config import check_number
    from ship_gym.text import table

    made = parser(HELP, EXAMPLES)
    made.add_argument("--flips", type=int, default=200, help="changed bits (default 200)")
    made.add_argument("--cuts", type=int, default=50, help="places of a cut (default 50)")
    made.add_argument("--kills", type=int, default=10, help="killed processes (default 10)")
    made.add_argument("--seed", type=int, default=0, help="of bits, places and moments (default 0)")
    args = made.parse_args()
    for name in ("flips", "cuts", "kills", "seed"):
        check_number(name, getattr(args, name), 0, 10**6)  # before the work
    with tempfile.TemporaryDirectory() as folder:
        found = _checked(args, Path(folder))
    rows, bad = [], 0
    for what, counts in found.items():
        for outcome, count in counts.most_common():
            good = outcome in ALLOWED[what]
            bad += 0 if good else count
            rows.append([what, outcome, str(count), "" if good else "BAD"])
    data = {what: dict(counts) for what, counts in found.items()} | {"bad": bad}
    show(args.json, data, table(["what", "outcome", "count", ""], rows, 2))
    if bad:
        sys.exit(1)


def _checked(args, folder: Path) -> dict[str, Counter]:
    """Outcomes of every kind of harm."""
    from _recording_checks import Apart, cut, flipped, killed

    sailed = _episode()
    file, journal = _files(sailed, folder)
    rng, apart = np.random.default_rng(args.seed), Apart()

    def each(jobs, what: str) -> Counter:
        return Counter(job() for job in progress(jobs, what))

    def harm(how: Callable, path: Path, places) -> list[Callable[[], str]]:
        return [lambda k=k: apart.call(how, str(path), int(k), sailed) for k in places]

    size = file.stat().st_size
    bits = [rng.integers(0, 8 * path.stat().st_size, args.flips) for path in (file, journal)]
    try:
        found = {
            "flips": each(harm(flipped, file, bits[0]), "flips"),
            "flips of a journal": each(harm(flipped, journal, bits[1]), "journal"),
            "cuts": each(harm(cut, file, rng.integers(0, size, args.cuts)), "cuts"),
        }
        kills = [lambda m=m: killed(_new(folder), sailed, *m) for m in _moments(rng, args, sailed)]
        found["kills"] = each(kills, "kills")
        found["full disk"] = Counter(_full(apart, sailed, folder))
        found["read-only folder"] = Counter([_read_only(sailed, folder)])
    finally:
        apart.close()
    return found


def _moments(rng, args, sailed) -> Iterator[tuple[int, float]]:
    """Rows and seconds after which to kill, by turns under way and while the file is written."""
    for k in range(args.kills):
        row, longest = (len(sailed), 1.0) if k % 2 else (int(rng.integers(1, len(sailed))), 0.02)
        yield row, rng.uniform(0.0, longest)


def _episode():
    """An episode of 600 s in waves."""
    from ship_gym_agents.entrants import controllers_of

    from ship_gym.evaluation.rollout import EVALUATION_SEED, rollout

    controller = controllers_of(["pid"])[0]
    return rollout(controller, "heading_keeping", seeds=[EVALUATION_SEED]).trajectory(0)


def _files(sailed, folder: Path) -> tuple[Path, Path]:
    """The recording, and the journal of one that broke off."""
    from ship_gym.recording import Recorder

    sailed.to_rrd(folder / "run.rrd")
    recorder = Recorder(folder / "broken.rrd", sailed.meta, sailed.names)
    recorder.add(np.stack([sailed[name] for name in sailed.names], axis=1))
    recorder.keep()
    return folder / "run.rrd", recorder.journal


def _full(apart, sailed, folder: Path) -> Iterator[str]:
    from _recording_checks import SMALL, disk, full

    for how in ("recorder", "to_rrd"):
        place = Path(_new(folder))
        with disk(place, f"size={SMALL}") as small:
            yield apart.call(full, str(place), sailed, how, None if small else SMALL)


def _read_only(sailed, folder: Path) -> str:
    from _recording_checks import disk, refused

    place = Path(_new(folder))
    with disk(place, "ro") as mounted:
        if mounted:
            return refused(str(place), sailed)
    place.chmod(0o555)
    if os.access(place, os.W_OK):
        return "not tried: the user may write anywhere"
    return refused(str(place), sailed)


def _new(folder: Path) -> str:
    return tempfile.mkdtemp(dir=folder)


if __name__ == "__main__":
    run(main)
