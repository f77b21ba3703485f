"""A run of the fuzzer in a folder: what is done is kept line by line, findings by kind."""

from __future__ import annotations

import dataclasses
import json
import shutil
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from _fuzz_formats import FORMATS, Case, case, good, kind_of
from _fuzz_impossible import NAME
from _fuzz_judge import BAD, Verdict, judged
from _fuzz_minimise import smallest
from _fuzz_pool import Pool

_APART = (NAME, "command", "recording")  # not in this process: rerun is not to be forked
_LOG, _FINDINGS = "cases.jsonl", "findings"


class _Job(NamedTuple):
    """One task of a worker: a case, or the search of the smallest one of its kind."""

    seed: int
    number: int
    folder: str
    kind: str = ""


def _work(job: _Job) -> Any:
    """What a worker does."""
    folder = Path(job.folder)
    if job.kind:
        return smallest(job.seed, job.number, job.kind, folder)
    return judged(case(job.seed, job.number), folder / f"c{job.number}")


class Run:
    """A run in a folder.

    Parameters
    ----------
    out : Path
    seed, count : int
    formats : sequence of str
        Only these; all, if empty.
    resume : bool
        Go on with what the folder holds of the same seed; else begin anew.
    """

    def __init__(self, out: Path, seed: int, count: int, formats: Sequence[str], resume: bool):
        self.out, self.seed, self.count = out, seed, count
        self.found: dict[int, tuple[str, Verdict]] = {}  # number -> format, verdict
        self.inputs: dict[str, tuple[Case | None, list[str]]] = {}  # kind -> smallest, differences
        self._formats, self._begun = list(formats), time.monotonic()
        if resume:
            self._read()
        else:
            (out / _LOG).unlink(missing_ok=True)
        shutil.rmtree(out / _FINDINGS, ignore_errors=True)
        self._numbers = [k for k in self._wanted() if k not in self.found]
        self.left = len(self._numbers)

    def __enter__(self) -> Run:
        self._folder = tempfile.TemporaryDirectory(prefix="fuzz", ignore_cleanup_errors=True)
        self._log = (self.out / _LOG).open("a", encoding="utf-8", buffering=1)
        return self

    def __exit__(self, *_: Any) -> None:
        self._log.close()
        self._folder.cleanup()

    def _wanted(self) -> Iterator[int]:
        """Numbers of the impossible ships, negative, then of the cases."""
        if not self._formats or NAME in self._formats:
            yield from range(-1, -1 - len(good(NAME)), -1)
        for k in range(self.count):
            if not self._formats or kind_of(self.seed, k) in self._formats:
                yield k

    def _read(self) -> None:
        """What is done already; a line that was cut by a kill is done again."""
        from ship_gym.config import ConfigError

        if not (self.out / _LOG).is_file():
            raise ConfigError(f"{self.out}: no run to go on with; begin one without --resume")
        whole = []
        for line in (self.out / _LOG).read_text("utf-8").splitlines():
            try:
                entry = json.loads(line)
                seed, number, kind = entry.pop("seed"), entry.pop("case"), entry.pop("format")
                verdict = Verdict(**entry | {"soft": tuple(entry["soft"])})
            except (ValueError, KeyError, TypeError):
                continue
            if seed != self.seed:
                raise ConfigError(
                    f"{self.out}: holds a run of seed {seed}, not {self.seed}; give another --out"
                )
            self.found[number] = kind, verdict
            whole.append(line)
        (self.out / _LOG).write_text("".join(f"{line}\n" for line in whole), "utf-8")

    def cases(self, jobs: int) -> Iterator[None]:
        """Run what is left."""
        warm_up()
        tasks = (_Job(self.seed, k, self._folder.name) for k in self._numbers)
        with Pool(jobs, _work, Path(self._folder.name)) as pool:
            for job, verdict in pool.each(tasks):
                kind = NAME if job.number < 0 else kind_of(self.seed, job.number)
                self.found[job.number] = kind, verdict
                entry = {"seed": self.seed, "case": job.number, "format": kind}
                self._log.write(json.dumps(entry | dataclasses.asdict(verdict)) + "\n")
                yield

    def minimised(self, jobs: int) -> Iterator[None]:
        """Find the smallest input of each kind of finding and write it."""
        tasks = []
        for kind, numbers in self._kinds().items():
            number = numbers[0]
            if number < 0 or kind.startswith(("hang", "death", "memory")):
                self._keep(kind, case(self.seed, number), [])
            else:
                tasks.append(_Job(self.seed, number, self._folder.name, kind))
        with Pool(jobs, _work, Path(self._folder.name)) as pool:
            for job, answer in pool.each(tasks):
                lost = isinstance(answer, Verdict)  # the worker died of it
                made, told = (case(self.seed, job.number), []) if lost else answer
                self._keep(job.kind, made, told)
                yield

    def _kinds(self) -> dict[str, list[int]]:
        """Kinds of findings with the numbers of their cases, those of few edits first."""
        kinds = defaultdict(list)
        for number, (_, verdict) in sorted(self.found.items()):
            if verdict.bad:
                kinds[verdict.kind].append(number)
        edits = {k: len(case(self.seed, k).edits) for ks in kinds.values() for k in ks[:20]}
        return {kind: sorted(ks, key=lambda k: edits.get(k, 99)) for kind, ks in kinds.items()}

    def _keep(self, kind: str, made: Case, told: list[str]) -> None:
        """Write the files of the smallest case of a kind."""
        from _fuzz_judge import written

        self.inputs[kind] = made, told
        slug = "".join(c if c.isalnum() else "_" for c in kind)[:100]
        place = self.out / _FINDINGS / slug
        shutil.rmtree(place, ignore_errors=True)
        written(made.files, place)
        about = {"kind": kind, "format": made.kind, "from": made.seed, "case": made.number}
        text = json.dumps(about | {"seed": self.seed, "differences": told}, indent=1)
        (place / "finding.json").write_text(text + "\n", "utf-8")

    def report(self) -> dict[str, Any]:
        """Figures and findings; also written as ``report.json`` and ``report.md``."""
        verdicts = [verdict for _, verdict in self.found.values()]
        by_format: dict[str, Counter] = defaultdict(Counter)
        for kind, verdict in self.found.values():
            by_format[kind]["known" if verdict.known else verdict.outcome] += 1
        self.data = {
            "seed": self.seed,
            "cases": sum(k >= 0 for k in self.found),
            "impossible_ships": sum(k < 0 for k in self.found),
            "outcomes": dict(Counter(v.outcome for v in verdicts).most_common()),
            "formats": {name: dict(counts) for name, counts in sorted(by_format.items())},
            "findings": [self._finding(*each) for each in self._kinds().items()],
            "known": dict(Counter(f"{v.kind}: {v.known}" for v in verdicts if v.known)),
            "beside": dict(Counter(soft for v in verdicts for soft in v.soft).most_common(60)),
            "largest_memory_MB": round(max((v.memory for v in verdicts), default=0) / 2**20),
            "slowest_s": round(max((v.seconds for v in verdicts), default=0.0), 2),
            "seconds": round(time.monotonic() - self._begun, 1),
            "out": str(self.out),
        }
        (self.out / "report.json").write_text(json.dumps(self.data, indent=1) + "\n", "utf-8")
        (self.out / "report.md").write_text(self.text() + "\n", "utf-8")
        return self.data

    def _finding(self, kind: str, numbers: list[int]) -> dict[str, Any]:
        made, told = self.inputs.get(kind, (None, []))
        name, verdict = self.found[numbers[0]]
        return {
            "kind": kind,
            "owner": FORMATS[name].owner,
            "format": name,
            "from": made.seed if made else case(self.seed, numbers[0]).seed,
            "count": len(numbers),
            "cases": numbers[:5],
            "message": verdict.message,
            "differences": told,
        }

    def text(self) -> str:
        """The report for people, in Markdown."""
        from ship_gym.text import table

        d = self.data
        rows = [
            [name, *(str(counts.get(o, 0)) for o in ("refused", "used", "work")),
             str(sum(n for o, n in counts.items() if o in BAD))]
            for name, counts in d["formats"].items()
        ]  # fmt: skip
        lines = [table(["format", "refused", "used", "work", "bad"], rows, 1), ""]
        count = sum(each["count"] for each in d["findings"])
        lines += [
            f"{d['cases']} cases and {d['impossible_ships']} impossible ships in {d['seconds']} s: "
            f"{count} findings of {len(d['findings'])} kinds; largest memory "
            f"{d['largest_memory_MB']} MB, slowest case {d['slowest_s']} s"
        ]
        lines += [f"known, {n} x {kind}" for kind, n in d["known"].items()]
        for each in d["findings"]:
            lines += ["", f"- {each['count']} x {each['kind']}  [{each['owner']}]"]
            lines += [f"    {each['format']} from {each['from']}, case {each['cases'][0]}"]
            lines += [f"    {line}" for line in (each["message"], *each["differences"]) if line]
        return "\n".join([*lines, "", f"wrote {d['out']}/report.json, report.md, {_FINDINGS}/"])


def warm_up() -> None:
    """Load libraries and kernels, which every worker then has; a good input must be accepted."""
    for name in FORMATS:
        one = good(name)[0]
        if name in _APART:
            continue
        with tempfile.TemporaryDirectory() as folder:
            found = judged(Case(0, name, one.name, (), one.files, one.options), Path(folder) / "c")
        if found.outcome != "used":
            raise RuntimeError(f"good {name} {one.name} is not accepted: {found.message}")
