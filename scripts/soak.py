"""Sail millions of ship-steps of everything at once and look at every one of them."""

from __future__ import annotations

import json
import os
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from _cli import parser, progress, run, show

HELP = """\
Sail all ships in all scenarios, in their own sea and in sea states 2 to 8 with wind, gusts and
2 m/s of current, under random, bang-bang, zig-zag and rolling helms with the propeller full ahead
and astern, as their files say and with the largest randomisation. Every step is looked at: states,
rewards, terms, forces and energies are finite, observations in their space, rudder and propeller
within their limits; a ship that is none any more has ended as diverged. Chunks of 100,000
ship-steps are lines of a log, which may be killed at any time: the same command goes on where it
was. Exit code 1: something that must not be.
"""
EXAMPLES = (
    "python scripts/soak.py --steps 5e6",
    "python scripts/soak.py --steps 1e8 --log /tmp/soak.jsonl --page docs/soak.md",
)
BEGIN, END = "<!-- figures: begin -->", "<!-- figures: end -->"
FORMAT = 1


def main() -> None:
    # one version of the kernels for all ships, with the same bits: compiling takes longer than this
    os.environ.setdefault("SHIP_GYM_ONE_VERSION", "1")
    from _soak import STEPS

    from ship_gym.config import ConfigError, check_number
    from ship_gym.locks import locked
    from ship_gym.writing import check_place

    made = parser(HELP, EXAMPLES)
    made.add_argument("--steps", type=float, default=5e6, help="ship-steps (default: %(default)g)")
    made.add_argument("--seed", type=int, default=0, help="of all numbers drawn (default 0)")
    made.add_argument("--log", type=Path, default=Path("soak.jsonl"), help="(default: %(default)s)")
    made.add_argument("--page", type=Path, help="put the figures into this Markdown page")
    made.add_argument("--fresh", action="store_true", help="begin a log anew")
    given = made.parse_args()
    check_number("--steps", given.steps, STEPS, 1e10)
    check_number("--seed", given.seed, 0, 2**31)
    check_place(given.log, "--log")
    if given.page is not None and not given.page.is_file():
        raise ConfigError(f"--page {given.page}: no such page")
    chunks = round(given.steps / STEPS)
    with locked(given.log.with_name(f".{given.log.name}.lock"), "soaks into this log"):
        if given.fresh:
            given.log.unlink(missing_ok=True)
        lines = resumed(given.log, {"format": FORMAT, "seed": given.seed})
        done = {line["number"] for line in lines}
        todo = [k for k in range(chunks) if k not in done]
        lines += append(given.log, progress(todo, "chunks"), given.seed)
    lines = [line for line in lines if line["number"] < chunks]
    data = summary(lines)
    text = as_text(data)
    if given.page is not None:
        write_page(given.page, text)
    files = [str(path) for path in (given.log, given.page) if path is not None]
    show(given.json, data | {"files": files}, f"{text}\nwrote {', '.join(files)}")
    if data["bad"] or data["exceptions"]:
        sys.exit(1)


def append(log: Path, numbers: Iterable[int], seed: int) -> Iterator[dict[str, Any]]:
    """Sail chunks, each a line of the log as soon as it is over."""
    with log.open("a", encoding="utf-8") as file:
        for number in numbers:
            line = sailed(number, seed)
            file.write(json.dumps(line) + "\n")
            file.flush()
            os.fsync(file.fileno())
            yield line


def sailed(number: int, seed: int) -> dict[str, Any]:
    """A chunk; an exception is a finding, too."""
    from _soak import chunk_of, sail

    chunk, started = chunk_of(number), time.monotonic()
    try:
        line = sail(chunk, seed)
    except Exception as error:  # whatever it is
        line = chunk._asdict() | {"exception": f"{type(error).__name__}: {error}"}
    return line | {"seconds": round(time.monotonic() - started, 3)}


def resumed(log: Path, settings: dict[str, Any]) -> list[dict[str, Any]]:
    """Chunks of a log; a torn last line is cut off. A new log gets its first line.

    Raises
    ------
    ConfigError
        It is the log of another seed, or no log.
    """
    from ship_gym.config import ConfigError
    from ship_gym.provenance import provenance

    if not log.is_file() or log.stat().st_size == 0:
        log.write_text(json.dumps(settings | provenance()) + "\n", encoding="utf-8")
        return []
    data = log.read_bytes()
    whole = data[: data.rfind(b"\n") + 1]
    try:
        head, *lines = [json.loads(line) for line in whole.splitlines()]
        other = {name: head[name] for name in settings}
        numbers = [line["number"] for line in lines]
    except (ValueError, KeyError, TypeError):
        raise ConfigError(f"{log}: no log of a soak; give another --log") from None
    if other != settings:
        raise ConfigError(
            f"{log}: it has {other}, asked is {settings}; give --fresh or another --log"
        )
    if len(whole) < len(data):
        os.truncate(log, len(whole))
    return [line for k, line in enumerate(lines) if line["number"] not in numbers[:k]]


def summary(lines: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Figures of all chunks and of each ship."""
    ran = [line for line in lines if "steps" in line]
    bad: Counter = Counter()
    for line in ran:
        bad.update(line["bad"])
    ships = {}
    for name in sorted({line["ship"] for line in ran}):
        own = [line for line in ran if line["ship"] == name]
        ships[name] = _sums(own) | {
            "fastest": max(line["fastest"] for line in own),
            "turn": max(line["turn"] for line in own),
        }
    return {
        **_sums(ran),
        "chunks": len(ran),
        "scenarios": len({line["scenario"] for line in ran}),
        "hours": round(sum(line["seconds"] for line in lines) / 3600.0, 3),
        "ships": ships,
        "bad": dict(bad),
        "exceptions": [_told(line, "exception") for line in lines if "exception" in line],
        "refused": sorted({line["refused"] for line in lines if "refused" in line}),
    }


def _sums(lines: Sequence[dict[str, Any]]) -> dict[str, int]:
    return {k: sum(line[k] for line in lines) for k in ("steps", "ended", "diverged", "above")}


def _told(line: dict[str, Any], key: str) -> str:
    what = ", ".join(str(line[k]) for k in ("number", "ship", "scenario", "sea", "helm", "draw"))
    return f"chunk {what}: {line[key]}"


def as_text(data: dict[str, Any]) -> str:
    from ship_gym.text import table

    rows = [
        [name, *(f"{one[k]:,}" for k in ("steps", "ended", "diverged", "above")),
         f"{one['fastest']:.2f}", f"{one['turn']:.2f}"]
        for name, one in data["ships"].items()
    ]  # fmt: skip
    size = f"{data['steps']:,} ship-steps in {data['chunks']:,} chunks"
    heads = ["ship", "ship-steps", "episodes ended", "diverged", "above 2 U0", "fastest", "r L/U0"]
    text = [
        f"{size}, {data['scenarios']} scenarios, {data['hours']:.2f} h;",
        f"{data['ended']:,} episodes ended, {data['diverged']:,} of them as diverged.",
        "",
        table(heads, rows, 1),
        "",
        "What must not be: "
        + (", ".join(f"{k} {n:,} times" for k, n in data["bad"].items()) or "nothing.")
        + f" Exceptions: {len(data['exceptions'])}.",
    ]
    text += [f"  {line}" for line in data["exceptions"]]
    text += [f"Refused when made: {line}" for line in data["refused"]]
    return "\n".join(text)


def write_page(page: Path, text: str) -> None:
    """Put the figures between the marks of a page."""
    from ship_gym.config import ConfigError
    from ship_gym.writing import atomic_path

    old = page.read_text(encoding="utf-8")
    if not (BEGIN in old and END in old.split(BEGIN, 1)[1]):
        raise ConfigError(f"{page}: needs the lines {BEGIN} and {END}")
    before, rest = old.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    with atomic_path(page) as temporary:
        new = f"{before}{BEGIN}\n\n```text\n{text}\n```\n\n{END}{after}"
        temporary.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    run(main)
