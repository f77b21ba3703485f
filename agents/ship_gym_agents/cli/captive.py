"""``ship-gym simulate captive``: what it sails, draws and prints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

ALL = "all"


def captive(
    as_json: bool,
    ship: Any,
    *,
    test: str | None,
    measured: str | None,
    speed: float | None,
    n: float | None,
    out: Path | None,
) -> None:
    """Tow a ship through a captive test, or through the runs of a file of measured ones.

    Parameters
    ----------
    as_json : bool
    ship : Ship
    test : str, optional
        One of ``captive.TESTS``, or all of them if omitted.
    measured : str, optional
        A file that ``reports.captive_file.read_measured`` reads; it says what is run.
    speed, n : float, optional
        As in ``captive.programme``.
    out : Path, optional
        Picture; of several tests each has its name added.
    """
    from ship_gym.captive import TESTS
    from ship_gym.config import ConfigError, check_known
    from ship_gym.plotting.captive import plot_captive
    from ship_gym.reports import captive as report
    from ship_gym_agents.cli.output import place, progress, show

    out = place(out, "runs/captive.png")
    if test is not None:
        check_known("captive test", test, (*TESTS, ALL))
    if measured is not None:
        given = {"test": test, "speed": speed, "n": n}
        for name in (name for name, value in given.items() if value is not None):
            raise ConfigError(f"{name}: a file of measured runs says it; leave it out")
        cases = [report.tow_as_measured(ship, measured)]
    else:
        tests = TESTS if test in (None, ALL) else (test,)
        cases = [report.tow(ship, each, speed, n) for each in progress(tests, "towing")]
    several = len(cases) > 1
    files = [out.with_stem(f"{out.stem}_{case.test}") if several else out for case in cases]
    for case, path in zip(cases, files, strict=True):
        plot_captive(case, path)
    data = [report.as_dict(c) | {"files": [str(f)]} for c, f in zip(cases, files, strict=True)]
    text = report.all_as_text(cases, [str(path) for path in files])
    show(as_json, {"captive": data}, text)
