"""Runs the blocks of a page in the folder where it is called, as a reader would.

Blocks in Python share their names, and a block whose first line is ``# name.py`` or ``# name.toml``
is that file. Commands of ours are called in the same process; those of other programs are not run
here, and have to be in `ELSEWHERE`, which says where they are.
"""

import re
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tests.docs.blocks import ROOT, SHELL, Block, blocks_of, commands

# what takes minutes of a reader's time, not a test's; of all pages
SHORTER = {"--minutes 2": "--minutes 0.1"}
# lines of other programs, by their beginning: where they are run
ELSEWHERE = {
    "pip install": "scripts/test_wheel.sh, scripts/test_clients.sh",
    "bash scripts/quickstart.sh": ".ci/run",
    "bash scripts/test.sh": ".ci/run",
    "source .venv/bin/activate && pre-commit install": "installs a hook of git",
    "git clone": "needs a network",
    "python scripts/check_gymnasium.py": "needs a checkout of Gymnasium",
    "python scripts/fuzz.py": "scripts/test.sh, tests/scripts/test_fuzz.py",
    "python scripts/soak.py": "tests/scripts/test_soak.py",
    "python scripts/mutate.py": "tests/scripts/test_mutate.py",
    "python scripts/check_kills.py": "tests/scripts",
    "python scripts/check_speed.py": "tests/scripts",
    "python scripts/measure_accuracy.py": "tests/reports/test_accuracy.py",
    "python docs/": "writes its page anew, minutes to hours; its figures are in tests",
    "python docs/examples/nmea_pid.py": "tests/agents/serve",
    "LD_PRELOAD=": "tests/cosim",
}
# libraries that scripts/test_clients.sh brings: their blocks run there
CLIENTS = ("torchrl", "skrl", "tianshou", "tensordict")


@dataclass(frozen=True)
class Reader:
    """What a reader of a page has beforehand, and where a test is in more of a hurry.

    Attributes
    ----------
    given:
        Files by name in the reader's folder: a file to copy, a text, or what makes them there.
    before:
        Commands that were called before the page is read.
    shorter:
        Text of the page and what is run instead.
    libraries:
        What the page needs beyond the package's own; without them a test skips it.
    """

    given: Mapping[str, Path | str | Callable[[Path], object]] = field(default_factory=dict)
    before: tuple[str, ...] = ()
    shorter: Mapping[str, str] = field(default_factory=dict)
    libraries: tuple[str, ...] = ()


def run_page(page: str, reader: Reader | None = None, client: str | None = None) -> dict:
    """All blocks of a page in order, in the working directory; gives the names they leave.

    With `client`, a library of `CLIENTS`, those that need it and no others, which stand for
    themselves; without, those that need none.
    """
    reader, names = reader or Reader(), {"__name__": "page"}
    for name, source in reader.given.items():
        give(Path(name), source)
    for line in reader.before:
        call(line)
    for block in blocks_of(ROOT / page):
        if not block.why and needs(block) == client:
            run_block(block, reader, names)
    return names


def needs(block: Block) -> str | None:
    """The library of `CLIENTS` that a block needs."""
    code = block.code if block.language == "python" else ""
    return next((name for name in CLIENTS if re.search(rf"\b{name}", code)), None)


def give(place: Path, source: Path | str | Callable[[Path], object]) -> None:
    """Lay a file of the reader's into the folder."""
    place.parent.mkdir(parents=True, exist_ok=True)
    if callable(source):
        source(place)
    else:
        place.write_bytes(source.encode() if isinstance(source, str) else source.read_bytes())


def run_block(block: Block, reader: Reader, names: dict) -> None:
    """One block; errors name its page and line."""
    code = block.code
    for text, instead in reader.shorter.items():
        code = code.replace(text, instead)
    if block.file:
        give(Path(block.file), code)
    elif block.language == "python":
        blank = "\n" * block.line  # so that a trace has the line of the page
        exec(compile(blank + code, block.page, "exec"), names)
    elif block.language in SHELL:
        for line in commands(code):
            call(line)


def call(line: str) -> None:
    """A command of ours, in this process."""
    from ship_gym_agents.cli import ship_gym

    for long, short in SHORTER.items():
        line = re.sub(rf"{long}(?![.\d])", short, line)
    program, *words = shlex.split(line, comments=True)
    if program == "ship-gym":
        ship_gym.main(words, program, standalone_mode=False)
    else:
        assert any(line.startswith(start) for start in ELSEWHERE), line
