"""The speed of two checkouts beside each other: child processes that take turns."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import ship_gym
from ship_gym.config import ConfigError, check_known
from ship_gym.reports.speed import import_time
from ship_gym.reports.speed_child import MEASURES, SHIP_ENV
from ship_gym.text import table

HERE = Path(ship_gym.__file__).resolve().parents[1]
_CHILD = Path(__file__).with_name("speed_child.py")
# Ships of a measure that does not go with the n asked for: of these the set-up takes long.
_FEW = {"heading, ends spread": 1024, "reset": 256}
# what is not ours
_SAME = ("CartPole scalar", "CartPole scalar, gym.make", "CartPole vector", "NumPy reference")
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_FIRST_STEP = (
    f"import gymnasium as gym, ship_gym; env = gym.make({SHIP_ENV!r}); env.reset(seed=0); "
    "env.step(env.action_space.sample())"
)


class Child:
    """A process that measures the package of one checkout; see `speed_child`.

    Parameters
    ----------
    checkout : path
        Folder that holds ``ship_gym``.
    """

    def __init__(self, checkout: Path):
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(_CHILD)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=_environment(checkout),
        )
        found = Path(self.ask(name="where")["file"]).resolve().parents[1]
        if found != checkout.resolve():
            raise ConfigError(f"--against {checkout}: Python imports ship_gym of {found} instead")

    def ask(self, **asked: Any) -> dict[str, Any]:
        """Have it measure: a name of ``speed_child.MEASURES`` or ``memory``, and its arguments."""
        assert self._process.stdout is not None  # of a pipe
        print(json.dumps(asked), file=self._process.stdin, flush=True)
        answer = self._process.stdout.readline()
        if not answer:
            raise ConfigError(f"speed of {asked['name']!r}: the process that measures it has ended")
        found = json.loads(answer)
        if "error" in found:
            raise ConfigError(f"speed of {asked['name']!r}: {found['error']}")
        return found

    def close(self) -> None:
        """End it."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


def _environment(checkout: Path, **more: str) -> dict[str, str]:
    path = os.pathsep.join([str(checkout), str(checkout / "agents")])
    return {**os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": path, **more}


def check_checkout(path: str | os.PathLike) -> Path:
    """The folder of another checkout.

    Raises
    ------
    ConfigError
        There is no ship_gym in it.
    """
    if not (Path(path) / "ship_gym" / "__init__.py").is_file():
        raise ConfigError(f"--against {path}: must be a folder that holds ship_gym/__init__.py")
    return Path(path).resolve()


def against(
    other: Path,
    only: Iterable[str] = (),
    *,
    n: int = 4096,
    ship: str = "kcs",
    rounds: int = 5,
    seconds: float = 0.2,
    start: bool = True,
    progress: Callable[[Iterable, str], Iterable] = lambda rounds, _: rounds,
) -> dict[str, Any]:
    """Measure both checkouts in turns, round by round.

    Parameters
    ----------
    other : path
        Folder that holds the other ``ship_gym``.
    only : iterable of str
        Of ``speed_child.MEASURES``, ``memory`` and ``start``; all if empty.
    n : int
        Ships or environments.
    ship : str
    rounds : int
        Turns of each; the best counts.
    seconds : float
        Of one repeat of one measure [s].
    start : bool
        Also compile everything from nothing, and import and step from what is compiled.
    progress : callable
        Wraps an iterable with a text.

    Returns
    -------
    dict
        ``n``, ``ship``, ``here``, ``there`` (folders), and ``measures``: name to ``here`` and
        ``there`` [s, of memory bytes], ``ratio`` there / here and ``n``.
    """
    known = [*MEASURES, "memory", *(["start"] if start else [])]
    chosen = [check_known("--only", name, known) for name in only] or known
    sides = {"here": HERE, "there": other}
    best: dict[str, dict[str, float]] = {}
    # threads that wait for work spin, which would count as processor time of the next measure
    children = {(side, t): Child(path) for side, path in sides.items() for t in (False, True)}
    try:
        for k in progress(range(rounds), "in turns"):
            for name in (name for name in chosen if name in MEASURES):
                threads = MEASURES[name][0]
                for side in list(sides)[:: 1 if k % 2 else -1]:
                    child, many = children[side, threads], _FEW.get(name, n)
                    found = child.ask(name=name, n=many, ship=ship, repeats=2, seconds=seconds)
                    _keep(best, name, side, found["seconds"])
                    if f"{name}, threads" in MEASURES:
                        _keep(best, f"{name}, one thread, wall", side, found["wall"])
        for side in sides if "memory" in chosen else ():
            for kind, size in children[side, False].ask(name="memory", n=n, ship=ship).items():
                if size is not None:
                    _keep(best, f"memory, {kind}", side, size)
    finally:
        for child in children.values():
            child.close()
    if "start" in chosen:
        _starts(sides, best)
    measures = {
        name: {**found, "ratio": found["there"] / found["here"], "n": _FEW.get(name, n)}
        for name, found in best.items()
    }
    return {"n": n, "ship": ship, **{k: str(v) for k, v in sides.items()}, "measures": measures}


def _keep(best: dict, name: str, side: str, value: float) -> None:
    found = best.setdefault(name, {})
    found[side] = min(value, found.get(side, value))


def _starts(sides: dict[str, Path], best: dict) -> None:
    with tempfile.TemporaryDirectory(prefix="ship_gym-") as folder:
        for name, turns in (("first use", 1), ("later first step", 3)):
            for _ in range(turns):
                for side, path in sides.items():
                    used = start_time(path, f"{folder}/{side}")
                    _keep(best, f"start, {name}", side, used)


def start_time(checkout: Path, cache: str | None = None) -> float:
    """Processor time [s] of a fresh process up to its first step; compiled code is in `cache`."""
    before = os.times()
    subprocess.run(
        [sys.executable, "-c", _FIRST_STEP],
        env=_environment(checkout, **({"NUMBA_CACHE_DIR": cache} if cache else {})),
        check=True,
        capture_output=True,
    )
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def memory(n: int, **env: Any) -> dict[str, float | None]:
    """Bytes of one environment more in a fresh process, see ``speed_child.memory``."""
    child = Child(HERE)
    try:
        return child.ask(name="memory", n=n, **env)
    finally:
        child.close()


def start_times(cold: bool) -> dict[str, float]:
    """Wall time [s] of the import; processor time [s] up to the first step in a fresh process.

    Parameters
    ----------
    cold : bool
        Also the first time after installation, which compiles everything.
    """
    found = {"import, wall": import_time()}
    with tempfile.TemporaryDirectory(prefix="ship_gym-") as folder:
        if cold:
            found["first step after installation, processor"] = start_time(HERE, folder)
        cache = {"cache": folder} if cold else {}
        found["first step later, processor"] = min(start_time(HERE, **cache) for _ in range(3))
    return found


def as_text(data: dict[str, Any]) -> str:
    """Both checkouts and their ratio as an aligned table, from `against`."""
    cells = []
    for name, found in data["measures"].items():
        unit, factor = "us", 1e6
        if name.startswith("memory"):
            unit, factor = "bytes", 1.0
        elif name.startswith("start"):
            unit, factor = "s", 1.0
        clock = "wall" if "threads" in name or "wall" in name else "processor"
        kind = f"{unit}, {clock}" if unit != "bytes" else "bytes"
        sizes = [f"{factor * found[side]:.4g}" for side in ("there", "here")]
        cells.append([name, kind, *sizes, f"{found['ratio']:.2f}"])
    lines = [
        f"there: {data['there']}",
        f"here:  {data['here']}",
        f"{data['ship']}, n = {data['n']}, of one step of one ship or environment; best of turns; "
        f"of {', '.join(f'{k}: n = {v}' for k, v in _FEW.items())}",
        "",
        table(["", "unit", "there", "here", "there / here"], cells),
        *control(data["measures"]),
        *gains(data["measures"]),
    ]
    return "\n".join(lines)


def control(measures: dict[str, dict]) -> list[str]:
    """How far the ratios are to be trusted: those of work that is the same in both checkouts."""
    found = [measures[name]["ratio"] for name in _SAME if name in measures]
    if not found:
        return []
    return [
        "",
        f"control: work that is the same on both sides has ratios from {min(found):.2f} to "
        f"{max(found):.2f}; the nearer to 1, the quieter the machine was",
    ]


def gains(measures: dict[str, dict]) -> list[str]:
    """How much threads gain on each side, one line for each kind of work."""
    lines = []
    for name in (n.removesuffix(", threads") for n in measures if n.endswith(", threads")):
        if f"{name}, one thread, wall" not in measures:
            continue
        one, many = measures[f"{name}, one thread, wall"], measures[f"{name}, threads"]
        there, here = (one[side] / many[side] for side in ("there", "here"))
        lines.append(f"threads gain in {name}: there {there:.2f}, here {here:.2f} times one thread")
    return ["", *lines] if lines else []
