"""Draw the pictures of recordings for the documentation, in rerun's native and web viewer.

Each subject is recorded by commands of ship-gym and drawn at its worst moment, a manoeuvre at its
end, in the dark and in the light theme, at 1920x1080. The native viewer draws without a window, by
a graphics driver in software (Debian: mesa-vulkan-drivers), the web viewer in Chromium (Debian:
chromium, chromium-driver; and selenium).
"""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from _cli import parser, progress, run, show
from _few_colours import write_small
from _web_viewer import check_browser, photograph
from ship_gym_agents.cli.output import need

from ship_gym.config import check_known
from ship_gym.writing import check_place

OUT = Path(__file__).resolve().parents[1] / "docs" / "recordings"
EXAMPLES = (
    "python scripts/draw_recordings.py                     # all: some minutes",
    "python scripts/draw_recordings.py --only track_current --viewers native --out runs/pictures",
)
SIZE = (1920, 1080)
VIEWERS, THEMES = ("native", "web"), ("dark", "light")


@dataclasses.dataclass(frozen=True)
class Subject:
    """What is drawn.

    Attributes
    ----------
    commands : tuple of tuple of str
        Of ship-gym, run in an empty folder.
    file : str
        The recording to draw, in that folder.
    run : str
        The recording whose moment is drawn; default: `file`.
    """

    commands: tuple[tuple[str, ...], ...]
    file: str
    run: str = ""


_SS6 = ("--scenario", "heading_ss6_quartering")
SUBJECTS = {
    "sea_state_6": Subject((("record", "--controller", "pid", *_SS6),), "runs/rollout.rrd"),
    "turning_circle": Subject(
        (("simulate", "turning", *"--ship kcs --sea ss5 --wave-from 45 --rrd turn.rrd".split()),),
        "turn.rrd",
    ),
    "track_current": Subject(
        (("record", "--scenario", "track_current", "--controller", "ilos"),), "runs/rollout.rrd"
    ),
    "pid_and_policy": Subject(
        (
            ("record", "--controller", "pid", *_SS6, "--out", "pid.rrd"),
            ("record", "--policy", "heading_kcs", *_SS6, "--out", "policy.rrd"),
            ("review", "compare", "pid.rrd", "policy.rrd", "--out", "compare.rrd"),
        ),
        "compare.rrd",
        "pid.rrd",
    ),
}


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--only", nargs="+", default=list(SUBJECTS), help=", ".join(SUBJECTS))
    p.add_argument("--viewers", nargs="+", default=VIEWERS, choices=VIEWERS)
    p.add_argument("--themes", nargs="+", default=THEMES, choices=THEMES)
    p.add_argument("--out", type=Path, default=OUT, help="folder (default docs/recordings)")
    return p.parse_args()


def main() -> None:
    args = arguments()
    for name in args.only:
        check_known("subject", name, SUBJECTS)
    check_place(args.out, "--out", folder=True)
    need("rerun", "matplotlib")  # which brings what writes pictures
    if "web" in args.viewers:
        check_browser()
    pictures = list(itertools.product(args.only, args.viewers, args.themes))
    files = []
    with tempfile.TemporaryDirectory() as folder:
        recorded = {
            name: record(SUBJECTS[name], Path(folder) / name)
            for name in progress(args.only, "recording")
        }
        for name, viewer, theme in progress(pictures, "pictures"):
            file = args.out / f"{name}_{viewer}_{theme}.png"
            write_small(DRAWN[viewer](*recorded[name], theme == "light"), file)
            files.append(file)
    sizes = {str(file): file.stat().st_size for file in files}
    wrote = "\n".join(f"wrote {file} ({size / 1000.0:.0f} kB)" for file, size in sizes.items())
    show(args.json, {"files": sizes}, wrote)


def record(subject: Subject, folder: Path) -> tuple[Path, float]:
    """Run the commands of a subject in a folder; its recording and the moment to draw [s]."""
    from ship_gym.recording import Trajectory
    from ship_gym.recording.marks import worst_moment

    folder.mkdir()
    start = "from ship_gym_agents.cli import main; main()"
    for command in subject.commands:
        done = subprocess.run(
            [sys.executable, "-c", start, *command], cwd=folder, capture_output=True, text=True
        )
        if done.returncode:
            raise OSError(f"ship-gym {' '.join(command)}: {done.stderr.strip()}")
    run = Trajectory.from_file(folder / (subject.run or subject.file))
    manoeuvre = run.meta.get("kind") == "manoeuvre"
    return folder / subject.file, float(run["t"][-1]) if manoeuvre else worst_moment(run)


def native(path: Path, moment: float, light: bool) -> bytes:
    """PNG of the native viewer."""
    from ship_gym.recording.rerun_export.viewer import screenshot

    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "shot.png"
        screenshot(path, out, moment, SIZE, light)
        return out.read_bytes()


def web(path: Path, moment: float, light: bool) -> bytes:
    """PNG of the web viewer."""
    with _served(path) as address:
        return photograph(address, moment, SIZE, light)


@contextlib.contextmanager
def _served(path: Path) -> Iterator[str]:
    from ship_gym.recording.rerun_export.viewer import serve_web

    server = serve_web(path)
    try:
        yield server.address
    finally:
        server.stop()


DRAWN = {"native": native, "web": web}


if __name__ == "__main__":
    run(main)
