"""Command lines: every verb with words left out, doubled, misspelt, with odd values and files.

A file of words, one a line, is the input. It runs in this process, as the console command does; as
soon as real work begins, a process or a second has gone, the case ends.
"""

from __future__ import annotations

import contextlib
import io
import multiprocessing.process
import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

_SECONDS = 1.0  # after which a command is taken to be at work
_LINES = """
list
list ships --json
list surrogates --ship kvlcc2_model
completion bash
--version
train --help
train --algo sac --ship kvlcc2 --minutes 0 --set training.gamma=2 --out runs/a
train --recipe nothing --seeds 5 --jobs 2
train --resume --out runs/nothing --minutes 20
evaluate --policy policy.safetensors --ship nothing --episodes 2
evaluate --controller pid nobody --record runs/recordings --which worst best
evaluate --controller gains.toml --ship kvlcc2 --episodes 0 --markdown
benchmark --suite nothing --ships kcs --controllers pid --seeds 2 --out bench
benchmark --suite scenario.toml --jobs 1 --out bench --fresh
report nothing --out page.html
report runs/benchmark/episodes.parquet --out report.html --episodes 60
bound --scenario nothing --ship kvlcc2 --seeds 1
bound --scenario scenario.toml --seeds 1 --lambdas 0.1 -1
record --policy policy.safetensors --ship nothing --out runs/b
record --controller pid --worst 5 --by nothing --of 8 --out runs/worst
record --controller pid --seeds 2000000..1 --out runs/c
review list nothing --worst 5
review list . --json
review metrics run.rrd
review metrics run.rrd nothing.rrd --json
review export run.rrd --out a.csv
review export run.rrd --to nothing
review compare run.rrd run.rrd --out a.rrd
review picture run.rrd --at nothing
review show nothing.rrd
export nothing --out policy.onnx
export policy.safetensors --to safetensors
export policy.safetensors --trust-sb3-zip --to safetensors --out a.safetensors
simulate zigzag --ship nothing --delta -20
simulate turning --ship mine.toml --n 1e9 --sea current --csv turn.csv
simulate captive --ship mine.toml --measured run.rrd
simulate stopping --ship mine.toml --psi 20
simulate turning --ship kcs --sea ss5 --wave-from 450 --delta 200
simulate turning --ship dtc_model --speed -1.48 --wave-height 0.112 --wavelength 0
trials --ship nothing --json
trials --before run.rrd --out trials.md
linearise --ship mine.toml --speed 5.0 --json
linearise --ship kcs --speed -1
tune --ship nothing --episodes 64 --out pid.toml
tune --controllers nobody --ship kcs --episodes 0 --out a.toml
tune-agent --algo nothing --minutes 2 --trials 30 --jobs 2
tune-agent --recipe track_guidance --ranges mine.toml --seeds 2 --out runs/track
fit-surrogate --samples my.csv --ship mine.toml
fit-surrogate --family nothing --out a.npz
fit-surrogate --data onrt --grid G9 --plot onrt.png
draw difference --against nothing
draw path --manoeuvre zigzag --delta 200
draw nothing --ship dtc_model --wave-height 0.112
build-wave-table --ship mine.toml --mesh run.rrd --scale 0.001
build-wave-table --from nothing.npz
speed --ship mine.toml --scenario nothing --quick
speed --against nothing --only calm waves
warm-up --ship nothing --task heading_keeping
warm-up --ship mine.toml --jobs 0 --json
route route.rtz
route route.rtz --out again.gpx --geometry nothing
route nothing.gpx --origin 91 0 --json
serve --port 0 --route route.rtz --at 91 8 --speed-up 10
serve --port 99999 --listen nothing --ship kvlcc2 --duration 60
serve --port 0 --rate HDT=5 XXX=1 --talker all=II --lockstep --patience 0.1
fmu --ship mine.toml --sea nothing --out a.fmu
fmu --wave-height -1 --wave-period 0 --at 57.7 181 --fmi 4
dataset --controllers pid nobody --noise -1 --episodes 0 --out sets
dataset --policy policy.safetensors --name nothing --out sets --episodes 2
simulate turning --sea nothing --wave-height 2 --regular
build-wave-table --ship mine.toml --mesh hull.mar --fix-normals --weld nothing
"""
_WORDS = """
- -- --- -1 0 1e9 1e400 nan inf -inf 1e-300 1,5 0x10 kcs kcs,kcs KCS kc all none . .. / /dev/null
/dev/zero /nowhere/x x= = sea.states=[ a.b=1 sensors.noise=7 sea.wave_height=-1 sea.wave_height=nan
training.gamma=9 steps=10 mine.toml scenario.toml gains.toml policy.safetensors run.rrd none.py
none.py:Name pid@nothing pid@ @kcs none.csv none.npz none.html 1:2:3 0..5 5..0 0.. --help --json
--out --ship --seed --scenario --set --task --control --jobs --episodes --nothing -h -x turning
zigzag --version route.rtz none.gpx 91 181
""".split()
_WORDS += ["", " ", "a" * 300, "a/" * 2000, "9" * 400, "\u00e9\u4e2d", "\udcff", "a\tb"]


_NEVER = ("--install",)  # writes into the package


class Enough(BaseException):
    """Real work has begun: nothing was refused, and the rest is for other tests."""


def seeds() -> Iterator[Any]:
    """Each line as a file of words, with the files that it may name beside it."""
    from _fuzz_field import routes
    from _fuzz_made import recordings
    from _fuzz_seeds import Seed, policies, scenarios, ships, toml_files
    from ship_gym_agents.gains_files import GAINS

    beside = {
        "route.rtz": next(routes()),
        "mine.toml": {seed.name: seed for seed in ships()}["kvlcc2_model"],
        "scenario.toml": next(scenarios()),
        "gains.toml": next(toml_files(GAINS)),
        "policy.safetensors": next(policies()),
        "run.rrd": next(recordings()),
    }
    beside = {name: next(iter(seed.files.values())) for name, seed in beside.items()}
    for line in _LINES.strip().split("\n"):
        yield Seed(line, {"line.words": "\n".join(line.split()).encode(), **beside})


def words_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A line with a value replaced, an option of the verb added, or words left out or mangled.

    The verb mostly stays: what it does not know is soon said.
    """
    words = data.decode("utf-8", "surrogateescape").split("\n")
    odd, how = _WORDS[int(rng.integers(len(_WORDS)))], rng.random()
    values = [k for k, word in enumerate(words) if k and not word.startswith("-")]
    k = int(rng.integers(0 if rng.random() < 0.1 else 1, max(len(words), 2)))
    if how < 0.4 and values:
        words[values[int(rng.integers(len(values)))]] = odd
    elif how < 0.7:
        options = _options(words)
        words += [options[int(rng.integers(len(options)))], odd][: int(rng.integers(1, 3))]
    elif how < 0.8 and k < len(words):
        del words[k]
    elif how < 0.85 and k < len(words):
        words.insert(k, words[k])
    elif how < 0.9 and k < len(words) and words[k]:
        j = int(rng.integers(len(words[k])))
        words[k] = words[k][:j] + words[k][j + 1 :]
    else:
        words.insert(k, odd)
    return "\n".join(words).encode("utf-8", "surrogateescape")


def _options(words: list[str]) -> list[str]:
    """Options of the verb of a line; of none those that all have."""
    from ship_gym_agents.cli import VERBS, load_verb, review

    try:
        if words[:1] == ["review"] and words[1:2] and words[1] in review.VERBS:
            command = review.load_verb(words[1])
        else:
            command = load_verb(words[0]) if words and words[0] in VERBS else None
    except ImportError:
        command = None
    found = [o for p in getattr(command, "params", ()) for o in (*p.opts, *p.secondary_opts)]
    return [o for o in found if o.startswith("-") and o not in _NEVER] or ["--help", "--json"]


def use(path: Path, **_: Any) -> None:
    """Run the line; raises what it would print as one line, or what it lets through."""
    from ship_gym_agents.cli import main

    from ship_gym.config import ConfigError

    words = path.read_bytes().decode("utf-8", "surrogateescape").split("\n")
    said = io.StringIO()
    try:
        with (
            _no_work(),
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(said),
        ):
            main([word.replace("\0", "") for word in words])
    except SystemExit as end:
        if end.code:
            raise ConfigError(said.getvalue().strip() or f"exit code {end.code}") from None


@contextlib.contextmanager
def _no_work() -> Iterator[None]:
    """End the case when the line starts another process or has worked for a second."""

    def stop(*_: Any, **__: Any) -> None:
        raise Enough

    places = [
        (multiprocessing.process.BaseProcess, "start"),
        (subprocess, "Popen"),
        (os, "execvp"),
        (os, "execv"),
    ]
    kept = [(where, name, getattr(where, name)) for where, name in places]
    before = signal.signal(signal.SIGALRM, stop)
    for where, name in places:
        setattr(where, name, stop)
    signal.setitimer(signal.ITIMER_REAL, _SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        for where, name, value in kept:
            setattr(where, name, value)
