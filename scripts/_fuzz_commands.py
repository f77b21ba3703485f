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
_LINES = (
    "list", "list ships", "list --kind scenarios --json", "completion bash", "--version", "train --help",
    "evaluate pid --scenario heading_calm --episodes 1 --ship nothing",
    "evaluate pid --scenario nothing.toml --seed 3",
    "evaluate nobody --episodes 2 --json --out table.csv",
    "train --recipe nothing --out run --seed 1", "train --resume nothing --steps 100",
    "train --algo ppo --scenario none.toml --steps 1e3 --envs 4 --out run",
    "benchmark --suite nothing --controllers pid --out bench --jobs 1",
    "benchmark --suites core --controllers nobody --ships kcs --episodes 1 --out bench",
    "report nothing --out page.html", "bound --scenario nothing --ship kcs --episodes 1",
    "record nobody --scenario heading_calm --out run.rrd", "record pid --out run.txt --seed 0",
    "review list nothing", "review metrics nothing.rrd", "review export nothing.rrd --out a.csv",
    "review compare nothing.rrd other.rrd --out a.rrd", "review picture nothing.rrd --out a.png",
    "export nothing.safetensors --out a.onnx", "export nothing.zip --to safetensors",
    "simulate turning --ship nothing --delta 35", "simulate zigzag --ship none.toml --psi 10",
    "simulate turning --ship kcs --speed -1 --csv a.csv", "simulate captive --measured none.csv",
    "simulate nothing --sea ss5 --wave-from 45", "simulate turning --sea nothing --n 1e9",
    "trials --ships nothing --csv a.csv", "linearise --ship nothing --speed 3",
    "tune --controllers nobody --ship kcs --out mine.toml", "tune --ship nothing --evaluations 0",
    "tune-agent --algo nothing --trials 1 --out run", "fit-surrogate --data nothing --ship kcs",
    "fit-surrogate --data none.csv --out a.npz --ship kcs_model", "draw nothing --out a.png",
    "build-wave-table --ship nothing --out a.npz", "build-wave-table --ship kcs --hull none.obj",
    "speed --check none.json", "warm-up --ships nothing",
)  # fmt: skip
_WORDS = (
    "", " ", "-", "--", "---", "-1", "0", "1e9", "1e400", "9" * 400, "nan", "inf", "-inf", "1e-300", "1,5",
    "kcs", "kcs,kcs", "KCS", "kc", "all", "none", ".", "..", "/", "/dev/null", "/dev/zero", "/nowhere/x",
    "a" * 300, "a/" * 2000, "\u00e9\u4e2d", "a\nb", "\udcff", "x=", "=", "sea.states=[", "a.b=1",
    "sensors.noise=7", "sea.wave_height=-1", "sea.wave_height=nan", "steps=10", "ship.toml", "none.py",
    "none.py:Name", "pid@nothing", "pid@", "@kcs", "none.csv", "none.npz", "none.html", "1:2:3", "0-5",
    "5-0", "0:", "--help", "--json", "--out", "--ship", "--seed", "--scenario", "--set", "--task",
    "--control", "--jobs", "--episodes", "--nothing", "-h", "-x", "turning", "zigzag", "--version",
)  # fmt: skip


class Enough(BaseException):
    """Real work has begun: nothing was refused, and the rest is for other tests."""


def seeds() -> Iterator[Any]:
    """Each line as a file of words."""
    from _fuzz_seeds import Seed
    from ship_gym_agents.cli import VERBS

    for line in (*_LINES, *(f"{verb} --nothing" for verb in VERBS)):
        yield Seed(line, {"line.words": "\n".join(line.split()).encode()})


def words_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """Words with one left out, doubled, moved, misspelt, replaced or added."""
    words = data.decode("utf-8", "surrogateescape").split("\n")
    k, how = int(rng.integers(len(words))), int(rng.integers(8))
    odd = _WORDS[int(rng.integers(len(_WORDS)))].replace("\n", " ")
    if how == 0:
        del words[k]
    elif how == 1:
        words.insert(k, words[k])
    elif how == 2:
        words.insert(k, words.pop(int(rng.integers(len(words)))))
    elif how == 3 and words[k]:
        j = int(rng.integers(len(words[k])))
        words[k] = words[k][:j] + words[k][j + 1 :]
    elif how in (4, 5):
        words.insert(int(rng.integers(len(words) + 1)), odd)
    else:
        words[k] = odd
    return "\n".join(words).encode("utf-8", "surrogateescape")


def use(path: Path, **_: Any) -> None:
    """Run the line; raises what it would print as one line, or what it lets through."""
    from ship_gym.config import ConfigError
    from ship_gym_agents.cli import main

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
