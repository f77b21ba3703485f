"""Runs one case and says what came of it."""

from __future__ import annotations

import dataclasses
import os
import shutil
import time
import traceback
import warnings
from pathlib import Path
from typing import Any

import ship_gym

LONGEST = 300  # characters of a line of a message
MOST_MEMORY = 1 << 30  # [bytes]
_ROOT = Path(ship_gym.__file__).resolve().parents[1]
_OURS = (str(_ROOT / "ship_gym") + os.sep, str(_ROOT / "agents") + os.sep)
_CHECKS = os.path.join("ship_gym", "config.py")
# what must not be; "wording" and "warning" are told, and are no findings
# Kinds that are known and not mended, with the reason; they are counted, and are no findings.
KNOWN = {
    "death: SIGABRT at ship_gym/recording/rerun_export/rrd_file.py": (
        "rerun's library ends the process at a recording that was forged and then sealed again: "
        "the seal tells damage, it is no signature"
    ),
}
BAD = ("traceback", "nonsense", "accepted", "long message", "hang", "death", "memory")


@dataclasses.dataclass
class Verdict:
    """What came of a case.

    Attributes
    ----------
    outcome : str
        One of `BAD`, or "refused", "used", "work" (a command line that was let through).
    where : str
        Of a finding: what was raised and the innermost line of our code.
    message : str
        First characters of what was said.
    seconds : float
        It took.
    memory : int
        Largest resident memory of the process meanwhile [bytes].
    soft : tuple of str
        What is no finding but no good either: warnings of numpy, a message without the file's name.
    """

    outcome: str
    where: str = ""
    message: str = ""
    seconds: float = 0.0
    memory: int = 0
    soft: tuple[str, ...] = ()

    @property
    def bad(self) -> bool:
        """Whether it must not be."""
        return self.outcome in BAD and not self.known

    @property
    def known(self) -> str:
        """Why it is not mended, of a kind of `KNOWN`; empty of others."""
        return next((why for kind, why in KNOWN.items() if self.kind.startswith(kind)), "")

    @property
    def kind(self) -> str:
        """What findings are grouped by."""
        return f"{self.outcome}: {self.where}" if self.where else self.outcome


def judged(case: Any, folder: Path) -> Verdict:
    """Write a case into a folder of its own, use it there, and judge.

    Parameters
    ----------
    case : _fuzz_formats.Case
    folder : Path
        Is made and removed again.
    """
    begun, here = time.monotonic(), os.getcwd()
    main = written(case.files, folder)
    _forget_peak()
    os.chdir(folder)
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", RuntimeWarning)
            found = _outcome(case, main)
    finally:
        os.chdir(here)
        shutil.rmtree(folder, ignore_errors=True)
    found.soft += tuple(sorted({_warning(w) for w in warned if w.category is RuntimeWarning}))
    found.seconds, found.memory = time.monotonic() - begun, peak()
    if not found.bad and found.memory > MOST_MEMORY:
        found.outcome, found.where = "memory", case.kind
    return found


def written(files: dict[str, bytes], folder: Path) -> Path:
    """Write the files of a case; the path of the first."""
    folder.mkdir(parents=True)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder / next(iter(files))


def _outcome(case: Any, main: Path) -> Verdict:
    from _fuzz_commands import Enough
    from _fuzz_formats import FORMATS
    from _fuzz_impossible import NAME
    from _fuzz_use import Nonsense
    from ship_gym_agents.cli.output import _in_words

    try:
        FORMATS[case.kind].use(main, **case.options)
    except Enough:
        return Verdict("work")
    except Nonsense as error:
        return Verdict("nonsense", f"{case.kind}: {error}", str(error))
    except KeyboardInterrupt:
        raise
    except Exception as error:
        if _in_words(error) or isinstance(error, OSError | ImportError):
            return _refused(case, main, error)
        return _raised(error)
    except BaseException as error:  # a panic of a compiled library, an exit
        return _raised(error)
    return Verdict("accepted", case.seed) if case.kind == NAME else Verdict("used")


def _raised(error: BaseException) -> Verdict:
    kind = type(error).__name__
    return Verdict("traceback", f"{kind} at {innermost(error)}", f"{kind}: {_short(error)}")


def _refused(case: Any, main: Path, error: Exception) -> Verdict:
    """A refusal in words, unless one of its lines is too long."""
    text = str(error)
    longest = max(map(len, text.splitlines()), default=0)
    if longest > LONGEST:
        return Verdict("long message", innermost(error), f"{longest} characters: {_short(error)}")
    names = [*(Path(name).name for name in case.files), main.parent.name]
    named = case.kind == "command" or any(name in text for name in names)
    soft = () if named else (f"wording: no file named, {caller(error)}",)
    return Verdict("refused", "", _short(error), soft=soft)


def _short(error: BaseException) -> str:
    try:
        return str(error)[:400]
    except Exception as worse:
        return f"its text raises {type(worse).__name__}"


def _warning(found: warnings.WarningMessage) -> str:
    name = found.filename.removeprefix(str(_ROOT) + os.sep)
    return f"warning: {str(found.message)[:80]} at {name}:{found.lineno}"


def innermost(error: BaseException) -> str:
    """Place of the innermost line of our code that an error came through."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename.startswith(_OURS)]
    return _place(frames[-1]) if frames else "outside our code"


def caller(error: BaseException) -> str:
    """The same of a refusal: who asked for what ``config.py`` has checked."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename.startswith(_OURS)]
    asked = [f for f in frames if not f.filename.endswith(_CHECKS)] or frames
    return _place(asked[-1]) if asked else "outside our code"


def _place(frame: traceback.FrameSummary) -> str:
    name = frame.filename.removeprefix(str(_ROOT) + os.sep)
    return f"{name}:{frame.lineno} {frame.name}"


def innermost_of_dump(text: str) -> str:
    """The same from what ``faulthandler`` has written of a process that hung or died."""
    for line in text.splitlines():
        if '"' in line and line.split('"')[1].startswith(_OURS):
            name = line.split('"')[1].removeprefix(str(_ROOT) + os.sep)
            return f"{name}{line.rpartition(', line')[2].replace(' in', ':', 1).strip()}"
    return "outside our code"


def _forget_peak() -> None:
    """Let the system count the largest memory anew, where it can."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        pass


def peak() -> int:
    """Largest resident memory of this process since `_forget_peak` [bytes]."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        import resource

        return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
