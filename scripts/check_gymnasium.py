"""Gymnasium's own tests of vector environments, run with our ids in place of theirs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from _cli import parser, progress, run, show

ROOT = Path(__file__).resolve().parents[1]
KNOWN = Path(__file__).with_name("gymnasium_tests.toml")
HELP = """\
FOLDER is a checkout of Gymnasium, or its folder tests; nothing in it is changed. Each test file
that names an environment is run as it is, with our ids and classes in place of Gymnasium's, and
tests of vectors and their wrappers once more with the native vector environment in place of
SyncVectorEnv and AsyncVectorEnv. A failure counts as explained where the test fails with
Gymnasium's environments too (of another version, or a library is missing here), or where
scripts/gymnasium_tests.toml says what it takes for granted. Exit code 1: a failure that neither
explains. The whole takes some 20 minutes, 15 of them for test_record_video, which draws pictures.
"""
EXAMPLES = (
    "python scripts/check_gymnasium.py ~/Gymnasium",
    "python scripts/check_gymnasium.py ~/Gymnasium --only test_make_vec --json",
    "python scripts/check_gymnasium.py ~/Gymnasium --skip record_video",
)
PLACES = ("vector", "wrappers/vector", "envs/vector", "envs/registration", "envs")
IDS = {
    "CartPole-v1": "ShipGym/HeadingKeeping-v0",
    "FrozenLake-v1": "ShipGym/TrackFollowing-v0",
    "BipedalWalker-v3": "ShipGym/TrackFollowing-v0",
    "CarRacing-v3": "ShipGym/CourseChanging-v0",
    "MountainCarContinuous-v0": "ShipGym/CourseChanging-v0",
    "Ant-v4": "ShipGym/CourseChanging-v0",
}
CLASSES = (
    "from ship_gym import HeadingKeeping as CartPoleEnv\n"
    "from ship_gym import ShipVectorEnv as CartPoleVectorEnv\n"
)
OURS = {
    r"from gymnasium\.envs\.classic_control(\.cartpole)? import": "from tests.ships import",
    r'"gymnasium\.envs\."': '"ship_gym.envs."',  # which specs the tests of all specs take
    **{re.escape(f'"{theirs}"'): f'"{ours}"' for theirs, ours in IDS.items()},
}
NATIVE = """
import gymnasium as gym
import ship_gym

before, plain = gym.make_vec, (gym.vector.SyncVectorEnv, gym.vector.AsyncVectorEnv)


def make_vec(id, num_envs=1, vectorization_mode=None, vector_kwargs=None, wrappers=None, **more):
    given = {"vectorization_mode": vectorization_mode, "vector_kwargs": vector_kwargs}
    if str(id).startswith("ShipGym/"):  # infos: plain dicts, whose class Gymnasium compares
        more = {"info": "flat", **more}
        if vectorization_mode is not None and not wrappers:
            given, more = {}, {**(vector_kwargs or {}), **more}
    gym.vector.SyncVectorEnv, gym.vector.AsyncVectorEnv = plain
    try:
        return before(id, num_envs, wrappers=wrappers, **given, **more)
    finally:
        gym.vector.SyncVectorEnv = gym.vector.AsyncVectorEnv = native


def native(env_fns, autoreset_mode="NextStep", copy=True, **_):
    made = env_fns[0]()
    return ship_gym.ShipVectorEnv(
        len(env_fns),
        scenario=made.unwrapped.scenario,
        render_mode=made.render_mode,
        autoreset_mode=autoreset_mode,
        copy=copy,
        info="flat",
    )


gym.make_vec = make_vec
gym.vector.SyncVectorEnv = gym.vector.AsyncVectorEnv = native
"""
BY_NATIVE = ("vector/", "wrappers/vector/")
# Of an environment itself: what it is called, not how it is built.
LEFT_OUT = ("test_env_spec.py", "test_register.py", "test_pprint_registry.py", "test_spec.py")
ASSUMED, TOO, BAD = "takes another environment for granted", "fails with theirs too", "unexplained"
_LIMIT = 1800.0  # s for one file


def main() -> None:
    from ship_gym.text import table

    made = parser(HELP, EXAMPLES)
    made.add_argument("folder", type=Path, metavar="FOLDER", help="checkout of Gymnasium")
    made.add_argument("--only", metavar="WORD", help="only files whose name has this in it")
    made.add_argument("--skip", metavar="WORD", help="no files whose name has this in it")
    args = made.parse_args()
    tests = tests_of(args.folder)
    files = [name for name in files_of(tests) if (args.only or "") in name]
    files = [name for name in files if not (args.skip and args.skip in name)]
    if not files:
        from ship_gym.config import ConfigError

        raise ConfigError("--only and --skip leave no file of tests that names an environment")
    found = checked(tests, files)
    counts = Counter(one["class"] for one in found)
    names = ("class", "by", "test", "reason")
    rows = [[one[name] for name in names] for one in found if one["reason"]]
    text = table(["", "by", "test", "why"], rows, 2) if rows else "every test passes"
    total = ", ".join(f"{count} {what}" for what, count in counts.most_common())
    show(args.json, {"counts": dict(counts), "tests": found}, f"{text}\n{total}")
    if counts[BAD]:
        sys.exit(1)


def tests_of(folder: Path) -> Path:
    """Gymnasium's folder ``tests`` in or at a place."""
    from ship_gym.config import ConfigError

    for place in (folder / "tests", folder):
        if (place / "vector").is_dir() and (place / "wrappers").is_dir():
            return place
    raise ConfigError(
        f"{folder}: no checkout of Gymnasium; allowed is a folder with tests/vector and "
        "tests/wrappers in it (git clone https://github.com/Farama-Foundation/Gymnasium)"
    )


def files_of(tests: Path) -> list[str]:
    """Test files that name an environment, relative to the folder."""
    found = []
    for place in PLACES:
        for path in sorted((tests / place).glob("test_*.py")):
            text = path.read_text(encoding="utf-8")
            named = in_ours(text) != text or "all_testing_" in text
            if named and path.name not in LEFT_OUT:
                found.append(str(path.relative_to(tests)))
    return found


def in_ours(text: str) -> str:
    """Text of a test with our ids and classes in place of Gymnasium's."""
    for theirs, ours in OURS.items():
        text = re.sub(theirs, ours, text)
    return text


def checked(tests: Path, files: list[str]) -> list[dict[str, str]]:
    """Every test of some files: its name, class and, of one that fails, why."""
    known = tomllib.loads(KNOWN.read_text(encoding="utf-8"))["known"]
    found = []
    with tempfile.TemporaryDirectory() as folder:
        theirs, ours, native = (Path(folder, name) for name in ("theirs", "ours", "native"))
        for place, first in ((theirs, ""), (ours, "import ship_gym\n"), (native, NATIVE)):
            _copy(tests, place, first)
        for file in progress(files, "test files"):
            before = {_renamed(name) for name, says in results(theirs, file) if says}
            for place in (ours, native) if file.startswith(BY_NATIVE) else (ours,):
                for name, says in results(place, file):
                    by = {"test": f"{file}::{name}", "by": place.name}
                    found.append(by | classified(name, says, before, known))
    return found


def _copy(tests: Path, place: Path, first: str) -> None:
    """The tests at a place, with `first` run before them, and ours in it if there is such."""
    shutil.copytree(tests, place / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    if first:
        for path in (place / "tests").rglob("*.py"):
            path.write_text(in_ours(path.read_text(encoding="utf-8")), encoding="utf-8")
        (place / "tests" / "ships.py").write_text(CLASSES, encoding="utf-8")
        (place / "conftest.py").write_text(first, encoding="utf-8")


def _renamed(name: str) -> str:
    """Name of a test of Gymnasium's as it is with our ids, which stand in parameters."""
    for theirs, ours in IDS.items():
        name = name.replace(theirs, ours)
    return name


def results(place: Path, file: str) -> Iterator[tuple[str, str]]:
    """Each test of a file that was run (not skipped), with what it says if it failed."""
    out = place / "results.xml"
    out.unlink(missing_ok=True)
    paths = [str(place), str(ROOT), str(ROOT / "agents"), os.environ.get("PYTHONPATH", "")]
    quiet = {"SDL_VIDEODRIVER": "dummy", "PYGAME_HIDE_SUPPORT_PROMPT": "1"}
    command = [sys.executable, "-m", "pytest", f"tests/{file}", f"--junitxml={out}", "-q"]
    command += ["-p", "no:cacheprovider", "-p", "no:xdist", f"--rootdir={place}"]
    env = {**os.environ, **quiet, "PYTHONPATH": os.pathsep.join(paths).rstrip(os.pathsep)}
    told = ""
    try:
        ended = subprocess.run(
            command, cwd=place, env=env, capture_output=True, text=True, timeout=_LIMIT, check=False
        )
        told = ended.stdout
    except subprocess.TimeoutExpired:
        told = f"not done within {_LIMIT:g} s"
    cases = ElementTree.parse(out).getroot().iter("testcase") if out.exists() else []
    seen = False
    for case in cases:
        seen = True
        if case.find("skipped") is None:
            bad = [*case.iter("failure"), *case.iter("error")]
            yield case.get("name", ""), _said(bad[0]) if bad else ""
    if not seen:
        yield "(the file)", f"pytest ran no test: {told[-200:]}"


def _said(failure: ElementTree.Element) -> str:
    """What a failed test says: the message, which pytest may cut, and the lines it is from."""
    lines = [line for line in (failure.text or "").splitlines() if line.startswith("E ")]
    return "\n".join([failure.get("message") or "failed", *lines])


def classified(
    name: str, says: str, before: set[str], known: list[dict[str, Any]]
) -> dict[str, str]:
    """Class of a test and, of one that failed, the reason."""
    if not says:
        return {"class": "passed", "reason": ""}
    for one in known:
        if re.search(one["test"], name) and re.search(one["says"], says, re.DOTALL):
            return {"class": ASSUMED, "reason": one["reason"]}
    if name in before:
        return {"class": TOO, "reason": _line(says)}
    return {"class": BAD, "reason": _line(says)}


def _line(text: str) -> str:
    return " ".join(text.split())[:160]


if __name__ == "__main__":
    run(main)
